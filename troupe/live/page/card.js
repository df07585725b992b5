// A robot's card: what it knows, what it is told, and its sensors as small plots. All text is text.

import { css, tint } from "./colors.js";
import { printable } from "./texts.js";

const degrees = (radians) => `${((radians * 180) / Math.PI).toFixed(1)}°`;
const metres = (value, digits = 2) => `${value.toFixed(digits)} m`;
const pose = ([x, y, yaw]) => `${x.toFixed(2)}, ${y.toFixed(2)} m, ${degrees(yaw)}`;

export class Card {
  constructor(box, drive) {
    this.box = box;
    this.drive = drive;     // (robot, [vx, vy, wz])
    this.robot = null;
  }

  /** Show a robot, or (null) nobody; `all`: how many are selected. */
  show(state, robot, ink, all) {
    const card = robot === null ? undefined : state.cards[robot];
    if (!card) {
      if (this.robot !== null || !this.box.firstChild) this.#clear(all);
      return;
    }
    const kinds = card.sensors.map(({ type, kind }) => `${type} ${kind}`).join();
    const look = `${robot},${card.name},${card.drivable},${kinds},${all}`;
    if (look !== this.look) this.#build(state, robot, card, all, look);
    this.#fill(state, card, ink);
  }

  #clear() {
    this.robot = null;
    this.look = "";
    this.box.replaceChildren(element("p", {
      className: "hint", textContent: "Click a robot, or type its name, to see what it knows." }));
  }

  #build(state, robot, card, all, look) {
    this.robot = robot;
    this.look = look;
    const head = element("h2", { textContent: printable(card.name) });
    const more = all > 1 ? [element("p", { className: "hint", textContent: `and ${all - 1} more` })]
      : [];
    this.rows = new Map();
    const table = element("table");
    const body = table.appendChild(element("tbody"));
    for (const name of ["model", "pose", "twist", "odometry", "odometry error", "command", "driven",
                        "contacts", "controller", "waits", "devices", "properties"]) {
      const row = body.appendChild(element("tr"));
      row.append(element("th", { textContent: name, scope: "row" }));
      this.rows.set(name, row.appendChild(element("td")));
    }
    this.plots = card.sensors.map((sensor, k) => {
      const canvas = element("canvas");
      canvas.setAttribute("role", "img");
      const figure = element("figure");
      const title = element("figcaption", { textContent: `${sensor.type} (${k})` });
      figure.append(canvas, title);
      return { figure, canvas, title, sensor: k };
    });
    const plots = element("div", { className: "plots" });
    plots.append(...this.plots.map(({ figure }) => figure));
    this.said = element("pre", { tabIndex: 0 });
    this.said.setAttribute("aria-label", "What it said");
    this.output = element("pre", { tabIndex: 0 });
    this.output.setAttribute("aria-label", "What its controller printed");
    const parts = [head, ...more, table];
    if (card.drivable) parts.push(this.#pad(robot, state));
    if (this.plots.length) parts.push(element("h3", { textContent: "Sensors" }), plots);
    parts.push(element("h3", { textContent: "Said" }), this.said,
               element("h3", { textContent: "Printed" }), this.output);
    this.box.replaceChildren(...parts);
  }

  /** Buttons that drive as long as they are held down. */
  #pad(robot, state) {
    const box = element("div");
    const pad = element("div", { className: "pad" });
    const told = state.scene.models[state.models[robot]].drive;
    const v = 0.6 * Math.min(told?.max_speed ?? 1, 2), w = 0.5 * Math.min(told?.max_turn_rate ?? 1, 2);
    for (const [label, name, twist] of [
      ["↖", "ahead and left", [v, 0, w]], ["↑", "ahead", [v, 0, 0]], ["↗", "ahead and right", [v, 0, -w]],
      ["←", "turn left", [0, 0, w]], ["■", "stop", [0, 0, 0]], ["→", "turn right", [0, 0, -w]],
      ["↙", "back and left", [-v, 0, -w]], ["↓", "back", [-v, 0, 0]], ["↘", "back and right", [-v, 0, w]],
    ]) {
      const button = element("button", { type: "button", textContent: label });
      button.setAttribute("aria-label", name);
      const stop = () => this.drive(robot, [0, 0, 0]);
      button.onpointerdown = (event) => {
        button.setPointerCapture(event.pointerId);
        this.drive(robot, twist);
      };
      button.onpointerup = button.onpointercancel = stop;
      button.onkeydown = (event) => {
        if ((event.key === "Enter" || event.key === " ") && !event.repeat) this.drive(robot, twist);
      };
      button.onkeyup = stop;
      pad.append(button);
    }
    box.append(element("h3", { textContent: "Drive it" }), pad);
    return box;
  }

  #fill(state, card, ink) {
    const { controller } = card, [kind, numbers] = card.command;
    const put = (name, text) => {
      const cell = this.rows.get(name);
      cell.parentElement.hidden = text === null;   // a log has not all that a run knows
      if (text !== null && cell.textContent !== text) cell.textContent = text;
    };
    put("model", printable(card.model));
    put("pose", pose(card.pose));
    put("twist", `${card.twist[0].toFixed(2)}, ${card.twist[1].toFixed(2)} m/s, ${degrees(card.twist[2])}/s`);
    put("odometry", card.odometry && pose(card.odometry));
    put("odometry error", card.error &&
      `${metres(Math.hypot(card.error[0], card.error[1]), 3)}, ${degrees(card.error[2])}`);
    put("command", `${kind} ${numbers.map((n) => n.toFixed(2)).join(", ")}`);
    const stalled = card.stalled ? "stalled now" : "";
    put("driven", card.distance === null ? stalled || null
      : `${metres(card.distance, 1)}${stalled && `, ${stalled}`}, ${card.stalls} stalls`);
    put("contacts", String(card.contacts));
    const ended = controller.error ? `: ${printable(controller.error, 400)}` : "";
    const driver = [controller.kind, controller.state].filter(Boolean).join(", ");
    put("controller", driver ? `${driver}${ended}` : null);
    const waited = controller.waited === null ? "" : `now ${controller.waited.toFixed(1)} s, `;
    put("waits", controller.last_wait === null ? null : `${waited}last ${(1000 * controller.last_wait).toFixed(1)} ms, ` +
      `longest ${(1000 * controller.longest_wait).toFixed(0)} ms`);
    put("devices", controller.last_wait === null ? null
      : card.devices.join(", ") || "none subscribed");
    const told = Object.entries(card.properties).map(
      ([key, value]) => `${printable(key, 40)}: ${printable(JSON.stringify(value), 80)}`);
    put("properties", told.join("; ") || "none");
    lines(this.said, card.said.map(([time, text]) => `${time.toFixed(1)} s  ${printable(text)}`));
    lines(this.output, card.output.map((line) => printable(line)));
    for (const plot of this.plots) this.#plot(state, plot, card.sensors[plot.sensor], ink);
  }

  #plot(state, { canvas, title, sensor }, told, ink) {
    const own = (parts) => parts.find((p) => p.robot === this.robot && p.sensor === sensor);
    const color = css(tint(ink, this.robot));
    if (told.kind === "scan" || told.kind === "intensities") {
      const fan = own(state.fans);
      if (fan) this.#fan(prepared(canvas, 150, 150), fan, told.range, color, ink);
      if (fan) note(title, `${told.type}: nearest ${metres(Math.min(...fan.ranges))}`);
    } else if (told.kind === "elements") {
      const cones = own(state.cones);
      if (cones) bars(prepared(canvas, 150, 80), cones.elements, 3, 4, told.range, color);
      if (cones) note(title, `${told.type}: ${cones.elements.length / 4} elements`);
    } else if (told.kind === "blobs") {
      const sight = own(state.sights);
      if (sight) image(canvas, sight);
      if (sight) note(title, `${told.type}: ${sight.blobs.length / 6} blobs`);
    } else if (told.kind === "bits") {
      const switches = own(state.switches);
      if (switches) bits(prepared(canvas, 80, 80), switches.parts);
      if (switches) {
        const closed = switches.parts.filter((_, k) => k % 3 === 0).reduce((a, b) => a + b, 0);
        note(title, `${told.type}: ${closed} of ${switches.parts.length / 3} closed`);
      }
    } else if (told.kind === "fiducials") {
      const marks = own(state.marks);
      canvas.hidden = true;
      const seen = [];
      for (let k = 0; marks && k < marks.seen.length; k += 4) {
        const [id, x, y] = marks.seen.subarray(k, k + 3);
        seen.push(`${id} at ${metres(Math.hypot(x, y))}, ${degrees(Math.atan2(y, x))}`);
      }
      note(title, `${told.type}: ${seen.join("; ") || "none in sight"}`);
    } else {
      canvas.hidden = true;
      note(title, (told.values ?? []).map(
        ([name, value, unit]) => `${name} ${value.toPrecision(4)} ${unit}`).join(", "));
    }
  }

  /** A scan in polar form: ahead is up. */
  #fan(context, fan, range, color, ink) {
    const size = 150, far = Math.min(range, 1.05 * Math.max(...fan.ranges.map(
      (r) => (r < 0.999 * range ? r : 0))) || range);
    const wide = fan.fov > Math.PI, scale = (size / 2 - 4) / far * (wide ? 1 : 1);
    const cx = size / 2, cy = wide ? size / 2 : size - 6, k = wide ? scale : (size - 12) / far;
    const fit = Math.min(k, (size / 2 - 2) / far);
    context.strokeStyle = css(ink.grid);
    for (const part of [0.5, 1]) {
      context.beginPath();
      context.arc(cx, cy, part * far * fit, 0, 2 * Math.PI);
      context.stroke();
    }
    context.beginPath();
    const last = Math.max(fan.ranges.length - 1, 1);
    context.moveTo(cx, cy);
    fan.ranges.forEach((range, i) => {
      const angle = -fan.fov / 2 + (fan.fov * i) / last, r = Math.min(range, far) * fit;
      context.lineTo(cx - r * Math.sin(angle), cy - r * Math.cos(angle));
    });
    context.closePath();
    context.globalAlpha = 0.3;
    context.fillStyle = color;
    context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = css(ink.ink);
    context.stroke();
  }
}

