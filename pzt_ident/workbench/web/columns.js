import { element, keepingFocus, put, row, select } from "./parts.js";
import { number } from "./signals.js";

const AXES = ["x", "y", "z"];
const ROLES = [["", "not used"], ["time", "time"], ...AXES.flatMap((axis) => [[`${axis}.drive`, `drive of ${axis}`], [`${axis}.response`, `response of ${axis}`]])];
const USUAL = { time: "s", drive: "V", response: "um" };
const USES = [["identify", "identify: fit it"], ["validate", "validate: keep it back"], ["split", "both: fit it but for its last third"]];
const LONG = 600; // rows of a record that may be parted
const usual = (role) => USUAL[role.split(".").at(-1)] ?? "";
const last = (path) => path.split("/").at(-1);

/** The columns of dropped files, or of their tables and sheets, as they were guessed, to be confirmed. A record is one
 * file, or several with the same rows, such as one file a signal. */
export class Columns {
  constructor(root, bar, look, confirm) {
    Object.assign(this, { root, bar, look, confirm, records: [], name: "my-stage", rate: "" });
  }

  get files() { return this.records.flatMap(({ files }) => files.map(({ file }) => file)); }

  /** What was found in a file, as a record after the last, in the place of another, or with one that lacks it. */
  async add(found, place = -1) {
    const mate = place < 0 ? this.records.findIndex((record) => mates(record, found)) : -1;
    if (mate >= 0) return this.join(mate, found);
    const same = this.records.findIndex((record) => key(record) === key(found));
    this.put(found, place < 0 ? same : place);
  }

  put(found, place) {
    const at = place < 0 ? this.records.length : place;
    found.chosen = this.records[at]?.chosen;
    this.records.splice(at, 1, found);
    this.settle();
  }

  /** One record of the files of two. */
  async join(place, found) {
    const files = [...this.records[place].files, ...found.files].map(({ file, part }) => ({ file, part }));
    this.put(await this.look(files), place);
  }

  /** What the first record has is what all are read by; it is fitted, and the others judge, unless another use was
   * chosen. A record alone is parted. */
  settle() {
    const first = this.records.length > 1 || this.records[0]?.rows < LONG ? "identify" : "split";
    this.records.forEach((record, place) => { record.use = record.chosen ?? (place ? "validate" : first); });
    if (this.first !== this.records[0]) {
      this.first = this.records[0];
      this.columns = this.first?.columns.map((column) => ({ ...column, unit: column.unit ?? usual(column.role) }));
      this.rate = this.first?.rate || this.rate;
    }
    this.show();
  }

  show() { keepingFocus(() => this.draw()); }

  draw() {
    this.root.replaceChildren();
    this.bar.replaceChildren();
    if (!this.records.length) return;
    const table = element(this.root, "table", { class: "files" });
    row(table, "th", ["record", this.records.some(({ files }) => files[0].kind) ? "table or sheet" : "", "rows", "use", ""]);
    this.records.forEach((record, place) => this.record(record, place, row(table, "td", [said(record), "", record.rows, "", ""])));
    const split = this.records.some(({ use }) => use === "split") ? "The last third of a record is kept back: the model is judged on it, and never fitted to it. " : "";
    element(this.root, "p", { class: "quiet" }, `${split}Is each column what it is taken for? Units decide the size of every parameter.`);
    this.table();
    this.last();
  }

  record(record, place, cells) {
    this.part(record, place, cells[1]);
    const above = this.records[place - 1];
    const joins = above && !above.files[0].kind && above.rows === record.rows ? [["join", "more columns of the record above"]] : [];
    const use = select(cells[3], [...USES, ...joins], record.use, `Use of ${said(record)}`);
    use.addEventListener("change", () => this.choose(record, place, use.value));
    const off = element(cells[4], "button", { type: "button", "aria-label": `Take off ${said(record)}` }, "Take off");
    off.addEventListener("click", () => { this.records.splice(place, 1); this.settle(); });
    const lacks = this.lacking(record);
    if (lacks) element(cells[4], "span", { class: "warn" }, ` has ${lacks}`);
  }

  choose(record, place, use) {
    if (use !== "join") return Object.assign(record, { use, chosen: use }) && this.show();
    this.records.splice(place, 1);
    this.join(place - 1, record).catch(() => { this.records.splice(place, 0, record); this.settle(); });
  }

  /** What a record has not, of what the first one is read by. */
  lacking(record) {
    if (record.files.length !== this.first.files.length) return "other files than the first record";
    if (record.files.length > 1) return "";
    const headers = record.columns.map((column) => column.header);
    const without = this.columns.filter(({ header, role }) => role && header && !headers.includes(header));
    return without.length ? `no column ${without.map(({ header }) => header).join(", ")}` : "";
  }

