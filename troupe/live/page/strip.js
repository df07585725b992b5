// The run's strip: time, real speed, for whom the world waits, and measures over the whole run.

const MEASURES = {
  coverage: { text: (value) => `${(100 * value).toFixed(1)} %`, most: () => 1 },
  contacts: { text: String, most: () => 0 },
  ended: { text: String, most: (state) => state.count },
};

export class Strip {
  constructor(find) {
    this.find = find;
    this.drawn = 0;
  }

  show(state, ink, now) {
    const { find } = this, { status } = state, { log } = state.scene;
    put(find("time"), `${state.time.toFixed(1)} s of ${state.scene.duration.toLocaleString("en")}`);
    const speed = status.paused ? 0 : state.speed;
    put(find("speed"), speed === undefined ? "–" : `${speed < 10 ? speed.toFixed(1) : Math.round(speed)} × real time`);
    put(find("count"), `${state.count}, ${status.running ?? 0} controllers running`);
    const waits = (status.waiting ?? []).map(([name, wait]) => `${name} (${wait.toFixed(0)} s)`);
    find("waiting-box").hidden = waits.length === 0;
    put(find("waiting"), waits.join(", "));
    const sometimes = now - this.drawn > 500;
    if (sometimes) this.drawn = now;
    find("speed-curve").hidden = Boolean(log);
    if (sometimes && !log) spark(find("speed-curve"), state.history.map((one) => [one.time, one.speed]), ink);
    for (const [name, { text, most }] of Object.entries(MEASURES)) {
      const value = status[name] ?? null, whole = log?.measures[name] ?? [];
      const box = find(`${name}-box`);
      box.hidden = log ? whole.length < 2 : !value;
      if (box.hidden) continue;
      put(find(name), value === null ? "" : text(value));
      if (!sometimes) continue;
      const curve = log ? whole : state.history.map((one) => [one.time, one[name] ?? 0]);
      spark(find(`${name}-curve`), curve, ink, most(state), log ? state.time : null);
    }
  }
}

/** A measure over the whole run as a line, and (of a log) where one is in it. */
function spark(canvas, curve, ink, most = 0, here = null) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth || 144, height = canvas.clientHeight || 24;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  if (curve.length < 2) return;
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const from = curve[0][0], span = curve.at(-1)[0] - from || 1;
  const top = most || Math.max(...curve.map(([, value]) => value)) || 1;
  const column = (time) => 1 + ((width - 2) * (time - from)) / span;
  context.beginPath();
  for (const [time, value] of curve) context.lineTo(column(time), height - 2 - ((height - 4) * value) / top);
  context.strokeStyle = context.fillStyle = ink;
  context.lineWidth = 1.5;
  context.stroke();
  if (here !== null) context.fillRect(column(Math.min(Math.max(here, from), from + span)), 0, 1, height);
}

/** Have a box say something; one that says it already is left alone, or it would be read out again. */
export function put(box, text) {
  if (box.textContent !== text) box.textContent = text;
}
