import { element } from "./explorer.js";
import { number } from "./signals.js";

const ROLES = [["", "not used"], ["time", "time"], ["drive", "drive"], ["response", "response"], ["other", "drive of the other axis"]];
const USUAL = { time: "s", drive: "V", response: "um", other: "V" };

/** The columns of dropped files, as they were guessed, to be confirmed. */
export class Columns {
  constructor(root, confirm) {
    Object.assign(this, { root, confirm, files: [] });
  }

  add(found) {
    this.files = [...this.files.filter((file) => file.file !== found.file), found];
    if (this.files.length === 1) this.columns = found.columns.map((column) => ({ ...column }));
    this.show();
  }

  show() {
    this.root.replaceChildren();
    const files = element(this.root, "table", { class: "files" });
    row(files, "th", ["file", "rows", "use", ""]);
    this.files.forEach((file, place) => {
      const cells = row(files, "td", [file.file, file.rows, "", ""]);
      const use = select(cells[2], [["identify", "identify: fit it"], ["validate", "validate: keep it back"]], file.use ?? (place ? "validate" : "identify"), `Use of ${file.file}`);
      use.addEventListener("change", () => { file.use = use.value; });
      file.use = use.value;
      const drop = element(cells[3], "button", { type: "button" }, "Take off");
      drop.addEventListener("click", () => { this.files.splice(place, 1); this.files.length ? this.show() : this.root.replaceChildren(); });
    });
    this.table();
    this.last();
  }

  table() {
    const table = element(this.root, "table", { class: "guessed" });
    row(table, "th", ["column", "it is", "unit", "from", "to", "first values"]);
    for (const column of this.columns) {
      const cells = row(table, "td", [column.header || `column ${column.number}`, "", "", number(column.low, 4), number(column.high, 4), column.first.map((value) => number(value, 4)).join("  ")]);
      const role = select(cells[1], ROLES, column.role, `Role of ${column.header || column.number}`);
      const unit = element(cells[2], "input", { "aria-label": `Unit of ${column.header || column.number}`, value: column.unit ?? USUAL[column.role] ?? "", placeholder: "unit" });
      column.unit ??= unit.value || null;
      role.addEventListener("change", () => { column.role = role.value; unit.value ||= USUAL[role.value] ?? ""; column.unit = unit.value; });
      unit.addEventListener("input", () => { column.unit = unit.value; });
    }
  }

  last() {
    const bar = element(this.root, "div", { class: "bar" });
    this.rate = element(element(bar, "label", {}, "Sample rate, without a time column "), "input", { placeholder: "1 kHz" });
    this.name = element(element(bar, "label", {}, "Name "), "input", { value: "my-stage" });
    const go = element(bar, "button", { type: "button", class: "strong", id: "confirm" }, "Confirm and identify");
    go.addEventListener("click", () => this.confirm(this.form()));
  }

  form() {
    const of = (role) => this.columns.find((column) => column.role === role);
    const place = (column) => ({ header: column.header, number: column.number, unit: column.unit || USUAL[column.role] });
    for (const role of ["drive", "response"]) if (!of(role)) throw new Error(`Which column is the ${role}?`);
    if (!of("time") && !this.rate.value) throw new Error("Which column is the time? Or give the sample rate.");
    const axes = { x: { drive: place(of("drive")), response: place(of("response")) } };
    if (of("other")) axes.y = { drive: place(of("other")) };
    return {
      name: this.name.value || "my-stage",
      records: this.files.map(({ file, use }) => ({ file, use })),
      time: of("time") ? place(of("time")) : null,
      sample_rate: of("time") ? null : this.rate.value,
      axes,
      model: ["bouc_wen"],
    };
  }
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
