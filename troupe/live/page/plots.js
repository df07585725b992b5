// A robot's sensors as small plots: scans in polar form, rings as bars, a camera's image, switches.

import { css, mix, tint } from "./colors.js";
import { degrees, metres } from "./numbers.js";

const SIZE = 150, BARS = 80, WIDE = 1.05 * Math.PI;

/** One sensor's figure; `show` draws what it reads now. */
export class Plot {
  constructor(sensor, told) {
    this.sensor = sensor;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.title = document.createElement("figcaption");
    this.title.textContent = `${told.type} (${sensor})`;
    this.figure = document.createElement("figure");
    this.figure.append(this.canvas, this.title);
  }

  show(state, robot, told, ink) {
    const own = (parts) => parts.find((p) => p.robot === robot && p.sensor === this.sensor);
    const color = css(tint(ink, robot)), { canvas } = this;
    const [kind, parts] = KINDS[told.kind] ?? [];
    const reading = kind && own(state[parts]);
    canvas.hidden = !reading || kind === fiducials;
    this.figure.classList.toggle("words", canvas.hidden);
    if (kind) this.#note(reading ? `${told.type}: ${kind(canvas, reading, told, color, ink)}` : `${told.type}`);
    else if (told.known) this.#note(`${told.type}: ${told.known}`);
    else this.#note(`${told.type}: ${(told.values ?? []).map(
      ([name, value, unit]) => `${name} ${value.toPrecision(4)} ${unit}`).join(", ")}`);
  }

  #note(text) {
    if (this.title.textContent === text) return;
    this.title.textContent = text;
    this.canvas.setAttribute("aria-label", text);
  }
}

const KINDS = {
  scan: [scan, "fans"], intensities: [scan, "fans"], elements: [ring, "cones"],
  blobs: [image, "sights"], bits: [bits, "switches"], fiducials: [fiducials, "marks"],
};

/** A scan in polar form: ahead is up; rings at half and all of how far it reaches here. */
function scan(canvas, fan, told, color, ink) {
  const near = fan.ranges.filter((range) => range < 0.999 * told.range);
  const far = Math.min(told.range, 1.05 * Math.max(...near, 0) || told.range);
  const wide = fan.fov > WIDE, height = wide ? SIZE : SIZE / 2 + 14;
  const context = prepared(canvas, SIZE, height);
  const fit = (SIZE / 2 - 4) / far, cx = SIZE / 2, cy = wide ? SIZE / 2 : SIZE / 2 + 4;
  context.strokeStyle = css(mix(ink.grid, ink.ink, 0.2));
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
  context.fillStyle = css(ink.soft_ink);
  context.font = "10px system-ui, sans-serif";
  context.fillText(metres(far), 3, height - 3);
  const least = Math.min(...fan.ranges), where = fan.ranges.indexOf(least);
  return least < 0.999 * told.range
    ? `nearest ${metres(least)} at ${degrees(-fan.fov / 2 + (fan.fov * where) / last)}`
    : `nothing within ${metres(told.range)}`;
}

/** A ring's elements as bars: what is near is high, as a bar that is full would hide it. */
function ring(canvas, { elements }, told, color, ink) {
  const context = prepared(canvas, SIZE, BARS), count = elements.length / 4, width = SIZE / count;
  let least = Infinity, which = 0;
  context.textAlign = "center";
  context.font = "10px system-ui, sans-serif";
  for (let k = 0; k < count; k++) {
    const range = elements[4 * k + 3], height = (BARS - 4) * Math.min(range / told.range, 1);
    if (range < least) [least, which] = [range, k];
    context.fillStyle = color;
    context.fillRect(k * width + 1, BARS - height, Math.max(width - 2, 1), height);
    context.fillStyle = css(ink.ink);
    if (width >= 28) context.fillText(range.toFixed(2), (k + 0.5) * width, BARS - 4);
  }
  return least < 0.999 * told.range ? `nearest ${metres(least)}, of element ${which}`
    : `nothing within ${metres(told.range)}`;
}

/** A camera's image as Player's clients see it, at half its height. */
function image(canvas, { width, height, blobs }) {
  const scale = Math.max(1, Math.floor(280 / width));
  const context = prepared(canvas, width * scale, (height * scale) / 2);
  context.scale(scale, scale / 2);
  context.fillStyle = "#101214";
  context.fillRect(0, 0, width, height);
  for (let k = 0; k < blobs.length; k += 6) {
    const [color, left, right, top, bottom] = blobs.subarray(k, k + 5);
    context.fillStyle = css(color);
    context.fillRect(left, top, right - left + 1, bottom - top + 1);
  }
  return `${blobs.length / 6} blobs`;
}

/** Switches about the robot; ahead is up. */
function bits(canvas, { parts }) {
  const context = prepared(canvas, BARS, BARS);
  let closed = 0;
  for (let k = 0; k < parts.length; k += 3) {
    context.beginPath();
    context.arc(40, 40, 28, -parts[k + 2] - Math.PI / 2 + 0.05, -parts[k + 1] - Math.PI / 2 - 0.05);
    context.lineWidth = parts[k] ? 12 : 4;
    context.strokeStyle = parts[k] ? "#d01010" : "#888888";
    context.stroke();
    closed += parts[k];
  }
  return `${closed} of ${parts.length / 3} closed`;
}

function fiducials(canvas, { seen }) {
  const told = [];
  for (let k = 0; k < seen.length; k += 4) {
    const [id, x, y] = seen.subarray(k, k + 3);
    told.push(`${id} at ${metres(Math.hypot(x, y))}, ${degrees(Math.atan2(y, x))}`);
  }
  return told.join("; ") || "none in sight";
}

/** How long the world waited for a robot, tick by tick, in milliseconds. */
export function waits(canvas, ticks, color, ink) {
  const context = prepared(canvas, 2 * SIZE, 36), most = Math.max(...ticks, 0.1);
  const width = (2 * SIZE) / 100;
  context.fillStyle = color;
  ticks.forEach((wait, k) => {
    const height = 30 * (wait / most);
    context.fillRect(2 * SIZE - (ticks.length - k) * width, 36 - height, width - 0.5, height);
  });
  context.fillStyle = css(ink.soft_ink);
  context.font = "10px system-ui, sans-serif";
  context.fillText(`${most.toFixed(1)} ms`, 3, 11);
}

/** A canvas of so many style pixels, emptied. */
function prepared(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  return context;
}
