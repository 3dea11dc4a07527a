import { sentence } from "./about.js";
import { element } from "./parts.js";
import { number } from "./signals.js";

export const percent = (share) => (share > 0.995 && share < 1 ? "more than 99 %" : `${Math.round(100 * share)} %`);

/** Where the model fails: the sentences of misfit and diagnosis, and the worst segments to look at. `reveal(record,
 * axis, from, to)` marks one in the plots. */
export function showMisfit(root, { misfit, diagnosis, result, weighed, ...catalogue }, reveal) {
  root.replaceChildren();
  const axes = Object.values(misfit?.axes ?? {});
  if (diagnosis) sentence(root, "p", diagnosis.reason, catalogue);
  if (!axes.length && !diagnosis) return void element(root, "p", { class: "quiet" }, "What is left of the measurement is taken apart here when the model has been identified.");
  for (const axis of axes) {
    if (axes.length > 1) element(root, "h2", {}, `Axis ${axis.axis}`);
    const list = element(root, "ul", { class: "findings" });
    for (const sentence of axis.sentences) element(list, "li", {}, sentence);
    if (axis.worst.length) element(root, "h2", {}, "Worst segments");
    const segments = element(root, "div", { class: "rows" });
    for (const { record, start, end, share } of axis.worst)
      element(segments, "button", { type: "button" }, `${record}, ${number(start, 4)} to ${number(end, 4)} s: ${percent(share)} of the misfit`)
        .addEventListener("click", () => reveal(record, axis.axis, start, end));
  }
  for (const { run, reason } of result?.failed_runs ?? []) element(root, "p", { class: "warn" }, `${run} failed: ${reason}.`);
  if (result?.best && result.best.rmse.validate === null) element(root, "p", {}, "There is no validation record: add a second record to test the model on data that it was not fitted to.");
  if (weighed) element(root, "p", { class: "quiet" }, weighed);
}
