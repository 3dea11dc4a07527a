import { element } from "./explorer.js";
import { number } from "./signals.js";
import { put } from "./staircase.js";

const AXES = ["x", "y", "z"];
const ROLES = [["", "not used"], ["time", "time"], ...AXES.flatMap((axis) => [[`${axis}.drive`, `drive of ${axis}`], [`${axis}.response`, `response of ${axis}`]])];
const USUAL = { time: "s", drive: "V", response: "um" };
const usual = (role) => USUAL[role.split(".").at(-1)] ?? "";

/** The columns of dropped files, or of their tables and sheets, as they were guessed, to be confirmed. */
export class Columns {
  constructor(root, last, look, confirm) {
    Object.assign(this, { root, bar: last, look, confirm, files: [], name: "my-stage", rate: "" });
  }

  /** A file, or one of its parts, in the place of another or after the last. */
  add(found, place = this.files.findIndex((file) => file.file === found.file && file.part === found.part)) {
    const at = place < 0 ? this.files.length : place;
    found.use = this.files[at]?.use ?? (at ? "validate" : "identify");
    this.files.splice(at, 1, found);
    this.settle();
  }

  /** What the first file has is what all are read by. */
  settle() {
    if (this.first !== this.files[0]) this.columns = this.files[0]?.columns.map((column) => ({ ...column, unit: column.unit ?? usual(column.role) }));
    this.first = this.files[0];
    this.show();
  }

  show() {
    this.root.replaceChildren();
    this.bar.replaceChildren();
    if (!this.files.length) return;
    const files = element(this.root, "table", { class: "files" });
    row(files, "th", ["file", this.files.some(({ kind }) => kind) ? "table or sheet" : "", "rows", "use", ""]);
    this.files.forEach((file, place) => this.file(file, place, row(files, "td", [file.file.split("/").at(-1), "", file.rows, "", ""])));
    element(this.root, "p", { class: "quiet" }, "Is each column what it is taken for? Units decide the size of every parameter.");
    this.table();
    this.last();
  }

  file(file, place, cells) {
    this.part(file, place, cells[1]);
    const use = select(cells[3], [["identify", "identify: fit it"], ["validate", "validate: keep it back"]], file.use, `Use of ${file.file}`);
    use.addEventListener("change", () => { file.use = use.value; });
    const off = element(cells[4], "button", { type: "button" }, "Take off");
    off.addEventListener("click", () => { this.files.splice(place, 1); this.settle(); });
    const headers = file.columns.map((column) => column.header);
    const lacking = this.columns.filter(({ header, role }) => role && header && !headers.includes(header));
    if (lacking.length) element(cells[4], "span", { class: "warn" }, ` has no column ${lacking.map(({ header }) => header).join(", ")}`);
  }

  /** Which of the tables or sheets of a file, and one more of them as a record of its own. */
  part(file, place, cell) {
    const parts = Object.entries(file.parts);
    if (!parts.length) return;
    const list = select(cell, parts, file.part, `Table or sheet of ${file.file}`);
    list.addEventListener("change", () => this.look(file.file, list.value, place).catch(() => { list.value = file.part; }));
    const taken = this.files.filter((other) => other.file === file.file).map((other) => other.part);
    const next = parts.map(([word]) => word).filter((word) => !taken.includes(word));
    const later = next.find((word) => parts.findIndex(([other]) => other === word) > parts.findIndex(([other]) => other === file.part)) ?? next[0];
    if (later) element(cell, "button", { type: "button" }, "And another").addEventListener("click", () => this.look(file.file, later).catch(() => {}));
  }

  table() {
    const table = element(element(this.root, "div", { class: "wide" }), "table", { class: "guessed" });
    row(table, "th", ["column", "it is", "unit", "from", "to", "looks like", "first values"]);
    for (const column of this.columns) {
      const name = column.header || `column ${column.number}`;
      const cells = row(table, "td", [name, "", "", number(column.low, 4), number(column.high, 4), "", column.first.map((value) => number(value, 4)).join("  ")]);
      const role = select(cells[1], ROLES, column.role, `Role of ${name}`);
      const unit = element(cells[2], "input", { "aria-label": `Unit of ${name}`, value: column.unit, placeholder: "unit" });
      pictured(cells[5], column.shape, name);
      role.addEventListener("change", () => this.choose(column, role.value));
      unit.addEventListener("input", () => { column.unit = unit.value; });
    }
  }

  /** A role is one column's: the one that had it loses it. */
  choose(column, role) {
    for (const other of this.columns) if (other.role === role) other.role = "";
    Object.assign(column, { role, unit: column.unit || usual(role) });
    this.show();
  }

  last() {
    const { bar } = this;
    this.field(bar, "Name of the job ", "name", {});
    if (!this.columns.some(({ role }) => role === "time")) this.field(bar, "No column is the time. Sample rate ", "rate", { placeholder: "1 kHz" });
    const go = element(bar, "button", { type: "button", class: "strong", id: "confirm" }, "Confirm and identify");
    go.addEventListener("click", () => this.confirm(() => this.form()));
  }

  field(bar, text, key, attributes) {
    const made = element(element(bar, "label", {}, text), "input", { value: this[key], ...attributes });
    made.addEventListener("input", () => { this[key] = made.value; });
  }

  /** What the server makes a job of, less the model. Throws an Error where something is left open. */
  form() {
    const of = (role) => this.columns.find((column) => column.role === role);
    const single = ({ header }) => this.columns.filter((other) => other.header === header).length === 1;
    const place = (column) => ({ header: single(column) ? column.header : "", number: column.number, unit: column.unit || usual(column.role) });
    const axes = {};
    for (const axis of AXES) {
      const [drive, response] = [of(`${axis}.drive`), of(`${axis}.response`)];
      if (drive) axes[axis] = { drive: place(drive), ...(response && { response: place(response) }) };
      else if (response) throw new Error(`Which column is the drive of ${axis}?`);
    }
    if (!Object.values(axes).some(({ response }) => response)) throw new Error("Which columns are the drive and the response? At least one axis needs both.");
    if (!of("time") && !this.rate) throw new Error("Which column is the time? Or give the sample rate.");
    if (!this.files.some(({ use }) => use === "identify")) throw new Error("No record is there to identify: choose one to fit.");
    const record = ({ file, use, kind, part }) => ({ file, use, ...(kind && { [kind]: part }) });
    return {
      name: this.name || "my-stage",
      records: this.files.map(record),
      time: of("time") ? place(of("time")) : null,
      sample_rate: of("time") ? null : this.rate,
      axes,
    };
  }
}

/** The course of a column, small. */
function pictured(cell, shape, name) {
  const points = shape.map((value, place) => `${place},${(20 * (1 - value)).toFixed(1)}`).join(" ");
  const svg = put(cell, "svg", { viewBox: `0 -1 ${shape.length} 22`, preserveAspectRatio: "none", class: "shape", role: "img", "aria-label": `Course of ${name}` });
  put(svg, "polyline", { points, "vector-effect": "non-scaling-stroke" });
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
