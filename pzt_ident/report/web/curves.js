// What is drawn between the scales of a plot: curves, dots and cells.

import { colour, HEAT, rgb } from "./colours.js";
import { lowerBound } from "./signals.js";

const NEAR = 0.7; // px: shorter steps of a curve are invisible
const APART = 4; // px between neighbouring dots, so that they are seen as dots
const MANY = 5000; // points of a loop, above which the dots would hide it

/** Draw a series between the scales of a plot: {xs, ys, colour, width, dash, dots, heat, hidden}. */
export function drawSeries(plot, pen, series) {
  if (series.hidden || !series.xs.length) return;
  [pen.strokeStyle, pen.fillStyle] = [colour(series.colour ?? "--model"), colour(series.colour ?? "--model")];
  [pen.lineWidth, pen.lineJoin] = [series.width ?? 1.5, "round"];
  pen.setLineDash(series.dash ?? []);
  if (series.heat) drawHeat(plot, pen, series);
  else if (plot.along) drawGraph(plot, pen, series);
  else if (series.dots) drawDots(plot, pen, series);
  else drawPath(plot, pen, series, 0, series.xs.length);
  pen.setLineDash([]);
}

/** A curve over ascending xs: the lowest and highest value of each pixel. */
function drawGraph(plot, pen, series) {
  const { xs, ys } = series;
  const first = Math.max(0, lowerBound(xs, plot.x.low) - 1), end = Math.min(xs.length, lowerBound(xs, plot.x.high) + 2);
  const bins = plot.width - plot.edge.left - plot.edge.right, count = end - first;
  if (series.dots && count < bins / 3) return drawDots(plot, pen, series, first, end, 0);
  if (series.dots) pen.lineWidth = 3.4;
  pen.beginPath();
  if (count <= 3 * bins || plot.scene.x.log) {
    for (let i = first; i < end; i++) pen.lineTo(plot.x.px(xs[i]), plot.y.px(ys[i]));
  } else
    for (let bin = 0; bin < bins; bin++) {
      const from = first + Math.floor((bin * count) / bins), to = first + Math.floor(((bin + 1) * count) / bins);
      let low = from, high = from;
      for (let i = from + 1; i < to; i++) {
        if (ys[i] < ys[low]) low = i;
        if (ys[i] > ys[high]) high = i;
      }
      const [one, two] = low < high ? [low, high] : [high, low];
      pen.lineTo(plot.x.px(xs[one]), plot.y.px(ys[one]));
      if (two !== one) pen.lineTo(plot.x.px(xs[two]), plot.y.px(ys[two]));
    }
  pen.stroke();
}

/** Dots that are told apart; of very many, smaller ones. */
function drawDots(plot, pen, { xs, ys }, first = 0, end = xs.length, apart = APART) {
  const size = end - first > MANY ? 2.8 : 3.4;
  let [left, top] = [-99, -99];
  for (let i = first; i < end; i++) {
    const x = plot.x.px(xs[i]), y = plot.y.px(ys[i]);
    if (Math.abs(x - left) + Math.abs(y - top) < apart) continue;
    pen.fillRect(x - size / 2, y - size / 2, size, size);
    [left, top] = [x, y];
  }
}

/** Dots coloured by a value: colour by colour, since a change of colour is slow. */
function drawHeat(plot, pen, { xs, ys, heat, heatRange: [low, high] }) {
  const sorted = HEAT.map(() => []);
  let [left, top] = [-99, -99];
  for (let i = 0; i < xs.length; i++) {
    const x = plot.x.px(xs[i]), y = plot.y.px(ys[i]);
    if (Math.abs(x - left) + Math.abs(y - top) < 1.5) continue;
    sorted[Math.min(HEAT.length - 1, Math.max(0, Math.floor(((heat[i] - low) / (high - low || 1)) * HEAT.length)))].push(x, y);
    [left, top] = [x, y];
  }
  sorted.forEach((points, place) => {
    pen.fillStyle = HEAT[place];
    for (let i = 0; i < points.length; i += 2) pen.fillRect(points[i] - 1.3, points[i + 1] - 1.3, 2.6, 2.6);
  });
}

/** A curve in the plane, without what lies outside. */
export function drawPath(plot, pen, { xs, ys }, first, end) {
  pen.beginPath();
  let [left, top, inside] = [-1e9, -1e9, false];
  for (let i = first; i < end; i++) {
    const x = plot.x.px(xs[i]), y = plot.y.px(ys[i]);
    if (Math.abs(x - left) + Math.abs(y - top) < NEAR && i !== end - 1) continue;
    const visible = x > -50 && y > -50 && x < plot.width + 50 && y < plot.height + 50;
    if (i === first || !(visible || inside)) pen.moveTo(x, y);
    else pen.lineTo(x, y);
    [left, top, inside] = [x, y, visible];
  }
  pen.stroke();
}

/** Draw the mean value of each cell as a colour on a diverging scale. */
export function drawCells(plot, pen) {
  const { columns, rows, largest, means, x: [left, right], y: [low, high] } = plot.scene.cells;
  const width = (plot.x.px(right) - plot.x.px(left)) / columns, height = (plot.y.px(low) - plot.y.px(high)) / rows;
  const [middle, below, above] = ["--zero", "--below", "--above"].map(rgb);
  means.forEach((mean, cell) => {
    if (Number.isNaN(mean)) return;
    const share = Math.min(1, Math.abs(mean) / largest), side = mean < 0 ? below : above;
    pen.fillStyle = `rgb(${middle.map((part, i) => Math.round(part + share * (side[i] - part))).join(" ")})`;
    const [column, row] = [cell % columns, Math.floor(cell / columns)];
    pen.fillRect(plot.x.px(left) + column * width, plot.y.px(low) - (row + 1) * height, width + 0.6, height + 0.6);
  });
}
