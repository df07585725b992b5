// Hands: Stage's keys and mouse, and fingers. What they ask for the run obeys, or refuses.

import { within } from "./shapes.js";
import { twistOf } from "./steering.js";

const PACES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
const NEAR = 6;         // pixels by which a body may be missed
const SLACK = 4;        // pixels that a click may move
const SOON = 500;       // milliseconds within which a pace that was asked for has come
const MOST_CARDS = 8;   // robots of which the run tells a page more; the latest has the card

export class Hands {
  /** `page` has state, camera, view, canvas, link, painter and changed(). */
  constructor(page) {
    this.page = page;
    this.grip = null;
    this.fingers = new Map();
    this.driven = new Set();
    const { canvas } = page;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => this.#up(event));
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      page.camera.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
      page.changed();
    }, { passive: false });
    window.addEventListener("keydown", (event) => this.#key(event));
    window.addEventListener("keyup", (event) => this.#release(event));
    window.addEventListener("blur", () => this.#stop());
  }

  // -- what is asked for

  ask(what) { this.page.link.ask(what); }

  toggle() { this.ask({ do: this.page.state.status.paused ? "go" : "pause" }); }

  step() { this.ask({ do: "step", ticks: 1 }); }

  /** A tick back; only a log has that. */
  back() {
    const { scene, tick } = this.page.state;
    if (scene?.log) this.ask({ do: "seek", time: (tick - 1) * scene.interval });
  }

  pace(factor) {
    this.wanted = { factor, until: performance.now() + SOON };
    this.ask({ do: "pace", factor });
  }

  /** The next pace of the row, up (1) or down (-1). Beyond the row lies flat out. */
  shift(direction) {
    // keys come quicker than what they bring about
    const late = this.wanted && performance.now() < this.wanted.until;
    const { pace = 1 } = this.page.state.status, now = late ? this.wanted.factor : pace;
    const faster = PACES.find((pace) => pace > now * 1.001) ?? null;
    const slower = PACES.findLast((pace) => pace < (now ?? Infinity) * 0.999) ?? PACES[0];
    if (direction > 0) this.pace(now === null ? null : faster);
    else this.pace(slower);
  }

  select(robots) {
    const { view } = this.page;
    this.#stop();              // or who was driven would drive on
    view.selected = new Set(robots);
    this.ask({ do: "select", robots: [...view.selected].slice(-MOST_CARDS) });
    this.page.changed();
  }

  /** The next robot, or the last one. */
  next(direction) {
    const { state, view } = this.page;
    if (!state.count) return;
    const now = view.selected.size ? [...view.selected].at(-1) : direction > 0 ? -1 : state.count;
    this.select([(now + direction + state.count) % state.count]);
  }

  /** Move the view; it follows nobody any more. */
  #pan(columns, rows) {
    const { camera, view } = this.page;
    camera.pan(columns, rows);
    if (view.show.follow) this.page.toggle("follow");
  }

  // -- the mouse, and fingers

  #at(column, row) {
    const { state, camera, painter } = this.page;
    let best = null, least = Infinity;
    for (let robot = 0; robot < state.count; robot++) {
      const distance = Math.hypot(camera.column(state.poses[3 * robot]) - column,
                                  camera.row(state.poses[3 * robot + 1]) - row);
      const room = Math.max(painter.reach(state, robot, camera), NEAR);
      if (distance <= room && distance < least) [best, least] = [{ robot }, distance];
    }
    if (best) return best;
    state.scene.things.forEach(({ shape, parts }, thing) => {
      if (parts) return;
      const distance = Math.hypot(camera.column(state.things[3 * thing]) - column,
                                  camera.row(state.things[3 * thing + 1]) - row);
      const room = Math.max(painter.shape(shape).at(camera.scale).reach, NEAR);
      if (distance <= room && distance < least) [best, least] = [{ thing }, distance];
    });
    return best ?? this.#standing(...camera.metres(column, row));
  }

  /** What stands there, and may be put elsewhere: it is large, and only itself is to be met. */
  #standing(px, py) {
    const { scene, things } = this.page.state;
    const thing = scene.things.findLastIndex(({ parts }, k) => {
      const [x, y, yaw] = things.subarray(3 * k, 3 * k + 3), cos = Math.cos(yaw), sin = Math.sin(yaw);
      const at = [cos * (px - x) + sin * (py - y), cos * (py - y) - sin * (px - x)];
      return parts?.some((corners) => within(corners, at));
    });
    return thing < 0 ? null : { thing };
  }

  #down(event) {
    const { state, canvas, view } = this.page;
    if (!state.scene) return;
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (this.fingers.size > 1) {
      this.#pinch();
      return;
    }
    const found = this.#at(event.offsetX, event.offsetY);
    const turn = event.button === 2 || event.ctrlKey;
    this.grip = { kind: "floor", column: event.offsetX, row: event.offsetY, moved: false,
                  more: event.shiftKey, found };
    if (!found || view.readOnly) return;
    const poses = found.robot === undefined ? state.things : state.poses;
    const index = found.robot ?? found.thing;
    const [x, y, yaw] = poses.subarray(3 * index, 3 * index + 3);
    const [px, py] = this.page.camera.metres(event.offsetX, event.offsetY);
    Object.assign(this.grip, { kind: turn ? "turn" : "move", x, y, yaw, px, py, index });
  }

  /** Two fingers zoom; the one that stays moves the floor. */
  #pinch() {
    this.page.view.ghost = null;
    this.grip = this.fingers.size > 1 ? { kind: "pinch", apart: this.#apart() }
      : { kind: "floor", moved: true };
  }

  #apart() {
    const [[ax, ay], [bx, by]] = [...this.fingers.values()];
    return { distance: Math.hypot(ax - bx, ay - by), column: (ax + bx) / 2, row: (ay + by) / 2 };
  }

  #move(event) {
    const { grip } = this, { camera } = this.page;
    if (!this.fingers.has(event.pointerId) || !grip) return;
    const [oldColumn, oldRow] = this.fingers.get(event.pointerId);
    this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (grip.kind === "pinch") {
      const now = this.#apart(), before = grip.apart;
      camera.pan(now.column - before.column, now.row - before.row);
      camera.zoom(now.distance / Math.max(before.distance, 1), now.column, now.row);
      grip.apart = now;
      this.page.changed();
      return;
    }
    grip.moved ||= Math.hypot(event.offsetX - grip.column, event.offsetY - grip.row) > SLACK;
    if (!grip.moved) return;
    if (grip.kind === "floor") {
      this.#pan(event.offsetX - oldColumn, event.offsetY - oldRow);
    } else {
      const [x, y] = camera.metres(event.offsetX, event.offsetY);
      const pose = grip.kind === "turn"
        ? [grip.x, grip.y, Math.atan2(y - grip.y, x - grip.x)]
        : [grip.x + x - grip.px, grip.y + y - grip.py, grip.yaw];
      this.#hold(grip, pose);
    }
    this.page.changed();
  }

  /** The robot is held there: it goes where it may, and an outline shows where it should. */
  #hold(grip, pose) {
    const { state, view } = this.page;
    grip.pose = pose;
    const shape = grip.found.robot === undefined ? state.scene.things[grip.index].shape
      : state.scene.models[state.models[grip.index]].shape;
    view.ghost = { shape, x: pose[0], y: pose[1], yaw: pose[2] };
    if (grip.waiting) return;
    grip.waiting = true;       // one a picture is enough
    requestAnimationFrame(() => {
      grip.waiting = false;
      this.#put(grip.found, grip.index, grip.pose);
    });
  }

  #put(found, robot, pose) {
    this.ask({ do: found.robot === undefined ? "put_thing" : "put", robot, pose });
  }

  #up(event) {
    const { grip } = this;
    this.fingers.delete(event.pointerId);
    if (!grip) return;
    if (this.fingers.size) {
      this.#pinch();
      return;
    }
    this.grip = null;
    this.page.view.ghost = null;
    if (grip.kind !== "pinch" && !grip.moved) this.#click(grip);
    else if (grip.pose) this.#put(grip.found, grip.index, grip.pose);
    this.page.changed();
  }

  #click({ found, more }) {
    const { selected } = this.page.view;
    if (found?.robot === undefined) {
      if (!more) this.select([]);
      return;
    }
    if (!more) this.select([found.robot]);
    else if (selected.has(found.robot)) this.select([...selected].filter((r) => r !== found.robot));
    else this.select([...selected, found.robot]);
  }

  // -- keys

  #key(event) {
    const typing = event.target.closest?.("input:not([type=checkbox]):not([type=range]), textarea, select");
    if (typing && event.key !== "Escape") return;
    if (event.metaKey || (event.ctrlKey && !event.key.startsWith("Arrow"))) return;
    const button = event.target.closest?.("button, input[type=checkbox], summary, pre");
    if (button && (event.key === " " || event.key === "Enter")) return;
    if (event.key.startsWith("Arrow")) {
      if (this.#arrow(event)) event.preventDefault();
      return;
    }
    const { page } = this, act = {
      p: () => this.toggle(), ".": () => this.step(),
      "<": () => this.back(), ">": () => this.step(),
      "[": () => this.shift(-1), "]": () => this.shift(1),
      "{": () => this.pace(1), "}": () => this.pace(null),
      " ": () => page.camera.reset(page.state.scene),
      "+": () => page.camera.zoom(1.25), "=": () => page.camera.zoom(1.25),
      "-": () => page.camera.zoom(0.8),
      ",": () => this.next(1), ";": () => this.next(-1),
      k: () => this.#take(), v: () => page.toggle("others"),
      q: () => this.#turn(0.1), e: () => this.#turn(-0.1),
      D: () => page.which(), d: () => page.toggle("sensors"), b: () => page.toggle("blobs"),
      t: () => page.toggle("trails"), n: () => page.toggle("names"),
      o: () => page.toggle("speech"), g: () => page.toggle("grid"),
      f: () => page.toggle("follow"), "?": () => page.help(),
      Escape: () => page.escape(),
    }[event.key];
    if (!act || !page.state.scene) return;
    if (event.repeat && event.key === "p") return;
    event.preventDefault();
    act();
    page.changed();
  }

  /** Arrows drive; with Shift they move the robot, with Alt or without a robot the view. */
  #arrow(event) {
    const { view, state } = this.page;
    if (!state.scene || event.target.closest?.("input[type=range], #help, pre")) return false;
    const [right, up] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1],
                          ArrowDown: [0, -1] }[event.key];
    const robots = [...view.selected].filter((robot) => robot < state.count);
    if (event.altKey || robots.length === 0) {
      if (event.target.closest?.("aside")) return false;
      this.#pan(-40 * right, 40 * up);
      this.page.changed();
      return true;
    }
    if (view.readOnly) return false;
    if (event.shiftKey) {
      for (const robot of robots) {
        const [x, y, yaw] = state.poses.subarray(3 * robot, 3 * robot + 3);
        this.#put({ robot }, robot, [x + 0.1 * right, y + 0.1 * up, yaw]);
      }
      return true;
    }
    if (!event.repeat) {
      this.driven.add(event.key);
      this.#steer();
    }
    return true;
  }

  #turn(angle) {
    const { view, state } = this.page;
    if (view.readOnly) return;
    for (const robot of view.selected) {
      const [x, y, yaw] = state.poses.subarray(3 * robot, 3 * robot + 3);
      this.#put({ robot }, robot, [x, y, yaw + angle]);
    }
  }

  #release(event) {
    if (this.driven.delete(event.key)) this.#steer();
  }

  #stop() {
    if (this.driven.size === 0) return;
    this.driven.clear();
    this.#steer();
  }

  /** Drive the selected robots as the arrows are held down. */
  #steer() {
    const { state, view } = this.page, held = (key) => (this.driven.has(key) ? 1 : 0);
    const ahead = held("ArrowUp") - held("ArrowDown"), left = held("ArrowLeft") - held("ArrowRight");
    for (const robot of view.selected) {
      const told = state.scene.models[state.models[robot]]?.drive;
      this.ask({ do: "drive", robot, twist: twistOf(told, ahead, left) });
    }
  }

  /** Take the selected robots from their controllers, or give them back. */
  #take() {
    const { state, view } = this.page;
    for (const robot of view.readOnly ? [] : view.selected) {
      this.ask({ do: state.cards[robot]?.taken ? "give" : "take", robot });
    }
  }
}
