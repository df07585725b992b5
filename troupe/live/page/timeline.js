// The time line of a log: to go to any time of it, with marks for what was said, touched and ended.

import { css, tint } from "./colors.js";
import { printable } from "./texts.js";

const NEAR = 6;            // pixels by which a mark may be missed
const MOST_LISTED = 300;   // events in the list

export class TimeLine {
  /** `seek(time)` goes there; `name(robot)` is what a robot is called. */
  constructor(find, seek, name) {
    Object.assign(this, { find, seek, name, log: null, held: false, events: [] });
    const slider = find("when");
    slider.oninput = () => {
      this.wanted = Number(slider.value);
      seek(this.wanted);
    };
    slider.onpointerdown = () => { this.held = true; };
    for (const end of ["pointerup", "pointercancel", "change", "blur"]) {
      slider.addEventListener(end, () => { this.held = false; });
    }
    const marks = find("marks");
    marks.onclick = (event) => seek(this.#near(event)?.time ?? this.#time(event.offsetX));
    marks.onpointermove = (event) => { marks.title = this.#near(event)?.text ?? ""; };
  }

  /** A log is shown, or (null) a run that goes on. */
  begin(log) {
    this.log = log;
    this.find("line").hidden = this.find("events").hidden = !log;
    if (!log) return;
    const slider = this.find("when");
    Object.assign(slider, { min: log.from, max: log.until, step: "any", value: log.from });
    const who = (robot) => printable(this.name(robot) ?? "?", 40);
    this.events = [
      ...log.said.map(([time, robot, words]) => (
        { time, robot, row: 0, text: `${who(robot)}: ${printable(words, 80)}` })),
      ...log.touches.map(([time, robot, x, y]) => (
        { time, robot, row: 1, text: `${who(robot)} touches at (${x.toFixed(2)}, ${y.toFixed(2)})` })),
      ...log.ends.map(([time, robot, state, error]) => (
        { time, robot, row: 2, text: `${who(robot)}: ${state}${error ? `, ${printable(error, 120)}` : ""}` })),
    ].sort((a, b) => a.time - b.time);
    this.drawn = "";
    this.#list();
  }

  #list() {
    const every = Math.ceil(this.events.length / MOST_LISTED) || 1;
    const shown = this.events.filter((event, k) => event.row === 2 || k % every === 0);
    this.find("happened").replaceChildren(...shown.slice(0, 2 * MOST_LISTED).map((event) => {
      const item = document.createElement("li"), button = document.createElement("button");
      Object.assign(button, { type: "button",
                              textContent: `${event.time.toFixed(1)} s  ${event.text}` });
      button.onclick = () => this.seek(event.time);
      item.append(button);
      return item;
    }));
  }

  #column(time, width) {
    const { from, until } = this.log;
    return 8 + ((width - 16) * (time - from)) / (until - from || 1);   // 8: half of a slider's knob
  }

  #time(column) {
    const { from, until } = this.log, width = this.find("marks").clientWidth;
    const share = (column - 8) / Math.max(width - 16, 1);
    return from + Math.min(Math.max(share, 0), 1) * (until - from);
  }

  #near({ offsetX, offsetY }) {
    const width = this.find("marks").clientWidth, row = Math.floor(offsetY / 7);
    let best = null, least = NEAR;
    for (const event of this.events) {
      const off = Math.abs(this.#column(event.time, width) - offsetX) + 4 * (event.row !== row);
      if (off < least) [best, least] = [event, off];
    }
    return best;
  }

  /** Where the log is now. */
  show(state, ink) {
    if (!this.log) return;
    const slider = this.find("when"), text = `${state.time.toFixed(2)} s`;
    if (!this.held) slider.value = state.time;
    slider.setAttribute("aria-valuetext", `${text} of ${this.log.until.toFixed(1)} s`);
    this.#marks(ink);
  }

  #marks(ink) {
    const canvas = this.find("marks"), ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    const look = `${width},${height},${ratio},${ink.ground}`;
    if (look === this.drawn || !width) return;
    this.drawn = look;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    for (const { time, robot, row } of this.events) {
      const column = this.#column(time, width), top = 7 * row;
      context.fillStyle = row === 1 ? "#d55e00" : row === 2 ? css(ink.ink) : css(tint(ink, Math.max(robot, 0)));
      if (row === 2) {
        context.beginPath();
        context.moveTo(column - 3.5, top);
        context.lineTo(column + 3.5, top);
        context.lineTo(column, top + 6);
        context.fill();
      } else context.fillRect(column - 1, top, 2, 6);
    }
  }
}

/** The time in a link to a moment of a log, `#t=12.3`; null where there is none. */
export function timeIn(hash) {
  const found = /^#t=(\d+(?:\.\d+)?)$/.exec(hash);
  return found ? Number(found[1]) : null;
}
