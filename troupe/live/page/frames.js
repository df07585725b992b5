// Messages taken apart: the page's side of sim/view/frames.py, where they are described.

const MAGIC = 0x31505254;
const words = new TextDecoder();

export const SETTLED = 1, STALLED = 2, TOUCHING = 4, AWAITED = 8;

/** A message as {kind, time, tick, robots, ...}: what a section has not changed is undefined. */
export function decode(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < 24 || view.getUint32(0, true) !== MAGIC) {
    throw new Error("this is no message of Troupe's");
  }
  const message = {
    kind: view.getUint16(4, true) === 1 ? "scene" : "moment",
    time: view.getFloat64(8, true),
    tick: view.getUint32(16, true),
    robots: view.getUint32(20, true),
  };
  let at = 24;
  while (at < buffer.byteLength) {
    const number = view.getUint32(at, true), size = view.getUint32(at + 4, true);
    const read = SECTIONS[number];
    if (read) read(message, new Part(buffer, at + 8, size));
    at += 8 + size + ((4 - (size % 4)) % 4);
  }
  return message;
}

/** A section that is read from its beginning to its end. */
class Part {
  constructor(buffer, at, size) {
    this.buffer = buffer;
    this.at = at;
    this.size = size;
    this.end = at + size;
  }
  get left() { return this.at < this.end; }
  whole(count) { return this.#take(Uint32Array, count); }
  real(count) { return this.#take(Float32Array, count); }
  #take(Kind, count) {
    const found = new Kind(this.buffer, this.at, count);
    this.at += 4 * count;
    return found;
  }
  bytes() { return new Uint8Array(this.buffer, this.at, this.size); }
  json() { return JSON.parse(words.decode(this.bytes())); }
}

function each(part, read) {
  const found = [];
  while (part.left) found.push(read(part));
  return found;
}

function solids(part) {
  const [count] = part.whole(1);
  const corners = part.whole(count), colors = part.whole(count);
  return Array.from(corners, (k, i) => ({ points: part.real(2 * k), color: colors[i] }));
}

function fan(part) {
  const [robot, sensor, k] = part.whole(3), [x, y, yaw, fov] = part.real(4);
  return { robot, sensor, x, y, yaw, fov, ranges: part.real(k) };
}

function cones(part) {
  const [robot, sensor, k] = part.whole(3), [fov] = part.real(1);
  return { robot, sensor, fov, elements: part.real(4 * k) };
}

function sight(part) {
  const [robot, sensor, k, width, height] = part.whole(5), [x, y, yaw, fov] = part.real(4);
  return { robot, sensor, width, height, x, y, yaw, fov, blobs: part.whole(6 * k) };
}

function marks(part) {
  const [robot, sensor, k] = part.whole(3), [x, y, yaw] = part.real(3);
  return { robot, sensor, x, y, yaw, seen: part.real(4 * k) };
}

function switches(part) {
  const [robot, sensor, k] = part.whole(3), [x, y, yaw] = part.real(3);
  return { robot, sensor, x, y, yaw, parts: part.real(3 * k) };
}

function ways(part) {
  const [marks, robots] = part.whole(2);
  return Array.from({ length: marks }, () => part.real(3 * robots));
}

function paint(part) {
  const [k] = part.whole(1);
  return { firsts: part.whole(k), lengths: part.whole(k), owners: part.whole(k) };
}

const SECTIONS = {
  1: (m, part) => { m.about = part.json(); },
  2: (m, part) => { m.solids = solids(part); },
  3: (m, part) => { m.poses = part.real(3 * m.robots); },
  4: (m, part) => { m.colors = part.whole(m.robots); },
  5: (m, part) => { m.states = part.bytes(); },
  6: (m, part) => { m.things = part.real(part.size / 4); },
  7: (m, part) => { m.fans = each(part, fan); },
  8: (m, part) => { m.cones = each(part, cones); },
  9: (m, part) => { m.sights = each(part, sight); },
  10: (m, part) => { m.marks = each(part, marks); },
  11: (m, part) => { m.switches = each(part, switches); },
  12: (m, part) => { m.paint = paint(part); },
  13: (m, part) => { m.entered = part.json(); },
  14: (m, part) => { m.said = part.json(); },
  15: (m, part) => { m.drawn = part.json(); },
  16: (m, part) => { m.status = part.json(); },
  17: (m, part) => { m.cards = part.json(); },
  18: (m, part) => { m.ways = ways(part); },
};
