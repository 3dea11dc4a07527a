import { isPrinting } from "./parts.js";
import { extent, number, thinned, ticks } from "./signals.js";

const EDGE = { left: 62, right: 14, top: 10, bottom: 42 };
const NEAR = 0.7; // px: shorter steps of a curve are invisible
const CURVE_BINS = 4000; // more cannot be resolved on a screen
const MARK_BINS = 600; // of the marked segments, which are redrawn with every move of the mouse

/** A colour of the page's style sheet, such as "--model". */
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** A plot of curves or cells over the drive, on a canvas. A box drawn with the mouse calls `onBox(xs, ys)`. */
export class Plane {
  constructor(holder, title, onBox) {
    this.figure = holder.appendChild(document.createElement("figure"));
    this.figure.className = "plane";
    this.caption = this.figure.appendChild(document.createElement("figcaption"));
    this.caption.textContent = title;
    this.stack = this.figure.appendChild(document.createElement("div"));
    this.stack.setAttribute("role", "img");
    this.stack.setAttribute("aria-label", title);
    this.layers = ["drawn", "marked", "pointed"].map((name) => {
      const canvas = this.stack.appendChild(document.createElement("canvas"));
      canvas.className = name;
      return canvas;
    });
    this.onBox = onBox;
    this.listen();
  }

  /** Draw a scene within `ranges`: `curves` of {xs, ys, colour, width, dash} or `cells`, and `marks` on xs, ys. */
  show(scene) {
    this.scene = scene;
    const [x, y] = scene.ranges;
    const padded = (range) => [range[0] - 0.04 * (range[1] - range[0]), range[1] + 0.04 * (range[1] - range[0])];
    [this.x, this.y] = [padded(x), padded(y)];
    this.draw();
  }

  size() {
    const width = Math.max(240, this.figure.clientWidth);
    return [width, Math.round(Math.min(width * 0.68, 620))];
  }

  toX(value) { return EDGE.left + ((value - this.x[0]) / (this.x[1] - this.x[0])) * (this.width - EDGE.left - EDGE.right); }
  toY(value) { return this.height - EDGE.bottom - ((value - this.y[0]) / (this.y[1] - this.y[0])) * (this.height - EDGE.top - EDGE.bottom); }
  fromX(px) { return this.x[0] + ((px - EDGE.left) / (this.width - EDGE.left - EDGE.right)) * (this.x[1] - this.x[0]); }
  fromY(px) { return this.y[0] + ((this.height - EDGE.bottom - px) / (this.height - EDGE.top - EDGE.bottom)) * (this.y[1] - this.y[0]); }

  draw() {
    [this.width, this.height] = this.size();
    this.stack.style.height = `${this.height}px`;
    const pen = this.pen(0);
    this.axes(pen);
    pen.save();
    pen.beginPath();
    pen.rect(EDGE.left, EDGE.top, this.width - EDGE.left - EDGE.right, this.height - EDGE.top - EDGE.bottom);
    pen.clip();
    if (this.scene.cells) this.cells(pen);
    for (const curve of this.scene.curves ?? []) this.curve(pen, curve, [[0, curve.xs.length]]);
    pen.restore();
    this.mark(this.scene.marks);
    if (isPrinting()) this.drawMarks(pen);
  }

  /** Draw marked segments on the layer above the drawing. */
  mark(marks = []) {
    this.scene.marks = marks;
    this.drawMarks(this.pen(1));
    this.overlay();
  }

  drawMarks(pen) {
    const { xs, ys, cells, marks } = this.scene;
    const bins = Math.ceil(MARK_BINS / Math.max(marks.length, 1));
    this.curve(pen, { xs, ys, colour: "--mark", width: cells ? 1 : 2.5, bins }, marks);
  }

  /** A drawing context of a layer in CSS pixels; setting the size clears the layer. */
  pen(layer) {
    const { [layer]: canvas } = this.layers;
    const scale = Math.max(window.devicePixelRatio || 1, 2); // fine enough for print
    Object.assign(canvas, { width: this.width * scale, height: this.height * scale });
    const pen = canvas.getContext("2d");
    pen.scale(scale, scale);
    return pen;
  }

