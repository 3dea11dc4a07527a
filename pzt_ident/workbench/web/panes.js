import { spelled } from "./about.js";
import { Explorer } from "./explorer.js";
import { Moving } from "./moving.js";
import { requestJson } from "./session.js";
import { decode } from "./signals.js";
import { Staircase } from "./staircase.js";

const byId = (id) => document.getElementById(id);

/** The three panes that stay in view: loop, time with the residual below it, and the staircase. */
export class Panes {
  constructor({ fail, chooseStep, onMoved }) {
    Object.assign(this, { fail, chooseStep, explorer: null, stairs: null, shown: "", floor: null, spectraOf: new Map() });
    this.moving = new Moving((records, rmse) => {
      this.explorer?.moveModel(records);
      onMoved(rmse);
    }, fail);
  }

  /** Show records, of a measurement or of a fitted model; returns the explorer. */
  explore(records, options = {}) {
    if (this.explorer) this.explorer.update(records, options);
    else this.explorer = new Explorer({ bar: byId("explorer-bar"), loop: byId("loop"), time: byId("time") }, records, { ...options, spectra: (record) => this.spectra(record) });
    return this.explorer;
  }

  /** Fetch and draw the signals if they are new; `steps`: two steps to compare. */
  async showSignals(state, steps = null) {
    const key = steps ? `compare ${steps.join(" ")}` : `${state.at}|${state.steps.map((step) => `${step.number}:${step.identify}`).join(" ")}`;
    if (key === this.shown || !state.steps.some((step) => step.identify !== null)) return;
    this.shown = key;
    this.spectraOf.clear();
    this.moving.stop();
    const { records, floors } = await requestJson(steps ? `signals?steps=${steps.join(",")}` : "signals");
    const decoded = await Promise.all(records.map(decode));
    if (key !== this.shown || !decoded.length) return;
    if (steps) for (const record of decoded) record.models.forEach((model, place) => { model.name = `step ${steps[place]}`; });
    this.explore(decoded, { floors });
  }

  async spectra({ name, axis, use }) {
    const key = this.shown;
    if (!this.spectraOf.has(key)) this.spectraOf.set(key, requestJson("spectrum").then(({ records }) => records));
    const records = await this.spectraOf.get(key);
    return records.find((item) => item.name === name && item.axis === axis && (!item.use || item.use === use)) ?? null;
  }

  move(at, values, effect = null) {
    if (values) return this.moving.ask(at, values, effect);
    this.moving.stop();
    this.explorer?.moveModel(null);
  }

  /** The staircase; its last steps grow while a search or an improvement runs. */
  showStaircase(state, { best, validate, unit, together }) {
    this.floor = state.result?.floor ?? state.diagnosis?.floor ?? this.floor;
    const steps = state.steps.map(({ number, change, identify, validate, note, promised }) => ({ number, name: change, identify, validate, promised, note: identify === null ? "not run" : note ?? "", current: number === state.at }));
    const last = steps.at(-1);
    if (state.stage === "run" && last.identify === null) Object.assign(last, Number.isFinite(best) ? { identify: best, validate, live: true, note: "so far" } : { note: "starting" });
    if (state.stage === "improve") steps.push(...grown(state.improving?.steps ?? [], last));
    for (const step of steps) step.href = spelled(step.name, state).find(({ href }) => href)?.href;
    const content = { steps, floor: this.floor, unit: state.unit || unit, together: state.unit ? state.together : together };
    if (this.stairs) this.stairs.show(content);
    else this.stairs = new Staircase(byId("stairs"), content, (step) => this.chooseStep(step));
  }
}

/** The steps that an improvement took so far, after the one that it started from. */
function grown(steps, { identify }) {
  return steps.filter(({ added, removed, change, rmse }) => (added || removed || change) && rmse.identify !== identify)
    .map(({ added, removed, change, rmse }) => ({ name: added ? `+ ${added}` : removed ? `− ${removed}` : change, ...rmse, live: true, note: "so far" }));
}
