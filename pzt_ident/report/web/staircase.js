import { element, redrawForPrint, svgElement, USE_NAMES } from "./parts.js";
import { decades, tick } from "./scale.js";
import { number } from "./signals.js";

const USES = Object.keys(USE_NAMES);
const NARROW = 5.2; // em a step, below which the names are turned

/** The RMSE after each of `steps` ({name, identify, validate, note, promised, current, live}) as stairs on a logarithmic
 * axis that ends at the noise floor. `choose(step)` is called for a step that is clicked. */
export class Staircase {
  constructor(root, content, choose = null) {
    Object.assign(this, { root, choose });
    root.classList.add("staircase");
    this.legend = element(root, "ul", { class: "legend" });
    this.holder = element(root, "div", { class: "stairs" });
    new ResizeObserver(() => `${this.holder.clientWidth} ${this.holder.clientHeight}` !== this.drawnSize && this.show(this.content)).observe(this.holder);
    redrawForPrint(() => this.show(this.content));
    this.show(content);
  }

  show(content) {
    this.content = content;
    this.showLegend();
    this.holder.replaceChildren();
    const [width, height] = [Math.max(200, this.holder.clientWidth), Math.max(150, this.holder.clientHeight)];
    this.drawnSize = `${this.holder.clientWidth} ${this.holder.clientHeight}`;
    const size = Math.max(11, 0.74 * parseFloat(getComputedStyle(document.documentElement).fontSize));
    this.svg = svgElement(this.holder, "svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": description(content), "font-size": size });
    const pitch = (width - 5 * size) / Math.max(content.steps.length, 1);
    const turned = pitch < NARROW * size;
    const area = { left: 4.2 * size, right: width - 0.8 * size, top: 2.4 * size, bottom: height - (turned ? 5.4 : 3) * size, size, turned };
    this.scale(content);
    if (this.range) this.axis(area);
    for (const use of USES.toReversed()) this.stairs(use, area, pitch);
    content.steps.forEach((step, place) => this.name(step, place, area, pitch));
  }

  scale({ steps, floor }) {
    const values = steps.flatMap((step) => USES.flatMap((use) => [step[use], step.promised?.[use]])).filter((value) => value > 0);
    const low = Math.min(...values, floor || Infinity), high = Math.max(...values, floor || 0);
    this.range = values.length || floor ? [low / 1.6, Math.max(high * 1.5, low * 2)] : null;
  }

  toY(value, { top, bottom }) {
    const [low, high] = this.range.map(Math.log);
    return bottom - ((Math.log(value) - low) / (high - low)) * (bottom - top);
  }

  showLegend() {
    const { steps, floor } = this.content;
    this.legend.replaceChildren();
    const entries = USES.filter((use) => steps.some((step) => step[use] > 0)).map((use) => [use, USE_NAMES[use]]);
    if (steps.some(({ promised }) => promised)) entries.push(["promised", "expected before"]);
    if (floor) entries.push(["noise-floor", "noise floor"]);
    for (const [style, text] of entries) {
      const item = element(this.legend, "li");
      const svg = svgElement(item, "svg", { viewBox: "0 0 26 10", width: 26, height: 10, "aria-hidden": "true", class: "staircase-sample" });
      if (style === "noise-floor") svgElement(svg, "rect", { x: 1, y: 1, width: 24, height: 8, class: "floor" });
      else if (style === "promised") svgElement(svg, "circle", { cx: 13, cy: 5, r: 4, class: "promised identify" });
      else {
        svgElement(svg, "line", { x1: 1, x2: 25, y1: 5, y2: 5, class: style });
        mark(svg, style, 13, 5, 4);
      }
      element(item, "span", {}, text);
    }
  }

  axis(area) {
    const { size } = area;
    for (const value of decades(...this.range, (area.bottom - area.top) / (2.4 * size))) {
      const y = this.toY(value, area);
      svgElement(this.svg, "line", { x1: area.left, x2: area.right, y1: y, y2: y, class: "rule" });
      svgElement(this.svg, "text", { x: area.left - 0.5 * size, y: y + 0.35 * size, class: "end" }, tick(value));
    }
    svgElement(this.svg, "text", { x: 2, y: size, class: "axis" }, `RMSE${this.content.together ?? ""}${this.content.unit ? ` [${this.content.unit}]` : ""}`);
    if (!this.content.floor) return;
    const y = this.toY(this.content.floor, area);
    svgElement(this.svg, "rect", { x: area.left, y, width: area.right - area.left, height: Math.max(2, area.bottom - y), class: "floor" });
  }

  /** The levels of one kind of records, joined to stairs, with their values. */
  stairs(use, area, pitch) {
    const { size } = area;
    const levels = this.content.steps.map((step, place) => ({ step, value: step[use], from: area.left + place * pitch, middle: area.left + (place + 0.5) * pitch })).filter(({ value }) => value > 0);
    const path = levels.map(({ value, from }, i) => `${i ? "L" : "M"}${from + (i ? 0 : 0.1 * pitch)},${this.toY(value, area)}h${pitch * (i ? 1 : 0.9)}`).join("");
    if (levels.length) svgElement(this.svg, "path", { d: path, class: use });
    for (const { step, value, middle } of levels) {
      const y = this.toY(value, area), other = step[use === "identify" ? "validate" : "identify"];
      const above = other > 0 ? value > other || (value === other && use === "validate") : true;
      if (step.promised?.[use] > 0) svgElement(this.svg, "circle", { cx: middle - 0.32 * pitch, cy: this.toY(step.promised[use], area), r: 0.4 * size, class: `promised ${use}` });
      mark(this.svg, `${use}${step.live ? " live" : ""}`, middle, y, 0.38 * size);
      svgElement(this.svg, "text", { x: middle, y: above ? y - 0.7 * size : y + 1.35 * size, class: `value ${use}` }, number(value));
    }
  }

  name(step, place, area, pitch) {
    const { size, turned } = area;
    const x = area.left + (place + 0.5) * pitch, y = area.bottom + 1.3 * size;
    const group = svgElement(this.svg, "g", { class: `step${step.current ? " current" : ""}` });
    const room = turned ? 12 : Math.floor(pitch / (0.56 * size));
    svgElement(group, "text", { x, y, class: turned ? "name turned" : "name", ...(turned && { transform: `rotate(-35 ${x} ${y})` }) }, shortened(step.name, room));
    if (step.note && !turned) svgElement(group, "text", { x, y: y + 1.2 * size, class: "note" }, shortened(step.note, room));
    svgElement(group, "title", {}, `${step.name}${step.note ? `: ${step.note}` : ""}`);
    const hit = svgElement(group, "rect", { x: area.left + place * pitch, y: 0, width: pitch, height: area.bottom + 3 * size, class: "hit" });
    if (this.choose) hit.addEventListener("click", () => this.choose(step));
  }
}

/** A disc for identification, a square on its corner for validation: told apart without colour. */
function mark(svg, style, x, y, r) {
  if (style.startsWith("identify")) svgElement(svg, "circle", { cx: x, cy: y, r, class: `mark ${style}` });
  else svgElement(svg, "path", { d: `M${x - 1.3 * r},${y}L${x},${y - 1.3 * r}L${x + 1.3 * r},${y}L${x},${y + 1.3 * r}Z`, class: `mark ${style}` });
}

function shortened(text, letters) {
  return text.length <= letters ? text : `${text.slice(0, Math.max(3, letters - 1))}…`;
}

function description({ steps, unit, together, floor }) {
  const levels = steps.map((step) => `${step.name}: ${USES.filter((use) => step[use] > 0).map((use) => `${USE_NAMES[use]} ${number(step[use])} ${unit}`).join(", ") || "not run"}`);
  return `RMSE${together ?? ""} by step, on a logarithmic axis. ${levels.join("; ")}${floor ? `; noise floor ${number(floor, 2)} ${unit}` : ""}.`;
}
