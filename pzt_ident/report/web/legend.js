import { element, svgElement } from "./parts.js";
import { number } from "./signals.js";

/** The legend of a plot: a sample of each line or of its dots, its name, and its value at the cursor. */
export class Legend {
  constructor(parent) {
    this.root = element(parent, "ul", { class: "legend" });
    this.key = "";
  }

  show(series, unit = "") {
    const named = series.filter(({ label, hidden }) => label && !hidden);
    const key = JSON.stringify([named.map(({ label, colour, dash, dots, heat }) => [label, colour, dash, dots, Boolean(heat)]), unit]);
    this.series = named;
    if (key === this.key) return;
    [this.key, this.unit] = [key, unit];
    this.root.replaceChildren();
    this.values = named.map((line) => {
      const item = element(this.root, "li");
      sample(item, line);
      element(item, "span", {}, line.label);
      return element(item, "span", { class: "value" });
    });
  }

  /** Show the values at a point of the record; of a series that has fewer points, the nearest. */
  pointAt(point) {
    this.series?.forEach((line, place) => {
      const index = point === null ? null : line.places ? nearestOf(line.places, point) : point;
      this.values[place].textContent = index === null || index >= line.ys.length ? "" : ` ${number(line.ys[index], 4)} ${line.unit ?? this.unit}`;
    });
  }
}

function nearestOf(places, point) {
  let low = 0, high = places.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (places[middle] < point) low = middle + 1;
    else high = middle;
  }
  return low;
}

function sample(parent, { colour = "--model", dash = [], dots, heat, width = 1.5 }) {
  const svg = svgElement(parent, "svg", { viewBox: "0 0 26 8", width: 26, height: 8, "aria-hidden": "true" });
  if (heat) return svg.classList.add("heat");
  const line = svgElement(svg, "line", { x1: 1, x2: 25, y1: 4, y2: 4, "stroke-width": dots ? 3.4 : Math.max(width, 1.5), "stroke-dasharray": dots ? "3.4 3.4" : dash.join(" ") });
  line.style.stroke = `var(${colour})`;
}
