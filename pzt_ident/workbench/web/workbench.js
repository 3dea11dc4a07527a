import { Progress } from "./progress.js";
import { Chain } from "./chain.js";
import { Columns } from "./columns.js";
import { Convergence } from "./convergence.js";
import { Explorer } from "./explorer.js";
import { element, keepingFocus, row } from "./parts.js";
import { ask, call, follow, opening, save } from "./session.js";
import { decode, number } from "./signals.js";
import { Staircase } from "./staircase.js";

const STAGES = { run: "Identifying", diagnose: "Looking for what is missing" };
const at = (id) => document.getElementById(id);
const convergence = new Convergence(at("convergence"));
const columns = new Columns(at("columns"), at("begin"), look, begin);
const asking = new Progress(() => { if (state?.stage === "diagnose") { status(); candidates(); } });
const chain = new Chain(at("blocks"), at("more"), { choose, add: (effect) => act("add", { effect }), remove: (effect) => act("remove", { effect }) });
let state = null, failure = "", stairs = null, explorer = null, shown = "", away = false, draft = ["bouc_wen"];

/** Do something on the server and show what became of it; an error is said, and nothing is lost. */
async function act(name, body = {}, then = null) {
  [failure, at("error").hidden] = ["", true];
  at("status").textContent = "One moment …";
  try {
    show(await ask(name, body));
    if (then) show(await ask(then, {}));
  } catch (error) {
    status();
    fail(error);
  }
}

/** A job from the columns as they are confirmed, and run it. */
function begin(form) {
  try {
    act("job", { ...form(), model: draft }, "run");
  } catch (error) { fail(error); }
}

/** Another model: that of the job, or what it will be made with. */
function choose(words) {
  if (state.steps.length) return act("model", { model: words });
  draft = words;
  keepingFocus(() => chain.show({ model: draft, effects: [] }, state, false));
}

function fail(error) {
  at("error").textContent = error.message;
  at("error").hidden = false;
}

function show(found) {
  keepingFocus(() => draw(found), () => at("actions").querySelector("button:not([hidden])"));
}

function draw(found) {
  state = found;
  const begun = state.steps.length > 0;
  at("name").textContent = begun ? state.job.name : "pzt-ident workbench";
  at("where").textContent = begun ? state.job.folder : state.folder;
  at("measurement").hidden = begun;
  for (const id of ["fall", "fit", "where-it-fails", "candidates"]) at(id).hidden = !begun;
  at("terminal").hidden = !state.commands.length;
  at("commands").textContent = state.commands.join("\n");
  if (state.failure !== failure) {
    failure = state.failure;
    if (failure) fail({ message: failure });
    else at("error").hidden = true;
  }
  buttons(begun);
  words(begun);
  chain.show(begun ? state.job : { model: draft, effects: [] }, state, begun);
  others();
  at("begin").hidden = begun;
  if (!begun) return files();
  fall();
  misfit();
  candidates();
  signals().catch(fail);
}

function buttons(begun) {
  const busy = Boolean(state.stage);
  at("run").hidden = !begun || busy || Boolean(state.diagnosis);
  at("run").textContent = state.failure ? "Run on" : "Run";
  at("stop").hidden = !busy;
  at("undo").hidden = !begun;
  at("undo").textContent = state.steps.length > 1 ? "Undo" : "Change the measurement";
  at("save").hidden = !begun;
  at("drive").hidden = !state.diagnosis?.next_experiment;
  at("report").hidden = !begun || !state.result;
  status();
}

function status() {
  const seconds = state?.stage ? Math.max(0, Math.round(Date.now() / 1000 - state.since)) : 0;
  const share = state?.stage === "run" && Number.isFinite(convergence.best) ? `, ${Math.round((100 * convergence.done) / convergence.budget)} %, best RMSE${convergence.together} ${number(convergence.best)}${convergence.done < convergence.budget ? "" : ", finishing"}` : "";
  const said = state?.stage === "diagnose" && asking.said ? `; ${asking.said}` : "";
  at("status").textContent = state?.stage ? `${STAGES[state.stage]}: ${seconds} s${share}${said}` : "";
}

