// What can be kept: the picture, and the robots' poses as a world file has them.

import { SvgContext } from "./svg.js";
import { printable } from "./texts.js";

/** The canvas as a PNG file. */
export function savePicture(canvas, name) {
  canvas.toBlob((blob) => offer(blob, `${name}.png`), "image/png");
}

/** The scene as it is shown, as an SVG file. */
export function saveSvg(page, name) {
  offer(new Blob([svgOf(page)], { type: "image/svg+xml" }), `${name}.svg`);
}

export function svgOf({ painter, state, camera, view }) {
  const context = new SvgContext(camera.width, camera.height, painter.context);
  painter.paint(context, state, camera, view, 1);
  return context.text(`${printable(state.scene.title, 80)}, ${state.time.toFixed(2)} s`);
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

export function saveText(text, name) {
  offer(new Blob([text], { type: "text/yaml" }), name);
}

function offer(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
