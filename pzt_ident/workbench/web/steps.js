import { sentence } from "./about.js";
import { element } from "./parts.js";
import { request, requestJson } from "./session.js";
import { number } from "./signals.js";

/** The steps of the session: what each changed, gave and had promised, its note and its job; two can be compared.
 * `page` has back(step), compare(steps), fail(error), refresh(). */
export class Steps {
  constructor(root, page) {
    Object.assign(this, { root, page, chosen: new Set(), key: "" });
  }

  show({ steps, others, at, unit, together, blocks, effects, optimizer_words }) {
    const key = JSON.stringify([steps, others, at, unit]);
    if (key === this.key) return;
    Object.assign(this, { key, at, unit, together: together ?? "", catalogue: { blocks, effects, optimizer_words } });
    const known = new Set([...steps, ...others].map(({ number: step }) => step));
    for (const step of this.chosen) if (!known.has(step)) this.chosen.delete(step);
    this.root.replaceChildren();
    const bar = element(this.root, "p", { class: "bar" });
    this.compare = element(bar, "button", { type: "button" }, "Compare two steps");
    this.compare.addEventListener("click", () => this.page.compare([...this.chosen]));
    this.hint = element(bar, "span", { class: "quiet" });
    const list = element(this.root, "div", { class: "rows" });
    for (const step of steps) this.card(list, step);
    if (others.length) element(this.root, "h2", {}, "Other steps");
    const aside = element(this.root, "div", { class: "rows" });
    for (const step of others) this.card(aside, step);
    this.told();
  }

  card(list, step) {
    const current = step.number === this.at;
    const card = element(list, "div", { class: `card${current ? " chosen" : ""}`, id: `step-${step.number}`, tabindex: -1 });
    const head = element(card, "h3");
    sentence(head, "span", `${step.number}: ${step.change}`, this.catalogue);
    if (current) element(head, "span", { class: "tag" }, "shown");
    const compare = element(element(head, "label", { class: "push" }, ""), "input", { type: "checkbox", "aria-label": `Compare step ${step.number}`, ...(this.chosen.has(step.number) && { checked: "" }) });
    compare.after("compare");
    compare.disabled = step.identify === null;
    compare.addEventListener("change", () => {
      compare.checked ? this.chosen.add(step.number) : this.chosen.delete(step.number);
      this.told();
    });
    element(card, "p", {}, step.identify === null ? "Not run." : `RMSE ${this.errors(step)}`);
    if (step.promised) element(card, "p", { class: "quiet" }, `Expected before: ${this.errors(step.promised)}`);
    if (step.tried?.length) sentence(card, "p", `Tried from here and taken back: ${step.tried.join(", ")}.`, this.catalogue).className = "quiet";
    const line = element(card, "div", { class: "bar" });
    if (!current) element(line, "button", { type: "button", "data-acts": "" }, "Go to this step").addEventListener("click", () => this.page.back(step.number));
    element(line, "button", { type: "button" }, "Job file").addEventListener("click", () => this.showJob(step, card));
    const note = element(element(card, "label", { class: "note" }, "Note "), "input", { value: step.note ?? "", "aria-label": `Note to step ${step.number}`, size: 28 });
    note.addEventListener("change", () => requestJson("note", { at: this.at, step: step.number, text: note.value }).then(() => this.page.refresh()).catch((error) => this.page.fail(error)));
  }

  errors({ identify, validate }) {
    return [[identify, "identification"], [validate, "validation"]].filter(([value]) => value !== null && value !== undefined).map(([value, name]) => `${number(value)} ${this.unit}${this.together} (${name})`).join(", ");
  }

  async showJob(step, card) {
    const shown = card.querySelector("pre");
    if (shown) return shown.remove();
    try {
      element(card, "pre", { tabindex: 0 }, await (await request(`step_job?step=${step.number}`)).text());
    } catch (error) { this.page.fail(error); }
  }

  told() {
    const ready = this.chosen.size === 2;
    this.compare.setAttribute("aria-disabled", String(!ready));
    this.hint.textContent = ready ? "" : "Tick two steps to see both models in the plots.";
  }

  reveal(step) {
    const card = this.root.querySelector(`#step-${step}`);
    card?.scrollIntoView({ block: "nearest" });
    card?.focus({ preventScroll: true });
  }
}
