import { about } from "./about.js";
import { Convergence } from "./convergence.js";
import { element, select } from "./parts.js";
import { number } from "./signals.js";

const BUDGET = { population: "Population", generations: "Generations", budget: "Evaluations" };

/** The optimizers of the last search beside each other, the search as it goes, and the form for another one. `page` has
 * search(form) and improve(budget). */
export class Optimizers {
  constructor(root, page) {
    Object.assign(this, { root, page, key: "" });
    this.live = element(root, "div");
    element(this.live, "h2", {}, "Best RMSE so far");
    this.plotted = element(this.live, "div", { class: "plotted", id: "convergence" });
    this.convergence = new Convergence(this.plotted);
    this.league = element(root, "div");
    this.forms = element(root, "div");
  }

  show({ optimizers, optimizer_words: words, job, unit, together }) {
    this.live.hidden = ![...this.convergence.runs.values()].some((points) => points.length > 1);
    const key = JSON.stringify([optimizers, job?.search, unit]);
    if (key === this.key) return;
    this.key = key;
    this.showLeague(optimizers ?? [], words ?? [], `${unit}${together ? `, ${together}` : ""}`);
    this.showForms(words ?? [], job?.search);
  }

  showLeague(rows, words, unit) {
    this.league.replaceChildren();
    if (!rows.length) return;
    element(this.league, "h2", {}, "The last search");
    element(this.league, "p", { class: "quiet" }, `RMSE [${unit}] on the identification records after ${rows[0].evaluations} evaluations a run: the best of the optimizer itself, and the median after the local polish that ends a run. CPU time of a run.`);
    const table = element(this.league, "table", { id: "league" });
    const head = element(element(table, "thead"), "tr");
    for (const text of ["own", "polished", "runs", "CPU"]) element(head, "th", { scope: "col", class: "number" }, text);
    for (const row of rows) {
      const body = element(table, "tbody");
      const name = element(element(body, "tr"), "th", { scope: "rowgroup", colspan: 4 }), known = words.find((word) => word.name === row.optimizer);
      if (known) about(name, known.name, known.about, known.doc);
      else name.append(row.optimizer);
      if (row.equal) element(name, "span", { class: "tag good" }, "within the noise of the best");
      const line = element(body, "tr");
      for (const text of [number(row.rmse_best), number(row.polished_rmse_median), String(row.runs), `${number(row.cpu_seconds_median, 2)} s`]) element(line, "td", { class: "number" }, text);
    }
  }

  showForms(words, search) {
    this.forms.replaceChildren();
    const improve = element(this.forms, "div");
    element(improve, "h2", {}, "Improve");
    element(improve, "p", { class: "quiet" }, "Diagnose, add what is missing, and go on down to the noise, within this CPU time.");
    const line = element(improve, "div", { class: "bar" });
    const budget = element(element(line, "label", {}, "CPU time "), "input", { value: "60 s", size: 7, "aria-label": "CPU time for the improvement" });
    element(line, "button", { type: "button", "data-acts": "" }, "Improve").addEventListener("click", () => this.page.improve(budget.value.replace(/\s+/g, "")));
    element(this.forms, "h2", {}, "Search with other optimizers");
    this.rows = element(this.forms, "div", { class: "rows" });
    this.words = words;
    for (const item of search?.optimizers ?? [{ name: words[0]?.name }]) this.optimizerRow(item);
    const bar = element(this.forms, "p", { class: "bar" });
    element(bar, "button", { type: "button" }, "One more").addEventListener("click", () => this.optimizerRow({ name: words[0]?.name }));
    const repeats = element(element(bar, "label", {}, "Repeats "), "input", { type: "number", min: 1, value: search?.repeats ?? 1, class: "small" });
    const seed = element(element(bar, "label", {}, "Seed "), "input", { type: "number", value: search?.seed ?? 7, class: "small" });
    const start = element(bar, "button", { type: "button", class: "strong", "data-acts": "", id: "search" }, "Search");
    start.addEventListener("click", () => this.page.search({ optimizers: this.chosen(), repeats: Number(repeats.value), seed: Number(seed.value) }));
  }

  /** An optimizer and its budget, as far as it has such settings; empty fields keep its own. */
  optimizerRow(chosen) {
    const line = element(this.rows, "div", { class: "card bar" });
    const list = select(line, this.words.map(({ name }) => [name, name]), chosen.name, "Optimizer");
    element(line, "button", { type: "button", class: "push", "aria-label": "Remove this optimizer" }, "×").addEventListener("click", () => line.remove());
    const fields = element(line, "span", { class: "bar" });
    const showFields = (values) => {
      fields.replaceChildren();
      const { settings = {} } = this.words.find(({ name }) => name === list.value) ?? {};
      for (const [key, text] of Object.entries(BUDGET).filter(([name]) => name in settings))
        element(element(fields, "label", {}, `${text} `), "input", { type: "number", min: 1, value: values[key] ?? "", placeholder: settings[key], class: "small", "data-key": key });
    };
    list.addEventListener("change", () => showFields({}));
    showFields(chosen);
  }

  chosen() {
    return [...this.rows.children].map((line) => {
      const fields = [...line.querySelectorAll("[data-key]")].filter(({ value }) => value);
      return { name: line.querySelector("select").value, ...Object.fromEntries(fields.map(({ dataset, value }) => [dataset.key, Number(value)])) };
    });
  }
}