function words(begun) {
  const { diagnosis, result } = state;
  at("advice").replaceChildren();
  if (!begun) at("verdict").textContent = columns.records.length ? "Is this what was measured?" : "Drop a measurement: voltage in, displacement out.";
  else if (diagnosis) at("verdict").textContent = diagnosis.reason;
  else if (result) at("verdict").textContent = `The model leaves ${number(result.best.rmse.validate ?? result.best.rmse.identify)} ${result.unit} RMS${state.together}${result.best.rmse.validate === null ? "" : " on records the fit never saw"}.`;
  else at("verdict").textContent = state.stage ? "Identifying the model." : state.failure ? "Not finished." : "Ready to run.";
  for (const { run, reason } of result?.failed_runs ?? []) element(at("advice"), "span", { class: "warn" }, `${run} failed: ${reason}. `);
  if (result?.best.rmse.validate === null) at("advice").append("No record is kept back to judge the model on: a second one, dropped beside the first, would show whether it holds. ");
  at("advice").append(state.weighed);
  if (!diagnosis) return;
  const missing = diagnosis.candidates.filter((item) => item.decision === "missing");
  for (const item of missing) addButton(at("advice"), item.effect, "strong");
  if (missing.length) at("advice").append(` ${missing[0].physics} On the rig: ${missing[0].remedy}`);
  if (diagnosis.next_experiment) at("advice").append(` To tell them apart: ${diagnosis.next_experiment.why}.`);
  else if (diagnosis.verdict === "inconclusive") at("advice").append(` No drive within the limits tells them apart. On the rig: ${missing[0].separate_by}`);
}

function addButton(parent, effect, kind = "", text = `Add ${effect}`) {
  const made = element(parent, "button", { type: "button", class: kind, "data-effect": effect, "aria-label": `Add ${effect}` }, text);
  made.addEventListener("click", () => act("add", { effect }));
  parent.append(" ");
}

function files() {
  at("here").replaceChildren();
  const free = state.files.filter((name) => !columns.files.includes(name));
  if (!free.length) return;
  at("here").append("Or take one of this folder: ");
  for (const name of free)
    element(at("here"), "button", { type: "button" }, name).addEventListener("click", () => take(name)), at("here").append(" ");
}

/** See what is in files of the folder, or in parts of them, that make a record. */
async function look(files) {
  at("error").hidden = true;
  try {
    return await ask("look", { files });
  } catch (error) {
    fail(error);
    throw error;
  }
}

function measured() {
  if (!state) return;
  words(false);
  files();
}

async function take(file) {
  try {
    await columns.add(await look([{ file }]));
    measured();
  } catch { /* it is said */ }
}

async function upload(list) {
  at("error").hidden = true;
  const said = [];
  for (const file of list)
    try {
      if (file.size > state?.largest) throw new Error(`${file.name} is larger than ${state.largest >> 20} MiB: put it into the folder that the workbench was started in, and take it from there.`);
      await columns.add(await (await call(`upload?name=${encodeURIComponent(file.name)}`, file, true)).json());
      measured();
    } catch (error) { said.push(error.message); }
  if (said.length) fail({ message: said.join("\n") });
}

/** The staircase, its last stair live while the search runs. */
function fall() {
  fall.floor = state.result?.floor ?? state.diagnosis?.floor ?? fall.floor;
  const steps = state.steps.map(({ change, identify, validate }) => ({ name: change, identify, validate, note: identify === null ? "not run" : "" }));
  const last = steps.at(-1);
  if (state.stage === "run" && last.identify === null && Number.isFinite(convergence.best))
    Object.assign(last, { identify: convergence.best, validate: convergence.validate, live: true, note: "so far" });
  else if (state.stage === "run") last.note = "begins";
  const { unit, together } = state.unit ? state : convergence;
  const content = { steps, floor: fall.floor, unit, together };
  if (stairs) stairs.show(content);
  else stairs = new Staircase(at("stairs"), content);
  at("converging").hidden = !convergence.runs.size;
}

/** Steps that were made and left: each can be gone back to. */
function others() {
  at("others").replaceChildren();
  for (const { number: step, change, identify } of state.others) {
    const left = identify === null ? "not run" : `leaves ${number(identify)} ${state.unit}${state.together}`;
    const made = element(at("others"), "button", { type: "button" }, `${step}: ${change} (${left})`);
    made.addEventListener("click", () => act("back", { step }));
    at("others").append(" ");
  }
  if (state.others.length) at("others").prepend("Tried before: ");
}

