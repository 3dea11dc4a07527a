// The small parts of a page.

const SVG = "http://www.w3.org/2000/svg";

/** A new element inside another. */
export function element(parent, tag, attributes = {}, text = "") {
  return filled(parent, document.createElement(tag), attributes, text);
}

/** A new element of a drawing inside another. */
export function put(parent, tag, attributes, text = "") {
  return filled(parent, document.createElementNS(SVG, tag), attributes, text);
}

function filled(parent, made, attributes, text) {
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return parent.appendChild(made);
}

/** A row of a table, its cells. */
export function row(table, kind, texts) {
  const line = element(table, "tr");
  return texts.map((text) => element(line, kind, { class: "word" }, String(text)));
}

export function select(parent, options, value, label) {
  const made = element(parent, "select", { "aria-label": label });
  for (const [word, text] of options) element(made, "option", { value: word }, text);
  made.value = value;
  return made;
}

/** Draw parts of a page again; who is at one of them by the keyboard stays there, or goes to `fallback` where it is gone. */
export function keepingFocus(redraw, fallback = null) {
  const name = (item) => `${item.tagName} ${item.getAttribute("aria-label") ?? (item.id || item.textContent)}`;
  const seen = (item) => item && item.isConnected && item.offsetParent !== null;
  const held = document.activeElement;
  const known = name(held);
  redraw();
  if (held === document.body || seen(held)) return;
  const again = [...document.querySelectorAll("button, select, input, summary")].find((item) => name(item) === known && seen(item));
  (again ?? fallback?.())?.focus({ preventScroll: true });
}

/** Whether it is drawn to be printed. A printer has no sheets: each cuts what is below out of the page. */
export function onPaper() {
  return document.documentElement.hasAttribute("data-print");
}

/** Draw as wide as a sheet of paper and in its colours while it is printed. */
export function printed(redraw) {
  for (const [name, on] of [["beforeprint", true], ["afterprint", false]])
    addEventListener(name, () => {
      document.documentElement.toggleAttribute("data-print", on);
      redraw();
    });
}
