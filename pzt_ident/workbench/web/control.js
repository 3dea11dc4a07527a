import { Figure } from "./figure.js";
import { element } from "./parts.js";
import { printed } from "./records.js";
import { once, request, requestJson, save } from "./session.js";
import { extent, number } from "./signals.js";
import { plain, typed } from "./slider.js";

const COLOURS = ["--identify", "--validate", "--third", "--fourth", "--before"];
const DASHES = [[6, 3], [], [2, 2], [8, 2, 2, 2], [4, 2]];
const KINDS = { error: "Error", displacement: "Displacement", drive: "Drive" };

/** The model put to work: a reference to follow, the error of each way to follow it, and the drive as a file. `page` has
 * act(name, body), fail(error) and clear(). */
export class Control {
  constructor(root, page) {
    Object.assign(this, { root, page, key: "", reference: null, file: null, typed: null });
  }

  show({ result, control, job, at }) {
    const key = JSON.stringify([Boolean(result), control, at]);
    if (key === this.key) return;
    this.key = key;
    this.root.replaceChildren();
    if (!result) return void element(this.root, "p", { class: "quiet" }, "When the model has been identified, a reference can be dropped here for the stage to follow.");
    this.form(job);
    if (control) this.showWays(control);
  }

  form(job) {
    element(this.root, "h2", {}, "Follow a reference");
    const drop = element(this.root, "div", { class: "card drop" });
    const choose = element(element(drop, "label", {}, "Drop or choose a CSV with time and displacement "), "input", { type: "file", accept: ".csv,.txt,.tsv" });
    const facts = element(drop, "p", { class: "quiet", role: "status" }, this.reference ? said(this.reference) : "");
    const take = async (file) => {
      if (!file) return;
      this.file = file;
      try {
        this.reference = await (await request(`reference?name=${encodeURIComponent(file.name)}&rate=${encodeURIComponent(this.typed.rate ?? "")}`, file, true)).json();
        facts.textContent = said(this.reference);
        this.page.clear();
      } catch (error) { this.page.fail(error); }
    };
    choose.addEventListener("change", () => take(choose.files[0]));
    for (const kind of ["dragover", "drop"])
      drop.addEventListener(kind, (event) => {
        event.preventDefault();
        event.stopPropagation();
        if (kind === "drop") take(event.dataTransfer.files[0]);
      });
    this.fields(job).rate.addEventListener("change", () => take(this.file));
    const start = element(this.root, "button", { type: "button", class: "strong", "data-acts": "", id: "follow" }, "Compute drive and errors");
    start.addEventListener("click", () => {
      if (!this.reference) return choose.focus();
      const { low, high, ...options } = this.typed, limits = [low, high].map((value) => typed({ value }));
      if ((low || high) && limits.includes(null)) return this.page.fail({ message: "Give the lowest and the highest drive as numbers, or neither." });
      this.page.act("control", { reference: this.reference.file, options: { ...options, ...(low && { limits }) } });
    });
  }

  /** What the amplifier can do, and how the reference is to be followed, by name; what is typed is kept. */
  fields(job) {
    const [low, high] = job?.limits?.drive ?? [], unit = Object.values(job?.drive_units ?? {})[0] ?? "";
    this.typed ??= { low: plain(low), high: plain(high), slew: plain(job?.limits?.slew), current: "", capacitance: "", noise_gain: "10", rate: "" };
    const made = {};
    for (const line of [[["low", "Drive from"], ["high", "to", unit]], [["slew", "Slew rate at most", `${unit}/s`]], [["current", "Amplifier current", "", "50 mA"], ["capacitance", "capacitance", "", "1.8 uF"]], [["noise_gain", "Noise gain at most"]], [["rate", "Sample rate without a time column", "", "10 kHz"]]]) {
      const bar = element(this.root, "p", { class: "bar" });
      for (const [name, text, shown = "", placeholder = ""] of line) {
        const label = element(bar, "label", {}, `${text} `);
        made[name] = element(label, "input", { value: this.typed[name], size: 6, placeholder, "aria-label": shown ? `${text}, in ${shown}` : text });
        made[name].addEventListener("input", () => { this.typed[name] = made[name].value; });
        label.append(shown);
      }
    }
    return made;
  }

