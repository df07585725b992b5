// Where the page looks: metres to pixels and back. Pixels are those of the style sheet.

export class Camera {
  x = 0; y = 0; scale = 1; width = 1; height = 1; whole = true;

  /** Show the whole world. */
  reset(scene, margin = 0.4) {
    const [width, height] = scene.size, [left, bottom] = scene.low;
    this.world = scene;
    this.whole = true;
    this.x = left + width / 2;
    this.y = bottom + height / 2;
    this.scale = Math.min(this.width / (width + 2 * margin), this.height / (height + 2 * margin));
  }

  resize(width, height) {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    if (this.whole && this.world) this.reset(this.world);
  }

  column(x) { return this.width / 2 + (x - this.x) * this.scale; }
  row(y) { return this.height / 2 - (y - this.y) * this.scale; }
  metres(column, row) {
    return [this.x + (column - this.width / 2) / this.scale,
            this.y - (row - this.height / 2) / this.scale];
  }

  /** Nearer (factor > 1) or farther; what lies under the pointer stays there. */
  zoom(factor, column = this.width / 2, row = this.height / 2) {
    const [x, y] = this.metres(column, row);
    this.scale = Math.min(Math.max(this.scale * factor, 1e-2), 1e5);
    this.x = x - (column - this.width / 2) / this.scale;
    this.y = y + (row - this.height / 2) / this.scale;
    this.whole = false;
  }

  pan(columns, rows) {
    this.x -= columns / this.scale;
    this.y += rows / this.scale;
    this.whole = false;
  }

  /** The context draws in metres from now on, y upwards. */
  apply(context, ratio) {
    const k = this.scale * ratio;
    context.setTransform(k, 0, 0, -k, (this.width / 2 - this.x * this.scale) * ratio,
                         (this.height / 2 + this.y * this.scale) * ratio);
  }

  get key() { return `${this.x},${this.y},${this.scale},${this.width},${this.height}`; }
}
