import { Columns } from "./columns.js";
import { Handles } from "./handles.js";
import { element } from "./parts.js";
import { crop, keyOf, printed, Records, recordName, said } from "./records.js";
import { short } from "./scale.js";
import { requestJson } from "./session.js";
import { number } from "./signals.js";

const PAUSE = 400; // ms without a change after which the choices are stored

/** The measurement before there is a job: loop and time plot at once, what was guessed, and the choices in the panel.
 * `page` has explorer(records, floors), fail(error), confirm(form), changed(), draftModel() and setDraftModel(words). */
export class Measurement {
  constructor(panel, facts, page) {
    Object.assign(this, { facts, page, records: new Records(), measured: new Map() });
    this.columns = new Columns(panel, this.records, {
      inspect: (files) => this.inspect(files), put: (record, place) => this.add(record, place), join: (place) => this.joinAbove(place),
      changed: (redraw = true) => this.changed(redraw), upload: (files) => this.page.upload(files), confirm: () => this.confirm(),
    });
    addEventListener("pagehide", () => this.waiting && this.store());
  }

  get empty() { return this.records.list.length === 0; }

  /** The columns of files of the folder, or of their tables or sheets, that make one record. */
  async inspect(files) {
    try {
      return await requestJson("look", { files });
    } catch (error) {
      this.page.fail(error);
      throw error;
    }
  }

  /** Add the columns of a file as a new record, in the place of an old one, or to a record that they complete. */
  async add(record, place = -1) {
    const partner = place < 0 ? this.records.partner(record) : -1;
    if (partner >= 0) {
      const files = [...this.records.list[partner].files, ...record.files].map(({ file, part }) => ({ file, part }));
      return this.add(await this.inspect(files), partner);
    }
    this.records.put(record, place);
    this.changed();
  }

  async joinAbove(place) {
    const [record] = this.records.list.splice(place, 1);
    const files = [...this.records.list[place - 1].files, ...record.files].map(({ file, part }) => ({ file, part }));
    try {
      await this.add(await this.inspect(files), place - 1);
    } catch {
      this.records.list.splice(place, 0, record);
      this.changed();
    }
  }

  /** Fetch the signals of all records, with the roles as they are chosen, and what they seem to be. */
  async measure() {
    const asked = JSON.stringify({
      records: this.records.list.map(({ files }) => ({ files: files.map(({ file, part }) => ({ file, part })) })),
      columns: Object.fromEntries([this.records.columnOf("time"), ...this.records.signals.flatMap(({ drive, response }) => [drive, response])].filter(Boolean).map((column) => [keyOfSignal(column), { number: column.number, of: column.of, unit: column.unit }])),
    });
    if (this.empty) return;
    if (asked === this.asked) return this.time();
    this.asked = asked;
    try {
      const { records, guess } = await requestJson("measurement", JSON.parse(asked));
      if (asked !== this.asked) return;
      this.guess = guess;
      this.measured.clear();
      records.forEach((signals, place) => this.take(this.records.list[place], signals));
    } catch (error) {
      if (asked === this.asked) this.page.fail(error);
    }
  }

  take(record, { t0, dt, positions, channels }) {
    const values = Object.fromEntries(Object.entries(channels).map(([role, { data }]) => [role, decoded(data)]));
    this.measured.set(keyOf(record), { values, places: positions && new Int32Array(bytesOf(positions).buffer) });
    const own = this.records.columnOf("time");
    Object.assign(record, { dt: own ? dt : 1 / (this.records.hertz ?? 1), t0: own ? t0 : 0 });
  }

  /** Records without a column of time follow the rate that is typed. */
  time() {
    if (!this.records.columnOf("time")) for (const record of this.records.list) Object.assign(record, { dt: 1 / (this.records.hertz ?? 1), t0: 0 });
  }

  /** Bring back, once, the choices that a reload interrupted. */
  restore(draft) {
    if (this.empty && !this.restored && draft?.records?.length) this.restored = this.restoreNow(draft);
  }

  async restoreNow(draft) {
    for (const { files } of draft.records)
      try {
        this.records.put(await this.inspect(files));
      } catch { /* shown by inspect */ }
    this.records.restore(draft);
    if (draft.model) this.page.setDraftModel(draft.model);
    await this.measure();
    this.show();
    this.page.changed();
  }