  axes(pen) {
    pen.font = `${Math.max(11, parseFloat(getComputedStyle(this.figure).fontSize) * 0.78)}px system-ui, sans-serif`;
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [colour("--quiet"), colour("--rule"), 1];
    pen.textAlign = "center";
    for (const value of ticks(this.x, this.width / 90)) {
      this.rule(pen, this.toX(value), EDGE.top, this.toX(value), this.height - EDGE.bottom);
      pen.fillText(tick(value), this.toX(value), this.height - EDGE.bottom + 15);
    }
    pen.fillText(this.scene.xLabel, (EDGE.left + this.width - EDGE.right) / 2, this.height - 7);
    pen.textAlign = "right";
    for (const value of ticks(this.y, this.height / 55)) {
      this.rule(pen, EDGE.left, this.toY(value), this.width - EDGE.right, this.toY(value));
      pen.fillText(tick(value), EDGE.left - 6, this.toY(value) + 4);
    }
    pen.save();
    pen.translate(13, (EDGE.top + this.height - EDGE.bottom) / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(this.scene.yLabel, 0, 0);
    pen.restore();
  }

  rule(pen, x0, y0, x1, y1) {
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    pen.stroke();
  }

  curve(pen, { xs, ys, colour: name, width, dash, bins = CURVE_BINS }, segments) {
    [pen.strokeStyle, pen.lineWidth, pen.lineJoin] = [colour(name), width, "round"];
    pen.setLineDash(dash ?? []);
    pen.beginPath();
    for (const [first, end] of segments) {
      const shown = thinned([xs, ys], first, end, bins);
      let [left, top] = [this.toX(xs[shown[0]]), this.toY(ys[shown[0]])];
      pen.moveTo(left, top);
      if (shown.length === 1) pen.lineTo(left + 0.01, top);
      for (const i of shown) {
        const [x, y] = [this.toX(xs[i]), this.toY(ys[i])];
        if (Math.abs(x - left) + Math.abs(y - top) < NEAR && i !== end - 1) continue;
        pen.lineTo(x, y);
        [left, top] = [x, y];
      }
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  /** Draw the mean value of each cell as a colour on a diverging scale. */
  cells(pen) {
    const { columns, rows, largest, means } = this.scene.cells;
    const cellWidth = (this.toX(this.scene.cells.x[1]) - this.toX(this.scene.cells.x[0])) / columns;
    const cellHeight = (this.toY(this.scene.cells.y[0]) - this.toY(this.scene.cells.y[1])) / rows;
    const [middle, below, above] = ["--zero", "--below", "--above"].map((name) => rgb(colour(name)));
    means.forEach((mean, cell) => {
      if (Number.isNaN(mean)) return;
      const share = Math.min(1, Math.abs(mean) / largest);
      const side = mean < 0 ? below : above;
      pen.fillStyle = `rgb(${middle.map((part, i) => Math.round(part + share * (side[i] - part))).join(" ")})`;
      const [column, row] = [cell % columns, Math.floor(cell / columns)];
      const left = this.toX(this.scene.cells.x[0]) + column * cellWidth;
      pen.fillRect(left, this.toY(this.scene.cells.y[0]) - (row + 1) * cellHeight, cellWidth + 0.6, cellHeight + 0.6);
    });
  }

  /** Draw the cursor's point, or the box being dragged, on the top layer. */
  overlay(point = null, box = null) {
    const pen = this.pen(2);
    const { xs, ys } = this.scene;
    pen.strokeStyle = colour("--ink");
    if (point !== null) {
      pen.beginPath();
      pen.arc(this.toX(xs[point]), this.toY(ys[point]), 5, 0, 2 * Math.PI);
      pen.stroke();
    }
    if (box) pen.strokeRect(box[0], box[1], box[2] - box[0], box[3] - box[1]);
  }

  listen() {
    let start = null;
    this.stack.addEventListener("pointerdown", (event) => {
      start = [event.offsetX, event.offsetY];
      this.stack.setPointerCapture(event.pointerId);
    });
    this.stack.addEventListener("pointermove", (event) => {
      if (start) this.overlay(null, [...start, event.offsetX, event.offsetY]);
    });
    this.stack.addEventListener("pointerup", (event) => {
      if (!start) return;
      const sorted = (a, b) => (a < b ? [a, b] : [b, a]);
      const dragged = Math.hypot(event.offsetX - start[0], event.offsetY - start[1]) > 4;
      const xs = sorted(this.fromX(start[0]), this.fromX(event.offsetX));
      const ys = sorted(this.fromY(start[1]), this.fromY(event.offsetY));
      start = null;
      this.onBox(...(dragged ? [xs, ys] : [null, null]));
    });
    this.stack.addEventListener("pointercancel", () => { start = null; this.overlay(); });
  }
}

/** Mean of `values` in each cell of a grid over the plane, from point `first` on; NaN in empty cells. */
export function gridded(xs, ys, values, first, columns = 110, rows = 72) {
  const [x, y] = [extent(xs.subarray(first)), extent(ys.subarray(first))];
  const total = new Float64Array(columns * rows), count = new Float64Array(columns * rows);
  for (let i = first; i < xs.length; i++) {
    const column = Math.min(columns - 1, Math.floor(((xs[i] - x[0]) / (x[1] - x[0])) * columns));
    const row = Math.min(rows - 1, Math.floor(((ys[i] - y[0]) / (y[1] - y[0])) * rows));
    total[row * columns + column] += values[i];
    count[row * columns + column] += 1;
  }
  const means = Array.from(total, (sum, cell) => (count[cell] ? sum / count[cell] : NaN));
  const sizes = means.filter((mean) => !Number.isNaN(mean)).map(Math.abs).sort((a, b) => a - b);
  return { x, y, columns, rows, means, largest: sizes[Math.floor(0.98 * (sizes.length - 1))] || 1 };
}

export function tick(value) {
  const [mantissa, power] = number(value, 6).split(" × ");
  const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
  return power ? `${short} × ${power}`.replace(/^(−?)1 × /, "$1") : short;
}

function rgb(hex) {
  return [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16));
}
