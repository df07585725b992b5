// A robot's card: what it knows, what it is told, and its sensors as small plots. All text is text.

import { css, tint } from "./colors.js";
import { degrees, fixed, metres } from "./numbers.js";
import { Plot, waits } from "./plots.js";
import { steering } from "./steering.js";
import { printable } from "./texts.js";

const pose = ([x, y, yaw]) => `${fixed(x, 2)}, ${metres(y)}, ${degrees(yaw)}`;
const LONG = 0.3;   // seconds after which a wait is told while it goes on
const ROWS = ["model", "pose", "twist", "odometry", "odometry error", "command", "driven", "contacts",
              "controller", "waits", "devices", "properties"];

export class Card {
  /** `ask(what)`: what is asked of the run. */
  constructor(box, ask) {
    Object.assign(this, { box, ask, robot: null, driven: null });
  }

  /** Show a robot, or (null) nobody; `all`: how many are selected. */
  show(state, robot, ink, all) {
    const card = robot === null ? undefined : state.cards[robot];
    if (!card) {
      if (this.robot !== null || !this.box.firstChild) this.#clear();
      return;
    }
    const kinds = card.sensors.map(({ type, kind }) => `${type} ${kind}`).join();
    const look = `${robot},${card.name},${card.drivable},${card.takable},${card.taken},${kinds},${all}`;
    if (look !== this.look) this.#build(state, robot, card, all, look);
    this.#fill(state, card, ink);
  }

  /** Who is driven from the card stops when that goes, or shows another robot. */
  #letGo() {
    if (this.driven !== null) this.ask({ do: "drive", robot: this.driven, twist: [0, 0, 0] });
    this.driven = null;
  }

  #clear() {
    this.#letGo();
    this.robot = null;
    this.look = "";
    this.box.replaceChildren(element("p", {
      className: "hint", textContent: "Click a robot, or type its name, to see what it knows." }));
  }

  #build(state, robot, card, all, look) {
    this.#letGo();
    const focused = this.box.contains(document.activeElement) && document.activeElement.id;
    this.robot = robot;
    this.look = look;
    const head = element("h2", { textContent: printable(card.name) });
    const more = all > 1 ? [element("p", { className: "hint", textContent: `and ${all - 1} more` })]
      : [];
    this.rows = new Map();
    const table = element("table");
    const body = table.appendChild(element("tbody"));
    for (const name of ROWS) {
      const row = body.appendChild(element("tr"));
      row.append(element("th", { textContent: name, scope: "row" }));
      this.rows.set(name, row.appendChild(element("td")));
      if (name === "waits") body.append(this.#bars());
    }
    this.plots = card.sensors.map((sensor, k) => new Plot(k, sensor));
    const plots = element("div", { className: "plots" });
    plots.append(...this.plots.map(({ figure }) => figure));
    this.said = element("pre", { tabIndex: 0 });
    this.said.setAttribute("aria-label", "What it said");
    this.output = element("pre", { tabIndex: 0 });
    this.output.setAttribute("aria-label", "What its controller printed");
    const parts = [head, ...more, table];
    const mayHold = !state.scene.read_only && (card.takable || card.taken);
    if (mayHold) parts.push(this.#grip(robot, card.taken));
    if (card.drivable && !state.scene.read_only) {
      const told = state.scene.models[state.models[robot]].drive;
      const drive = (twist) => {
        this.driven = twist.some(Boolean) ? robot : null;
        this.ask({ do: "drive", robot, twist });
      };
      parts.push(element("h3", { textContent: "Drive it" }), steering(drive, told));
    }
    if (this.plots.length) parts.push(element("h3", { textContent: "Sensors" }), plots);
    parts.push(element("h3", { textContent: "Said" }), this.said,
               element("h3", { textContent: "Printed" }), this.output);
    this.box.replaceChildren(...parts);
    if (focused) document.getElementById(focused)?.focus();
  }

  /** A row in which waits are drawn. */
  #bars() {
    this.waited = element("canvas");
    this.waited.setAttribute("role", "img");
    this.waited.setAttribute("aria-label", "How long the world waited for it in the last 100 ticks");
    const row = element("tr", { hidden: true });
    row.appendChild(element("td", { colSpan: 2 })).append(this.waited);
    return row;
  }

  /** Take it from whoever drives it, and give it back. */
  #grip(robot, taken) {
    const button = element("button", { type: "button", id: "take", title: "k",
                                       textContent: taken ? "Give it back" : "Take it over" });
    button.setAttribute("aria-keyshortcuts", "k");
    button.onclick = () => this.ask({ do: taken ? "give" : "take", robot });
    return button;
  }

  #fill(state, card, ink) {
    const { controller } = card, [kind, numbers] = card.command, log = Boolean(state.scene.log);
    const put = (name, text) => {
      const cell = this.rows.get(name);
      cell.parentElement.hidden = text === null;
      if (text !== null && cell.textContent !== text) cell.textContent = text;
    };
    put("model", printable(card.model));
    put("pose", pose(card.pose));
    put("twist", `${fixed(card.twist[0], 2)}, ${metres(card.twist[1])}/s, ${degrees(card.twist[2])}/s`);
    put("odometry", card.odometry ? pose(card.odometry)
      : "not in this log: --log-sensors odometry keeps it");
    put("odometry error", card.error &&
      `${metres(Math.hypot(card.error[0], card.error[1]), 3)}, ${degrees(card.error[2])}`);
    put("command", `${kind} ${numbers.map((n) => fixed(n, 2)).join(", ")}`);
    const stalled = card.stalled ? "stalled now" : "";
    put("driven", card.distance === null ? stalled || null
      : `${metres(card.distance, 1)}${stalled && `, ${stalled}`}, ${card.stalls} stalls`);
    put("contacts", String(card.contacts));
    const code = controller.exit_code && `exit code ${controller.exit_code}`;
    const ended = controller.error ? `: ${printable(controller.error, 400)}` : "";
    const driver = [controller.kind, controller.state, code].filter(Boolean).join(", ");
    const held = card.taken ? "; a hand holds the robot" : "";
    put("controller", driver ? `${driver}${ended}${held}` : null);
    this.#waits(card.waits, log, put, css(tint(ink, this.robot)), ink);
    put("devices", card.devices && (card.devices.join(", ") || "none subscribed"));
    const told = Object.entries(card.properties).map(
      ([key, value]) => `${printable(key, 40)}: ${printable(JSON.stringify(value), 80)}`);
    put("properties", told.join("; ") || "none");
    lines(this.said, card.said.map(([time, text]) => `${time.toFixed(1)} s  ${printable(text)}`));
    lines(this.output, card.output.map((line) => printable(line)));
    for (const plot of this.plots) plot.show(state, this.robot, card.sensors[plot.sensor], ink);
  }

  /** How long the world waited for its controller. */
  #waits(told, log, put, color, ink) {
    this.waited.closest("tr").hidden = !told;   // with no tick yet it shows too: nothing is to move
    if (!told) {
      put("waits", log ? "a log does not keep them" : null);
      return;
    }
    const now = told.now > LONG ? `now ${told.now.toFixed(1)} s, ` : "";
    put("waits", told.ticks.length
      ? `${now}last tick ${told.ticks.at(-1).toFixed(1)} ms, longest ${told.longest.toFixed(1)} ms`
      : `${now}timed from the next tick on`);
    waits(this.waited, told.ticks, color, ink);
  }
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
