// Elements of a page, and printing.

/** What the use of a record is called. */
export const USE_NAMES = { identify: "identification", validate: "validation" };

const SVG = "http://www.w3.org/2000/svg";

/** A new element inside another. */
export function element(parent, tag, attributes = {}, text = "") {
  return append(parent, document.createElement(tag), attributes, text);
}

/** A new element with a name in it, which is parted, where it must be, after a dot, a slash or an underscore. */
export function named(parent, tag, attributes, name) {
  const node = element(parent, tag, attributes);
  name.split(/(?<=[a-z\d][._/])(?=[a-z])/i).forEach((part, place) => node.append(...(place ? [document.createElement("wbr")] : []), part));
  return node;
}

/** A new SVG element inside another. */
export function svgElement(parent, tag, attributes, text = "") {
  return append(parent, document.createElementNS(SVG, tag), attributes, text);
}

function append(parent, node, attributes, text) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.textContent = text;
  return parent.appendChild(node);
}

/** A new row of a table; returns its cells. */
export function row(table, kind, texts) {
  const line = element(table, "tr");
  return texts.map((text) => element(line, kind, { class: "word" }, String(text)));
}

export function select(parent, options, value, label) {
  const list = element(parent, "select", { "aria-label": label });
  for (const [option, text] of options) element(list, "option", { value: option }, text);
  list.value = value;
  return list;
}

/** Redraw parts of a page and keep the keyboard focus, and in a field what is selected: on the element of the same name,
 * else on `fallback()`. */
export function keepingFocus(redraw, fallback = null) {
  const name = (item) => `${item.tagName} ${item.getAttribute("aria-label") ?? (item.id || item.labels?.[0]?.textContent || item.textContent)}`;
  const visible = (item) => item && item.isConnected && item.offsetParent !== null;
  const focused = document.activeElement;
  const focusedName = name(focused), { selectionStart, selectionEnd } = focused;
  redraw();
  if (focused === document.body || visible(focused)) return;
  const successor = [...document.querySelectorAll("a, button, select, input, summary, [role=button]")].find((item) => name(item) === focusedName && visible(item));
  (successor ?? fallback?.())?.focus({ preventScroll: true });
  if (typeof selectionStart === "number") successor?.setSelectionRange(selectionStart, selectionEnd);
  else if (successor?.matches("input[type=number]")) successor.select();
}

/** Whether the page is drawn for printing. Stacked canvases do not print: each hides the one below. */
export function isPrinting() {
  return document.documentElement.hasAttribute("data-print");
}

/** Redraw in the width and colours of paper before printing, and as before afterwards. */
export function redrawForPrint(redraw) {
  for (const [name, on] of [["beforeprint", true], ["afterprint", false]])
    addEventListener(name, () => {
      document.documentElement.toggleAttribute("data-print", on);
      redraw();
    });
}
