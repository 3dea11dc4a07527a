import { element, redrawForPrint, svgElement, USE_NAMES } from "./parts.js";
import { decades, tick } from "./scale.js";
import { number } from "./signals.js";

const USES = Object.keys(USE_NAMES);
const LINES = 3; // of a name that is not turned
const LINE = 1.2; // em
const TOUCHED = 24; // px, the least size of a link
const FLATTEST = Math.PI / 5; // angle of names that are turned
const pen = document.createElement("canvas").getContext("2d");

/** The RMSE after each of `steps` ({name, href, identify, validate, note, promised, current, live}) as stairs on a logarithmic
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
    this.svg = svgElement(this.holder, "svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: content.steps.some(({ href }) => href) ? "group" : "img", "aria-label": description(content), "font-size": size });
    this.scale(content);
    const family = getComputedStyle(this.holder).fontFamily;
    const left = Math.max(4.2 * size, this.widestTick(height, size, family) + 0.8 * size), right = width - 0.8 * size;
    const pitch = (right - left) / Math.max(content.steps.length, 1);
    const texts = namesOf(content.steps, pitch, size, 0.32 * height, family);
    const area = { left, right, top: 2.4 * size, bottom: height - texts.height - 0.6 * size, size };
    if (this.range) this.axis(area);
    for (const use of USES.toReversed()) this.stairs(use, area, pitch);
    this.values(area, pitch);
    content.steps.forEach((step, place) => this.name(step, place, area, pitch, texts));
  }

  scale({ steps, floor }) {
    const values = steps.flatMap((step) => USES.flatMap((use) => [step[use], step.promised?.[use]])).filter((value) => value > 0);
    const low = Math.min(...values, floor || Infinity), high = Math.max(...values, floor || 0);
    this.range = values.length || floor ? [low / 1.6, Math.max(high * 1.5, low * 2)] : null;
  }

  widestTick(height, size, family) {
    pen.font = `${size}px ${family}`;
    const values = this.range ? decades(...this.range, height / (2.4 * size)) : [];
    return Math.max(0, ...values.map((value) => pen.measureText(tick(value)).width));
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

  /** The levels of one kind of records, joined to stairs. */
  stairs(use, area, pitch) {
    const { size } = area;
    const levels = this.content.steps.map((step, place) => ({ step, value: step[use], from: area.left + place * pitch, middle: area.left + (place + 0.5) * pitch })).filter(({ value }) => value > 0);
    const path = levels.map(({ value, from }, i) => `${i ? "L" : "M"}${from + (i ? 0 : 0.1 * pitch)},${this.toY(value, area)}h${pitch * (i ? 1 : 0.9)}`).join("");
    if (levels.length) svgElement(this.svg, "path", { d: path, class: use });
    for (const { step, value, middle } of levels) {
      if (step.promised?.[use] > 0) svgElement(this.svg, "circle", { cx: middle - 0.32 * pitch, cy: this.toY(step.promised[use], area), r: 0.4 * size, class: `promised ${use}` });
      mark(this.svg, `${use}${step.live ? " live" : ""}`, middle, this.toY(value, area), 0.38 * size);
    }
  }

  /** The values beside the levels as far as they have room: those of the current step, of the first one and of the
   * others from the last one back. */
  values(area, pitch) {
    const { size } = area, { steps } = this.content, taken = [];
    const rank = ({ step, place }) => (step.current ? -2 : place ? -place / steps.length : -1.5);
    for (const { step, place } of steps.map((step, place) => ({ step, place })).toSorted((a, b) => rank(a) - rank(b)))
      for (const use of USES.filter((word) => step[word] > 0)) {
        const value = step[use], other = step[use === "identify" ? "validate" : "identify"];
        const above = other > 0 ? value > other || (value === other && use === "validate") : true;
        const x = area.left + (place + 0.5) * pitch, y = this.toY(value, area) + (above ? -0.7 : 1.35) * size;
        const text = svgElement(this.svg, "text", { x, y, class: `value ${use}` }, number(value));
        const half = text.getComputedTextLength() / 2 + 0.2 * size;
        if (taken.some((box) => Math.abs(box.x - x) < box.half + half && Math.abs(box.y - y) < size)) text.remove();
        else taken.push({ x, y, half });
      }
  }

  name(step, place, area, pitch, { angle, lines }) {
    const { size } = area;
    const x = area.left + (place + 0.5) * pitch, y = area.bottom + 1.3 * size;
    const group = svgElement(this.svg, "g", { class: `step${step.current ? " current" : ""}` });
    const turned = angle ? { transform: `rotate(${(-180 * angle) / Math.PI} ${x} ${y})` } : {};
    const { named, note } = lines[place];
    const hit = svgElement(group, "rect", { x: area.left + place * pitch, y: 0, width: pitch, height: area.bottom + 3 * size, class: "hit" });
    if (this.choose) hit.addEventListener("click", () => this.choose(step));
    const link = step.href ? svgElement(group, "a", { href: step.href, "aria-label": `About ${step.name}`, ...(step.href.startsWith("#") || { target: "_blank" }) }) : group;
    const text = svgElement(link, "text", { x, y, class: angle ? "name turned" : "name", ...turned });
    named.forEach((line, i) => svgElement(text, "tspan", { x, dy: i ? LINE * size : 0 }, line));
    if (step.href) {
      const width = Math.max(TOUCHED, text.getComputedTextLength() / (angle ? 1 : named.length)), height = Math.max(TOUCHED, named.length * LINE * size);
      svgElement(link, "rect", { x: x - (angle ? width : width / 2), y: y - 0.35 * size - TOUCHED / 2, width, height, class: "touched", ...turned });
    }
    if (note) svgElement(group, "text", { x, y: y + named.length * LINE * size, class: "note" }, note);
    svgElement(group, "title", {}, `${step.name}${step.note ? `: ${step.note}` : ""}`);
  }
}

