import { listen } from "./gestures.js";
import { Legend } from "./legend.js";
import { element } from "./parts.js";
import { Plot } from "./plot.js";
import { tick } from "./scale.js";

let count = 0;

/** A plot with its controls, its legend and, for those who do not see it, a sentence on what it shows. */
export class Figure {
  constructor(parent, { label, along = false, gestures = {}, lower = false }) {
    this.element = element(parent, "div", { class: `figure${lower ? " lower" : ""}` });
    const head = element(this.element, "div", { class: "figure-head" });
    this.bar = element(head, "span", { class: "figure-bar" });
    this.legend = new Legend(head);
    this.plot = new Plot(this.element, { label, along });
    this.summary = element(this.element, "p", { class: "unseen", id: `figure-${(count += 1)}` });
    this.plot.root.setAttribute("aria-describedby", this.summary.id);
    this.message = element(this.element, "p", { class: "quiet", hidden: "" });
    listen(this.plot, gestures);
  }

  show(scene, unit = "") {
    [this.message.hidden, this.plot.root.hidden] = [true, false];
    this.legend.show(keysOf(scene), unit);
    this.plot.show(scene);
    const ranges = [scene.x, scene.y].map(({ label, range }, i) => [label || "time", i && scene.fit ? scene.fit(...scene.x.range) : range]);
    this.summary.textContent = `${scene.caption ?? ""} ${ranges.map(([name, [low, high]]) => `${name} from ${tick(Number(low.toPrecision(4)))} to ${tick(Number(high.toPrecision(4)))}`).join("; ")}. Shown: ${keysOf(scene).map(({ label }) => label).join(", ")}.`;
    this.summary.classList.toggle("unseen", !scene.caption);
    if (scene.caption) this.summary.textContent = scene.caption;
  }

  /** As `show`, where only what follows a slider has moved. */
  move(scene) {
    this.legend.series = keysOf(scene).filter(({ label, hidden }) => label && !hidden);
    this.plot.move(scene);
  }

  /** A sentence in the place of the plot. */
  say(text) {
    this.legend.show([]);
    [this.message.hidden, this.plot.root.hidden, this.message.textContent] = [false, true, text];
  }

  pointAt(point) {
    this.plot.pointAt(point);
    this.legend.pointAt(point);
  }
}

/** What a legend names: the series, and the band about 0. */
function keysOf({ series, floor }) {
  return floor ? [...series, { label: "± noise floor (RMS)", colour: "--floor", ys: [] }] : series;
}
