import { colour } from "./colours.js";
import { drawCells, drawPath, drawSeries } from "./curves.js";
import { isPrinting } from "./parts.js";
import { padded, Scale, tick } from "./scale.js";
import { lowerBound } from "./signals.js";

const SHORT = 7, LONG = 6.8; // letters beside an axis of usual width, and em for longer ones, as of powers of ten

/** A plot on three canvases: axes and what stays, what moves, and marks with the cursor.
 *
 * A scene has `x` and `y` ({label, range, log}), `series` ({label, xs, ys, colour, width, dash, dots, heat, over}) and
 * perhaps `cells`, `strips` ({from, to, colour}), `floor` (half the height of a band about 0), `marks` and `track`
 * ({xs, ys} that the cursor and the marks follow). Where `along` is set, xs ascend and y fits what is in view. */
export class Plot {
  constructor(parent, { label, along = false }) {
    Object.assign(this, { along, view: { x: null, y: null }, x: new Scale(), y: new Scale(), watchers: [] });
    this.root = parent.appendChild(document.createElement("div"));
    this.root.className = "plot";
    this.root.tabIndex = 0;
    this.root.setAttribute("role", "group");
    this.root.setAttribute("aria-label", label);
    this.layers = ["drawn", "moving", "pointed"].map((name) => {
      const canvas = this.root.appendChild(document.createElement("canvas"));
      canvas.className = name;
      canvas.setAttribute("aria-hidden", "true");
      return canvas;
    });
    new ResizeObserver(() => this.scene && (this.root.clientWidth !== this.width || this.root.clientHeight !== this.height) && this.draw()).observe(this.root);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.scene && this.draw());
  }

  show(scene) {
    this.scene = scene;
    this.draw();
  }

  /** Show a scene of which only the series above have moved; the axes stay while they hold what is shown. */
  move(scene) {
    const before = this.scene;
    this.scene = scene;
    const range = this.view.y ?? (this.along ? scene.fit(this.x.low, this.x.high) : scene.y.range);
    const held = before && this.edge && range[0] >= this.y.low && range[1] <= this.y.high && before.series.length === scene.series.length;
    if (held) this.drawMoving();
    else this.draw();
  }

  /** Show a part, or all where a range is null. */
  look(x, y) {
    this.view = { x, y };
    if (this.scene) this.draw();
  }

  draw() {
    [this.width, this.height] = [this.root.clientWidth, this.root.clientHeight];
    if (this.width < 40 || this.height < 40) return;
    this.scales();
    this.drawUnder();
    this.drawMoving();
    this.drawTop();
    for (const watcher of this.watchers) watcher();
  }

  scales() {
    const { x, y } = this.scene;
    const size = this.fontSize();
    this.edge = { left: Math.round(4.2 * size), right: Math.round(0.9 * size), top: Math.round(1.6 * size), bottom: Math.round((x.label ? 2.9 : 0.5) * size) };
    const { right, top, bottom } = this.edge;
    const setX = () => this.x.set(this.view.x ?? (this.along ? x.range : padded(x.range, x.log)), this.edge.left, this.width - right, x.log);
    setX();
    const range = this.view.y ?? (this.along && this.scene.fit ? this.scene.fit(this.x.low, this.x.high) : y.range);
    this.clipped = !this.view.y && range.cut;
    this.y.set(this.view.y ?? padded(range, y.log), this.height - bottom, top, y.log);
    if (this.y.ticks(3 * size).some((value) => tick(value).length > SHORT)) {
      this.edge.left = Math.round(LONG * size); // one width for all: plots above each other stay in line
      setX();
    }
    this.root.dataset.span = `${this.x.low} ${this.x.high}`;
  }

  fontSize() { return Math.max(11, 0.74 * parseFloat(getComputedStyle(document.documentElement).fontSize)); }

  /** A drawing context of a layer in CSS pixels; setting the size clears the layer. */
  pen(layer) {
    const canvas = isPrinting() ? this.layers[0] : this.layers[layer];
    const scale = Math.max(window.devicePixelRatio || 1, isPrinting() ? 3 : 1);
    if (!isPrinting() || layer === 0) Object.assign(canvas, { width: this.width * scale, height: this.height * scale });
    const pen = canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    return pen;
  }

  within(pen, paint) {
    const { left, right, top, bottom } = this.edge;
    pen.save();
    pen.beginPath();
    pen.rect(left, top, this.width - left - right, this.height - top - bottom);
    pen.clip();
    paint();
    pen.restore();
  }

  drawUnder() {
    const pen = this.pen(0);
    this.within(pen, () => this.backdrop(pen));
    this.axes(pen);
    this.within(pen, () => {
      if (this.scene.cells) drawCells(this, pen);
      for (const series of this.scene.series) if (!series.over) drawSeries(this, pen, series);
    });
  }

  drawMoving() {
    const pen = this.pen(1);
    this.within(pen, () => {
      for (const series of this.scene.series) if (series.over) drawSeries(this, pen, series);
      this.bandEdges(pen);
    });
  }

  /** The edges of the band about 0, over the curve that may hide it; none where they would be one line. */
  bandEdges(pen) {
    const { scene: { floor }, edge: { left, right } } = this;
    const edges = floor ? [floor, -floor].map((edge) => Math.round(this.y.px(edge))) : [];
    if (!(edges[1] - edges[0] > 4)) return;
    pen.fillStyle = colour("--floor");
    for (const y of edges) pen.fillRect(left, y - 1, this.width - left - right, 2);
  }

  backdrop(pen) {
    const { strips = [], floor } = this.scene;
    const { top, bottom, left, right } = this.edge;
    for (const { from, to, colour: name } of strips) {
      pen.fillStyle = colour(name);
      pen.fillRect(this.x.px(from), top, Math.max(1, this.x.px(to) - this.x.px(from)), this.height - top - bottom);
    }
    if (!floor) return;
    pen.fillStyle = colour("--noise");
    pen.fillRect(left, this.y.px(floor), this.width - left - right, this.y.px(-floor) - this.y.px(floor));
  }

  axes(pen) {
    const { left, right, top, bottom } = this.edge;
    const size = this.fontSize();
    pen.font = `${size}px system-ui, sans-serif`;
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [colour("--quiet"), colour("--rule"), 1];
    pen.textAlign = "center";
    for (const value of this.x.ticks(7 * size)) {
      const x = Math.round(this.x.px(value)) + 0.5;
      rule(pen, x, top, x, this.height - bottom);
      if (this.scene.x.label) pen.fillText(tick(value), Math.min(x, this.width - 1.2 * size), this.height - bottom + 1.2 * size);
    }
    if (this.scene.x.label) pen.fillText(this.scene.x.label, (left + this.width - right) / 2, this.height - 0.35 * size);
    pen.textAlign = "right";
    for (const value of this.y.ticks(3 * size)) {
      const y = Math.round(this.y.px(value)) + 0.5;
      rule(pen, left, y, this.width - right, y);
      pen.fillText(tick(value), left - 0.5 * size, y + 0.35 * size);
    }
    pen.textAlign = "left";
    pen.fillText(`${this.scene.y.label}${this.clipped ? ", peaks cut off" : ""}`, 2, 0.95 * size);
  }

  /** Show marked segments, the cursor at a point of the track, and a box that is being drawn. */
  drawTop() {
    const pen = this.pen(2);
    const { marks = [], track } = this.scene;
    this.within(pen, () => {
      if (track) for (const mark of marks) this.marked(pen, track, mark);
      if (track && this.point !== null && this.point !== undefined && this.point < track.xs.length && !isPrinting()) this.cursor(pen, track);
    });
    if (!this.box) return;
    const [x0, y0, x1, y1] = this.box;
    [pen.strokeStyle, pen.fillStyle] = [colour("--ink"), colour("--marked")];
    const { top, bottom } = this.edge;
    const shape = this.boxAcross ? [x0, top, x1 - x0, this.height - top - bottom] : [x0, y0, x1 - x0, y1 - y0];
    pen.fillRect(...shape);
    pen.strokeRect(...shape);
  }

  marked(pen, { xs, ys }, [first, end]) {
    if (this.along) {
      pen.fillStyle = colour("--marked");
      const from = this.x.px(xs[first]);
      pen.fillRect(from, 0, Math.max(1, this.x.px(xs[end - 1]) - from), this.height);
    } else {
      [pen.strokeStyle, pen.lineWidth] = [colour("--mark"), 2.5];
      drawPath(this, pen, { xs, ys }, first, end);
    }
  }

  cursor(pen, { xs, ys }) {
    const [x, y] = [this.x.px(xs[this.point]), this.y.px(ys[this.point])];
    [pen.strokeStyle, pen.lineWidth] = [colour("--ink"), 1];
    if (this.along) {
      pen.setLineDash([3, 3]);
      rule(pen, x, 0, x, this.height);
      pen.setLineDash([]);
    }
    pen.beginPath();
    pen.arc(x, y, 4.5, 0, 2 * Math.PI);
    pen.stroke();
  }

  pointAt(point) {
    this.point = point;
    if (this.scene && this.edge) this.drawTop();
  }

  mark(marks) {
    this.scene.marks = marks;
    if (this.edge) this.drawTop();
  }

  /** The point of the track nearest to a pixel; null if there is none. */
  nearest(px, py) {
    const { track } = this.scene;
    if (!track?.xs.length) return null;
    if (this.along) return Math.min(lowerBound(track.xs, this.x.value(px)), track.xs.length - 1);
    let best = null, least = 30 ** 2;
    for (let i = 0; i < track.xs.length; i++) {
      const square = (this.x.px(track.xs[i]) - px) ** 2 + (this.y.px(track.ys[i]) - py) ** 2;
      if (square < least) [best, least] = [i, square];
    }
    return best;
  }
}

function rule(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}