/** The lines of the name of each step, its note, and the angle at which they are written: within the width of a step
 * where their parts have room there, else turned until they pass each other, without notes and no higher than `room`. */
function namesOf(steps, pitch, size, room, family) {
  pen.font = `bold ${size}px ${family}`;
  const width = (text) => pen.measureText(text).width;
  const fits = (text) => width(text) <= pitch - 0.5 * size;
  const lines = steps.map(({ name, note }) => ({ named: wrapped(name, fits), note: note && shortened(note, fits) }));
  if (lines.every(({ named }) => named.length <= LINES && named.every((line) => fits(line.trimEnd()))))
    return { angle: 0, lines, height: (Math.max(1, ...lines.map(({ named, note }) => named.length + Boolean(note))) * LINE + 0.3) * size };
  const angle = Math.max(FLATTEST, Math.asin(Math.min(1, (LINE * size) / pitch)));
  const turned = steps.map(({ name }, place) => {
    const long = Math.min(room / Math.sin(angle), (4.2 * size + (place + 0.5) * pitch) / Math.max(0.01, Math.cos(angle))) - size;
    return shortened(name, (text) => width(text) <= long);
  });
  const longest = Math.max(...turned.map((text) => width(text)));
  return { angle, lines: turned.map((text) => ({ named: [text] })), height: Math.sin(angle) * longest + 1.6 * size };
}

/** A name in lines that fit, parted after a space, a dot or an underscore. */
function wrapped(name, fits) {
  const lines = [];
  for (const part of name.match(/[^ ._]+[ ._]*/g) ?? [name]) {
    const longer = `${lines.at(-1) ?? ""}${part}`;
    if (lines.length && (fits(longer.trimEnd()) || lines.at(-1).length < 3)) lines[lines.length - 1] = longer;
    else lines.push(part);
  }
  return lines;
}

/** A text that fits, its middle left out where it must be: names often differ at their ends. */
function shortened(text, fits) {
  let kept = text.length;
  const cut = () => (kept === text.length ? text : `${text.slice(0, Math.ceil(0.4 * kept))}…${text.slice(text.length - Math.floor(0.6 * kept))}`);
  while (kept > 3 && !fits(cut())) kept--;
  return cut();
}

/** A disc for identification, a square on its corner for validation: told apart without colour. */
function mark(svg, style, x, y, r) {
  if (style.startsWith("identify")) svgElement(svg, "circle", { cx: x, cy: y, r, class: `mark ${style}` });
  else svgElement(svg, "path", { d: `M${x - 1.3 * r},${y}L${x},${y - 1.3 * r}L${x + 1.3 * r},${y}L${x},${y + 1.3 * r}Z`, class: `mark ${style}` });
}

function description({ steps, unit, together, floor }) {
  const levels = steps.map((step) => `${step.name}: ${USES.filter((use) => step[use] > 0).map((use) => `${USE_NAMES[use]} ${number(step[use])} ${unit}`).join(", ") || "not run"}`);
  return `RMSE${together ?? ""} by step, on a logarithmic axis. ${levels.join("; ")}${floor ? `; noise floor ${number(floor, 2)} ${unit}` : ""}.`;
}
