import { Figure } from "./figure.js";
import { extent } from "./signals.js";

const COLOURS = ["--identify", "--validate", "--third", "--fourth", "--before"];
const DASHES = [[], [6, 3], [2, 2], [8, 2, 2, 2], [4, 2]];
const INTERVAL = 40; // ms between two drawings, at least

/** Best RMSE so far of every run against evaluations, from the lines of `events.jsonl` as they arrive. */
export class Convergence {
  constructor(root) {
    this.root = root;
    this.clear();
  }

  clear() {
    Object.assign(this, { runs: new Map(), unit: "", together: "", best: Infinity, validate: null, done: 0, budget: 0 });
    this.root.hidden = true;
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

  draw() {
    const series = [...this.runs].filter(([, points]) => points.length > 1).map(([label, points], place) => ({
      label, colour: COLOURS[place % 5], dash: DASHES[Math.floor(place / 5) % 5], ...stairs(points.filter(([, best]) => best > 0)),
    })).filter(({ xs }) => xs.length);
    if (!series.length) return;
    this.root.hidden = false;
    this.figure ??= new Figure(this.root, { label: "Best RMSE so far of every run over the evaluations of the model", along: true, gestures: { reset: () => this.figure.plot.look(null, null) } });
    const [x, y] = ["xs", "ys"].map((key) => extent(series.flatMap((line) => [...extent(line[key])])));
    this.figure.show({ series, x: { label: "evaluations of the model", range: [0, x[1]] }, y: { label: `best RMSE so far${this.together} [${this.unit}]`, range: y, log: true } });
  }
}

function stairs(points) {
  const xs = [], ys = [];
  for (const [x, y] of points) {
    if (xs.length) { xs.push(x); ys.push(ys.at(-1)); }
    xs.push(x);
    ys.push(y);
  }
  return { xs: Float64Array.from(xs), ys: Float64Array.from(ys) };
}
