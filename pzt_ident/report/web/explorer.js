import { Figure } from "./figure.js";
import { element, redrawForPrint, select, USE_NAMES } from "./parts.js";
import { tick } from "./scale.js";
import { bodeScenes, COLOURINGS, driveScene, LOOP_VIEWS, loopScene, NAMES, residualScene, responseScene, spectrumScene } from "./scenes.js";
import { deviationFromLine, errorOf, lowerBound, marksInBox, marksInTime, number, sampledAt } from "./signals.js";

const MODES = { pan: "Move", zoom: "Zoom", mark: "Mark" };
const TIME_VIEWS = { time: "Time", spectrum: "Spectrum of the residual", bode: "Frequency response" };
const KEYS = "Arrow keys move the cursor, with Shift they mark; Enter zooms to the mark, Escape clears it; plus and minus zoom, Page Up and Page Down pan, Home shows all.";

/** Model and measurement as a loop and over time, with linked cursors, marks and views, in panes of the page:
 * `bar` for the controls, `loop` and `time` for the plots. `spectra(record)` gives spectra, where there are any. */
export class Explorer {
  constructor(panes, records, { floors = {}, wheel = "always", spectra = null } = {}) {
    Object.assign(this, { panes, records, floors, spectra, marks: [], mode: "pan", loopView: "loop", timeView: "time", colouring: "", point: null, live: null });
    for (const pane of Object.values(panes)) pane.replaceChildren();
    const gestures = {
      wheel, mode: () => this.mode, reset: () => this.showAll(), moved: (plot) => this.follow(plot), point: (point) => this.pointAt(point),
    };
    this.loop = new Figure(panes.loop, { label: `Loop: response against drive. ${KEYS}`, gestures: { ...gestures, mark: (xs, ys) => this.markBox(xs, ys) } });
    const inTime = { ...gestures, mark: (xs) => this.mark(xs ? marksInTime(this.record, ...xs) : []) };
    this.response = new Figure(panes.time, { label: `Response over time. ${KEYS}`, along: true, gestures: inTime });
    this.lower = new Figure(panes.time, { label: `Residual over time: model minus measurement. ${KEYS}`, along: true, gestures: inTime, lower: true });
    this.bar();
    for (const { plot } of this.figures()) plot.root.addEventListener("keydown", (event) => this.key(event));
    redrawForPrint(() => this.record && this.draw());
    this.choose(0);
  }

  figures() { return [this.loop, this.response, this.lower]; }

  bar() {
    const { bar } = this.panes;
    this.picker = select(bar, [], "", "Record");
    this.picker.addEventListener("change", () => this.choose(Number(this.picker.value)));
    const group = element(bar, "span", { class: "modes", role: "group", "aria-label": "What dragging in a plot does" });
    for (const [mode, text] of Object.entries(MODES)) {
      const button = element(group, "button", { type: "button", "aria-pressed": String(mode === this.mode), "data-mode": mode }, text);
      button.addEventListener("click", () => this.setMode(mode));
    }
    element(bar, "button", { type: "button" }, "Show all").addEventListener("click", () => this.showAll());
    this.clear = element(bar, "button", { type: "button" }, "Clear mark");
    this.clear.addEventListener("click", () => this.mark([]));
    this.readout = element(bar, "span", { class: "readout", role: "status" });
    const loopBar = this.loop.bar, timeBar = this.response.bar;
    this.loopPicker = select(loopBar, Object.entries(LOOP_VIEWS), "loop", "View of the loop");
    this.loopPicker.addEventListener("change", () => { this.loopView = this.loopPicker.value; this.loop.plot.look(null, null); this.draw(); });
    this.colourPicker = select(loopBar, Object.entries(COLOURINGS), "", "Colour of the loop");
    this.colourPicker.addEventListener("change", () => { this.colouring = this.colourPicker.value; this.draw(); });
    this.timePicker = select(timeBar, Object.entries(TIME_VIEWS), "time", "View over time or frequency");
    this.timePicker.addEventListener("change", () => { this.timeView = this.timePicker.value; this.showAll(); this.draw(); });
    this.fillPicker();
  }

