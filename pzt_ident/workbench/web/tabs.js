import { element } from "./parts.js";

/** Tabs with their sheets; the arrow keys go from tab to tab. `titles`: name to text. */
export class Tabs {
  constructor(list, sheets, titles, onShow = () => {}) {
    Object.assign(this, { list, onShow, tabs: {}, sheets: {} });
    for (const [name, title] of Object.entries(titles)) {
      this.sheets[name] = element(sheets, "div", { role: "tabpanel", id: `sheet-${name}`, "aria-labelledby": `tab-${name}`, tabindex: 0, hidden: "" });
      this.tabs[name] = element(list, "button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": `sheet-${name}`, tabindex: -1 }, title);
      this.tabs[name].addEventListener("click", () => this.open(name));
    }
    list.addEventListener("keydown", (event) => this.key(event));
  }

  /** Offer these tabs only; the one that was open stays open if it is one of them. */
  offer(names) {
    for (const [name, tab] of Object.entries(this.tabs)) tab.hidden = !names.includes(name);
    if (!names.includes(this.current)) this.open(names[0]);
  }

  open(name) {
    this.current = name;
    for (const [other, tab] of Object.entries(this.tabs)) {
      tab.setAttribute("aria-selected", String(other === name));
      tab.tabIndex = other === name ? 0 : -1;
      this.sheets[other].hidden = other !== name;
    }
    this.onShow(name);
  }

  key(event) {
    const names = Object.keys(this.tabs).filter((name) => !this.tabs[name].hidden);
    const place = names.indexOf(this.current);
    const next = { ArrowRight: place + 1, ArrowDown: place + 1, ArrowLeft: place - 1, ArrowUp: place - 1, Home: 0, End: -1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.open(names.at(next % names.length));
    this.tabs[this.current].focus();
  }
}