/** A camera's image as Player's clients see it. */
function image(canvas, { width, height, blobs }) {
  const scale = Math.max(1, Math.floor(280 / width));
  const context = prepared(canvas, width * Math.max(scale, 1), height * Math.max(scale, 1) / 2);
  context.scale(Math.max(scale, 1), Math.max(scale, 1) / 2);
  context.fillStyle = "#101214";
  context.fillRect(0, 0, width, height);
  for (let k = 0; k < blobs.length; k += 6) {
    const [color, left, right, top, bottom] = blobs.subarray(k, k + 5);
    context.fillStyle = css(color);
    context.fillRect(left, top, right - left + 1, bottom - top + 1);
  }
}

function bars(context, values, offset, stride, most, color) {
  const count = values.length / stride, width = 150 / count;
  context.fillStyle = color;
  for (let k = 0; k < count; k++) {
    const height = 76 * Math.min(values[stride * k + offset] / most, 1);
    context.fillRect(k * width + 1, 80 - height, Math.max(width - 2, 1), height);
  }
}

function bits(context, parts) {
  for (let k = 0; k < parts.length; k += 3) {
    context.beginPath();
    context.arc(40, 40, 28, -parts[k + 2] - Math.PI / 2 + 0.05, -parts[k + 1] - Math.PI / 2 - 0.05);
    context.lineWidth = parts[k] ? 12 : 4;
    context.strokeStyle = parts[k] ? "#d01010" : "#888888";
    context.stroke();
  }
}

/** A canvas of so many style pixels, emptied. */
function prepared(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  canvas.hidden = false;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  return context;
}

function note(title, text) {
  if (title.textContent === text) return;
  title.textContent = text;
  title.previousSibling?.setAttribute("aria-label", text);
}

function lines(box, texts) {
  const text = texts.join("\n") || "nothing";
  if (box.textContent === text) return;
  box.textContent = text;
  box.scrollTop = box.scrollHeight;
}

function element(name, properties = {}) {
  return Object.assign(document.createElement(name), properties);
}
