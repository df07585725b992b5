// What can be kept: the picture, and the robots' poses as a world file has them.

/** The canvas as a PNG file. */
export function savePicture(canvas, name) {
  canvas.toBlob((blob) => offer(blob, `${name}.png`), "image/png");
}

/** The present poses, to be pasted into a world file: metres and degrees. */
export function posesOf(state) {
  const lines = ["robots:"];
  for (let robot = 0; robot < state.count; robot++) {
    const [x, y, yaw] = state.poses.subarray(3 * robot, 3 * robot + 3);
    const numbers = [x, y, (yaw * 180) / Math.PI].map((value) => Number(value.toFixed(4)));
    const [name, model] = [state.names[robot], state.models[robot]].map((t) => JSON.stringify(t));
    lines.push(`  - {name: ${name}, model: ${model}, pose: [${numbers.join(", ")}]}`);
  }
  return `# ${state.scene.title.replace(/\s+/g, " ")}, ${state.time.toFixed(1)} s, seed ${state.status.seed}\n${lines.join("\n")}\n`;
}

export function savePoses(state, name) {
  offer(new Blob([posesOf(state)], { type: "text/yaml" }), `${name}.yaml`);
}

function offer(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
