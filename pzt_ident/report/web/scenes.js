// What the plots of an explorer show of a record: series, ranges and bands. Nothing here touches the page.

import { extent, gridded, lowerBound, number } from "./signals.js";

const MODELS = ["--model", "--before", "--third", "--fourth"];
export const NAMES = { now: "model", before: "model before" };
const PEAKED = 5; // times the range of nearly all values, above which peaks are cut off
const DASHES = [[], [6, 3], [2, 2], [8, 2, 2, 2]];

export const LOOP_VIEWS = { loop: "Loop", deviation: "Loop without its slope", map: "Map of the residual" };
export const COLOURINGS = { "": "one colour", rate: "rate of the drive", time: "time", residual: "residual" };

/** The models of a record as lines, first on top; the one that follows a slider, if there is one, above all. */
function models(record, live, ys) {
  const lines = record.models.map((model, place) => ({
    label: record.models.length > 1 ? NAMES[model.name] ?? model.name : live ? "fitted" : "model", xs: record.time, ys: ys(model),
    colour: live ? "--before" : MODELS[place % 4], dash: live ? [6, 3] : DASHES[place % 4], width: place || live ? 1.3 : 1.6, over: !live,
  })).reverse();
  return live ? [...lines.slice(-1), { ...live, over: true, colour: "--model", width: 1.6 }] : lines;
}

/** Response over time; of a record without a model beside its drive. */
export function responseScene(record, live) {
  const series = [
    { label: "measured", xs: record.time, ys: record.response, colour: "--measured", dots: true },
    ...models(record, live && { label: "with these values", xs: live.time, ys: live.values, places: live.places }, (model) => model.output),
  ];
  return timeScene(record, series, `response [${record.unit}]`, record.response);
}

export function residualScene(record, live, floor) {
  const series = models(record, live && { label: "with these values", xs: live.time, ys: live.residual, places: live.places }, (model) => model.residual);
  const scene = timeScene(record, series, `model minus measurement [${record.unit}]`, record.models[0].residual, floor);
  return { ...scene, fit: (from, to) => withoutPeaks(scene.fit(from, to), series, from, to) };
}

/** A range, narrowed (`cut`) to what nearly all values in view need where a few peaks would make the rest a line. */
function withoutPeaks([low, high], series, from, to) {
  const usual = series.map(({ xs, ys }) => {
    const [first, end] = [lowerBound(xs, from), lowerBound(xs, to)];
    const step = Math.max(1, Math.floor((end - first) / 1000));
    const sorted = Float64Array.from({ length: Math.floor((end - first) / step) }, (_, i) => ys[first + i * step]).sort();
    return sorted.length > 100 ? [sorted[Math.floor(0.01 * sorted.length)], sorted[Math.floor(0.99 * sorted.length)]] : [low, high];
  });
  const [least, most] = [Math.min(...usual.map(([a]) => a)), Math.max(...usual.map(([, b]) => b))];
  const room = 0.8 * (most - least);
  if (!(high - low > PEAKED * (most - least) && most > least)) return [low, high];
  return Object.assign([Math.max(low, least - room), Math.min(high, most + room)], { cut: true });
}

export function driveScene(record) {
  return timeScene(record, [{ label: "drive", xs: record.time, ys: record.drive, colour: "--identify" }], `drive [${record.driveUnit}]`, record.drive);
}

function timeScene(record, series, label, track, floor = 0) {
  const { time, start, settle, dt } = record;
  const scored = time[Math.min(record.scored, time.length - 1)];
  const fit = (from, to) => {
    const within = ({ xs, ys }) => {
      const ends = [lowerBound(xs, Math.min(Math.max(from, scored), to)), lowerBound(xs, to) + 1];
      return extent(ys.subarray(...ends));
    };
    const ranges = series.map(within).filter(([low]) => Number.isFinite(low));
    return [Math.min(-floor * 1.5 || Infinity, ...ranges.map(([low]) => low)), Math.max(floor * 1.5 || -Infinity, ...ranges.map(([, high]) => high))];
  };
  return {
    series, fit, floor, track: { xs: time, ys: track },
    strips: record.strips?.() ?? (settle ? [{ from: start, to: start + settle * dt, colour: "--unscored" }] : []),
    x: { label: record.timeLabel ?? "time [s]", range: [time[0], time.at(-1)] }, y: { label, range: [0, 1] },
  };
}

