import { element, keepingFocus, row, select, svgElement } from "./parts.js";
import { number } from "./signals.js";

const AXES = ["x", "y", "z"];
const ROLES = [["", "not used"], ["time", "time"], ...AXES.flatMap((axis) => [[`${axis}.drive`, `drive of ${axis}`], [`${axis}.response`, `response of ${axis}`]])];
const USUAL_UNITS = { time: "s", drive: "V", response: "um" };
const USES = [["identify", "identification (fitted)"], ["validate", "validation (not fitted)"], ["split", "both: last third for validation"]];
const LONG = 600; // rows; a single record of at least this length is split
const usualUnit = (role) => USUAL_UNITS[role.split(".").at(-1)] ?? "";
const fileName = (path) => path.split("/").at(-1);

/** The guessed roles of the columns of dropped files, tables or sheets, for the user to confirm. A record is one file,
 * or several with the same number of rows, such as one file per signal. */
export class Columns {
  constructor(root, bar, inspect, confirm) {
    Object.assign(this, { root, bar, inspect, confirm, records: [], name: "my-stage", rate: "" });
  }

  get files() { return this.records.flatMap(({ files }) => files.map(({ file }) => file)); }

  /** Add the columns of a file as a new record, in the place of an old one, or to a record that they complete. */
  async add(record, place = -1) {
    const partner = place < 0 ? this.records.findIndex((other) => complementary(other, record)) : -1;
    if (partner >= 0) return this.join(partner, record);
    const same = this.records.findIndex((other) => key(other) === key(record));
    this.put(record, place < 0 ? same : place);
  }

  put(record, place) {
    const index = place < 0 ? this.records.length : place;
    record.chosen = this.records[index]?.chosen;
    this.records.splice(index, 1, record);
    this.update();
  }

  /** Join the files of two records into one record. */
  async join(place, record) {
    const files = [...this.records[place].files, ...record.files].map(({ file, part }) => ({ file, part }));
    this.put(await this.inspect(files), place);
  }

