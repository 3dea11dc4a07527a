import { number, ticks } from "./signals.js";

/** Values along one side of a plot: `low` to `high` at the pixels `from` to `to`, linear or logarithmic. */
export class Scale {
  set([low, high], from, to, log) {
    Object.assign(this, { low, high, from, to, log });
    [this.first, this.last] = log ? [Math.log(low), Math.log(high)] : [low, high];
    this.perValue = (to - from) / (this.last - this.first);
  }

  px(value) { return this.from + ((this.log ? Math.log(value) : value) - this.first) * this.perValue; }

  value(px) {
    const place = this.first + (px - this.from) / this.perValue;
    return this.log ? Math.exp(place) : place;
  }

  ticks(spacing) {
    const count = Math.max(1.5, Math.abs(this.to - this.from) / spacing);
    if (this.log) return decades(this.low, this.high, count);
    const values = ticks([this.low, this.high], count);
    return values.length > 1 ? values : ticks([this.low, this.high], 2 * count);
  }
}

/** Round values of a logarithmic axis: 1, 2, 5 of every decade where there is room, else every decade or so. */
export function decades(low, high, count) {
  const span = Math.log10(high / low);
  const steps = span * 3 <= count ? [1, 2, 5] : [1], jump = Math.ceil(span / count) || 1, values = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++)
    if (steps.length > 1 || power % jump === 0) values.push(...steps.map((step) => Number(`${step}e${power}`)));
  const inside = values.filter((value) => value >= low * 0.9999 && value <= high * 1.0001);
  return inside.length > 1 ? inside : ticks([low, high], count).filter((value) => value > 0);
}

/** A range with a margin on both sides. */
export function padded([low, high], log) {
  if (log) return [low / 1.15, high * 1.15];
  return [low - 0.04 * (high - low), high + 0.04 * (high - low)];
}

/** A number without trailing zeros, of four significant digits at most. */
export function short(value) {
  return tick(Number(value.toPrecision(4)));
}

/** A value beside an axis. */
export function tick(value) {
  const [mantissa, power] = number(value, 6).split(" × ");
  const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
  return power ? `${short} × ${power}`.replace(/^(−?)1 × /, "$1") : short;
}
