// The records of a measurement before there is a job: files, columns with their roles, rows and use. Nothing here draws.

import { short } from "./scale.js";

export const AXES = ["x", "y", "z"];
export const ROLES = [["", "not used"], ["time", "time"], ...AXES.flatMap((axis) => [[`${axis}.drive`, `drive of ${axis}`], [`${axis}.response`, `response of ${axis}`]])];
export const USES = [["identify", "identification (fitted)"], ["validate", "validation (not fitted)"], ["split", "both: the end for validation"]];
const USUAL_UNITS = { time: "s", drive: "V", response: "um" };
const LONG = 600; // rows; a single record of at least this length is split

export const usualUnit = (role) => USUAL_UNITS[role.split(".").at(-1)] ?? "";
/** A unit as it is printed. */
export const printed = (unit) => unit.replace(/^u(?=[a-zA-Z])/, "µ");
export const fileName = (path) => path.split("/").at(-1);

/** A role such as "x.drive" as it is said. */
export const said = (role) => Object.fromEntries(ROLES)[role];

/** The name of a record: its files, and the table or sheet. */
export function recordName({ files }) {
  const names = files.map(({ file }) => fileName(file)).join(" + ");
  return files[0].part && Object.keys(files[0].parts ?? {}).length > 1 ? `${names}: ${files[0].parts[files[0].part] ?? files[0].part}` : names;
}

/** A key that identifies a record by its files and their parts. */
export function keyOf({ files }) {
  return JSON.stringify(files.map(({ file, part }) => [file, part ?? null]));
}

/** The records of one measurement. `columns` are those of the first one, with the roles and units that hold for all. */
export class Records {
  constructor() {
    Object.assign(this, { list: [], columns: [], name: "my-stage", rate: "", first: null });
  }

  /** The unit of what stands for time. */
  get clock() { return this.timed ? "s" : "samples"; }

  get files() { return this.list.flatMap(({ files }) => files.map(({ file }) => file)); }

  /** Put in a record in the place of another, or at the end. */
  put(record, place = -1) {
    const same = place < 0 ? this.list.findIndex((other) => keyOf(other) === keyOf(record)) : place;
    const index = same < 0 ? this.list.length : same;
    Object.assign(record, { chosen: this.list[index]?.chosen, settle: 0, rows: record.rows, crop: [0, record.rows], split: Math.floor((2 * record.rows) / 3) });
    this.list.splice(index, 1, record);
    this.update();
  }

  drop(place) {
    this.list.splice(place, 1);
    this.update();
  }

  /** A record whose columns complete the ones of `record`, such as one file a signal; -1 if there is none. */
  partner(record) {
    return this.list.findIndex((other) => complementary(other, record));
  }

  /** Unless chosen otherwise the first record is for identification and the others are for validation; a single long
   * record is for both. */
  update() {
    const first = this.list.length > 1 || this.list[0]?.rows < LONG ? "identify" : "split";
    this.list.forEach((record, place) => { record.use = record.chosen ?? (place ? "validate" : first); });
    if (this.first === this.list[0]) return;
    this.first = this.list[0];
    this.columns = this.first?.columns.map((column) => ({ ...column, stated: column.unit, unit: column.unit ?? usualUnit(column.role) })) ?? [];
    this.rate = this.first?.rate || this.rate;
  }

  columnOf(role) { return this.columns.find((column) => this.roleOf(column) === role); }

  /** The signals to be plotted, whether a model can be made of them or not: of each axis the columns of its drive and
   * its response, one of which may be missing; where there is neither, the first column that is not the time. */
  get signals() {
    const column = (role) => this.columns.find((other) => other.role === role);
    const pairs = AXES.map((axis) => ({ axis, drive: column(`${axis}.drive`), response: column(`${axis}.response`) })).filter(({ drive, response }) => drive || response);
    const other = this.columns.find(({ role }) => role !== "time");
    return pairs.length || !other ? pairs : [{ axis: "", response: other }];
  }

  /** The role of a column; one that is constant in every record is neither drive nor response. */
  roleOf(column) { return column.role.includes(".") && this.constant(column) ? "" : column.role; }

