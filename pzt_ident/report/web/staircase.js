import { element, redrawForPrint, svgElement, USE_NAMES } from "./parts.js";
import { number, ticks } from "./signals.js";

const USES = Object.keys(USE_NAMES);

/** Bar chart of the RMSE after each of `steps` ({name, identify, validate, note}), with the noise floor. */
export class Staircase {
  constructor(root, content) {
    this.root = root;
    root.classList.add("staircase");
    new ResizeObserver(() => root.clientWidth !== this.drawnWidth && this.show(this.content)).observe(root);
    redrawForPrint(() => this.show(this.content));
    this.show(content);
  }

  show(content) {
    this.content = content;
    this.drawnWidth = this.root.clientWidth;
    this.root.replaceChildren();
    this.legend();
    const size = parseFloat(getComputedStyle(this.root).fontSize);
    const [width, height] = [Math.max(280, this.root.clientWidth), Math.round(17 * size)];
    this.svg = svgElement(this.root, "svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": description(content) });
    const area = { left: 4 * size, right: width - 0.5 * size, top: 1.5 * size, bottom: height - 2.6 * size, size };
    const values = content.steps.flatMap((step) => USES.map((use) => step[use] ?? 0));
    this.largest = 1.05 * Math.max(...values.filter(Number.isFinite), content.floor ?? 0) || 1;
    this.axis(area);
    content.steps.forEach((step, place) => this.stair(step, place, area));
  }

  legend() {
    const legend = element(this.root, "p", { class: "legend" });
    const shown = USES.filter((use) => this.content.steps.some((step) => Number.isFinite(step[use])));
    const entries = shown.map((use) => [use, USE_NAMES[use]]);
    if (this.content.floor) entries.push(["noise-floor", "noise floor"]);
    for (const [style, name] of entries) {
      element(legend, "span", { class: `swatch ${style}` });
      legend.append(`${name} `);
    }
  }

  toY(value, { top, bottom }) { return bottom - (value / this.largest) * (bottom - top); }

  axis(area) {
    for (const value of ticks([0, this.largest], 4)) {
      const y = this.toY(value, area);
      svgElement(this.svg, "line", { x1: area.left, x2: area.right, y1: y, y2: y, class: "rule" });
      svgElement(this.svg, "text", { x: area.left - 6, y: y + 4, class: "end" }, String(value));
    }
    svgElement(this.svg, "text", { x: 0, y: area.size }, `RMSE${this.content.together} [${this.content.unit}]`);
    if (!this.content.floor) return;
    const y = this.toY(this.content.floor, area);
    svgElement(this.svg, "rect", { x: area.left, y, width: area.right - area.left, height: area.bottom - y, class: "floor" });
  }

  stair(step, place, area) {
    const pitch = (area.right - area.left) / this.content.steps.length;
    const width = Math.min(0.3 * pitch, 4 * area.size);
    const middle = area.left + (place + 0.5) * pitch;
    const shown = USES.filter((use) => Number.isFinite(step[use]));
    shown.forEach((use, side) => {
      const value = step[use];
      const [x, y] = [middle + (side - shown.length / 2) * width, this.toY(value, area)];
      svgElement(this.svg, "rect", { x: x + 1, y, width: width - 2, height: area.bottom - y, class: `${use}${step.live ? " live" : ""}` });
      svgElement(this.svg, "text", { x: x + width / 2, y: y - 4, class: "value" }, number(value));
    });
    svgElement(this.svg, "text", { x: middle, y: area.bottom + 1.1 * area.size, class: "name" }, step.name);
    if (step.note) svgElement(this.svg, "text", { x: middle, y: area.bottom + 2.2 * area.size, class: "note" }, step.note);
  }
}

function description({ steps, unit, together }) {
  return `RMSE${together} by step: ` + steps.map((step) => `${step.name} ${USES.filter((use) => Number.isFinite(step[use])).map((use) => `${USE_NAMES[use]} ${number(step[use])} ${unit}`).join(", ")}`).join("; ");
}
