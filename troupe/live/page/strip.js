// The run's strip: time, real speed, for whom the world waits, and measures over the whole run.

export class Strip {
  constructor(find) {
    this.find = find;
    this.drawn = 0;
  }

  show(state, ink, now) {
    const { find } = this, { status } = state;
    put(find("time"), `${state.time.toFixed(1)} s of ${state.scene.duration.toLocaleString("en")}`);
    const speed = status.paused ? 0 : state.speed;
    put(find("speed"), speed === undefined ? "–" : `${speed < 10 ? speed.toFixed(1) : Math.round(speed)} × real time`);
    put(find("count"), `${state.count}, ${status.running ?? 0} controllers running`);
    const waits = (status.waiting ?? []).map(([name, wait]) => `${name} (${wait.toFixed(0)} s)`);
    find("waiting-box").hidden = waits.length === 0;
    put(find("waiting"), waits.join(", "));
    const paints = status.coverage !== null && status.coverage !== undefined;
    const { log } = state.scene, whole = log?.coverage ?? [];
    find("speeds-box").hidden = Boolean(log);
    find("coverage-box").hidden = !paints;
    find("coverages-box").hidden = log ? whole.length < 2 : !paints;
    if (paints) put(find("coverage"), `${(100 * status.coverage).toFixed(1)} %`);
    if (now - this.drawn < 500) return;
    this.drawn = now;
    if (log) {
      spark(find("coverages"), whole, 1, ink, 1);
      return;
    }
    spark(find("speeds"), state.history, 1, ink);
    if (paints) spark(find("coverages"), state.history, 2, ink, 1);
  }
}

/** A measure over the whole run as a line. */
function spark(canvas, history, which, ink, most = 0) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth || 144, height = canvas.clientHeight || 24;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  if (history.length < 2) return;
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const from = history[0][0], span = history.at(-1)[0] - from || 1;
  const top = most || Math.max(...history.map((entry) => entry[which])) || 1;
  context.beginPath();
  for (const entry of history) {
    context.lineTo(1 + ((width - 2) * (entry[0] - from)) / span,
                   height - 2 - ((height - 4) * entry[which]) / top);
  }
  context.strokeStyle = ink;
  context.lineWidth = 1.5;
  context.stroke();
}

function put(box, text) {
  if (box.textContent !== text) box.textContent = text;
}