  /** The lowest and the highest value of a column in some records, all of them unless told. */
  range({ header, number: place, of }, records = this.list) {
    const same = (other) => (header ? other.header === header : other.number === place && other.of === of);
    const columns = records.flatMap((record) => record.columns.filter(same));
    return [Math.min(...columns.map(({ low }) => low)), Math.max(...columns.map(({ high }) => high))];
  }

  constant(column, records = this.list) {
    const [low, high] = this.range(column, records);
    return !(low < high);
  }

  /** The columns that would be drive or response if they moved. */
  get still() { return this.columns.filter((column) => column.role && !this.roleOf(column)); }

  level({ low, unit }) { return `${short(low)} ${printed(unit)}`.trim(); }

  /** The roles that a column may be given. */
  rolesOf(column) { return this.constant(column) ? ROLES.filter(([role]) => !role.includes(".")) : ROLES; }

  /** What is missing before a job can be made, as a sentence; empty where nothing is. */
  get missing() {
    const needed = ({ role }) => !this.axes().length || (role.endsWith(".drive") && this.columnOf(`${role[0]}.response`));
    const still = this.still.find(needed);
    if (still) return `${this.columnName(still)} is constant at ${this.level(still)}: give the ${said(still.role)} another column, or drop a record in which it moves.`;
    for (const axis of AXES) if (this.columnOf(`${axis}.response`) && !this.columnOf(`${axis}.drive`)) return `Which column is the drive of ${axis}?`;
    if (!this.axes().length) return "Which columns are the drive and the response? At least one axis needs both. If they are in separate files, drop these too.";
    if (!this.timed) return "Which column is the time? Or give the sample rate, such as 5 kHz.";
    const fitted = this.list.filter(({ use }) => use !== "validate");
    if (!fitted.length) return "There is no identification record: choose one.";
    for (const axis of this.axes())
      for (const column of ["drive", "response"].map((signal) => this.columnOf(`${axis}.${signal}`)))
        if (this.constant(column, fitted)) return `${this.columnName(column)} is constant in the identification records: choose a record in which it moves for identification.`;
    return "";
  }

  /** The sample rate in Hz of records without a column of time, as it is typed; null if it is not given. */
  get hertz() {
    const [, value, prefix] = /^\s*([\d.]+(?:e[+-]?\d+)?)\s*([kM]?)Hz\s*$/i.exec(this.rate) ?? [];
    return Number(value) > 0 ? Number(value) * ({ k: 1e3, M: 1e6 }[prefix] ?? 1) : null;
  }

  /** Whether it is known how much time lies between two samples. */
  get timed() { return Boolean(this.columnOf("time") || this.hertz); }

  /** The axes that have a drive and a response. */
  axes() { return AXES.filter((axis) => this.columnOf(`${axis}.drive`) && this.columnOf(`${axis}.response`)); }

  /** Give a column a role, and the usual unit where neither its heading nor the user states one; the column that had
   * the role loses it. */
  setRole(column, role) {
    for (const other of this.columns) if (role && other.role === role) other.role = "";
    const unit = column.stated || (column.unit === usualUnit(column.role) ? "" : column.unit);
    Object.assign(column, { role, unit: unit || usualUnit(role) });
  }

  columnName(column) {
    const title = column.header || `column ${column.number}`;
    const file = this.first.files.length > 1 ? fileName(this.first.files[column.of].file) : "";
    return file && !file.startsWith(title) ? `${file}: ${title}` : file || title;
  }

  /** How the files or columns of a record differ from those of the first one, as text; empty if they do not. */
  difference(record) {
    if (record.files.length !== this.first.files.length) return "other files than the first record";
    if (record.files.length > 1) return "";
    const headers = record.columns.map((column) => column.header);
    const missing = this.columns.filter(({ header, role }) => role && header && !headers.includes(header));
    return missing.length ? `no column ${missing.map(({ header }) => header).join(", ")}` : "";
  }

  /** What a reload must bring back. */
  draft() {
    return {
      name: this.name, rate: this.rate,
      records: this.list.map(({ files, chosen, crop, settle, split }) => ({ files: files.map(({ file, part }) => ({ file, part })), chosen, crop, settle, split })),
      columns: this.columns.map(({ of, number, role, unit }) => ({ of, number, role, unit })),
    };
  }

