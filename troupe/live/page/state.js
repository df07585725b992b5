// What the page knows of the run: the scene, the latest moment, and what follows from all moments.

import { SETTLED } from "./frames.js";
import { Trails } from "./trails.js";

export class State {
  scene = null;
  time = 0; tick = 0; count = 0;
  names = []; models = [];
  poses = new Float32Array(0); colors = new Uint32Array(0); states = new Uint8Array(0);
  things = new Float32Array(0);
  fans = []; cones = []; sights = []; marks = []; switches = [];
  said = new Map(); drawn = []; status = {}; cards = {};
  paint = null;          // owners by cell, once anything is painted
  painted = [];          // runs of cells that are still to be drawn
  trails = new Trails();
  history = [];          // times and measures, thinned out as it grows
  moments = 0;

  begin(message) {
    Object.assign(this, new State());
    this.scene = message.about;
    this.scene.solids = message.solids;
  }

  take(message, now) {
    this.moments += 1;
    if (message.entered) {
      message.entered.robots.forEach(([name, model], k) => {
        this.names[message.entered.from + k] = name;
        this.models[message.entered.from + k] = model;
      });
    }
    this.count = message.robots;
    for (const part of ["poses", "colors", "states", "things", "fans", "cones", "sights", "marks",
                        "switches", "drawn", "status"]) {
      if (message[part] !== undefined) this[part] = message[part];
    }
    if (message.cards) this.cards = message.cards;
    for (const [robot, time, text] of message.said ?? []) this.said.set(robot, { time, text });
    if (message.solids) Object.assign(this.scene, { solids: message.solids, begun: now });
    if (message.paint) this.#paint(message.paint);
    this.#pace(message, now);
    this.time = message.time;
    this.tick = message.tick;
    if (message.ways) this.trails.begin(message.ways, message.time);
    this.trails.mark(this.time, this.poses);
  }

  settled(robot) { return (this.states[robot] & SETTLED) !== 0; }

  #paint({ firsts, lengths, owners }) {
    const { columns, rows } = this.scene.floor;
    this.paint ??= new Uint32Array(columns * rows);
    for (let k = 0; k < firsts.length; k++) {
      this.paint.fill(owners[k], firsts[k], firsts[k] + lengths[k]);
      this.painted.push([firsts[k], lengths[k]]);
    }
  }

  #pace(message, now) {
    const before = this.clock;
    if (!before || message.time < before.time || this.status.paused) {
      this.clock = { time: message.time, now };
      if (this.status.paused) this.speed = 0;
      return;
    }
    const passed = (now - before.now) / 1000;
    if (passed < 0.25) return;
    this.speed = (message.time - before.time) / passed;
    this.clock = { time: message.time, now };
    const { coverage, contacts, ended } = this.status;
    this.history.push({ time: message.time, speed: this.speed, coverage, contacts, ended });
    if (this.history.length > 600) this.history = this.history.filter((_, k) => k % 2 === 0);
  }
}
