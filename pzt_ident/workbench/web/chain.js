import { element, select } from "./parts.js";

const KINDS = { hysteresis: "Hysteresis", mechanics: "Mechanics" };
const TERM = 4.5; // place of an effect that is a term in the equation of the hysteresis operator

/** The model as a chain of blocks in signal order, and the blocks to choose from: a block that is dragged onto the
 * chain or clicked replaces the block of the same kind. */
export class Chain {
  constructor(root, palette, { setModel, add, remove }) {
    Object.assign(this, { root, palette, setModel, add, remove });
    root.addEventListener("dragover", (event) => {
      if (!event.dataTransfer.types.includes("text/plain")) return;
      event.preventDefault();
      event.stopPropagation();
      root.classList.add("over");
    });
    root.addEventListener("dragleave", () => root.classList.remove("over"));
    root.addEventListener("drop", (event) => {
      root.classList.remove("over");
      this.place(event.dataTransfer.getData("text/plain"));
    });
  }

  /** `model` and `effects` are words; `catalogue` has the name, doc, place and kind of every block and effect. */
  show({ model, effects }, catalogue, begun) {
    this.known = Object.fromEntries([...catalogue.blocks, ...catalogue.effects].map((block) => [block.name, block]));
    this.open = begun === this.begun ? this.palette.querySelector("details")?.open : !begun;
    Object.assign(this, { model, effects, begun });
    const position = (word) => this.known[word]?.place ?? TERM;
    this.root.replaceChildren();
    element(this.root, "li", { class: "end" }, "drive");
    for (const word of [...model, ...effects].toSorted((a, b) => position(a) - position(b))) this.showBlock(word);
    element(this.root, "li", { class: "end" }, "response");
    this.showPalette(catalogue);
  }

  showBlock(word) {
    const effect = this.effects.includes(word);
    const item = element(this.root, "li", { title: this.known[word]?.doc ?? "", ...(effect && { class: "effect" }) }, word);
    if (!effect && this.model.length === 1) return;
    const button = element(item, "button", { type: "button", "aria-label": `Remove ${word}`, title: `Remove ${word}` }, "×");
    button.addEventListener("click", () => (effect ? this.remove(word) : this.setModel(this.model.filter((other) => other !== word))));
  }

  showPalette({ blocks, effects }) {
    this.palette.replaceChildren();
    const details = element(this.palette, "details", this.open ? { open: "" } : {});
    element(details, "summary", {}, "Choose a block, or drag it onto the chain");
    for (const [kind, title] of Object.entries(KINDS)) {
      const row = element(details, "div", { class: "bar" });
      element(row, "span", { class: "quiet" }, title);
      for (const block of blocks.filter((item) => item.kind === kind)) this.showChip(row, block);
    }
    if (!this.begun) return;
    const free = effects.filter(({ name }) => !this.effects.includes(name));
    const list = select(this.palette, [["", "Add an effect …"], ...free.map(({ name, doc }) => [name, `${name}: ${doc}`.slice(0, 110)])], "", "Add an effect");
    list.addEventListener("change", () => list.value && this.add(list.value));
  }

  showChip(row, { name, doc }) {
    const used = this.model.includes(name);
    const chip = element(row, "button", { type: "button", title: doc, draggable: "true", "aria-pressed": String(used), class: "chip" }, name);
    chip.addEventListener("dragstart", (event) => event.dataTransfer.setData("text/plain", name));
    chip.addEventListener("click", () => this.place(name));
  }

  /** Put a block into the model in the place of the one of its kind. */
  place(word) {
    const kind = this.known[word]?.kind;
    if (!(kind in KINDS) || this.model.includes(word)) return;
    const others = this.model.filter((other) => this.known[other]?.kind !== kind);
    this.setModel(kind === "hysteresis" ? [word, ...others] : [...others, word]);
  }
}
