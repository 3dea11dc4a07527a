import { element, isPrinting, redrawForPrint, USE_NAMES } from "./parts.js";
import { colour, gridded, Plane, tick } from "./plane.js";
import { deviationFromLine, errorOf, extent, lowerBound, marksInBox, marksInTime, number, thinned } from "./signals.js";

const MODELS = ["--model", "--before", "--third", "--fourth"];
const DASHES = [[], [6, 3], [2, 2], [8, 2, 2, 2]];
const LONG = 20000; // points; longer records are drawn without dashes, one pixel wide, which is five times as fast

/** Model and measurement over time, as a loop and as a map of the residual. A mark made in one plot is shown in all. */
export class Explorer {
  constructor(root, records, options = {}) {
    Object.assign(this, { root, records, floors: options.floors ?? {}, marks: [] });
    root.classList.add("explorer");
    root.replaceChildren();
    this.bar();
    this.readout = element(root, "p", { class: "readout", role: "status", "aria-live": "polite" });
    this.curves = element(root, "div", {
      class: "curves", tabindex: 0, role: "group",
      "aria-label": "Signals over time. Arrow keys move the mark, with Shift its end; Enter zooms to the mark, Home shows the whole record; Escape clears the mark.",
    });
    const planes = element(root, "div", { class: "planes" });
    this.loop = new Plane(planes, "Loop: response against drive", (xs, ys) => this.markBox(this.record.response, xs, ys));
    this.map = new Plane(planes, "Residual map", (xs, ys) => this.markBox(this.deviation, xs, ys));
    this.curves.addEventListener("keydown", (event) => this.key(event));
    const redraw = () => this.record && this.draw();
    new ResizeObserver(() => this.root.clientWidth !== this.drawnWidth && redraw()).observe(root);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    redrawForPrint(redraw);
    this.choose(0);
  }

  bar() {
    const bar = element(this.root, "div", { class: "bar" });
    this.picker = element(element(bar, "label", {}, "Record "), "select");
    this.picker.addEventListener("change", () => this.choose(Number(this.picker.value)));
    this.from = element(element(bar, "label", {}, "Mark from "), "input", { type: "number", step: "any" });
    this.to = element(element(bar, "label", {}, "to "), "input", { type: "number", step: "any" });
    bar.append("s");
    for (const field of [this.from, this.to])
      field.addEventListener("change", () => this.markFields());
    for (const [name, action] of [["Zoom to mark", () => this.zoomToMark()], ["Show all", () => this.zoom()], ["Clear", () => this.mark([])]])
      element(bar, "button", { type: "button" }, name).addEventListener("click", action);
    this.fillPicker();
  }

  fillPicker() {
    this.picker.replaceChildren();
    this.records.forEach((record, place) => {
      const several = this.records.some((other) => other.axis !== record.axis);
      element(this.picker, "option", { value: place }, `${record.name}${several ? `, ${record.axis}` : ""} (${USE_NAMES[record.use]})`);
    });
  }

  /** Show other models or records; the selected record and its marks are kept if the new records have them. */
  update(records) {
    const same = records.findIndex((item) => item.name === this.record.name && item.axis === this.record.axis);
    const sameSize = same >= 0 && records[same].index.length === this.record.index.length;
    const marks = sameSize ? this.marks : [];
    this.records = records;
    this.fillPicker();
    this.choose(Math.max(same, 0), marks);
  }

  choose(place, marks = []) {
    this.picker.value = place;
    this.record = this.records[place];
    this.scored = lowerBound(this.record.index, this.record.settle);
    this.deviation = deviationFromLine(this.record.drive, this.record.response, this.scored);
    this.span = [0, this.record.index.length];
    this.marks = marks;
    this.draw();
  }

  mark(marks, written = true) {
    this.marks = marks;
    const { time } = this.record;
    const ends = marks.length ? [time[marks[0][0]], time[marks.at(-1)[1] - 1]] : ["", ""];
    if (written) [this.from.value, this.to.value] = ends.map((value) => (value === "" ? "" : Number(value.toPrecision(7))));
    this.updateReadout();
    for (const plot of this.plots) this.band(plot);
    for (const plane of [this.loop, this.map]) plane.mark(marks);
  }

  /** Mark the interval in the two fields; an empty field is the start or end of the record. */
  markFields() {
    const { time } = this.record;
    const [from, to] = [this.from, this.to].map((field, end) => (field.value === "" ? time.at(-end || 0) : Number(field.value)));
    this.mark(this.from.value + this.to.value === "" ? [] : marksInTime(this.record, from, to), false);
  }

  markBox(ys, xRange, yRange) {
    this.mark(xRange ? marksInBox(this.record.drive, ys, xRange, yRange) : []);
  }

