// A canvas context that writes down what is drawn on it as SVG: as much of it as our pages draw with.

const TURN = 2 * Math.PI;
const SPACE = "http:" + "//www.w3.org/2000/svg";   // a name: nothing is fetched from there
const short = (value) => String(Math.round(value * 100) / 100);

export class SvgContext {
  /** `ruler`: a canvas context, which measures texts. */
  constructor(width, height, ruler) {
    this.width = width;
    this.height = height;
    this.ruler = ruler;
    this.parts = [];
    this.path = [];
    this.dash = [];
    this.setTransform(1, 0, 0, 1, 0, 0);
    Object.assign(this, {
      fillStyle: "#000000", strokeStyle: "#000000", lineWidth: 1, globalAlpha: 1,
      lineJoin: "miter", font: "10px sans-serif", textAlign: "left", textBaseline: "alphabetic",
    });
  }

  setTransform(a, b, c, d, e, f) {
    this.matrix = [a, b, c, d, e, f];
    this.grown = Math.sqrt(Math.abs(a * d - b * c));
  }

  setLineDash(dash) { this.dash = dash; }

  #at(x, y) {
    const [a, b, c, d, e, f] = this.matrix;
    return `${short(a * x + c * y + e)} ${short(b * x + d * y + f)}`;
  }

  // -- paths

  beginPath() { this.path = []; }
  closePath() { this.path.push("Z"); }
  moveTo(x, y) { if (Number.isFinite(x + y)) this.path.push(`M${this.#at(x, y)}`); }
  lineTo(x, y) {
    if (Number.isFinite(x + y)) this.path.push(`${this.path.length ? "L" : "M"}${this.#at(x, y)}`);
  }

  /** Clockwise on the screen, as a canvas draws it; under scales that are alike in x and y. */
  arc(x, y, radius, from, to) {
    const sweep = to - from >= TURN ? TURN : (((to - from) % TURN) + TURN) % TURN;
    this.lineTo(x + radius * Math.cos(from), y + radius * Math.sin(from));
    const r = short(radius * this.grown);
    for (const part of sweep > 3 ? [0.5, 1] : [1]) {
      const angle = from + part * sweep;
      const end = this.#at(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
      this.path.push(`A${r} ${r} 0 0 1 ${end}`);
    }
  }

  roundRect(x, y, width, height, radius) {
    const [r, right, bottom] = [radius, x + width, y + height];
    this.moveTo(x + r, y);
    this.lineTo(right - r, y);
    this.arc(right - r, y + r, r, -TURN / 4, 0);
    this.lineTo(right, bottom - r);
    this.arc(right - r, bottom - r, r, 0, TURN / 4);
    this.lineTo(x + r, bottom);
    this.arc(x + r, bottom - r, r, TURN / 4, TURN / 2);
    this.lineTo(x, y + r);
    this.arc(x + r, y + r, r, TURN / 2, (3 * TURN) / 4);
    this.closePath();
  }

  fill() { this.#add("path", { d: this.path.join(""), ...this.#inside() }); }
  stroke() { this.#add("path", { d: this.path.join(""), ...this.#edge() }); }
  fillRect(x, y, width, height) { this.#rectangle(x, y, width, height, this.#inside()); }
  strokeRect(x, y, width, height) { this.#rectangle(x, y, width, height, this.#edge()); }

  #rectangle(x, y, width, height, look) {
    const corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
    this.#add("path", { d: `M${corners.map(([px, py]) => this.#at(px, py)).join("L")}Z`, ...look });
  }

  // -- texts and images

  measureText(text) {
    this.ruler.font = this.font;
    return this.ruler.measureText(text);
  }

  fillText(text, x, y) { this.#text(text, x, y, this.#inside()); }
  strokeText(text, x, y) { this.#text(text, x, y, this.#edge()); }

  #text(text, x, y, look) {
    const [column, row] = this.#at(x, y).split(" ");
    const [size, ...family] = this.font.split(" ");
    const top = this.textBaseline === "top" ? { "dominant-baseline": "text-before-edge" } : {};
    const anchor = this.textAlign === "center" ? { "text-anchor": "middle" } : {};
    this.#add("text", { x: column, y: row, "font-size": size, "font-family": family.join(" "),
                        ...top, ...anchor, ...look }, text);
  }

  drawImage(image, x, y, width = image.width, height = image.height) {
    const [a, b, c, d, e, f] = this.matrix;
    const turned = [a, b, c, d, e, f].map((value) => Math.round(value * 1e6) / 1e6);
    this.#add("image", { x, y, width, height, href: image.toDataURL("image/png"),
                         transform: `matrix(${turned.join(" ")})`, preserveAspectRatio: "none",
                         style: "image-rendering: pixelated" });
  }

  // -- what comes of it

  #inside() { return { fill: this.fillStyle, ...this.#pale("fill-opacity") }; }

  #edge() {
    const dashed = this.dash.length ? { "stroke-dasharray": this.dash.join(" ") } : {};
    const joined = this.lineJoin === "miter" ? {} : { "stroke-linejoin": this.lineJoin };
    return { fill: "none", stroke: this.strokeStyle, "stroke-width": short(this.lineWidth * this.grown),
             ...dashed, ...joined, ...this.#pale("stroke-opacity") };
  }

  #pale(name) { return this.globalAlpha === 1 ? {} : { [name]: short(this.globalAlpha) }; }

  #add(name, attributes, text) {
    if (attributes.d === "") return;
    const told = Object.entries(attributes).map(([key, value]) => ` ${key}="${escaped(value)}"`);
    this.parts.push(text === undefined ? `<${name}${told.join("")}/>`
      : `<${name}${told.join("")}>${escaped(text)}</${name}>`);
  }

  /** The document. */
  text(title) {
    const size = `width="${short(this.width)}" height="${short(this.height)}"`;
    const box = `viewBox="0 0 ${short(this.width)} ${short(this.height)}"`;
    return `<svg xmlns="${SPACE}" ${size} ${box}>\n` +
      `<title>${escaped(title)}</title>\n${this.parts.join("\n")}\n</svg>\n`;
  }
}

const SIGNS = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" };

/** Text as XML takes it. */
function escaped(text) {
  return String(text).replace(/[&<>"]/g, (sign) => SIGNS[sign])
    .replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]/g, "·");
}
