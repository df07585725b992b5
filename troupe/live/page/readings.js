// What robots perceive, in the world: fans, sonar cones, bumpers' parts, fiducials, cameras' colours.

import { css, mix, tint } from "./colors.js";

const FILLED = 8, RING = 7, RING_WIDTH = 3;
const ON_THE_WAY = 0.6;   // more than half: two that see each other have a number each

/** Whose readings show. */
const showing = (state, view) => ({ robot }) =>
  view.selected.has(robot) || (view.show.others && !state.settled(robot));

/** Lasers' fans and sonars' cones on the floor: of who is `selected`, or of all others. */
export function drawFans(context, state, camera, ink, view, selected) {
  if (!view.show.sensors) return;
  const { lasers, sonars } = view.show, shows = showing(state, view);
  const fans = lasers ? state.fans.filter(shows) : [], filled = selected || fans.length <= FILLED;
  const strength = selected ? 0.16 : 0.16 / Math.sqrt(Math.max(fans.length, 1)) + 0.03;
  const now = ({ robot }) => view.selected.has(robot) === selected;
  for (const fan of fans.filter(now)) {
    const color = tint(ink, fan.robot);
    context.beginPath();
    fanPath(context, fan, (x) => camera.column(x), (y) => camera.row(y));
    context.closePath();
    if (filled) {
      context.globalAlpha = strength;
      context.fillStyle = css(color);
      context.fill();
      context.globalAlpha = 1;
    }
    context.strokeStyle = css(mix(color, ink.ground, filled ? 0.35 : 0.7));
    context.lineWidth = 1;
    context.stroke();
  }
  for (const cones of sonars ? state.cones.filter(shows).filter(now) : []) {
    drawCones(context, cones, camera, ink);
  }
}

/** What is seen of others and felt of walls, below the bodies. */
export function drawReadings(context, state, camera, ink, view) {
  if (!view.show.sensors) return;
  const { fiducials, bumpers } = view.show, shows = showing(state, view);
  const drawn = (wanted, parts, draw) => { if (wanted) parts.filter(shows).forEach(draw); };
  drawn(fiducials, state.marks, (marks) => drawMarks(context, marks, camera, ink));
  drawn(bumpers, state.switches, (switches) => drawSwitches(context, switches, state, camera));
}

/** A fan's outline from its sensor over all rays, in whatever coordinates column and row give. */
export function fanPath(context, fan, column, row) {
  const { x, y, yaw, fov, ranges } = fan, last = Math.max(ranges.length - 1, 1);
  context.moveTo(column(x), row(y));
  for (let k = 0; k < ranges.length; k++) {
    const angle = yaw - fov / 2 + (fov * k) / last;
    context.lineTo(column(x + ranges[k] * Math.cos(angle)), row(y + ranges[k] * Math.sin(angle)));
  }
}

function drawCones(context, { robot, fov, elements }, camera, ink) {
  const color = tint(ink, robot);
  context.beginPath();
  for (let k = 0; k < elements.length; k += 4) {
    const [x, y, heading, range] = elements.subarray(k, k + 4);
    const column = camera.column(x), row = camera.row(y);
    context.moveTo(column, row);
    context.arc(column, row, range * camera.scale, -heading - fov / 2, -heading + fov / 2);
    context.closePath();
  }
  context.globalAlpha = 0.14;
  context.fillStyle = css(color);
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = css(mix(color, ink.ground, 0.35));
  context.lineWidth = 1;
  context.stroke();
}

/** A line to each, with its number on the way: a body stands where it ends. */
function drawMarks(context, { robot, x, y, yaw, seen }, camera, ink) {
  const cos = Math.cos(yaw), sin = Math.sin(yaw), color = css(mix(tint(ink, robot), ink.ink, 0.3));
  const from = [camera.column(x), camera.row(y)];
  context.fillStyle = color;
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "alphabetic";
  for (let k = 0; k < seen.length; k += 4) {
    const [id, dx, dy] = seen.subarray(k, k + 3);
    const column = camera.column(x + cos * dx - sin * dy);
    const row = camera.row(y + sin * dx + cos * dy);
    context.beginPath();
    context.setLineDash([3, 3]);
    context.moveTo(...from);
    context.lineTo(column, row);
    context.strokeStyle = color;
    context.lineWidth = 1;
    context.stroke();
    context.setLineDash([]);
    const text = String(Math.round(id)), [at, height] = [column, row].map(
      (end, k) => from[k] + ON_THE_WAY * (end - from[k]));
    context.strokeStyle = css(ink.ground);
    context.lineWidth = 3;
    context.strokeText(text, at, height + 4);
    context.fillText(text, at, height + 4);
  }
}

function drawSwitches(context, { robot, x, y, yaw, parts }, state, camera) {
  const model = state.scene.models[state.models[robot]];
  const told = model.shape.radius ?? Math.max(...model.shape.corners.map((c) => Math.hypot(...c)));
  const column = camera.column(x), row = camera.row(y), reach = told * camera.scale + 3;
  for (let k = 0; k < parts.length; k += 3) {
    const [closed, begin, end] = parts.subarray(k, k + 3);
    context.beginPath();
    context.arc(column, row, reach, -(yaw + end) + 0.03, -(yaw + begin) - 0.03);
    context.strokeStyle = closed ? "#d01010" : "rgb(128 128 128 / 60%)";
    context.lineWidth = closed ? 4 : 1.5;
    context.stroke();
  }
}

/** What blobfinders see as arcs about their robots, over the bodies. */
export function drawSights(context, state, camera, ink, view, reach) {
  if (!view.show.sensors) return;
  for (const { robot, x, y, yaw, fov, width, blobs } of state.sights.filter(showing(state, view))) {
    if (!view.show.blobs && !view.selected.has(robot)) continue;
    const column = camera.column(x), row = camera.row(y), radius = reach(robot) + RING;
    for (const [color, breadth] of [[ink.ink, RING_WIDTH + 2], [null, RING_WIDTH]]) {
      context.lineWidth = breadth;
      for (let k = 0; k < blobs.length; k += 6) {
        const left = yaw + fov / 2 - (blobs[k + 1] * fov) / width;
        const right = yaw + fov / 2 - ((blobs[k + 2] + 1) * fov) / width;
        context.beginPath();
        context.arc(column, row, radius, -left, -right);
        context.strokeStyle = css(color ?? blobs[k]);
        context.stroke();
      }
    }
  }
}