  /** The RMSE of each model over the marked segments, or over the whole record. */
  updateReadout() {
    const { record, marks } = this;
    const wholeRecord = [[0, record.index.length]];
    const errors = record.models.map((model) => {
      const { rmse, share } = errorOf(record, model, marks.length ? marks : wholeRecord);
      const portion = marks.length ? `, ${number(100 * share, 2)} % of the record's squared error` : "";
      return `${record.models.length > 1 ? `${model.name}: ` : ""}RMSE ${number(rmse)} ${record.unit}${portion}`;
    });
    this.readout.textContent = `${this.markedSpan()}: ${errors.join("; ")}${this.overFloor()}.`;
  }

  markedSpan() {
    const { time } = this.record;
    if (!this.marks.length) return `Whole record, ${number(time.at(-1) - time[0])} s`;
    const [from, to] = [time[this.marks[0][0]], time[this.marks.at(-1)[1] - 1]];
    const parts = this.marks.length > 1 ? `${this.marks.length} segments ` : "";
    return `Marked ${parts}from ${tick(from)} s to ${tick(to)} s`;
  }

  overFloor() {
    const floor = this.floors[this.record.axis];
    return floor ? `; noise floor ${number(floor, 2)} ${this.record.unit}` : "";
  }

  draw() {
    this.drawnWidth = this.root.clientWidth;
    this.pixelRatio = isPrinting() ? 2 : 1;
    this.curves.replaceChildren();
    const { record } = this;
    const several = record.models.length > 1, models = record.models.toReversed();
    this.plots = [
      this.plot(`response [${record.unit}]`, 0.26, 0, [record.response, ...models.map((model) => sum(record.response, model.residual))], [
        { label: "measured", stroke: () => colour("--measured"), width: 3 * this.pixelRatio },
        ...this.lines(several ? (model) => model.name : () => "model"),
      ]),
      this.plot(`residual [${record.unit}]`, 0.18, this.floors[record.axis] ?? 0, models.map((model) => model.residual),
        this.lines(several ? (model) => `residual, ${model.name}` : () => "residual (model minus measurement)")),
    ];
    this.loop.show(this.scene(record.response, `response [${record.unit}]`, {
      curves: [
        { xs: record.drive, ys: record.response, colour: "--measured", width: 3 },
        ...record.models.map((model, place) => ({
          xs: record.drive, ys: sum(record.response, model.residual), colour: MODELS[place % 4], width: 1, dash: this.dash(place),
        })).reverse(),
      ],
    }));
    const cells = gridded(record.drive, this.deviation, record.models[0].residual, this.scored);
    this.map.caption.textContent = `Residual map: mean residual along the loop, drawn without its mean slope. Violet: the model is ${number(cells.largest, 2)} ${record.unit} or more below the measurement; orange: above.`;
    this.map.show(this.scene(this.deviation, `deviation from a straight line [${record.unit}]`, { cells }));
    this.mark(this.marks);
  }

  scene(ys, yLabel, content) {
    const ranges = [this.record.drive, ys].map((values) => extent(values.subarray(this.scored)));
    return { xs: this.record.drive, ys, ranges, xLabel: `drive [${this.record.driveUnit}]`, yLabel, marks: this.marks, ...content };
  }

  plot(label, share, floor, arrays, series) {
    const { record, pixelRatio } = this;
    const width = Math.max(280, this.curves.clientWidth - 4);
    const font = `${Math.round(0.78 * pixelRatio * parseFloat(getComputedStyle(this.curves).fontSize))}px system-ui, sans-serif`;
    const axis = (label, labelSize, size, more) => ({
      label, labelSize: pixelRatio * labelSize, size: pixelRatio * size, gap: 5 * pixelRatio, space: (self, axis) => pixelRatio * (axis ? 24 : 50), font, labelFont: font,
      stroke: () => colour("--quiet"), grid: { stroke: () => colour("--rule"), width: pixelRatio }, ticks: { show: false }, ...more,
    });
    const plot = new uPlot({
      width: pixelRatio * width, height: pixelRatio * Math.round(Math.min(Math.max(width * share, 130), 420)),
      legend: { live: false },
      cursor: { sync: { key: this.record.name }, drag: { x: true, y: false, setScale: false }, points: { show: false } },
      scales: { x: { time: false }, y: { range: () => this.range(arrays, floor) } },
      axes: [axis("time [s]", 18, 32), axis(label, 20, 58, { values: (_, values) => values.map(tick) })],
      series: [{ label: "time" }, ...series],
      hooks: {
        setSelect: [(self) => this.dragged(self)],
        setCursor: [(self) => this.hover(self)],
        drawAxes: [(self) => this.shade(self, floor)],
        draw: [(self) => self.bands && this.band(self)],
      },
    }, null, this.curves);
    plot.bands = element(plot.under, "canvas");
    plot.fill = () => {
      const shown = thinned(arrays, ...this.span, Math.max(200, Math.round(width)));
      plot.setData([shown.map((i) => record.time[i]), ...arrays.map((values) => shown.map((i) => values[i]))]);
      plot.shown = shown;
    };
    plot.over.addEventListener("dblclick", () => this.mark([]));
    plot.fill();
    return plot;
  }