  setMode(mode) {
    this.mode = mode;
    for (const button of this.panes.bar.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", String(button.dataset.mode === mode));
    for (const { plot } of this.figures()) plot.root.classList.toggle("boxes", mode !== "pan");
  }

  fillPicker() {
    this.picker.replaceChildren();
    const several = this.records.some((other) => other.axis !== this.records[0].axis);
    this.records.forEach((record, place) =>
      element(this.picker, "option", { value: place }, `${record.name}${several ? `, ${record.axis}` : ""}${record.use ? ` (${USE_NAMES[record.use] ?? record.use})` : ""}`));
  }

  /** Show other models or records; the record, its marks and the view are kept if the new records have them. */
  update(records, { floors = this.floors } = {}) {
    const same = this.record ? records.findIndex((item) => item.name === this.record.name && item.axis === this.record.axis && item.use === this.record.use) : -1;
    const sameSize = same >= 0 && records[same].index.length === this.record.index.length;
    const [marks, views] = [sameSize ? this.marks : [], this.figures().map(({ plot }) => plot.view)];
    Object.assign(this, { records, floors, live: null });
    this.fillPicker();
    this.choose(Math.max(same, 0), marks, sameSize ? views : null);
  }

  choose(place, marks = [], views = null) {
    this.picker.value = place;
    const record = this.record = this.records[place];
    record.scored ??= Math.min(lowerBound(record.index, record.settle), record.index.length - 2);
    if (!record.deviation) [record.deviation, record.line] = deviationFromLine(record.drive, record.response, record.scored);
    for (const model of record.models) model.output ??= model.residual.map((value, i) => value + record.response[i]);
    this.marks = marks;
    this.figures().forEach(({ plot }, i) => { plot.view = views?.[i] ?? { x: null, y: null }; });
    for (const [picker, name] of [[this.loopPicker, "map"], [this.colourPicker, "residual"]])
      picker.querySelector(`[value=${name}]`).disabled = !record.models.length;
    if (!record.models.length) {
      [this.timeView, this.timePicker.value] = ["time", "time"];
      if (this.loopView === "map") [this.loopView, this.loopPicker.value] = ["loop", "loop"];
      if (this.colouring === "residual") [this.colouring, this.colourPicker.value] = ["", ""];
    }
    if (this.live) this.live = null;
    this.timePicker.hidden = !this.spectra || !record.models.length;
    this.draw();
    this.mark(marks);
    this.onChoose?.();
  }

  liveOf({ name, axis, use }, live = this.live) { return live?.get(`${name}|${axis}|${use}`) ?? live?.get(`${name}|${axis}`) ?? null; }

  draw() {
    const { record } = this;
    if (record.alone) return this.drawAlone();
    this.loop.show(this.loopScene(), record.unit);
    if (this.timeView !== "time") return this.drawSpectra();
    this.response.plot.along = this.lower.plot.along = true;
    this.response.show(this.responseScene(), record.unit);
    this.lower.show(this.lowerScene(), record.models.length ? record.unit : record.driveUnit);
    this.lower.element.hidden = false;
    this.pointAt(this.point);
  }

  /** A record of a single signal. */
  drawAlone() {
    const { record } = this;
    this.loop.say("The loop is drawn when there are a drive and a response.");
    this.lower.element.hidden = true;
    const scene = responseScene(record);
    this.response.show({ ...scene, y: { ...scene.y, label: `${record.alone} [${record.unit}]` } }, record.unit);
    this.pointAt(this.point);
  }

  loopScene() {
    return { ...loopScene(this.record, this.loopView, this.colouring, this.liveOf(this.record)), marks: this.marks };
  }

  responseScene() {
    const { record, marks } = this;
    return { ...responseScene(record, this.liveOf(record)), marks, x: { label: "", range: [record.time[0], record.time.at(-1)] } };
  }

  lowerScene() {
    const { record, marks } = this;
    const scene = record.models.length ? residualScene(record, this.liveOf(record), this.floors[record.axis] ?? 0) : driveScene(record);
    return { ...scene, marks };
  }

  async drawSpectra() {
    const { record, timeView } = this;
    const waiting = setTimeout(() => this.say("Computing …"), 200);
    const spectra = await Promise.resolve(this.spectra(record)).catch((error) => error);
    clearTimeout(waiting);
    if (record !== this.record || timeView !== this.timeView) return;
    if (spectra instanceof Error) return this.say(spectra.message);
    const found = timeView === "spectrum" ? spectra?.residual.some((value) => value > 0) && [spectrumScene(spectra, record.unit)] : spectra?.measured?.amplitude.filter(Number.isFinite).length > 2 && bodeScenes(spectra, `${record.unit}/${record.driveUnit}`);
    if (!found) return this.say(timeView === "spectrum" ? "There is no spectrum of this record." : "The drive of this record has too few frequencies for a frequency response.");
    this.response.plot.along = this.lower.plot.along = false;
    this.lower.element.hidden = found.length < 2;
    this.response.show(found[0], timeView === "spectrum" ? record.unit : `${record.unit}/${record.driveUnit}`);
    if (found[1]) this.lower.show(found[1], "°");
  }

  /** A sentence in the place of the plots over time. */
  say(text) {
    this.response.say(text);
    this.lower.element.hidden = true;
  }

  /** Show what the model would do with other values: a map of record and axis to {places, values}; null ends it. */
  moveModel(live) {
    const before = this.live;
    this.live = live;
    const { record } = this, mine = this.liveOf(record);
    if (mine && !mine.residual) {
      [mine.time, mine.drive] = before && this.liveOf(record, before)?.places === mine.places ? [this.liveOf(record, before).time, this.liveOf(record, before).drive] : [sampledAt(record.time, mine.places), sampledAt(record.drive, mine.places)];
      mine.residual = mine.values.map((value, i) => value - record.response[mine.places[i]]);
    }
    if (!before || !live) return this.draw();
    if (this.loopView !== "map") this.loop.move(this.loopScene());
    if (this.timeView !== "time") return;
    this.response.move(this.responseScene());
    this.lower.move(this.lowerScene());
  }

  follow(plot) {
    if (this.timeView !== "time" || !plot.along) return;
    for (const { plot: other } of [this.response, this.lower]) if (other !== plot) other.look(plot.view.x, other.view.y);
  }

  showAll() {
    for (const { plot } of this.figures()) plot.look(null, null);
  }

  pointAt(point) {
    this.point = point;
    for (const figure of this.figures()) figure.pointAt(this.timeView === "time" || figure === this.loop ? point : null);
    this.updateReadout();
  }

  mark(marks) {
    this.marks = marks;
    for (const { plot } of this.figures()) if (plot.scene) plot.mark(plot.scene.track ? marks : []);
    this.clear.disabled = !marks.length;
    this.updateReadout();
  }

  markBox(xs, ys) {
    this.mark(xs ? marksInBox(this.record.drive, this.loopView === "loop" ? this.record.response : this.record.deviation, xs, ys) : []);
  }

  /** Time and drive at the cursor, or the RMSE of each model over the marked segments or the whole record. */
  updateReadout() {
    const { record, marks, point } = this;
    if (point !== null && point < record.time.length) {
      const drive = record.alone ? "" : `, drive ${number(record.drive[point], 4)} ${record.driveUnit}`;
      return this.read(`${tick(Number(record.time[point].toPrecision(6)))} ${record.timeLabel === "sample" ? "samples" : "s"}${drive}`);
    }
    const errors = record.models.map((model) => {
      const { rmse, share } = errorOf(record, model, marks.length ? marks : [[0, record.index.length]]);
      const portion = marks.length ? `, ${number(100 * share, 2)} % of the record's squared error` : "";
      return `${record.models.length > 1 ? `${NAMES[model.name] ?? model.name}: ` : ""}RMSE ${number(rmse)} ${record.unit}${portion}`;
    });
    const floor = this.floors[record.axis];
    if (floor && errors.length) errors.push(`noise floor ${number(floor, 2)} ${record.unit}`);
    this.read([this.markedSpan(), ...errors].join("; "));
  }

  read(text) {
    this.readout.textContent = this.readout.title = text;
  }

  markedSpan() {
    const { time } = this.record;
    if (!this.marks.length) return `Whole record, ${this.record.timeLabel === "sample" ? `${this.record.samples} samples` : `${number(time.at(-1) - time[0])} s`}`;
    const [from, to] = [time[this.marks[0][0]], time[this.marks.at(-1)[1] - 1]];
    return `Marked ${this.marks.length > 1 ? `${this.marks.length} segments ` : ""}from ${tick(from)} s to ${tick(to)} s`;
  }

  zoomToMark() {
    if (!this.marks.length) return;
    const { time } = this.record;
    const [from, to] = [time[this.marks[0][0]], time[this.marks.at(-1)[1] - 1]], margin = 0.05 * (to - from);
    for (const { plot } of [this.response, this.lower]) plot.look([Math.max(time[0], from - margin), Math.min(time.at(-1), to + margin)], null);
  }

  key(event) {
    if (event.altKey) return;
    const move = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const last = this.record.time.length - 1;
    if (move) {
      const before = this.point ?? lowerBound(this.record.time, this.response.plot.x.low ?? 0);
      const [first, end] = ["low", "high"].map((side) => lowerBound(this.record.time, this.response.plot.x[side]));
      const point = Math.min(last, Math.max(0, before + move * Math.max(1, Math.round((end - first) / 50))));
      if (event.shiftKey) {
        this.anchor ??= before;
        this.mark([[Math.min(this.anchor, point), Math.max(this.anchor, point) + 1]]);
      } else this.anchor = null;
      this.pointAt(point);
    } else if (event.key === "Enter") this.zoomToMark();
    else if (event.key === "Escape") { this.anchor = null; this.point = null; this.mark([]); this.pointAt(null); }
    else return;
    event.preventDefault();
  }

  /** Select a record by name and axis and mark an interval in it, for a button elsewhere on the page. */
  reveal(name, axis, from, to) {
    const place = this.records.findIndex((record) => record.name === name && record.axis === axis);
    if (place < 0) return;
    if (this.timeView !== "time") [this.timeView, this.timePicker.value] = ["time", "time"];
    if (this.record !== this.records[place]) this.choose(place);
    this.point = null;
    this.mark(marksInTime(this.record, from, to));
    this.zoomToMark();
    this.panes.time.scrollIntoView({ block: "nearest" });
  }
}
