import { colour, tick } from "./plane.js";

const COLOURS = ["--identify", "--validate", "--third", "--fourth", "--before"];
const INTERVAL = 40; // ms between two drawings, at least

/** Best RMSE so far of every run against evaluations, from the lines of `events.jsonl` as they arrive. */
export class Convergence {
  constructor(root) {
    this.root = root;
    this.clear();
    new ResizeObserver(() => this.plot && this.plot.width !== this.size().width && this.draw(true)).observe(root);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.plot && this.draw(true));
  }

  clear() {
    Object.assign(this, { runs: new Map(), unit: "", together: "", best: Infinity, validate: null, done: 0, budget: 0 });
    this.plot?.destroy();
    this.plot = null;
  }

  update(event) {
    if (event.event === "start") {
      this.clear();
      Object.assign(this, { unit: event.unit, together: event.together, budget: event.budget });
    }
    if (event.event !== "generation") return;
    const run = this.runs.get(event.run) ?? this.runs.set(event.run, []).get(event.run);
    run.push([event.evaluations, event.best]);
    this.done = [...this.runs.values()].reduce((sum, points) => sum + points.at(-1)[0], 0);
    if (event.best !== null && event.best <= this.best) [this.best, this.validate] = [event.best, event.validate];
    if (!this.waiting) this.waiting = setTimeout(() => { this.waiting = null; this.draw(); }, INTERVAL);
  }

  size() {
    return { width: Math.max(280, this.root.clientWidth - 4), height: 210 };
  }

  draw(rebuild = false) {
    const tables = [...this.runs.values()].map((points) => [points.map(([x]) => x), points.map(([, y]) => y)]);
    if (!tables.length) return;
    const data = uPlot.join(tables);
    if (rebuild || this.plot?.series.length !== data.length) {
      this.plot?.destroy();
      this.plot = new uPlot(this.options([...this.runs.keys()]), data, this.root);
    } else this.plot.setData(data);
  }

  options(names) {
    const font = `${Math.round(0.78 * parseFloat(getComputedStyle(this.root).fontSize))}px system-ui, sans-serif`;
    const axis = (label, more) => ({ label, labelSize: 18, font, labelFont: font, stroke: () => colour("--quiet"), grid: { stroke: () => colour("--rule"), width: 1 }, ticks: { show: false }, ...more });
    return {
      ...this.size(),
      legend: { live: false },
      padding: [null, 30, null, null],
      cursor: { drag: { x: false, y: false } },
      scales: { x: { time: false }, y: { distr: 3 } },
      axes: [axis("evaluations of the model", { size: 32 }), axis(`RMSE${this.together} [${this.unit}]`, { size: 62, values: (_, values) => values.map((value) => (value === null ? "" : tick(value))) })],
      series: [{}, ...names.map((label, place) => ({
        label, stroke: () => colour(COLOURS[place % 5]), width: 1.5, spanGaps: true, paths: uPlot.paths.stepped({ align: 1 }), points: { show: false },
      }))],
    };
  }
}
