import { about, placeOf } from "./about.js";
import { element, select } from "./parts.js";

const KINDS = { start: "Start of a record", hysteresis: "Hysteresis", mechanics: "Mechanics" };
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
      event.preventDefault();
      root.classList.remove("over");
      this.place(event.dataTransfer.getData("text/plain"));
    });
    addEventListener("keydown", (event) => {
      const details = palette.querySelector("details[open]");
      if (event.key !== "Escape" || !details) return;
      details.open = false;
      details.querySelector("summary").focus();
    });
    addEventListener("pointerdown", (event) => {
      const details = palette.querySelector("details[open]");
      if (details && !details.contains(event.target) && !root.contains(event.target)) details.open = false;
    });
  }

  /** `model` and `effects` are words; `catalogue` has the name, doc, place and kind of every block and effect. */
  show({ model, effects }, catalogue, begun) {
    const key = JSON.stringify([model, effects, begun]);
    if (key === this.key) return;
    this.key = key;
    this.known = Object.fromEntries([...catalogue.blocks, ...catalogue.effects].map((block) => [block.name, block]));
    Object.assign(this, { model, effects, begun });
    const wordOf = (item) => item.split(".")[0];
    const position = (item) => this.known[wordOf(item)]?.place ?? TERM;
    this.root.replaceChildren();
    element(this.root, "li", { class: "end" }, "drive");
    for (const word of [...model, ...effects].toSorted((a, b) => position(a) - position(b))) this.showBlock(word, this.known[wordOf(word)]);
    element(this.root, "li", { class: "end" }, "response");
    this.showPalette(catalogue);
  }

  showBlock(word, known) {
    const effect = this.effects.includes(word);
    const item = element(this.root, "li", effect ? { class: "effect" } : {}, known ? "" : word);
    if (known) about(item, word, placeOf(known, word), known.doc);
    if (!effect && this.model.length === 1) return;
    const button = element(item, "button", { type: "button", "aria-label": `Remove ${word}`, title: `Remove ${word}`, ...(this.begun && { "data-acts": "" }) }, "×");
    button.addEventListener("click", () => (effect ? this.remove(word) : this.setModel(this.model.filter((other) => other !== word))));
  }

  showPalette({ blocks, effects }) {
    const open = this.palette.querySelector("details")?.open ?? false;
    this.palette.replaceChildren();
    if (this.begun) this.showEffects(effects);
    const details = element(this.palette, "details", open && !this.begun ? { open: "" } : {});
    element(details, "summary", {}, "Choose blocks");
    const sheet = element(details, "div", { class: "palette" });
    element(sheet, "p", { class: "quiet" }, "Click a block, or drag it onto the chain. It replaces the block of the same kind.");
    for (const [kind, title] of Object.entries(KINDS)) {
      element(sheet, "p", {}, title);
      const list = element(sheet, "ul");
      for (const block of blocks.filter((item) => item.kind === kind)) this.showChip(element(list, "li"), block);
    }
  }

  /** A list to choose an effect from, with the link to what was chosen; only the button adds it. */
  showEffects(effects) {
    const free = effects.filter(({ name }) => !this.effects.includes(name));
    const list = select(this.palette, [["", "Add an effect …"], ...free.map(({ name, doc }) => [name, `${name}: ${doc}`.slice(0, 110)])], "", "Effect to add");
    const button = element(this.palette, "button", { type: "button", "data-acts": "", "aria-label": "Add the chosen effect" }, "Add");
    button.addEventListener("click", () => (list.value ? this.add(list.value) : list.focus()));
    const chosen = element(this.palette, "span");
    list.addEventListener("change", () => {
      chosen.replaceChildren();
      if (list.value) about(chosen, list.value, this.known[list.value].about, this.known[list.value].doc, `About ${list.value}`);
    });
  }

  /** A block to click or drag, and what it is as the link to more. */
  showChip(line, { name, doc, about: href }) {
    const used = this.model.includes(name);
    const chip = element(line, "button", { type: "button", draggable: "true", "aria-pressed": String(used), class: "chip" }, name);
    about(line, name, href, "", doc);
    chip.addEventListener("dragstart", (event) => event.dataTransfer.setData("text/plain", name));
    chip.addEventListener("click", () => this.place(name));
  }

  /** Put a block into the model in the place of the one of its kind. */
  place(word) {
    const kind = this.known[word]?.kind;
    if (!(kind in KINDS) || this.model.includes(word)) return;
    const others = this.model.filter((other) => this.known[other.split(".")[0]]?.kind !== kind);
    this.setModel(kind === "mechanics" ? [...others, word] : [word, ...others]);
  }
}