/** The loop, the loop without its mean slope, or the map of the residual. */
export function loopScene(record, view, colouring, live) {
  const ys = view === "loop" ? record.response : record.deviation;
  const shift = view === "loop" ? null : record.line;
  const scene = {
    x: { label: `drive [${record.driveUnit}]`, range: extent(record.drive.subarray(record.scored)) },
    y: { label: `${view === "loop" ? "response" : "deviation from a straight line"} [${record.unit}]`, range: extent(ys.subarray(record.scored)) },
    track: { xs: record.drive, ys }, series: [],
  };
  if (view === "map") {
    scene.cells = gridded(record.drive, record.deviation, record.models[0].residual, record.scored);
    scene.caption = `Mean residual along the loop. Violet: the model is ${number(scene.cells.largest, 2)} ${record.unit} or more below the measurement; orange: above.`;
    return scene;
  }
  const bent = (values, drive) => (shift ? values.map((value, i) => value - shift.offset - shift.slope * drive[i]) : values);
  const measured = { label: "measured", xs: record.drive, ys, colour: "--measured", dots: true };
  if (colouring) Object.assign(measured, heatOf(record, colouring));
  const drawn = live && { label: "with these values", xs: live.drive, ys: bent(live.values, live.drive), places: live.places };
  const lines = models(record, drawn, (model) => bent(model.output, record.drive)).map((line) => ({ ...line, xs: line === drawn || line.places ? line.xs : record.drive }));
  scene.series = [measured, ...(colouring ? [] : drawn ? lines.slice(-1) : lines)];
  return scene;
}

/** Values that colour the points of a loop, their range without outliers, and how the legend names them. */
function heatOf(record, colouring) {
  const heat = { rate: () => rateOf(record), time: () => record.time, residual: () => record.models[0].residual }[colouring]();
  const sorted = Float64Array.from(heat.filter((_, i) => i % Math.ceil(heat.length / 5000) === 0)).sort();
  const heatRange = [sorted[Math.floor(0.01 * sorted.length)], sorted[Math.floor(0.99 * (sorted.length - 1))]];
  const unit = { rate: `${record.driveUnit}/s`, time: "s", residual: record.unit }[colouring];
  return { heat, heatRange, label: `measured, ${COLOURINGS[colouring]} ${number(heatRange[0], 3)} to ${number(heatRange[1], 3)} ${unit}` };
}

function rateOf({ drive, time }) {
  return drive.map((_, i) => (i ? (drive[i] - drive[i - 1]) / (time[i] - time[i - 1] || 1) : 0));
}

/** Amplitude density of the residual over frequency; `spectrum` as the server sends it for one record and axis. */
export function spectrumScene({ frequency, residual }, unit) {
  return logScene([curve("residual", frequency, residual, "--model", false)], `amplitude density of the residual [${unit}/√Hz]`);
}

/** Amplitude, and phase, of the response over frequency: measured as dots, model as a line. */
export function bodeScenes({ frequency, measured, model }, unit) {
  const pick = (key) => [curve("measured", frequency, measured[key], "--measured", true), curve("model", frequency, model[key], "--model", false)];
  const phases = logScene(pick("phase"), "phase [°]");
  phases.y.log = false;
  return [logScene(pick("amplitude"), `amplitude ratio [${unit}]`), phases];
}

function curve(label, frequency, values, colour, dots) {
  const shown = frequency.map((x, i) => [x, values[i]]).filter(([x, y]) => x > 0 && Number.isFinite(y));
  return { label, xs: shown.map(([x]) => x), ys: shown.map(([, y]) => y), colour, dots, over: !dots };
}

function logScene(series, label) {
  const range = (key) => extent(series.flatMap((line) => line[key]));
  return { series, x: { label: "frequency [Hz]", range: range("xs"), log: true }, y: { label, range: range("ys"), log: true }, track: null };
}
