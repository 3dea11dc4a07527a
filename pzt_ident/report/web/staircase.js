import { element, printed, put } from "./parts.js";
import { number, ticks } from "./signals.js";

const USES = ["identify", "validate"];

/** How the error falls, step by step, down to the noise: bars of `steps` ({name, identify, validate, note}). */
export class Staircase {
  constructor(root, content) {
    this.root = root;
    root.classList.add("staircase");
    new ResizeObserver(() => root.clientWidth !== this.drawnAt && this.show(this.content)).observe(root);
    printed(() => this.show(this.content));
    this.show(content);
  }

  show(content) {
    this.content = content;
    this.drawnAt = this.root.clientWidth;
    this.root.replaceChildren();
    this.legend();
    const size = parseFloat(getComputedStyle(this.root).fontSize);
    const [width, height] = [Math.max(280, this.root.clientWidth), Math.round(17 * size)];
    this.svg = put(this.root, "svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": said(content) });
    const area = { left: 4 * size, right: width - 0.5 * size, top: 1.5 * size, bottom: height - 2.6 * size, size };
    const values = content.steps.flatMap((step) => USES.map((use) => step[use] ?? 0));
    this.most = 1.05 * Math.max(...values.filter(Number.isFinite), content.floor ?? 0) || 1;
    this.axis(area);
    content.steps.forEach((step, place) => this.stair(step, place, area));
  }

  legend() {
    const legend = element(this.root, "p", { class: "legend" });
    const shown = USES.filter((use) => this.content.steps.some((step) => Number.isFinite(step[use])));
    for (const name of [...shown, ...(this.content.floor ? ["noise floor"] : [])]) {
      element(legend, "span", { class: `swatch ${name.replace(" ", "-")}` });
      legend.append(`${name} `);
    }
  }

  toY(value, { top, bottom }) { return bottom - (value / this.most) * (bottom - top); }

  axis(area) {
    for (const value of ticks([0, this.most], 4)) {
      const y = this.toY(value, area);
      put(this.svg, "line", { x1: area.left, x2: area.right, y1: y, y2: y, class: "rule" });
      put(this.svg, "text", { x: area.left - 6, y: y + 4, class: "end" }, String(value));
    }
    put(this.svg, "text", { x: 0, y: area.size }, `RMSE${this.content.together} [${this.content.unit}]`);
    if (!this.content.floor) return;
    const y = this.toY(this.content.floor, area);
    put(this.svg, "rect", { x: area.left, y, width: area.right - area.left, height: area.bottom - y, class: "floor" });
  }

  stair(step, place, area) {
    const pitch = (area.right - area.left) / this.content.steps.length;
    const wide = Math.min(0.3 * pitch, 4 * area.size);
    const middle = area.left + (place + 0.5) * pitch;
    const shown = USES.filter((use) => Number.isFinite(step[use]));
    shown.forEach((use, side) => {
      const value = step[use];
      const [x, y] = [middle + (side - shown.length / 2) * wide, this.toY(value, area)];
      put(this.svg, "rect", { x: x + 1, y, width: wide - 2, height: area.bottom - y, class: `${use}${step.live ? " live" : ""}` });
      put(this.svg, "text", { x: x + wide / 2, y: y - 4, class: "value" }, number(value));
    });
    put(this.svg, "text", { x: middle, y: area.bottom + 1.1 * area.size, class: "name" }, step.name);
    if (step.note) put(this.svg, "text", { x: middle, y: area.bottom + 2.2 * area.size, class: "note" }, step.note);
  }
}

function said({ steps, unit, together }) {
  return `RMSE${together} by step: ` + steps.map((step) => `${step.name} ${USES.filter((use) => Number.isFinite(step[use])).map((use) => `${use} ${number(step[use])} ${unit}`).join(", ")}`).join("; ");
}