  showWays({ ways, units, notes, gains, drive_units: driveUnits }) {
    element(this.root, "h2", {}, "How well the stage follows it");
    const table = element(this.root, "table", { id: "ways" });
    const head = element(element(table, "thead"), "tr");
    for (const text of ["way", "axis", "RMS error", "largest error"]) element(head, "th", { scope: "col" }, text);
    const body = element(table, "tbody");
    for (const [name, { rmse, peak }] of Object.entries(ways))
      for (const axis of Object.keys(rmse)) {
        const line = element(body, "tr");
        element(line, "th", { scope: "row" }, name);
        element(line, "td", {}, axis);
        for (const value of [rmse[axis], peak[axis]]) element(line, "td", { class: "number" }, `${number(value)} ${units[axis]}`);
      }
    for (const [axis, { kp, ki }] of Object.entries(gains ?? {})) element(this.root, "p", { class: "quiet" }, `PI controller of ${axis}: Kp ${number(kp)} ${driveUnits[axis]}/${units[axis]}, Ki ${number(ki)} ${driveUnits[axis]}/(${units[axis]} s).`);
    for (const note of notes ?? []) element(this.root, "p", {}, note);
    const bar = element(this.root, "p", { class: "bar" });
    once(element(bar, "button", { type: "button", id: "take-drive" }, "Download the drive (CSV)"), () => save("download?name=drive.csv", "drive.csv"), this.page.fail);
    for (const [kind, title] of Object.entries(KINDS)) {
      element(this.root, "h2", {}, title);
      this[kind] = this.figure(title);
    }
    this.draw().catch((error) => this.page.fail(error));
  }

  figure(title) {
    const figure = new Figure(element(this.root, "div", { class: "plotted" }), { label: `${title} over time, of each way to follow the reference`, along: true, gestures: { reset: () => figure.plot.look(null, null), point: (point) => figure.pointAt(point) } });
    return figure;
  }

  /** Columns by heading, such as "x, inverse [um]" and "u_x, inverse [V]", as curves. */
  async draw() {
    const { columns } = await requestJson("tracking");
    const signals = Object.entries(columns).map(([heading, data]) => ({ heading, values: floats(data) }));
    const xs = signals[0].values, references = {}, series = { error: [], displacement: [], drive: [] };
    const ways = [];
    for (const { heading, values } of signals.slice(1)) {
      const [, axis, way, stated] = heading.match(/^(.*?), (.*) \[(.*)\]$/) ?? [];
      if (!axis) continue;
      const unit = printed(stated);
      if (way === "reference") {
        references[axis] = values;
        series.displacement.push({ label: `${axis}, reference`, xs, ys: values, colour: "--measured", dots: true, unit });
        continue;
      }
      if (!ways.includes(way)) ways.push(way);
      const look = { xs, colour: COLOURS[ways.indexOf(way) % 5], dash: DASHES[ways.indexOf(way) % 5], over: true, unit, label: `${axis}, ${way}` };
      if (axis.startsWith("u_")) series.drive.push({ ...look, ys: values });
      else {
        series.displacement.push({ ...look, ys: values });
        series.error.push({ ...look, ys: values.map((value, i) => value - references[axis][i]) });
      }
    }
    for (const [kind, lines] of Object.entries(series)) {
      if (!lines.length) continue;
      const ends = lines.map(({ ys }) => extent(ys));
      this[kind].show({
        series: lines, track: { xs, ys: lines[0].ys }, x: { label: "time [s]", range: [xs[0], xs.at(-1)] },
        y: { label: `[${lines[0].unit}]`, range: [Math.min(...ends.map(([a]) => a)), Math.max(...ends.map(([, b]) => b))] },
      }, lines[0].unit);
    }
  }
}

function said({ file, axes, samples, rate }) {
  return `${file.split("/").at(-1)}: ${Object.entries(axes).map(([axis, { unit }]) => `${axis} in ${printed(unit)}`).join(", ")}; ${samples} samples${rate ? ` at ${number(rate, 4)} Hz` : ""}.`;
}

function floats(data) {
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  return Float64Array.from(new Float32Array(bytes.buffer));
}
