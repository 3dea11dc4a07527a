import { about, sentence } from "./about.js";
import { Figure } from "./figure.js";
import { percent } from "./misfit.js";
import { element, named, USE_NAMES } from "./parts.js";
import { once, request, requestJson, save } from "./session.js";
import { extent, number } from "./signals.js";
import { slider } from "./slider.js";

/** The effects that the diagnosis scored: what each explains, what it would leave, sliders that show what it does, and
 * the button that adds it; and the drive that would tell the candidates apart. `page` has add, move, fail. */
export class Candidates {
  constructor(root, page) {
    Object.assign(this, { root, page, key: "" });
  }

  show({ diagnosis, unit, together, at, blocks, effects, optimizer_words }, progress) {
    const key = JSON.stringify([diagnosis, unit, at, diagnosis ? 0 : progress]);
    if (key === this.key) return;
    Object.assign(this, { key, unit, together: together ?? "", at, catalogue: { blocks, effects, optimizer_words } });
    this.root.replaceChildren();
    if (!diagnosis) return this.showProgress(progress);
    const { candidates, next_experiment: drive } = diagnosis;
    if (!candidates.length) element(this.root, "p", {}, "No effect was scored: what is left is not attributed to the model.");
    if (drive) this.showDrive(drive);
    if (drive) element(this.root, "h2", {}, "Effects");
    const order = { missing: 0, equivalent: 1 };
    const list = element(this.root, "div", { class: "rows" });
    for (const item of candidates.toSorted((a, b) => (order[a.decision] ?? 2) - (order[b.decision] ?? 2) || b.explained - a.explained)) this.card(list, item);
  }

  showProgress({ scored }) {
    if (!scored.length) return void element(this.root, "p", { class: "quiet" }, "Every effect of the catalogue is scored here when the model has been identified.");
    const table = element(this.root, "table");
    const head = element(element(table, "thead"), "tr");
    for (const text of ["effect", "share of the misfit that it explains"]) element(head, "th", { scope: "col" }, text);
    const body = element(table, "tbody");
    for (const { effect, explained } of scored.toSorted((a, b) => b.explained - a.explained)) {
      const line = element(body, "tr");
      sentence(line, "td", effect, this.catalogue);
      element(line, "td", { class: "number" }, percent(explained));
    }
  }

  card(list, item) {
    const effect = item.item ?? item.effect;
    const card = element(list, "div", { class: `card${item.decision === "missing" ? " missing" : ""}` });
    const head = element(card, "h3");
    about(head, effect, item.about, item.physics);
    const add = element(head, "button", { type: "button", class: `push ${item.decision === "missing" ? "strong" : ""}`, "data-acts": "", "data-effect": effect, "aria-label": `Add ${effect}` }, "Add");
    add.addEventListener("click", () => this.page.add(effect));
    const tags = element(card, "p", { class: "bar" });
    element(tags, "span", { class: `tag ${item.decision === "missing" ? "warn" : ""}` }, item.decision);
    element(tags, "span", { class: "tag" }, `explains ${percent(item.explained)} of the misfit`);
    if (item.rmse) element(card, "p", {}, `RMSE with it${this.together}: ${this.errors(item.rmse)}`);
    const more = element(card, "details");
    element(more, "summary", {}, "Physics, estimate, sliders");
    const facts = element(more, "dl", { class: "facts" });
    const others = item.class.filter((word) => word !== item.effect).join(", ");
    for (const [term, text] of [["estimate", item.estimate], ["visibility", number(item.visibility, 2)], ["cannot be told from", others]])
      if (text) { element(facts, "dt", {}, term); sentence(facts, "dd", text, this.catalogue); }
    sentence(more, "p", item.physics, this.catalogue);
    if (item.remedy) sentence(more, "p", `On the test rig: ${item.remedy}`, this.catalogue);
    const tried = element(more, "div");
    more.addEventListener("toggle", () => (more.open ? this.proposal(effect, tried) : this.page.move(null)));
  }

  /** Sliders of an effect that is not in the model yet, at the values at which it does nothing. */
  async proposal(effect, root) {
    root.replaceChildren();
    try {
      const { parameters } = await requestJson(`proposal?effect=${encodeURIComponent(effect)}`);
      element(root, "p", { class: "quiet" }, "Move a slider to see in the plots what the effect does; it starts where it does nothing.");
      const values = {};
      this.error = element(root, "p", { role: "status" });
      for (const parameter of parameters) {
        values[parameter.name] = parameter.value;
        const entry = element(root, "div", { class: "parameter", role: "group", "aria-label": parameter.name });
        const head = element(entry, "div", { class: "parameter-head" });
        named(head, "strong", { title: parameter.physics ?? "" }, parameter.name.slice(parameter.name.indexOf(".") + 1));
        slider(entry, head, parameter, (value) => { values[parameter.name] = value; this.page.move({ ...values }, effect); });
      }
    } catch (error) { this.page.fail(error); }
  }

  errors(rmse) {
    return Object.entries(USE_NAMES).filter(([use]) => Number.isFinite(rmse?.[use])).map(([use, name]) => `${number(rmse[use])} ${this.unit} (${name})`).join(", ");
  }

  /** The error with the values of the sliders. */
  moved(rmse) {
    if (this.error) this.error.textContent = `RMSE ${this.errors(rmse)}`;
  }

  showDrive({ splits, why }) {
    element(this.root, "h2", {}, "Next measurement");
    sentence(this.root, "p", `To tell ${splits.join(" and ")} apart, apply this drive: ${why}.`, this.catalogue);
    const holder = element(this.root, "div", { class: "plotted" });
    const figure = new Figure(holder, { label: "The proposed drive over time", along: true, gestures: { reset: () => figure.plot.look(null, null), point: (point) => figure.pointAt(point) } });
    once(element(element(this.root, "p"), "button", { type: "button" }, "Download the drive (CSV)"), () => save("drive", "next_experiment.csv"), this.page.fail);
    request("drive").then((reply) => reply.text()).then((text) => figure.show(driveScene(text), "")).catch((error) => this.page.fail(error));
  }
}

/** The columns of a CSV as curves over its first one. */
export function driveScene(text) {
  const { names, columns: [xs, ...signals] } = parsed(text);
  const looks = [["--identify", []], ["--validate", [6, 3]], ["--third", [2, 2]]];
  const series = signals.map((ys, place) => ({ label: names[place + 1], xs, ys, colour: looks[place % 3][0], dash: looks[place % 3][1] }));
  const ranges = signals.map(extent);
  return {
    series, track: { xs, ys: signals[0] }, x: { label: "time [s]", range: [xs[0], xs.at(-1)] },
    y: { label: names.length === 2 ? names[1] : "", range: [Math.min(...ranges.map(([low]) => low)), Math.max(...ranges.map(([, high]) => high))] },
  };
}

/** The heading and the columns of a CSV of numbers. */
export function parsed(text) {
  const lines = text.trim().split("\n").filter((line) => line && !line.startsWith("#"));
  const rows = lines.slice(1).map((line) => line.split(",").map(Number));
  const names = lines[0].split(",").map((name) => name.trim().replace(/^"|"$/g, ""));
  return { names, columns: names.map((_, place) => Float64Array.from(rows, (values) => values[place])) };
}
