import { about } from "./about.js";
import { element } from "./parts.js";
import { number } from "./signals.js";
import { plain, slider, typed } from "./slider.js";

const VERDICTS = { yes: ["determined", "good"], no: ["not determined", "warn"] };

/** The parameters of the current model: value, interval, unit, bounds and verdict of each, and a slider that moves the
 * model in the plots. `page` has move(values), settle(body), polish(values), acts(button). */
export class Parameters {
  constructor(root, page) {
    Object.assign(this, { root, page, values: {}, key: "" });
  }

  show(parameters, unit, rmse) {
    const key = JSON.stringify([parameters, unit, rmse]);
    if (key === this.key) return;
    Object.assign(this, { key, unit, rmse, parameters, values: {}, sliders: {} });
    this.root.replaceChildren();
    if (!parameters?.length) return void element(this.root, "p", { class: "quiet" }, "The parameters are shown here when the model has been identified.");
    const bar = element(this.root, "div", { class: "sticky bar" });
    this.error = element(bar, "strong", { role: "status" });
    this.reset = element(bar, "button", { type: "button", class: "push" }, "Reset");
    this.reset.addEventListener("click", () => this.back());
    this.polish = element(bar, "button", { type: "button", class: "strong", "data-acts": "", title: "Local least squares from these values" }, "Polish from here");
    this.polish.addEventListener("click", () => this.page.polish({ ...this.values }));
    this.showError();
    for (const parameter of parameters) this.entry(parameter);
    this.told();
  }

  entry(parameter) {
    const { name, about: href, unit, low, high, bounds, fixed, determined, physics } = parameter;
    const entry = element(this.root, "div", { class: "parameter", role: "group", "aria-label": name });
    const head = element(entry, "div", { class: "parameter-head" });
    about(element(head, "strong"), name, href, physics);
    const line = element(entry, "div", { class: "slide" });
    const fields = ["lower", "upper"].map((side, i) => this.bound(line, parameter, side, bounds[i]));
    const made = slider(line, head, parameter, (value) => this.move(name, value));
    this.sliders[name] = { ...made, value: parameter.value };
    line.append(fields[1]);
    this.settleBounds(line, parameter, fields);
    const fix = element(element(line, "label", { title: "Keep this value in the next fit" }, ""), "input", { type: "checkbox", "aria-label": `Fix ${name}`, ...(fixed && { checked: "" }) });
    fix.after("fix");
    fix.addEventListener("change", () => this.page.settle(fix.checked ? { parameter: name, value: this.values[name] ?? parameter.value } : { parameter: name, free: true }, () => { fix.checked = fixed; }));
    const facts = element(entry, "small", {}, low !== null && low !== undefined && !fixed ? `95 %: ${number(low, 4)} to ${number(high, 4)} ${unit ?? ""} ` : "");
    const [text, style] = fixed ? ["fixed", ""] : VERDICTS[determined] ?? [determined ?? "", "warn"];
    if (text) element(facts, "span", { class: `tag ${style}` }, text);
  }

  bound(line, { name, unit }, side, value) {
    return element(line, "input", { type: "text", inputmode: "decimal", value: plain(value, 4), "aria-label": `${name}, ${side} bound${unit ? ` in ${unit}` : ""}` });
  }

  /** Take both bounds at once, by Enter or when the line is left. */
  settleBounds(line, { name, bounds }, fields) {
    const shown = bounds.map((value) => plain(value, 4));
    let asked = false;
    const undo = () => { asked = false; fields.forEach((field, i) => { field.value = shown[i]; }); };
    const settle = () => {
      const [low, high] = fields.map((field, i) => (field.value === shown[i] ? bounds[i] : typed(field)));
      if (asked || (low === bounds[0] && high === bounds[1])) return;
      asked = low < high;
      if (asked) this.page.settle({ parameter: name, bounds: [low, high] }, undo);
      else undo();
    };
    line.addEventListener("focusout", ({ relatedTarget }) => line.contains(relatedTarget) || settle());
    fields.forEach((field, i) => {
      field.addEventListener("change", () => { if (typed(field) === null) field.value = shown[i]; });
      field.addEventListener("keydown", ({ key }) => key === "Enter" && settle());
    });
  }

  move(name, value) {
    this.values[name] = value;
    this.last = name;
    this.page.move({ ...this.values });
    this.told();
  }

  back() {
    this.values = {};
    for (const { set, value } of Object.values(this.sliders)) set(value);
    this.showError();
    this.page.move(null);
    if (document.activeElement === this.reset) this.sliders[this.last].range.focus({ preventScroll: true });
    this.told();
  }

  told() {
    for (const button of [this.reset, this.polish]) button.hidden = !Object.keys(this.values).length;
  }

  /** The error of the model, or of what the sliders make of it. */
  showError(moved = null) {
    const text = (rmse) => ["validate", "identify"].filter((use) => rmse?.[use] !== null && rmse?.[use] !== undefined).map((use) => `${number(rmse[use])} ${this.unit} ${use === "validate" ? "validation" : "identification"}`).join(", ");
    const rmse = moved ?? this.rmse;
    this.error.textContent = rmse ? `RMSE ${text(rmse)}` : "Not fitted yet";
  }
}