  /** Take over the choices of a draft for records that have been put in again. */
  restore({ name, rate, records, columns }) {
    for (const saved of records) {
      const record = this.list.find((item) => keyOf(item) === keyOf(saved));
      if (record) Object.assign(record, { chosen: saved.chosen, crop: saved.crop, settle: saved.settle, split: saved.split });
    }
    this.update();
    for (const saved of columns) {
      const column = this.columns.find(({ of, number }) => of === saved.of && number === saved.number);
      if (column) Object.assign(column, { role: saved.role, unit: saved.unit });
    }
    Object.assign(this, { name, rate });
  }

  /** The form that the server makes a job of, without the model. */
  form() {
    const axes = {};
    for (const axis of AXES) {
      const [drive, response] = [this.columnOf(`${axis}.drive`), this.columnOf(`${axis}.response`)];
      if (drive) axes[axis] = { drive: this.channel(drive), ...(response && { response: this.channel(response) }) };
    }
    const time = this.columnOf("time");
    return {
      name: this.name || "my-stage",
      records: this.list.flatMap((record) => this.recordForms(record)),
      time: time ? this.channel(time) : null, sample_rate: time ? null : this.rate, axes,
    };
  }

  /** A column by its heading if that is unique, else by its number; by its unit alone where a record is several files,
   * since the records then name the columns. */
  channel({ header, number, unit, role }) {
    if (this.first.files.length > 1) return { unit: unit || usualUnit(role) };
    const unique = this.columns.filter((other) => other.header === header).length === 1;
    return { header: unique ? header : "", number, unit: unit || usualUnit(role) };
  }

  /** One record of the job, or two of the same rows: the first part for identification, and all of it for validation
   * with only its end scored, so that the model has the history of the stage there. */
  recordForms(record) {
    const { files, use, rows, columns, crop: [from, to], settle, split } = record;
    const [{ file, kind, part }] = files;
    const time = this.columnOf("time");
    const stamps = time && columns.find(({ number, of }) => number === time.number && of === time.of);
    const channels = files.length > 1 ? this.columns.filter((column) => this.roleOf(column)).map(({ role, number, of }) => [role, { file: files[of]?.file ?? "", number }]) : [];
    const form = { file, rows, ...(stamps && { span: stamps.high - stamps.low }), ...(kind && { [kind]: part }), channels: Object.fromEntries(channels) };
    const whole = from === 0 && to === rows;
    const cropped = (first, end) => (whole && end === rows ? {} : { crop: [first, end] });
    const settled = settle > 0 ? { settle: `${Number(settle.toPrecision(9))} s` } : {};
    if (use !== "split") return [{ ...form, use, ...cropped(from, to), ...settled }];
    if (whole && split === Math.floor((2 * rows) / 3) && !settle) return [{ ...form, use: "split" }];
    const history = `${Number(((split - from) * record.dt).toPrecision(9))} s`;
    return [{ ...form, use: "identify", crop: [from, split], ...settled }, { ...form, use: "validate", ...cropped(from, to), settle: history }];
  }
}

/** Move the first row of a record that is taken, the last one, the one from which on it is for validation, or the time
 * that is not scored. All stay within the rows, and two thirds are fitted where the rows leave nothing on one side. */
export function crop(record, { from = record.crop[0], to = record.crop[1], split = null, settle = record.settle }) {
  const [first, end] = [clamp(from, 0, record.crop[1] - 10), clamp(to, record.crop[0] + 10, record.rows)];
  const within = clamp(split ?? record.split, first + 5, end - 5);
  record.crop = [first, end];
  record.split = split === null && within !== record.split ? first + Math.floor((2 * (end - first)) / 3) : within;
  const fitted = (record.use === "split" ? record.split : end) - first;
  record.settle = clamp(settle, 0, 0.9 * fitted * record.dt);
}

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** Whether two records of the same length have different roles that make one record together. */
function complementary(record, other) {
  const [roles, otherRoles] = [record, other].map(({ columns }) => columns.map(({ role }) => role).filter(Boolean));
  const complete = (list) => ["x.drive", "x.response"].every((role) => list.includes(role));
  const joinable = record.rows === other.rows && !record.files[0].kind && !other.files[0].kind && keyOf(record) !== keyOf(other);
  return joinable && !roles.some((role) => otherRoles.includes(role)) && !(complete(roles) && complete(otherRoles)) && !(complete(roles) && !otherRoles.length);
}
