// Names and what is said, beside their robots and not on each other.

import { css, tint } from "./colors.js";

const MOST_NAMES = 64, MOST_BALLOONS = 24, SPEECH = 30, LONGEST = 48, SHORT = 20, CROWD = 8;

export function drawTexts(context, state, camera, ink, view, reach) {
  const taken = [];
  context.textAlign = "left";
  context.textBaseline = "top";
  const bodies = boxes(state, camera, reach);
  if (view.show.names) names(context, state, camera, ink, view, reach, taken, bodies);
  if (view.show.speech) speech(context, state, camera, ink, reach, taken, bodies);
}

/** The robots' boxes in pixels, as many as have names. */
function boxes(state, camera, reach) {
  const found = [];
  for (let robot = 0; robot < Math.min(state.count, MOST_NAMES); robot++) {
    const [column, row] = place(state, camera, robot), radius = reach(robot);
    found.push([column - radius, row - radius, column + radius, row + radius]);
  }
  return found;
}

/** The first of some boxes on which nothing lies, not even a robot; or else a robot alone. */
function first(choices, taken, bodies) {
  const open = choices.filter((box) => free(box, taken));
  return open.find((box) => free(box, bodies)) ?? open[0];
}

function place(state, camera, robot) {
  return [camera.column(state.poses[3 * robot]), camera.row(state.poses[3 * robot + 1])];
}

function names(context, state, camera, ink, view, reach, taken, bodies) {
  context.font = "12px system-ui, sans-serif";
  for (let robot = 0; robot < state.count; robot++) {
    if (state.count > MOST_NAMES && !view.selected.has(robot)) continue;
    const [column, row] = place(state, camera, robot);
    if (column < 0 || row < 0 || column > camera.width || row > camera.height) continue;
    const text = printable(state.names[robot], 24), radius = reach(robot);
    if (radius < 5 && state.count > 12 && !view.selected.has(robot)) continue;
    const width = context.measureText(text).width;
    const choices = [[column - width / 2, row + radius + 2], [column - width / 2, row - radius - 15],
                     [column + radius + 3, row - 6], [column - radius - width - 3, row - 6]];
    const inside = choices.filter(([, y]) => y >= 0 && y + 13 <= camera.height);
    const found = first(inside.map(([x, y]) => [x, y, x + width, y + 13]), taken, bodies);
    if (!found) continue;
    taken.push(found);
    halo(context, text, found[0], found[1], ink);
  }
}

function speech(context, state, camera, ink, reach, taken, bodies) {
  const speaking = [...state.said].filter(
    ([robot, { time, text }]) => robot < state.count && text.trim() && time <= state.time && state.time - time < SPEECH);
  speaking.sort((a, b) => b[1].time - a[1].time);
  context.font = "12px system-ui, sans-serif";
  for (const [robot, { text }] of speaking.slice(0, MOST_BALLOONS)) {
    const [column, row] = place(state, camera, robot);
    if (column < 0 || row < 0 || column > camera.width || row > camera.height) continue;
    const words = printable(text, state.count > CROWD ? SHORT : LONGEST);
    const width = context.measureText(words).width + 14, height = 20, radius = reach(robot);
    const choices = [];
    const add = (x, y) => {
      const left = Math.min(Math.max(x, 3), camera.width - width - 3);
      if (y > 0 && y + height < camera.height) choices.push([left, y, left + width, y + height]);
    };
    for (let rise = 0; rise < 4; rise++) {
      for (const share of [0.5, 0.15, 0.85]) {
        add(column - share * width, row - radius - 9 - height - rise * (height + 3));
      }
    }
    for (let fall = 0; fall < 3; fall++) add(column - width / 2, row + radius + 18 + fall * (height + 3));
    const found = first(choices, taken, bodies);
    if (!found) continue;   // those who spoke last have found their places
    taken.push(found);
    balloon(context, words, found, [column, row], { width, height, radius }, tint(ink, robot), ink);
  }
}

function balloon(context, words, [x, y], [column, row], { width, height, radius }, color, ink) {
  const above = y < row, foot = above ? y + height : y;
  const base = Math.min(Math.max(column, x + 10), x + width - 10);
  context.beginPath();
  context.moveTo(base - 4, foot);
  context.lineTo(column, row + (above ? -0.75 : 0.75) * radius);
  context.lineTo(base + 4, foot);
  context.closePath();
  context.fillStyle = css(color);
  context.fill();
  context.beginPath();
  context.roundRect(x, y, width, height, 5);
  context.fillStyle = css(ink.paper);
  context.fill();
  context.strokeStyle = css(color);
  context.lineWidth = 1.5;
  context.stroke();
  context.fillStyle = css(ink.ink);
  context.fillText(words, x + 7, y + 4);
}

function halo(context, text, x, y, ink) {
  context.strokeStyle = css(ink.ground);
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeText(text, x, y);
  context.fillStyle = css(ink.ink);
  context.fillText(text, x, y);
}

const free = ([left, top, right, bottom], taken) =>
  taken.every(([l, t, r, b]) => right < l || left > r || bottom < t || top > b);

/** Text that is not ours, on one line, without what would lead the eye astray. */
export function printable(text, longest = 200) {
  const shown = String(text).replace(
    /[\u0000-\u001f\u007f-\u009f\u2028\u2029\u202a-\u202e\u2066-\u2069]/g, "·");
  return shown.length > longest ? `${shown.slice(0, longest - 1)}…` : shown;
}