function misfit() {
  const axes = Object.values(state.misfit?.axes ?? {});
  at("where-it-fails").hidden = !axes.length;
  at("misfit").replaceChildren();
  for (const axis of axes) {
    const name = axes.length > 1 ? `${axis.axis}: ` : "";
    for (const sentence of axis.sentences) element(at("misfit"), "li", {}, name + sentence);
    for (const one of axis.worst) {
      const item = element(at("misfit"), "li");
      element(item, "button", { type: "button" }, `${name}${one.record}, ${number(one.start, 4)} to ${number(one.end, 4)} s: ${share(one.share)} of the misfit`)
        .addEventListener("click", () => explorer?.reveal(one.record, axis.axis, one.start, one.end));
    }
  }
}

function candidates() {
  const { diagnosis } = state;
  const scoring = !diagnosis && state.stage === "diagnose" && asking.scored.length > 0;
  at("candidates").hidden = !diagnosis?.candidates.length && !scoring;
  at("effects").replaceChildren();
  if (scoring) {
    row(at("effects"), "th", ["effect", "would explain"]);
    for (const { effect, explained } of asking.scored.toSorted((a, b) => b.explained - a.explained))
      row(at("effects"), "td", [effect, share(explained)]);
  }
  if (!diagnosis) return;
  row(at("effects"), "th", ["effect", "", "decision", "explains", "would be", "visible", `identify after it${state.together} [${state.unit}]`, "validate", "cannot be told from", "what it is"]);
  for (const item of diagnosis.candidates) {
    const rmse = ["identify", "validate"].map((use) => (item.rmse ? number(item.rmse[use]) : ""));
    const alike = item.class.filter((word) => word !== item.effect).join(", ");
    const cells = row(at("effects"), "td", [item.effect, "", item.decision, share(item.explained), item.would_be, number(item.visibility, 2), ...rmse, alike, item.physics]);
    cells[4].classList.add("expected");
    cells[9].classList.add("note");
    if (item.decision === "missing") cells[0].parentElement.classList.add("missing");
    addButton(cells[1], item.effect, "", "Add");
  }
}

function share(part) {
  return `${Math.round(100 * part)} %`;
}

/** Fetch and draw the signals where a step has new ones. */
async function signals() {
  const key = state.steps.map((step) => `${step.number}:${step.identify}`).join(" ");
  const none = !state.steps.some((step) => step.identify !== null);
  at("fit").hidden = none || !explorer;
  if (none || key === shown || !state.result) return;
  shown = key;
  const found = await ask("signals");
  const records = await Promise.all(found.records.map(decode));
  if (!records.length) return;
  at("fit").hidden = false;
  if (explorer) Object.assign(explorer, { floors: found.floors }).update(records);
  else explorer = new Explorer(at("explorer"), records, { floors: found.floors });
}

async function refresh() {
  try { show(await ask("state")); } catch (error) { fail(error); }
}

async function report() {
  try {
    const page = window.open("", "_blank");
    const { url } = await ask("report", {});
    page ? (page.location = url) : (location.href = url);
  } catch (error) { fail(error); }
}

at("run").addEventListener("click", () => act("run"));
at("stop").addEventListener("click", () => act("stop"));
at("undo").addEventListener("click", () => act("undo"));
at("save").addEventListener("click", () => save("job", `${state.job.name}.yaml`).catch(fail));
at("drive").addEventListener("click", () => save("drive", "next_experiment.csv").catch(fail));
at("report").addEventListener("click", report);
at("choose").addEventListener("change", (event) => upload(event.target.files));
for (const name of ["dragover", "dragleave", "drop"])
  at("drop").addEventListener(name, (event) => {
    event.preventDefault();
    at("drop").classList.toggle("over", name === "dragover");
    if (name === "drop") upload(event.dataTransfer.files);
  });
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => event.preventDefault());
setInterval(status, 500);

await refresh();
if (opening && !state?.steps.length) await take(opening);
follow((event) => {
  if (away) [away, at("error").hidden] = [false, true];
  if (event.event === "step") [convergence, asking].forEach((part) => part.clear());
  else if (event.event === "changed") { if (event.version !== state?.version || state?.stage) refresh(); }
  else {
    convergence.take(event);
    asking.take(event);
    if (state?.stage === "run" && event.event === "generation") { fall(); status(); }
  }
}, (error) => { away = true; fail(error); });
