// One moment on the canvas, in the video's style: paint and walls, trails, readings, bodies, texts.

import { coat, css, inks, mix, tint } from "./colors.js";
import { AWAITED, STALLED } from "./frames.js";
import { Ground } from "./ground.js";
import { drawFans, drawReadings, drawSights } from "./readings.js";
import { Shape, trace } from "./shapes.js";
import { drawTexts } from "./texts.js";

export class Painter {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.ground = new Ground();
    this.shapes = new WeakMap();   // those of a scene go with it
  }

  shape(told) {
    if (!this.shapes.has(told)) this.shapes.set(told, new Shape(told));
    return this.shapes.get(told);
  }

  /** A robot's radius in pixels, as drawn. */
  reach(state, robot, camera) {
    const model = state.scene.models[state.models[robot]];
    return model ? this.shape(model.shape).at(camera.scale).reach : 0;
  }

  draw(state, camera, view) {
    const ratio = window.devicePixelRatio || 1, { context, canvas } = this;
    const width = Math.round(camera.width * ratio), height = Math.round(camera.height * ratio);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    this.paint(context, state, camera, view, ratio);
  }

  /** The same on any context: `ratio` of its units are a pixel of the style sheet. */
  paint(context, state, camera, view, ratio) {
    const ink = inks(state.scene.palette, view.dark), grid = view.show.grid;
    const fans = (selected) => {
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      drawFans(context, state, camera, ink, view, selected);
    };
    const how = context === this.context ? "draw" : "trace";
    this.ground[how](context, state, camera, ink, { ratio, grid }, () => fans(false));
    fans(true);
    if (view.show.trails) this.#trails(context, state, camera, ink);
    drawReadings(context, state, camera, ink, view);
    this.#things(context, state, camera, ink);
    this.#robots(context, state, camera, ink);
    this.#selected(context, state, camera, ink, view);
    drawSights(context, state, camera, ink, view, (robot) => this.reach(state, robot, camera));
    this.#drawn(context, state, camera);
    drawTexts(context, state, camera, ink, view, (robot) => this.reach(state, robot, camera));
  }

  #trails(context, state, camera, ink) {
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    const lines = ink.tints.map(() => []);   // in batches of one colour, the older half paler
    state.trails.each(state.poses, (robot, points) => lines[robot % lines.length].push(points));
    const halves = [[0, 0.5, 0.55], [0.5, 1, 0.15]];
    for (const [begin, end, pale] of halves) {
      lines.forEach((some, k) => {
        if (!some.length) return;
        context.beginPath();
        for (const points of some) {
          const at = (share) => 2 * Math.ceil(share * (points.length / 2 - 1));
          for (let j = at(begin); j <= at(end); j += 2) {
            const column = camera.column(points[j]), row = camera.row(points[j + 1]);
            if (j === at(begin)) context.moveTo(column, row);
            else context.lineTo(column, row);
          }
        }
        context.strokeStyle = css(mix(mix(ink.tints[k], ink.ink, 0.15), ink.ground, pale));
        context.stroke();
      });
    }
  }

  #things(context, state, camera, ink) {
    state.scene.things.forEach(({ shape, color, parts }, k) => {
      if (parts || 3 * k >= state.things.length) return;   // what stands is drawn with the walls
      const [x, y, yaw] = state.things.subarray(3 * k, 3 * k + 3);
      const colors = coat(ink, color, null, false);
      const made = this.shape(shape).at(camera.scale);
      context.beginPath();
      trace(context, made.outline, camera.column(x), camera.row(y), yaw);
      context.fillStyle = colors.fill;
      context.fill();
      context.strokeStyle = colors.edge;
      context.lineWidth = 1;
      context.stroke();
    });
  }

  /** All bodies, batch by batch of one kind and coat: a thousand cost little more than ten. */
  #robots(context, state, camera, ink) {
    const batches = new Map(), { poses } = state, margin = 60;
    for (let robot = 0; robot < state.count; robot++) {
      const column = camera.column(poses[3 * robot]), row = camera.row(poses[3 * robot + 1]);
      if (column < -margin || row < -margin || column > camera.width + margin ||
          row > camera.height + margin) continue;
      const model = state.models[robot], settled = state.settled(robot);
      const made = this.shape(state.scene.models[model].shape).at(camera.scale);
      const name = made.rimmed ? robot % ink.tints.length : -1;
      const key = `${model},${state.colors[robot]},${name},${settled}`;
      let batch = batches.get(key);
      if (!batch) {
        const colors = coat(ink, state.colors[robot], made.rimmed ? robot : null, settled);
        batches.set(key, (batch = { made, colors, places: [] }));
      }
      batch.places.push(column, row, poses[3 * robot + 2]);
    }
    for (const { made, colors, places } of batches.values()) this.#batch(context, made, colors, places);
  }

  #batch(context, made, colors, places) {
    const path = (points) => {
      context.beginPath();
      for (let k = 0; k < places.length; k += 3) {
        trace(context, points, places[k], places[k + 1], places[k + 2]);
      }
    };
    context.fillStyle = made.rimmed ? colors.rim : colors.fill;
    if (!made.detailed) {
      const side = 1.7 * made.reach;
      for (let k = 0; k < places.length; k += 3) {
        context.fillRect(places[k] - side / 2, places[k + 1] - side / 2, side, side);
      }
      return;
    }
    path(made.outline);
    context.fill();
    context.strokeStyle = colors.edge;
    context.lineWidth = 1;
    context.stroke();
    if (!made.rimmed) return;
    path(made.inner);
    context.fillStyle = colors.fill;
    context.fill();
    path(made.arrow);
    context.strokeStyle = colors.halo;
    context.lineWidth = 2.5;
    context.stroke();
    context.fillStyle = colors.rim;
    context.fill();
  }

  /** A ring about who is selected, and about whom the world waits for or who stalls. */
  #selected(context, state, camera, ink, view) {
    const rings = (robots, style, dash, gap) => {
      if (!robots.length) return;
      context.beginPath();
      for (const robot of robots) {
        const reach = this.reach(state, robot, camera) + gap;
        const column = camera.column(state.poses[3 * robot]), row = camera.row(state.poses[3 * robot + 1]);
        context.moveTo(column + reach, row);
        context.arc(column, row, reach, 0, 2 * Math.PI);
      }
      context.setLineDash(dash);
      context.strokeStyle = style;
      context.lineWidth = 2;
      context.stroke();
      context.setLineDash([]);
    };
    const awaited = [], stalled = [];
    state.states.forEach((bits, robot) => {
      if (bits & AWAITED) awaited.push(robot);
      else if (bits & STALLED) stalled.push(robot);
    });
    rings(awaited, css(ink.ink), [2, 4], 7);
    rings(stalled, "#d55e00", [5, 3], 6);
    const selected = [...view.selected].filter((robot) => robot < state.count);
    rings(selected, view.dark ? "#7cc4ff" : "#0060a0", [], 3);
    if (view.ghost) {
      const { shape, x, y, yaw } = view.ghost;
      context.beginPath();
      trace(context, this.shape(shape).at(camera.scale).outline, camera.column(x), camera.row(y),
            yaw);
      context.strokeStyle = css(ink.ink);
      context.setLineDash([4, 3]);
      context.stroke();
      context.setLineDash([]);
    }
  }

  /** Figures of Player's graphics2d, in their robots' frames. */
  #drawn(context, state, camera) {
    for (const { robot, kind, points, color, fill } of state.drawn) {
      const [x, y, yaw] = state.poses.subarray(3 * robot, 3 * robot + 3);
      const cos = Math.cos(yaw), sin = Math.sin(yaw);
      const at = points.map(([px, py]) => [camera.column(x + cos * px - sin * py),
                                           camera.row(y + sin * px + cos * py)]);
      context.strokeStyle = context.fillStyle = css(color);
      context.lineWidth = 1;
      context.beginPath();
      if (kind === "points") {
        for (const [column, row] of at) {
          context.moveTo(column + 2, row);
          context.arc(column, row, 2, 0, 2 * Math.PI);
        }
        context.fill();
        continue;
      }
      at.forEach(([column, row], k) => {
        if (k === 0 || (kind === "multiline" && k % 2 === 0)) context.moveTo(column, row);
        else context.lineTo(column, row);
      });
      if (kind === "polygon") {
        context.closePath();
        if (fill !== null) {
          context.fillStyle = css(fill);
          context.fill();
        }
      }
      context.stroke();
    }
  }
}