  changed(redraw = true) {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.store(), PAUSE);
    if (redraw) this.show();
    this.measure().then(() => this.show());
    this.page.changed();
  }

  store() {
    clearTimeout(this.waiting);
    this.waiting = null;
    requestJson("draft", { ...this.records.draft(), model: this.page.draftModel() }).catch((error) => this.page.fail(error));
  }

  show() {
    this.columns.show();
    if (this.empty) return;
    const shown = this.plotted();
    if (shown.length) {
      this.explorer = this.page.explorer(shown, {});
      this.handles ??= new Handles(this.explorer.response.plot, (done) => this.moved(done));
      this.explorer.onChoose = () => this.showHandles();
      this.showHandles();
    }
    this.showGuess();
  }

  /** The records as the explorer shows them: an entry for each axis. */
  plotted() {
    return this.records.list.flatMap((record) => {
      const signals = this.measured.get(keyOf(record));
      return signals ? this.records.signals.map((pair) => this.entry(record, signals, pair)).filter(Boolean) : [];
    });
  }

  /** A record with the signals of an axis; `alone`: what the one of two signals is that is there. */
  entry(record, signals, { axis, drive, response }) {
    const [u, y] = [drive, response].map((column) => column && signals.values[keyOfSignal(column)]), values = y ?? u;
    if (!values) return null;
    const index = Float64Array.from(signals.places ?? values.keys()), unitOf = (column) => printed((column ?? drive ?? response).unit || "1");
    return {
      source: record, name: recordName(record), use: record.use === "split" ? "" : record.use, axis, unit: unitOf(response), driveUnit: unitOf(drive), start: record.t0, dt: record.dt,
      samples: record.rows, settle: 0, index, timeLabel: this.records.timed ? "time [s]" : "sample", time: index.map((i) => record.t0 + i * record.dt), drive: u ?? values, response: values, models: [], counts: index,
      alone: u && y ? "" : axis ? (u ? "drive" : "response") : this.records.columnName(response), strips: () => strips(record),
    };
  }

  showHandles() {
    const entry = this.explorer?.record, record = entry?.source;
    if (!record) return this.handles?.show([]);
    const seconds = (i) => record.t0 + i * record.dt, sample = (value) => Math.round((value - record.t0) / record.dt);
    const handles = [
      { name: "start", kind: "crop", read: () => seconds(record.crop[0]), write: (value) => crop(record, { from: sample(value) }) },
      { name: "not scored", kind: "settle", read: () => seconds(record.crop[0]) + record.settle, write: (value) => crop(record, { settle: value - seconds(record.crop[0]) }) },
      { name: "end", kind: "crop end", read: () => seconds(record.crop[1]), write: (value) => crop(record, { to: sample(value) }) },
    ];
    if (record.use === "split") handles.push({ name: "validation from here", kind: "split", read: () => seconds(record.split), write: (value) => crop(record, { split: sample(value) }) });
    this.handles.show(handles);
  }

  moved(done) {
    this.explorer.response.plot.scene.strips = strips(this.explorer.record.source);
    this.explorer.response.plot.draw();
    if (done) { this.columns.show(); this.changed(false); }
  }

  /** What was guessed, as words and numbers. */
  showGuess() {
    this.facts.replaceChildren();
    const record = this.records.first, { guess } = this;
    element(this.facts, "h2", {}, "Read from the measurement");
    const list = element(this.facts, "dl", { class: "facts" });
    const fact = (term, text) => { if (text) { element(list, "dt", {}, term); element(list, "dd", {}, text); } };
    for (const axis of this.records.axes())
      for (const role of ["drive", "response"]) {
        const column = this.records.columnOf(`${axis}.${role}`);
        fact(`${role} of ${axis}`, `${this.records.columnName(column)}, ${this.records.range(column).map(short).join(" to ")} ${printed(column.unit)}`);
      }
    for (const column of this.records.still) fact(said(column.role), `${this.records.columnName(column)} is constant at ${this.records.level(column)}`);
    const { clock, timed } = this.records;
    fact("samples", `${this.records.list.map(({ rows }) => rows).join(", ")}${record.dt && timed ? `, ${short(record.rows * record.dt)} s` : ""}`);
    fact("missing values", this.records.columns.filter((column) => this.records.roleOf(column) && column.missing).map((column) => `${column.missing} of ${this.records.columnName(column)}: crop the record, or fill the gaps in the file`).join("; "));
    if (!guess) return;
    fact("sample rate", timed ? `${short(1 / record.dt)} Hz` : "not known: give it above the columns");
    const usable = (facts) => Object.entries(facts).filter(([axis]) => this.records.axes().includes(axis));
    for (const [axis, { value, unit }] of usable(guess.amplitude)) fact(`span of the drive of ${axis}`, `${short(value)} ${unit}`);
    for (const [axis, value] of usable(guess.frequency)) fact(`main frequency of ${axis}`, value && timed ? `${number(guess.rate ? value / guess.rate / record.dt : value, 3)} Hz` : "");
    const rests = guess.rests.flat();
    if (this.records.axes().length) fact("rests", rests.length ? rests.slice(0, 3).map(([a, b]) => `${short(a)} to ${short(b)} ${clock}`).join("; ") + (rests.length > 3 ? ` and ${rests.length - 3} more` : "") : "none");
    for (const [axis, floor] of usable(guess.noise_floor)) fact(`noise floor of ${axis}`, floor?.value ? `${number(floor.value, 2)} ${floor.unit}, from ${floor.source}` : "not known");
    if (timed) for (const { record: name, said: what } of guess.faults) fact(guess.rests.length > 1 ? `readings of ${name}` : "readings", what);
  }

  /** There is a job now: the panes are its own. */
  leave() {
    this.handles?.show([]);
    if (this.explorer) this.explorer.onChoose = null;
  }

  confirm() {
    const { missing } = this.records;
    if (missing) this.page.fail({ message: missing });
    else this.page.confirm(this.records.form());
  }
}

/** The name under which a column is asked for: its role, or none that the server knows. */
function keyOfSignal({ role }) { return role || "shown"; }

/** Bands over time: what is cropped or not scored, and the part for validation. */
function strips({ t0, dt, rows, crop: [from, to], settle, split, use }) {
  const at = (i) => t0 + i * dt;
  const bands = [{ from: at(0), to: at(from), colour: "--cropped" }, { from: at(to), to: at(rows), colour: "--cropped" }, { from: at(from), to: at(from) + settle, colour: "--unscored" }];
  if (use !== "identify") bands.push({ from: at(use === "split" ? split : from), to: at(to), colour: "--noise" });
  return bands.filter((band) => band.to > band.from);
}

/** Little-endian 32-bit floats from base64. */
function decoded(data) {
  return Float64Array.from(new Float32Array(bytesOf(data).buffer));
}

function bytesOf(data) {
  return Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
}