  /** All records have the columns of the first one. Unless chosen otherwise it is for identification and the others are
   * for validation; a single long record is split. */
  update() {
    const first = this.records.length > 1 || this.records[0]?.rows < LONG ? "identify" : "split";
    this.records.forEach((record, place) => { record.use = record.chosen ?? (place ? "validate" : first); });
    if (this.first !== this.records[0]) {
      this.first = this.records[0];
      this.columns = this.first?.columns.map((column) => ({ ...column, unit: column.unit ?? usualUnit(column.role) }));
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
    this.records.forEach((record, place) => this.recordRow(record, place, row(table, "td", [recordName(record), "", record.rows, "", ""])));
    const split = this.records.some(({ use }) => use === "split") ? "The last third of the record is for validation: the model is not fitted to it. " : "";
    element(this.root, "p", { class: "quiet" }, `${split}Check the role and the unit of each column: the units set the scale of every parameter.`);
    this.columnTable();
    this.confirmation();
  }

  recordRow(record, place, cells) {
    this.partChoice(record, place, cells[1]);
    const above = this.records[place - 1];
    const joins = above && !above.files[0].kind && above.rows === record.rows ? [["join", "columns of the record above"]] : [];
    const use = select(cells[3], [...USES, ...joins], record.use, `Use of ${recordName(record)}`);
    use.addEventListener("change", () => this.setUse(record, place, use.value));
    const button = element(cells[4], "button", { type: "button", "aria-label": `Remove ${recordName(record)}` }, "Remove");
    button.addEventListener("click", () => { this.records.splice(place, 1); this.update(); });
    const difference = this.difference(record);
    if (difference) element(cells[4], "span", { class: "warn" }, ` has ${difference}`);
  }

  setUse(record, place, use) {
    if (use !== "join") return Object.assign(record, { use, chosen: use }) && this.show();
    this.records.splice(place, 1);
    this.join(place - 1, record).catch(() => { this.records.splice(place, 0, record); this.update(); });
  }

  /** How the files or columns of a record differ from those of the first one, as text; empty if they do not. */
  difference(record) {
    if (record.files.length !== this.first.files.length) return "other files than the first record";
    if (record.files.length > 1) return "";
    const headers = record.columns.map((column) => column.header);
    const missing = this.columns.filter(({ header, role }) => role && header && !headers.includes(header));
    return missing.length ? `no column ${missing.map(({ header }) => header).join(", ")}` : "";
  }

  /** A choice of the table or sheet of a file, and a button that adds another one as a further record. */
  partChoice({ files: [file] }, place, cell) {
    const parts = Object.entries(file.parts);
    if (!parts.length) return;
    const list = select(cell, parts, file.part, `Table or sheet of ${file.file}`);
    const addPart = async (part, index) => this.add(await this.inspect([{ file: file.file, part }]), index);
    list.addEventListener("change", () => addPart(list.value, place).catch(() => { list.value = file.part; }));
    const taken = this.records.filter(({ files: [other] }) => other.file === file.file).map(({ files: [other] }) => other.part);
    const unused = parts.map(([word]) => word).filter((word) => !taken.includes(word));
    const following = unused.find((word) => parts.findIndex(([other]) => other === word) > parts.findIndex(([other]) => other === file.part)) ?? unused[0];
    if (following) element(cell, "button", { type: "button" }, "Add another").addEventListener("click", () => addPart(following).catch(() => {}));
  }

  columnTable() {
    const table = element(element(this.root, "div", { class: "wide" }), "table", { class: "guessed" });
    const several = this.first.files.length > 1;
    row(table, "th", ["column", "role", "unit", "minimum", "maximum", "preview", "first values"]);
    for (const column of this.columns) {
      const title = column.header || `column ${column.number}`;
      const file = several ? fileName(this.first.files[column.of].file) : "";
      const name = file && !file.startsWith(title) ? `${file}: ${title}` : file || title;
      const cells = row(table, "td", [name, "", "", number(column.low, 4), number(column.high, 4), "", column.first.map((value) => number(value, 4)).join("  ")]);
      const role = select(cells[1], ROLES, column.role, `Role of ${name}`);
      const unit = element(cells[2], "input", { "aria-label": `Unit of ${name}`, value: column.unit, placeholder: "unit" });
      drawPreview(cells[5], column.shape, name);
      role.addEventListener("change", () => this.setRole(column, role.value));
      unit.addEventListener("input", () => { column.unit = unit.value; });
    }
  }

  /** Give a column a role; the column that had it loses it. */
  setRole(column, role) {
    for (const other of this.columns) if (other.role === role) other.role = "";
    Object.assign(column, { role, unit: column.unit || usualUnit(role) });
    this.show();
  }

  confirmation() {
    const { bar } = this;
    this.field(bar, "Name of the job ", "name", {});
    if (!this.columns.some(({ role }) => role === "time")) this.field(bar, "No time column. Sample rate ", "rate", { placeholder: "1 kHz" });
    const button = element(bar, "button", { type: "button", class: "strong", id: "confirm" }, "Confirm and identify");
    button.addEventListener("click", () => this.confirm(() => this.form()));
  }

  field(bar, text, key, attributes) {
    const input = element(element(bar, "label", {}, text), "input", { value: this[key], ...attributes });
    input.addEventListener("input", () => { this[key] = input.value; });
  }

  /** The form that the server makes a job of, without the model. Throws an Error if something is missing. */
  form() {
    const columnOf = (role) => this.columns.find((column) => column.role === role);
    const axes = {};
    for (const axis of AXES) {
      const [drive, response] = [columnOf(`${axis}.drive`), columnOf(`${axis}.response`)];
      if (drive) axes[axis] = { drive: this.channel(drive), ...(response && { response: this.channel(response) }) };
      else if (response) throw new Error(`Which column is the drive of ${axis}?`);
    }
    if (!Object.values(axes).some(({ response }) => response)) throw new Error("Which columns are the drive and the response? At least one axis needs both. If they are in separate files, drop these too.");
    if (!columnOf("time") && !this.rate) throw new Error("Which column is the time? Or give the sample rate.");
    if (this.records.every(({ use }) => use === "validate")) throw new Error("There is no identification record: choose one.");
    return {
      name: this.name || "my-stage",
      records: this.records.map((record) => this.recordForm(record)),
      time: columnOf("time") ? this.channel(columnOf("time")) : null,
      sample_rate: columnOf("time") ? null : this.rate,
      axes,
    };
  }

  /** A column by its heading if that is unique, else by its number; by its unit alone where a record is several files,
   * since the records then name the columns. */
  channel({ header, number, unit, role }) {
    if (this.first.files.length > 1) return { unit: unit || usualUnit(role) };
    const unique = this.columns.filter((other) => other.header === header).length === 1;
    return { header: unique ? header : "", number, unit: unit || usualUnit(role) };
  }

  recordForm({ files, use, rows, columns }) {
    const [{ file, kind, part }] = files;
    const time = this.columns.find(({ role }) => role === "time");
    const timestamps = time && columns.find(({ number, of }) => number === time.number && of === time.of);
    const channels = files.length > 1 ? this.columns.filter(({ role }) => role).map(({ role, number, of }) => [role, { file: files[of]?.file ?? "", number }]) : [];
    return { file, use, rows, ...(timestamps && { span: timestamps.high - timestamps.low }), ...(kind && { [kind]: part }), channels: Object.fromEntries(channels) };
  }
}

/** Whether two records of the same length have different roles that make one record together. */
function complementary(record, other) {
  const [roles, otherRoles] = [record, other].map(({ columns }) => columns.map(({ role }) => role).filter(Boolean));
  const complete = (list) => ["x.drive", "x.response"].every((role) => list.includes(role));
  const joinable = record.rows === other.rows && !record.files[0].kind && !other.files[0].kind && key(record) !== key(other);
  return joinable && !roles.some((role) => otherRoles.includes(role)) && !(complete(roles) && complete(otherRoles)) && !(complete(roles) && !otherRoles.length);
}

/** The name of a record: its files. */
function recordName({ files }) {
  return files.map(({ file }) => fileName(file)).join(" + ");
}

/** A key that identifies a record by its files and their parts. */
function key({ files }) {
  return JSON.stringify(files.map(({ file, part }) => [file, part]));
}

/** A small plot of a column. */
function drawPreview(cell, shape, name) {
  const points = shape.map((value, place) => `${place},${(20 * (1 - value)).toFixed(1)}`).join(" ");
  const svg = svgElement(cell, "svg", { viewBox: `0 -1 ${shape.length} 22`, preserveAspectRatio: "none", class: "shape", role: "img", "aria-label": `Preview of ${name}` });
  svgElement(svg, "polyline", { points, "vector-effect": "non-scaling-stroke" });
}
