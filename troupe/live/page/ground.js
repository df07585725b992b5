// What never moves, drawn once for each place of the camera; and the paint on it.

import { css, mix, soften } from "./colors.js";

const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000], APART = 24;
const STRENGTH = 0.5;

export class Ground {
  constructor() {
    this.floor = document.createElement("canvas");
    this.walls = document.createElement("canvas");
    this.key = "";
  }

  /** Floor with its grid, then what `under()` draws, then paint, then walls. */
  draw(context, state, camera, ink, { ratio, grid }, under) {
    const key = `${camera.key},${ratio},${grid},${ink.ground},${state.scene.begun}`;
    if (key !== this.key) {
      this.key = key;
      this.#render(state.scene, camera, ink, ratio, grid);
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.floor, 0, 0);
    under();
    this.#paint(context, state, camera, ink, ratio);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.walls, 0, 0);
  }

  /** The same on any context, line by line, where that one keeps them. */
  trace(context, state, camera, ink, { ratio, grid }, under) {
    floorOn(context, state.scene, camera, ink, ratio, grid);
    under();
    this.#paint(context, state, camera, ink, ratio);
    wallsOn(context, state.scene, camera, ratio);
  }

  #render(scene, camera, ink, ratio, grid) {
    for (const canvas of [this.floor, this.walls]) {
      canvas.width = Math.round(camera.width * ratio);
      canvas.height = Math.round(camera.height * ratio);
    }
    floorOn(this.floor.getContext("2d"), scene, camera, ink, ratio, grid);
    wallsOn(this.walls.getContext("2d"), scene, camera, ratio, true);
  }

  #paint(context, state, camera, ink, ratio) {
    if (!state.paint) return;
    camera.apply(context, ratio);
    const { columns, rows, resolution } = state.scene.floor;
    if (!this.paint || this.scene !== state.scene || this.painting !== ink.ground) {
      this.scene = state.scene;
      this.painting = ink.ground;
      this.paint = document.createElement("canvas");
      this.paint.width = columns;
      this.paint.height = rows;
      this.image = this.paint.getContext("2d");
      this.pixels = this.image.createImageData(columns, rows);
      state.painted = [[0, columns * rows]];
    }
    if (state.painted.length) {
      const words = new Uint32Array(this.pixels.data.buffer);
      const tints = ink.tints.map((color) => little(mix(ink.ground, color, STRENGTH)));
      for (const [first, length] of state.painted) {
        for (let cell = first; cell < first + length; cell++) {
          const owner = state.paint[cell];
          words[cell] = owner ? tints[(owner - 1) % tints.length] : 0;
        }
      }
      state.painted = [];
      this.image.putImageData(this.pixels, 0, 0);
    }
    // Row 0 lies lowest, and the context's y axis points up: the image stands as it should.
    context.imageSmoothingEnabled = false;
    context.drawImage(this.paint, ...state.scene.low, columns * resolution, rows * resolution);
  }
}

/** Floor, grid and doors. */
function floorOn(floor, scene, camera, ink, ratio, grid) {
  const [width, height] = scene.size, [x0, y0] = scene.low, x1 = x0 + width, y1 = y0 + height;
  const pixel = 1 / camera.scale;
  floor.setTransform(1, 0, 0, 1, 0, 0);
  floor.fillStyle = css(ink.outside);
  floor.fillRect(0, 0, camera.width * ratio, camera.height * ratio);
  camera.apply(floor, ratio);
  floor.fillStyle = css(ink.ground);
  floor.fillRect(x0, y0, width, height);
  if (grid) {
    const step = STEPS.find((metres) => metres * camera.scale >= APART) ?? 1000;
    floor.strokeStyle = css(ink.grid);
    floor.lineWidth = pixel;
    floor.beginPath();
    for (const x of multiples(step, x0, x1)) line(floor, x, y0, x, y1);
    for (const y of multiples(step, y0, y1)) line(floor, x0, y, x1, y);
    floor.stroke();
  }
  for (const door of scene.doors) {
    outline(floor, door.flat());
    floor.fillStyle = css(mix(ink.ground, ink.soft_ink, 0.12));
    floor.fill();
    floor.strokeStyle = css(ink.soft_ink);
    floor.lineWidth = pixel;
    floor.stroke();
  }
}

/** What stands. `oblong`: rectangles one by one, which a canvas fills a hundred times faster. */
function wallsOn(walls, scene, camera, ratio, oblong = false) {
  const pixel = 1 / camera.scale, hair = 0.25 * pixel;
  camera.apply(walls, ratio);
  const [left, bottom] = camera.metres(0, camera.height);
  const [right, top] = camera.metres(camera.width, 0);
  const colors = new Map();
  for (const solid of scene.solids) {
    const [x0, y0, x1, y1] = (solid.box ??= box(solid.points));
    if (x1 < left || x0 > right || y1 < bottom || y0 > top) continue;
    if (!colors.has(solid.color)) colors.set(solid.color, []);
    colors.get(solid.color).push(solid);
  }
  for (const [color, shapes] of colors) {
    // A hair's breadth of the same colour closes the seams between blocks of a map.
    walls.fillStyle = walls.strokeStyle = css(soften(color));
    walls.lineWidth = 2 * hair;
    let paths = false;
    walls.beginPath();
    for (const solid of shapes) {
      if (oblong && (solid.oblong ??= isOblong(solid.points, solid.box))) {
        const [x0, y0, x1, y1] = solid.box;
        walls.fillRect(x0 - hair, y0 - hair, x1 - x0 + 2 * hair, y1 - y0 + 2 * hair);
      } else {
        outline(walls, solid.points, true);
        paths = true;
      }
    }
    if (!paths) continue;
    walls.fill();
    walls.stroke();
  }
}

/** Whether an outline is its box: four corners, each at one of the box's. */
function isOblong(points, [x0, y0, x1, y1]) {
  if (points.length !== 8) return false;
  for (let k = 0; k < 8; k += 2) {
    const next = (k + 2) % 8;
    if ((points[k] !== x0 && points[k] !== x1) || (points[k + 1] !== y0 && points[k + 1] !== y1)) return false;
    if ((points[k] === points[next]) === (points[k + 1] === points[next + 1])) return false;
  }
  return true;
}

/** 0xRRGGBB as a pixel of image data, opaque. */
const little = (color) =>
  (0xff000000 | ((color & 255) << 16) | (color & 0xff00) | (color >> 16)) >>> 0;

/** The multiples of `step` between two numbers, themselves excluded. */
function multiples(step, low, high) {
  const found = [];
  for (let k = Math.floor(low / step + 0.01) + 1; k * step < high - step / 100; k++) {
    found.push(k * step);
  }
  return found;
}

function line(context, x0, y0, x1, y1) {
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
}

function outline(context, points, further = false) {
  if (!further) context.beginPath();
  context.moveTo(points[0], points[1]);
  for (let k = 2; k < points.length; k += 2) context.lineTo(points[k], points[k + 1]);
  context.closePath();
}

function box(points) {
  const found = [Infinity, Infinity, -Infinity, -Infinity];
  for (let k = 0; k < points.length; k += 2) {
    found[0] = Math.min(found[0], points[k]);
    found[1] = Math.min(found[1], points[k + 1]);
    found[2] = Math.max(found[2], points[k]);
    found[3] = Math.max(found[3], points[k + 1]);
  }
  return found;
}
