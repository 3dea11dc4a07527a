// The arrays of a record, marks in them, and errors over marks. Nothing here draws.

/** A record from the payload of `report/traces.py`: typed arrays over the kept samples (points). */
export async function decode(packed) {
  const steps = packed.kept && new Uint16Array(await inflated(packed.kept));
  const points = steps ? steps.length : packed.samples;
  const index = new Float64Array(points);
  for (let i = 0, sample = 0; i < points; i++) index[i] = steps ? (sample += steps[i]) : i;
  const models = [];
  for (const model of packed.models) {
    const residual = await channel(model.residual);
    const sizes = model.sizes ? await channel(model.sizes) : residual;
    models.push({ name: model.name, residual, squares: cumulativeSums(points, (i) => (index[i] < packed.settle ? 0 : sizes[i] ** 2)) });
  }
  const first = packed.settle - 1;
  const counts = cumulativeSums(points, (i) => Math.max(0, index[i] - Math.max(i ? index[i - 1] : -1, first)));
  return {
    ...packed, index, models, counts,
    time: index.map((value) => packed.start + packed.dt * value),
    drive: await channel(packed.drive),
    response: await channel(packed.response),
  };
}

async function channel({ data, low, step }) {
  return Float64Array.from(new Uint16Array(await inflated(data)), (value) => low + step * value);
}

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** Cumulative sums of `value(i)`: over the first 0, 1, 2, ... points. */
function cumulativeSums(points, value) {
  const total = new Float64Array(points + 1);
  for (let i = 0; i < points; i++) total[i + 1] = total[i] + value(i);
  return total;
}

/** The points of a time interval as marks: a list of segments [first, last + 1]. */
export function marksInTime(record, from, to) {
  const first = lowerBound(record.time, Math.min(from, to));
  const end = lowerBound(record.time, Math.max(from, to) + record.dt * 1e-6);
  return end > first ? [[first, end]] : [];
}

/** The points inside a box of a plane as marks; a single point outside does not split a segment. */
export function marksInBox(xs, ys, [left, right], [low, high]) {
  const marks = [];
  for (let i = 0; i < xs.length; i++) {
    if (xs[i] < left || xs[i] > right || ys[i] < low || ys[i] > high) continue;
    const last = marks.at(-1);
    if (last && i - last[1] < 2) last[1] = i + 1;
    else marks.push([i, i + 1]);
  }
  return marks;
}

/** RMSE of a model over marks, their scored samples, and their share of the record's squared error. */
export function errorOf(record, model, marks) {
  let squares = 0, samples = 0;
  for (const [first, end] of marks) {
    squares += model.squares[end] - model.squares[first];
    samples += record.counts[end] - record.counts[first];
  }
  const total = model.squares.at(-1);
  return { rmse: samples ? Math.sqrt(squares / samples) : NaN, samples, share: total ? squares / total : 0 };
}

/** The first index of an ascending array whose value is not below `value`. */
export function lowerBound(values, value) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Deviation of y from the least-squares line through the points from `first` on, which opens a narrow loop, and the
 * line: {slope, offset}. */
export function deviationFromLine(xs, ys, first) {
  const n = xs.length - first;
  let x = 0, y = 0, xx = 0, xy = 0;
  for (let i = first; i < xs.length; i++) { x += xs[i] / n; y += ys[i] / n; }
  for (let i = first; i < xs.length; i++) { xx += (xs[i] - x) ** 2; xy += (xs[i] - x) * (ys[i] - y); }
  const slope = xx ? xy / xx : 0;
  return [ys.map((value, i) => value - y - slope * (xs[i] - x)), { slope, offset: y - slope * x }];
}

/** The values at some places of an array. */
export function sampledAt(values, places) {
  return Float64Array.from(places, (place) => values[place]);
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

export function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low < high ? [low, high] : [low - 0.5, low + 0.5];
}

/** Round values that divide a range into about `count` steps. */
export function ticks([low, high], count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((round) => round * power).find((round) => round >= raw);
  const values = [];
  for (let i = Math.ceil(low / step); i * step <= high + step * 1e-9; i++) values.push(Number((i * step).toPrecision(12)));
  return values;
}

/** A number with `digits` significant digits as text; a dash where there is none. */
export function number(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) {
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    const raised = [...String(Number(power))].map((sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]).join("");
    return `${mantissa} × 10${raised}`.replace("-", "−");
  }
  const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(places).replace("-", "−");
}
