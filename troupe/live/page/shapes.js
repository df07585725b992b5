// Bodies' outlines in their own frames, with the rim and the arrow that say who it is and where it looks.

const RIM = 3.2, SMALLEST = 2.5, DETAILED = 5;

/** All that drawing needs of one kind of body at one scale (pixels per metre). */
export class Shape {
  constructor(told) {
    this.radius = told.radius ?? Math.max(...told.corners.map(([x, y]) => Math.hypot(x, y)));
    this.round = told.radius !== undefined;
    this.told = told;
    this.scale = 0;
  }

  /** Made for a scale: outline, inside and arrow as flat arrays in pixels, y upwards. */
  at(scale) {
    if (scale === this.scale) return this;
    this.scale = scale;
    this.reach = Math.max(this.radius * scale, SMALLEST);
    this.detailed = this.reach >= DETAILED;
    const grow = this.reach / this.radius;
    this.outline = this.round ? circle(this.reach) : this.told.corners.flatMap(
      ([x, y]) => [x * grow, y * grow]);
    const inside = innerRadius(this.outline);
    this.rimmed = this.detailed && inside > 0;
    if (this.rimmed) {
      const rim = Math.min(Math.max(RIM, 1), inside / 3);
      this.inner = this.outline.map((value) => value * (1 - rim / inside));
      this.arrow = wedge(this.inner);
    }
    return this;
  }
}

function circle(radius) {
  const corners = Math.min(96, Math.max(8, Math.ceil(Math.PI * Math.sqrt(radius / 0.2))));
  const points = [];
  for (let k = 0; k < corners; k++) {
    const angle = (2 * Math.PI * k) / corners;
    points.push(radius * Math.cos(angle), radius * Math.sin(angle));
  }
  return points;
}

/** Distance from the origin to the nearest edge about it; 0 or less where it lies outside. */
function innerRadius(points) {
  let left = Infinity, right = Infinity;
  for (let k = 0; k < points.length; k += 2) {
    const j = (k + 2) % points.length;
    const ax = points[j] - points[k], ay = points[j + 1] - points[k + 1];
    const length = Math.hypot(ax, ay);
    if (length === 0) continue;
    const distance = (points[k] * ay - points[k + 1] * ax) / length;
    left = Math.min(left, distance);
    right = Math.min(right, -distance);
  }
  return Math.max(left, right);
}

function wedge(points) {
  let front = 0, low = Infinity, high = -Infinity;
  for (let k = 0; k < points.length; k += 2) {
    const j = (k + 2) % points.length;
    const [x0, y0, x1, y1] = [points[k], points[k + 1], points[j], points[j + 1]];
    low = Math.min(low, y0);
    high = Math.max(high, y0);
    if ((y0 <= 0) !== (y1 <= 0)) front = Math.max(front, x0 - (y0 * (x1 - x0)) / (y1 - y0));
  }
  const side = 0.5 * Math.min(high - low, 1.4 * front), back = -0.2 * front;
  return [0.9 * front, 0, back, 0.6 * side, back, -0.6 * side];
}

/** Add an outline at a pixel place, turned, to the context's path. */
export function trace(context, points, column, row, yaw) {
  const cos = Math.cos(yaw), sin = Math.sin(yaw);
  for (let k = 0; k < points.length; k += 2) {
    const x = column + cos * points[k] - sin * points[k + 1];
    const y = row - sin * points[k] - cos * points[k + 1];
    if (k === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
  context.closePath();
}

/** Whether a point lies in a convex outline, whose corners run counter-clockwise. */
export function within(corners, [x, y]) {
  return corners.every(([ax, ay], k) => {
    const [bx, by] = corners[(k + 1) % corners.length];
    return (bx - ax) * (y - ay) >= (by - ay) * (x - ax);
  });
}
