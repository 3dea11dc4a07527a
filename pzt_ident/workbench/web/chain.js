import { element, select } from "./parts.js";

const KINDS = { hysteresis: "Hysteresis", mechanics: "Mechanics" };
const TERM = 4.5; // place of a term in the operator's own equation

/** The model drawn as its chain of blocks, in the order of the signal, and the blocks that it may be made of: one of
 * a kind, drawn onto the chain with the mouse or chosen, takes the place of that kind. */
export class Chain {
  constructor(root, palette, { choose, add, remove }) {
    Object.assign(this, { root, palette, choose, add, remove });
    root.addEventListener("dragover", (event) => {
      if (!event.dataTransfer.types.includes("text/plain")) return;
      event.preventDefault();
      event.stopPropagation();
      root.classList.add("over");
    });
    root.addEventListener("dragleave", () => root.classList.remove("over"));
    root.addEventListener("drop", (event) => {
      root.classList.remove("over");
      this.put(event.dataTransfer.getData("text/plain"));
    });
  }

  /** `model` and `effects` are words; `known` says of each block and effect its name, doc, place and kind. */
  show({ model, effects }, known, begun) {
    this.known = Object.fromEntries([...known.blocks, ...known.effects].map((block) => [block.name, block]));
    this.open = begun === this.begun ? this.palette.querySelector("details")?.open : !begun;
    Object.assign(this, { model, effects, begun });
    const place = (word) => this.known[word]?.place ?? TERM;
    this.root.replaceChildren();
    element(this.root, "li", { class: "end" }, "drive");
    for (const word of [...model, ...effects].toSorted((a, b) => place(a) - place(b))) this.block(word);
    element(this.root, "li", { class: "end" }, "response");
    this.choices(known);
  }

  block(word) {
    const effect = this.effects.includes(word);
    const item = element(this.root, "li", { title: this.known[word]?.doc ?? "", ...(effect && { class: "effect" }) }, word);
    if (!effect && this.model.length === 1) return;
    const off = element(item, "button", { type: "button", "aria-label": `Take off ${word}`, title: `Take off ${word}` }, "×");
    off.addEventListener("click", () => (effect ? this.remove(word) : this.choose(this.model.filter((other) => other !== word))));
  }

  choices({ blocks, effects }) {
    this.palette.replaceChildren();
    const details = element(this.palette, "details", this.open ? { open: "" } : {});
    element(details, "summary", {}, "Blocks to choose, or to draw onto the chain");
    for (const [kind, said] of Object.entries(KINDS)) {
      const row = element(details, "div", { class: "bar" });
      element(row, "span", { class: "quiet" }, said);
      for (const block of blocks.filter((one) => one.kind === kind)) this.chip(row, block);
    }
    if (!this.begun) return;
    const free = effects.filter(({ name }) => !this.effects.includes(name));
    const list = select(this.palette, [["", "Add an effect …"], ...free.map(({ name, doc }) => [name, `${name}: ${doc}`.slice(0, 110)])], "", "Add an effect");
    list.addEventListener("change", () => list.value && this.add(list.value));
  }

  chip(row, { name, doc }) {
    const there = this.model.includes(name);
    const chip = element(row, "button", { type: "button", title: doc, draggable: "true", "aria-pressed": String(there), class: "chip" }, name);
    chip.addEventListener("dragstart", (event) => event.dataTransfer.setData("text/plain", name));
    chip.addEventListener("click", () => this.put(name));
  }

  put(word) {
    const kind = this.known[word]?.kind;
    if (!(kind in KINDS) || this.model.includes(word)) return;
    const rest = this.model.filter((other) => this.known[other]?.kind !== kind);
    this.choose(kind === "hysteresis" ? [word, ...rest] : [...rest, word]);
  }
}