  /** Which of the tables or sheets of a file, and one more of them as a record of its own. */
  part({ files: [file] }, place, cell) {
    const parts = Object.entries(file.parts);
    if (!parts.length) return;
    const list = select(cell, parts, file.part, `Table or sheet of ${file.file}`);
    const look = async (part, at) => this.add(await this.look([{ file: file.file, part }]), at);
    list.addEventListener("change", () => look(list.value, place).catch(() => { list.value = file.part; }));
    const taken = this.records.filter(({ files: [other] }) => other.file === file.file).map(({ files: [other] }) => other.part);
    const next = parts.map(([word]) => word).filter((word) => !taken.includes(word));
    const later = next.find((word) => parts.findIndex(([other]) => other === word) > parts.findIndex(([other]) => other === file.part)) ?? next[0];
    if (later) element(cell, "button", { type: "button" }, "And another").addEventListener("click", () => look(later).catch(() => {}));
  }

  table() {
    const table = element(element(this.root, "div", { class: "wide" }), "table", { class: "guessed" });
    const several = this.first.files.length > 1;
    row(table, "th", ["column", "it is", "unit", "from", "to", "looks like", "first values"]);
    for (const column of this.columns) {
      const own = column.header || `column ${column.number}`;
      const file = several ? last(this.first.files[column.of].file) : "";
      const name = file && !file.startsWith(own) ? `${file}: ${own}` : file || own;
      const cells = row(table, "td", [name, "", "", number(column.low, 4), number(column.high, 4), "", column.first.map((value) => number(value, 4)).join("  ")]);
      const role = select(cells[1], ROLES, column.role, `Role of ${name}`);
      const unit = element(cells[2], "input", { "aria-label": `Unit of ${name}`, value: column.unit, placeholder: "unit" });
      pictured(cells[5], column.shape, name);
      role.addEventListener("change", () => this.take(column, role.value));
      unit.addEventListener("input", () => { column.unit = unit.value; });
    }
  }

  /** A role is one column's: the one that had it loses it. */
  take(column, role) {
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
    const axes = {};
    for (const axis of AXES) {
      const [drive, response] = [of(`${axis}.drive`), of(`${axis}.response`)];
      if (drive) axes[axis] = { drive: this.place(drive), ...(response && { response: this.place(response) }) };
      else if (response) throw new Error(`Which column is the drive of ${axis}?`);
    }
    if (!Object.values(axes).some(({ response }) => response)) throw new Error("Which columns are the drive and the response? At least one axis needs both. Where they are in files of their own, drop these too.");
    if (!of("time") && !this.rate) throw new Error("Which column is the time? Or give the sample rate.");
    if (this.records.every(({ use }) => use === "validate")) throw new Error("No record is there to identify: choose one to fit.");
    return {
      name: this.name || "my-stage",
      records: this.records.map((record) => this.written(record)),
      time: of("time") ? this.place(of("time")) : null,
      sample_rate: of("time") ? null : this.rate,
      axes,
    };
  }

  /** A column by its heading where it has one of its own, else by its number; where each record is several files, by
   * its unit alone, since the records say the rest. */
  place({ header, number, unit, role }) {
    if (this.first.files.length > 1) return { unit: unit || usual(role) };
    const single = this.columns.filter((other) => other.header === header).length === 1;
    return { header: single ? header : "", number, unit: unit || usual(role) };
  }

  written({ files, use, rows, columns }) {
    const [{ file, kind, part }] = files;
    const time = this.columns.find(({ role }) => role === "time");
    const stamps = time && columns.find(({ number, of }) => number === time.number && of === time.of);
    const placed = files.length > 1 ? this.columns.filter(({ role }) => role).map(({ role, number, of }) => [role, { file: files[of]?.file ?? "", number }]) : [];
    return { file, use, rows, ...(stamps && { span: stamps.high - stamps.low }), ...(kind && { [kind]: part }), channels: Object.fromEntries(placed) };
  }
}

/** Whether one of two records lacks what the other one has. */
function mates(record, found) {
  const [here, there] = [record, found].map(({ columns }) => columns.map(({ role }) => role).filter(Boolean));
  const whole = (roles) => ["x.drive", "x.response"].every((role) => roles.includes(role));
  const apart = record.rows === found.rows && !record.files[0].kind && !found.files[0].kind && key(record) !== key(found);
  return apart && !here.some((role) => there.includes(role)) && !(whole(here) && whole(there)) && !(whole(here) && !there.length);
}

/** A record by its files. */
function said({ files }) {
  return files.map(({ file }) => last(file)).join(" + ");
}

/** What tells one record from another. */
function key({ files }) {
  return JSON.stringify(files.map(({ file, part }) => [file, part]));
}

/** The course of a column, small. */
function pictured(cell, shape, name) {
  const points = shape.map((value, place) => `${place},${(20 * (1 - value)).toFixed(1)}`).join(" ");
  const svg = put(cell, "svg", { viewBox: `0 -1 ${shape.length} 22`, preserveAspectRatio: "none", class: "shape", role: "img", "aria-label": `Course of ${name}` });
  put(svg, "polyline", { points, "vector-effect": "non-scaling-stroke" });
}
