import { element, keepingFocus, named, row, select, svgElement } from "./parts.js";
import { crop, recordName, USES } from "./records.js";
import { short } from "./scale.js";
import { typed } from "./slider.js";

/** The side panel before there is a job: records with rows and use, columns with role and unit, and the button that
 * makes a job of them. `actions` has inspect(files), put(record, place), join(place, record), changed() and confirm(). */
export class Columns {
  constructor(root, records, actions) {
    Object.assign(this, { root, records, actions, due: false, typing: false, pressed: false });
    const follow = (target, kinds, change) => kinds.forEach((kind) => target.addEventListener(kind, (event) => { change(event); this.show(false); }, true));
    follow(root, ["input"], ({ target }) => { this.typing = target.matches("input:not([type=file])"); });
    follow(root, ["change", "focusout"], () => { this.typing = false; });
    follow(window, ["pointerdown"], () => { this.pressed = true; });
    follow(window, ["pointerup", "pointercancel"], () => { this.pressed = false; });
  }

  /** Draw what has changed, once no field is being typed in and nothing is being pressed. */
  show(changed = true) {
    this.due ||= changed;
    setTimeout(() => {
      if (!this.due || this.typing || this.pressed) return;
      this.due = false;
      keepingFocus(() => this.draw());
    });
  }

  draw() {
    this.root.replaceChildren();
    const { list } = this.records;
    if (!list.length) return;
    element(this.root, "h2", {}, "Records");
    const cards = element(this.root, "div", { class: "rows files" });
    list.forEach((record, place) => this.recordCard(cards, record, place));
    element(this.root, "p", { class: "quiet" }, "Drag the handles in the time plot to crop a record, to leave out its start, or to move the part for validation.");
    const more = element(element(this.root, "p"), "label", {}, "More files ");
    element(more, "input", { type: "file", multiple: "" }).addEventListener("change", (event) => this.actions.upload(event.target.files));
    if (!this.records.columnOf("time")) this.field(element(this.root, "p", { class: "bar" }), "No time column. Sample rate ", "rate", { placeholder: "1 kHz" });
    element(this.root, "h2", {}, "Columns");
    element(this.root, "p", { class: "quiet" }, "Check the role and the unit of each column: the units set the scale of every parameter.");
    this.columnTable();
    this.confirmation();
  }

  recordCard(cards, record, place) {
    const card = element(cards, "div", { class: "card record" });
    const head = element(card, "h3", {}, recordName(record));
    element(head, "span", { class: "tag" }, `${record.rows} rows`);
    const difference = this.records.difference(record);
    if (difference) element(head, "span", { class: "warn" }, `has ${difference}`);
    const remove = element(head, "button", { type: "button", class: "push", "aria-label": `Remove ${recordName(record)}` }, "Remove");
    remove.addEventListener("click", () => { this.records.drop(place); this.actions.changed(); });
    this.partChoice(record, place, card);
    const above = this.records.list[place - 1];
    const joins = above && !above.files[0].kind && above.rows === record.rows ? [["join", "columns of the record above"]] : [];
    const line = element(card, "div", { class: "bar" });
    const use = select(line, [...USES, ...joins], record.use, `Use of ${recordName(record)}`);
    use.addEventListener("change", () => (use.value === "join" ? this.actions.join(place) : (Object.assign(record, { chosen: use.value }), this.records.update(), this.actions.changed())));
    if (!record.dt) return;
    const fields = element(card, "div", { class: "bar" });
    this.seconds(fields, record, "From", () => record.crop[0] * record.dt, (value) => crop(record, { from: Math.round(value / record.dt) }));
    this.seconds(fields, record, "to", () => record.crop[1] * record.dt, (value) => crop(record, { to: Math.round(value / record.dt) }));
    this.seconds(fields, record, "not scored for", () => record.settle, (value) => crop(record, { settle: value }));
  }

  seconds(parent, record, text, read, write) {
    const label = element(parent, "label", {}, text);
    const field = element(label, "input", { type: "number", step: "any", min: 0, value: Number(read().toPrecision(5)), "aria-label": `${recordName(record)}: ${text}, in ${this.records.timed ? "seconds" : "samples"}`, class: "seconds" });
    label.append(this.records.clock);
    field.addEventListener("change", () => { write(typed(field) ?? read()); this.actions.changed(); });
  }

  /** A choice of the table or sheet of a file, and a button that adds another one as a further record. */
  partChoice({ files: [file] }, place, card) {
    const parts = Object.entries(file.parts ?? {});
    if (!parts.length) return;
    const line = element(card, "div", { class: "bar" });
    const list = select(line, parts, file.part, `Table or sheet of ${file.file}`);
    const inspected = async (part, index) => this.actions.put(await this.actions.inspect([{ file: file.file, part }]), index);
    list.addEventListener("change", () => inspected(list.value, place).catch(() => { list.value = file.part; }));
    const taken = this.records.list.filter(({ files: [other] }) => other.file === file.file).map(({ files: [other] }) => other.part);
    const unused = parts.map(([word]) => word).filter((word) => !taken.includes(word));
    const following = unused.find((word) => parts.findIndex(([other]) => other === word) > parts.findIndex(([other]) => other === file.part)) ?? unused[0];
    if (following) element(line, "button", { type: "button" }, "Add another").addEventListener("click", () => inspected(following, -1).catch(() => {}));
  }

  columnTable() {
    const table = element(this.root, "table", { class: "guessed" });
    const head = element(element(table, "thead"), "tr");
    for (const text of ["column", "role", "unit", "range"]) element(head, "th", { scope: "col" }, text);
    const body = element(table, "tbody");
    for (const column of this.records.columns) {
      const name = this.records.columnName(column);
      const cells = row(body, "td", ["", "", "", this.records.constant(column) ? `constant ${short(column.low)}` : this.records.range(column).map(short).join(" to ")]);
      named(cells[0], "span", {}, name);
      const role = select(cells[1], this.records.rolesOf(column), this.records.roleOf(column), `Role of ${name}`);
      const unit = element(cells[2], "input", { "aria-label": `Unit of ${name}`, value: column.unit, placeholder: "unit", size: 4 });
      preview(cells[3], column.shape, name);
      role.addEventListener("change", () => { this.records.setRole(column, role.value); this.actions.changed(); });
      unit.addEventListener("input", () => { column.unit = unit.value; });
      unit.addEventListener("change", () => this.actions.changed());
    }
  }

  confirmation() {
    const bar = element(this.root, "p", { class: "bar" });
    this.field(bar, "Name of the job ", "name", {});
    const button = element(bar, "button", { type: "button", class: "strong", id: "confirm", "data-acts": "" }, "Confirm and identify");
    button.addEventListener("click", () => this.actions.confirm());
  }

  field(bar, text, key, attributes) {
    const input = element(element(bar, "label", {}, text), "input", { value: this.records[key], size: 12, "aria-label": text.trim(), ...attributes });
    input.addEventListener("change", () => this.actions.changed(key === "rate"));
    input.addEventListener("input", () => { this.records[key] = input.value; });
  }
}

/** A small plot of a column. */
function preview(cell, shape, name) {
  if (!shape?.length) return;
  const points = shape.map((value, place) => `${place},${(20 * (1 - value)).toFixed(1)}`).join(" ");
  const svg = svgElement(cell, "svg", { viewBox: `0 -1 ${shape.length} 22`, preserveAspectRatio: "none", class: "shape", role: "img", "aria-label": `Preview of ${name}` });
  svgElement(svg, "polyline", { points, "vector-effect": "non-scaling-stroke" });
}
