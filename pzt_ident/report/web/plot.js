import { isPrinting } from "./parts.js";
import { padded, Scale, tick } from "./scale.js";
import { lowerBound } from "./signals.js";

const NEAR = 0.7; // px: shorter steps of a curve are invisible
const APART = 4; // px between neighbouring dots, so that they are seen as dots
const MANY = 5000; // points of a loop, above which the dots would hide it
const HEAT = ["#30123b", "#4559cb", "#3e9bfe", "#18d7cc", "#46f783", "#a4fc3b", "#e1dc37", "#fda330", "#ef5911", "#b81f02", "#7a0402"];

/** A colour of the page's style sheet, such as "--model". */
export function colour(name) {
  return name.startsWith("--") ? getComputedStyle(document.documentElement).getPropertyValue(name).trim() : name;
}

/** A plot on three canvases: axes and what stays, what moves, and marks with the cursor.
 *
 * A scene has `x` and `y` ({label, range, log}), `series` ({label, xs, ys, colour, width, dash, dots, heat, over}) and
 * perhaps `cells`, `strips` ({from, to, colour}), `floor` (half the height of a band about 0), `marks` and `track`
 * ({xs, ys} that the cursor and the marks follow). Where `along` is set, xs ascend and y fits what is in view. */
export class Plot {
  constructor(parent, { label, along = false, follow = null, plain = false }) {
    Object.assign(this, { along, follow, plain, view: { x: null, y: null }, x: new Scale(), y: new Scale(), watchers: [] });
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
    const { left, right, top, bottom } = this.edge;
    this.x.set(this.view.x ?? (this.along ? x.range : padded(x.range, x.log)), left, this.width - right, x.log);
    const range = this.view.y ?? (this.along && this.scene.fit ? this.scene.fit(this.x.low, this.x.high) : y.range);
    this.clipped = !this.view.y && range.cut;
    this.y.set(this.view.y ?? padded(range, y.log), this.height - bottom, top, y.log);
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
      if (this.scene.cells) this.cells(pen);
      for (const series of this.scene.series) if (!series.over) this.line(pen, series);
    });
  }

  drawMoving() {
    const pen = this.pen(1);
    this.within(pen, () => {
      for (const series of this.scene.series) if (series.over) this.line(pen, series);
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

  line(pen, series) {
    if (series.hidden || !series.xs.length) return;
    [pen.strokeStyle, pen.fillStyle] = [colour(series.colour ?? "--model"), colour(series.colour ?? "--model")];
    [pen.lineWidth, pen.lineJoin] = [series.width ?? 1.5, "round"];
    pen.setLineDash(series.dash ?? []);
    if (series.heat) this.heated(pen, series);
    else if (this.along) this.graph(pen, series);
    else if (series.dots) this.dots(pen, series);
    else this.path(pen, series, 0, series.xs.length);
    pen.setLineDash([]);
  }

  /** A curve over ascending xs: the lowest and highest value of each pixel. */
  graph(pen, series) {
    const { xs, ys } = series;
    const first = Math.max(0, lowerBound(xs, this.x.low) - 1), end = Math.min(xs.length, lowerBound(xs, this.x.high) + 2);
    const bins = this.width - this.edge.left - this.edge.right, count = end - first;
    if (series.dots && count < bins / 3) return this.dots(pen, series, first, end, 0);
    if (series.dots) pen.lineWidth = 3.4;
    pen.beginPath();
    if (count <= 3 * bins || this.scene.x.log) {
      for (let i = first; i < end; i++) pen.lineTo(this.x.px(xs[i]), this.y.px(ys[i]));
    } else
      for (let bin = 0; bin < bins; bin++) {
        const from = first + Math.floor((bin * count) / bins), to = first + Math.floor(((bin + 1) * count) / bins);
        let low = from, high = from;
        for (let i = from + 1; i < to; i++) {
          if (ys[i] < ys[low]) low = i;
          if (ys[i] > ys[high]) high = i;
        }
        const [one, two] = low < high ? [low, high] : [high, low];
        pen.lineTo(this.x.px(xs[one]), this.y.px(ys[one]));
        if (two !== one) pen.lineTo(this.x.px(xs[two]), this.y.px(ys[two]));
      }
    pen.stroke();
  }

  /** Dots that are told apart; of very many, smaller ones. */
  dots(pen, { xs, ys }, first = 0, end = xs.length, apart = APART) {
    const size = end - first > MANY ? 1.6 : 3.2;
    let [left, top] = [-99, -99];
    for (let i = first; i < end; i++) {
      const x = this.x.px(xs[i]), y = this.y.px(ys[i]);
      if (Math.abs(x - left) + Math.abs(y - top) < apart) continue;
      pen.fillRect(x - size / 2, y - size / 2, size, size);
      [left, top] = [x, y];
    }
  }

  heated(pen, { xs, ys, heat, heatRange: [low, high] }) {
    const sorted = HEAT.map(() => []);
    let [left, top] = [-99, -99];
    for (let i = 0; i < xs.length; i++) {
      const x = this.x.px(xs[i]), y = this.y.px(ys[i]);
      if (Math.abs(x - left) + Math.abs(y - top) < 1.5) continue;
      sorted[Math.min(HEAT.length - 1, Math.max(0, Math.floor(((heat[i] - low) / (high - low || 1)) * HEAT.length)))].push(x, y);
      [left, top] = [x, y];
    }
    sorted.forEach((points, place) => {
      pen.fillStyle = HEAT[place];
      for (let i = 0; i < points.length; i += 2) pen.fillRect(points[i] - 1.3, points[i + 1] - 1.3, 2.6, 2.6);
    });
  }

  path(pen, { xs, ys }, first, end) {
    pen.beginPath();
    let [left, top, inside] = [-1e9, -1e9, false];
    for (let i = first; i < end; i++) {
      const x = this.x.px(xs[i]), y = this.y.px(ys[i]);
      if (Math.abs(x - left) + Math.abs(y - top) < NEAR && i !== end - 1) continue;
      const visible = x > -50 && y > -50 && x < this.width + 50 && y < this.height + 50;
      if (i === first || !(visible || inside)) pen.moveTo(x, y);
      else pen.lineTo(x, y);
      [left, top, inside] = [x, y, visible];
    }
    pen.stroke();
  }

  /** Draw the mean value of each cell as a colour on a diverging scale. */
  cells(pen) {
    const { columns, rows, largest, means, x: [left, right], y: [low, high] } = this.scene.cells;
    const width = (this.x.px(right) - this.x.px(left)) / columns, height = (this.y.px(low) - this.y.px(high)) / rows;
    const [middle, below, above] = ["--zero", "--below", "--above"].map((name) => rgb(colour(name)));
    means.forEach((mean, cell) => {
      if (Number.isNaN(mean)) return;
      const share = Math.min(1, Math.abs(mean) / largest), side = mean < 0 ? below : above;
      pen.fillStyle = `rgb(${middle.map((part, i) => Math.round(part + share * (side[i] - part))).join(" ")})`;
      const [column, row] = [cell % columns, Math.floor(cell / columns)];
      pen.fillRect(this.x.px(left) + column * width, this.y.px(low) - (row + 1) * height, width + 0.6, height + 0.6);
    });
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
      this.path(pen, { xs, ys }, first, end);
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

function rgb(hex) {
  return [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16));
}
