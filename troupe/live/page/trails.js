// Where robots were: the last stretch of every way, kept by the page itself.

const APART = 0.4;        // simulated seconds between two marks
const LENGTH = 60, CROWD = 100, CROWD_LENGTH = 15, MOST = 2000;

export class Trails {
  marks = [];
  last = -Infinity;

  mark(time, poses) {
    if (time < this.last) this.clear();
    if (time - this.last < APART - 1e-6) return;
    this.last = time;
    const count = poses.length / 3;
    if (count > MOST) return;
    this.marks.push(poses.slice());   // a view would keep all of its message
    const most = count > CROWD ? CROWD_LENGTH : LENGTH;
    while (this.marks.length > most) this.marks.shift();
  }

  /** Time has jumped: these marks, (x, y, yaw) of all robots, led to where it is. */
  begin(ways, time) {
    this.marks = ways.slice(-LENGTH);
    this.last = time;
  }

  clear() {
    this.marks = [];
    this.last = -Infinity;
  }

  /** Calls draw(robot, points) with the way of each robot that has moved, to `now`. */
  each(now, draw) {
    const count = now.length / 3;
    if (count > MOST || this.marks.length === 0) return;
    for (let robot = 0; robot < count; robot++) {
      const points = [];
      for (const mark of this.marks) {
        if (mark.length > 3 * robot && !Number.isNaN(mark[3 * robot])) points.push(mark[3 * robot], mark[3 * robot + 1]);
      }
      points.push(now[3 * robot], now[3 * robot + 1]);
      const moved = Math.hypot(points[0] - points.at(-2), points[1] - points.at(-1));
      if (points.length > 2 && (moved > 0.01 || points.length > 8)) draw(robot, points);
    }
  }
}
