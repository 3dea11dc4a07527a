import { element } from "./parts.js";
import { number } from "./signals.js";

const NOTCHES = 1000;

/** A value within bounds: a number, its unit, and a slider, logarithmic where the bounds span decades. `onMove(value)`
 * follows every movement. Returns {set(value), field, range}. */
export function slider(parent, head, { name, symbol, value, unit, bounds: [low, high], fixed }, onMove) {
  const logarithmic = low > 0 && high / low > 100;
  const toNotch = (x) => NOTCHES * (logarithmic ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low));
  const fromNotch = (notch) => (logarithmic ? low * (high / low) ** (notch / NOTCHES) : low + ((high - low) * notch) / NOTCHES);
  const field = element(head, "input", { type: "text", inputmode: "decimal", "aria-label": `${name}, value${unit ? ` in ${unit}` : ""}`, title: symbol ?? name });
  element(head, "small", {}, unit ?? "");
  const range = element(parent, "input", { type: "range", min: 0, max: NOTCHES, step: 1, "aria-label": `${name}, slider` });
  const set = (x) => {
    field.value = plain(x);
    range.value = toNotch(x);
    range.setAttribute("aria-valuetext", `${number(x, 4)} ${unit ?? ""}`);
  };
  if (value !== null) set(value);
  const moved = (x, own) => {
    if (own !== field) field.value = plain(x);
    if (own !== range) range.value = toNotch(x);
    range.setAttribute("aria-valuetext", `${number(x, 4)} ${unit ?? ""}`);
    onMove(x);
  };
  range.addEventListener("input", () => moved(fromNotch(Number(range.value)), range));
  field.addEventListener("change", () => {
    const x = typed(field);
    if (x !== null) moved(Math.min(Math.max(x, low), high), null);
    else set(value);
  });
  range.disabled = fixed || value === null;
  field.disabled = value === null;
  return { set, field, range };
}

/** The number in a field, with a point or a comma; null where it holds none. */
export function typed({ value }) {
  const x = Number(value.replace("−", "-").replace(",", "."));
  return value.trim() && Number.isFinite(x) ? x : null;
}

/** A number as it is typed. */
export function plain(value, digits = 5) {
  return value === null || value === undefined ? "" : String(Number(value.toPrecision(digits)));
}