  /** Range of the scored samples in view and of the noise floor, with a margin. */
  range(arrays, floor) {
    const first = Math.min(Math.max(this.span[0], this.scored), this.span[1] - 1);
    const ends = arrays.map((values) => extent(values.subarray(first, this.span[1])));
    const [low, high] = [Math.min(-floor || Infinity, ...ends.map(([low]) => low)), Math.max(floor || -Infinity, ...ends.map(([, high]) => high))];
    return [low - 0.06 * (high - low), high + 0.06 * (high - low)];
  }

  /** The series of the models, the last one on top. */
  lines(labelOf) {
    const width = (this.record.index.length > LONG ? 1 : 1.2) * this.pixelRatio;
    return this.record.models.map((model, place) => ({
      label: labelOf(model), stroke: () => colour(MODELS[place % 4]), width, dash: this.dash(place),
    })).reverse();
  }

  dash(place) { return this.record.index.length > LONG ? [] : DASHES[place % 4]; }

  dragged(plot) {
    if (plot.select.width < 3) return;
    const [from, to] = [plot.select.left, plot.select.left + plot.select.width].map((px) => plot.posToVal(px, "x"));
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.mark(marksInTime(this.record, from, to));
  }

  hover(plot) {
    const point = plot.cursor.idx === null || plot.cursor.idx === undefined ? null : plot.shown?.[plot.cursor.idx] ?? null;
    if (point === this.pointed || !this.map.scene) return;
    this.pointed = point;
    this.loop.overlay(point);
    this.map.overlay(point);
  }

  /** Draw the marked segments on a layer behind the curves, which need not be redrawn. */
  band(plot) {
    const { time } = this.record;
    const { width, height } = plot.bbox;
    Object.assign(plot.bands, { width, height }); // clears it
    const pen = plot.bands.getContext("2d");
    pen.fillStyle = colour("--marked");
    for (const [first, end] of this.marks) {
      const [from, to] = [time[first], time[end - 1]].map((value) => plot.valToPos(value, "x", true) - plot.bbox.left);
      if (to >= 0 && from <= width) pen.fillRect(from, 0, Math.max(to - from, 1), height);
    }
  }

  /** Shade the samples that are not scored and, in the residual, the noise floor. */
  shade(plot, floor) {
    const { time, settle, start, dt } = this.record;
    const { left, top, width, height } = plot.bbox;
    const strip = (from, to, fill) => {
      const [x0, x1] = [from, to].map((value) => Math.min(Math.max(plot.valToPos(value, "x", true), left), left + width));
      plot.ctx.fillStyle = fill;
      plot.ctx.fillRect(x0, top, x1 - x0, height);
    };
    plot.ctx.save();
    if (settle) strip(start, start + settle * dt, colour("--soft"));
    if (isPrinting()) for (const [first, end] of this.marks) strip(time[first], time[end - 1], colour("--marked"));
    if (floor) {
      const [y0, y1] = [floor, -floor].map((value) => Math.min(Math.max(plot.valToPos(value, "y", true), top), top + height));
      plot.ctx.fillStyle = colour("--noise");
      plot.ctx.fillRect(left, y0, width, y1 - y0);
    }
    plot.ctx.restore();
  }

  zoom(first = 0, end = this.record.index.length) {
    this.span = [first, end];
    for (const plot of this.plots) plot.fill();
  }

  zoomToMark() {
    if (!this.marks.length) return;
    const [first, end] = [this.marks[0][0], this.marks.at(-1)[1]];
    const margin = Math.max(2, Math.round(0.05 * (end - first)));
    this.zoom(Math.max(0, first - margin), Math.min(this.record.index.length, end + margin));
  }

  key(event) {
    const { time } = this.record;
    const [first, end] = this.span;
    const step = (time[end - 1] - time[first]) / 50;
    const [from, to] = this.marks.length ? [time[this.marks[0][0]], time[this.marks.at(-1)[1] - 1]] : [time[first], time[first] + 5 * step];
    const move = { ArrowLeft: -step, ArrowRight: step }[event.key];
    if (move) {
      const shift = this.marks.length ? move : 0;
      const span = event.shiftKey ? [from, Math.max(from + step, to + shift)] : [from + shift, to + shift];
      this.mark(marksInTime(this.record, ...span));
    } else if (event.key === "Enter") this.zoomToMark();
    else if (event.key === "Home") this.zoom();
    else if (event.key === "Escape") this.mark([]);
    else return;
    event.preventDefault();
  }

  /** Select a record by name and axis and mark an interval in it, for a button elsewhere on the page. */
  reveal(name, axis, from, to) {
    const place = this.records.findIndex((record) => record.name === name && record.axis === axis);
    if (place < 0) return;
    if (this.record !== this.records[place]) this.choose(place);
    this.mark(marksInTime(this.record, from, to));
    this.root.scrollIntoView({ block: "start" });
  }
}

function sum(a, b) {
  return a.map((value, i) => value + b[i]);
}
