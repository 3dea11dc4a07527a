import { Progress } from "./progress.js";
import { Chain } from "./chain.js";
import { Columns } from "./columns.js";
import { Convergence } from "./convergence.js";
import { Explorer } from "./explorer.js";
import { element, keepingFocus, row } from "./parts.js";
import { follow, initialFile, request, requestJson, save } from "./session.js";
import { decode, number } from "./signals.js";
import { Staircase } from "./staircase.js";

const STAGES = { run: "Identifying", diagnose: "Diagnosing" };
const byId = (id) => document.getElementById(id);
const convergence = new Convergence(byId("convergence"));
const columns = new Columns(byId("columns"), byId("begin"), inspect, begin);
const diagnosisProgress = new Progress(() => { if (state?.stage === "diagnose") { showStatus(); showCandidates(); } });
const chain = new Chain(byId("blocks"), byId("more"), { setModel, add: (effect) => act("add", { effect }), remove: (effect) => act("remove", { effect }) });
let state = null, failure = "", stairs = null, explorer = null, shownSignals = "", disconnected = false, draftModel = ["bouc_wen"];

/** Request an action, then perhaps another, and show the new state or the error. */
async function act(name, body = {}, then = null) {
  [failure, byId("error").hidden] = ["", true];
  byId("status").textContent = "Working …";
  try {
    show(await requestJson(name, body));
    if (then) show(await requestJson(then, {}));
  } catch (error) {
    showStatus();
    showError(error);
  }
}

/** Make a job of the confirmed columns and run it. */
function begin(form) {
  try {
    act("job", { ...form(), model: draftModel }, "run");
  } catch (error) { showError(error); }
}

/** Change the model of the job, or the one that the next job is made with. */
function setModel(words) {
  if (state.steps.length) return act("model", { model: words });
  draftModel = words;
  keepingFocus(() => chain.show({ model: draftModel, effects: [] }, state, false));
}

function showError(error) {
  byId("error").textContent = error.message;
  byId("error").hidden = false;
}

function show(newState) {
  keepingFocus(() => draw(newState), () => byId("actions").querySelector("button:not([hidden])"));
}

function draw(newState) {
  state = newState;
  const begun = state.steps.length > 0;
  byId("name").textContent = begun ? state.job.name : "pzt-ident workbench";
  byId("where").textContent = begun ? state.job.folder : state.folder;
  byId("measurement").hidden = begun;
  for (const id of ["fall", "fit", "where-it-fails", "candidates"]) byId(id).hidden = !begun;
  byId("terminal").hidden = !state.commands.length;
  byId("commands").textContent = state.commands.join("\n");
  if (state.failure !== failure) {
    failure = state.failure;
    if (failure) showError({ message: failure });
    else byId("error").hidden = true;
  }
  showButtons(begun);
  showVerdict(begun);
  chain.show(begun ? state.job : { model: draftModel, effects: [] }, state, begun);
  showOtherSteps();
  byId("begin").hidden = begun;
  if (!begun) return showFiles();
  showStaircase();
  showMisfit();
  showCandidates();
  showSignals().catch(showError);
}

function showButtons(begun) {
  const busy = Boolean(state.stage);
  byId("run").hidden = !begun || busy || Boolean(state.diagnosis);
  byId("run").textContent = state.failure ? "Resume" : "Run";
  byId("stop").hidden = !busy;
  byId("undo").hidden = !begun;
  byId("undo").textContent = state.steps.length > 1 ? "Undo" : "Change the measurement";
  byId("save").hidden = !begun;
  byId("drive").hidden = !state.diagnosis?.next_experiment;
  byId("report").hidden = !begun || !state.result;
  showStatus();
}

function showStatus() {
  const seconds = state?.stage ? Math.max(0, Math.round(Date.now() / 1000 - state.since)) : 0;
  const progress = state?.stage === "run" && Number.isFinite(convergence.best) ? `, ${Math.round((100 * convergence.done) / convergence.budget)} %, best RMSE${convergence.together} ${number(convergence.best)}${convergence.done < convergence.budget ? "" : ", finishing"}` : "";
  const activity = state?.stage === "diagnose" && diagnosisProgress.sentence ? `; ${diagnosisProgress.sentence}` : "";
  byId("status").textContent = state?.stage ? `${STAGES[state.stage]}: ${seconds} s${progress}${activity}` : "";
}

function showVerdict(begun) {
  const { diagnosis, result } = state;
  byId("advice").replaceChildren();
  if (!begun) byId("verdict").textContent = columns.records.length ? "Check the columns and confirm them." : "Drop a measurement with voltage and displacement.";
  else if (diagnosis) byId("verdict").textContent = diagnosis.reason;
  else if (result) byId("verdict").textContent = `The RMSE is ${number(result.best.rmse.validate ?? result.best.rmse.identify)} ${result.unit}${state.together} on the ${result.best.rmse.validate === null ? "identification" : "validation"} records.`;
  else byId("verdict").textContent = state.stage ? "Identifying the model." : state.failure ? "Not finished." : "Ready to run.";
  for (const { run, reason } of result?.failed_runs ?? []) element(byId("advice"), "span", { class: "warn" }, `${run} failed: ${reason}. `);
  if (result?.best.rmse.validate === null) byId("advice").append("There is no validation record: add a second record to test the model on data that it was not fitted to. ");
  byId("advice").append(state.weighed);
  if (!diagnosis) return;
  const missing = diagnosis.candidates.filter((item) => item.decision === "missing");
  for (const item of missing) appendAddButton(byId("advice"), item.item ?? item.effect, "strong");
  if (missing.length) byId("advice").append(` ${missing[0].physics} On the test rig: ${missing[0].remedy}`);
  if (diagnosis.next_experiment) byId("advice").append(` To distinguish ${diagnosis.next_experiment.splits.join(" and ")}, apply the next drive (to be saved above): ${diagnosis.next_experiment.why}.`);
  else if (diagnosis.verdict === "inconclusive") byId("advice").append(` No drive within the limits distinguishes the candidates. On the test rig: ${missing[0].separate_by}`);
}

function appendAddButton(parent, effect, kind = "", text = `Add ${effect}`) {
  const button = element(parent, "button", { type: "button", class: kind, "data-effect": effect, "aria-label": `Add ${effect}` }, text);
  button.addEventListener("click", () => act("add", { effect }));
  parent.append(" ");
}

function showFiles() {
  byId("here").replaceChildren();
  const free = state.files.filter((name) => !columns.files.includes(name));
  if (!free.length) return;
  byId("here").append("Or choose a file of this folder: ");
  for (const name of free)
    element(byId("here"), "button", { type: "button" }, name).addEventListener("click", () => addFile(name)), byId("here").append(" ");
}

/** The columns of files of the folder, or of their tables or sheets, that make one record. */
async function inspect(files) {
  byId("error").hidden = true;
  try {
    return await requestJson("look", { files });
  } catch (error) {
    showError(error);
    throw error;
  }
}

function showMeasurement() {
  if (!state) return;
  showVerdict(false);
  showFiles();
}

async function addFile(file) {
  try {
    await columns.add(await inspect([{ file }]));
    showMeasurement();
  } catch { /* shown by inspect */ }
}

async function upload(list) {
  byId("error").hidden = true;
  const messages = [];
  for (const file of list)
    try {
      if (file.size > state?.largest) throw new Error(`${file.name} is larger than ${state.largest >> 20} MiB: put it into the folder in which the workbench was started, and choose it there.`);
      await columns.add(await (await request(`upload?name=${encodeURIComponent(file.name)}`, file, true)).json());
      showMeasurement();
    } catch (error) { messages.push(error.message); }
  if (messages.length) showError({ message: messages.join("\n") });
}

/** The staircase; its last step is updated live while the search runs. */
function showStaircase() {
  showStaircase.floor = state.result?.floor ?? state.diagnosis?.floor ?? showStaircase.floor;
  const steps = state.steps.map(({ change, identify, validate }) => ({ name: change, identify, validate, note: identify === null ? "not run" : "" }));
  const last = steps.at(-1);
  if (state.stage === "run" && last.identify === null && Number.isFinite(convergence.best))
    Object.assign(last, { identify: convergence.best, validate: convergence.validate, live: true, note: "so far" });
  else if (state.stage === "run") last.note = "starting";
  const { unit, together } = state.unit ? state : convergence;
  const content = { steps, floor: showStaircase.floor, unit, together };
  if (stairs) stairs.show(content);
  else stairs = new Staircase(byId("stairs"), content);
  byId("converging").hidden = !convergence.runs.size;
}

/** Steps outside the current chain, to return to. */
function showOtherSteps() {
  byId("others").replaceChildren();
  for (const { number: step, change, identify } of state.others) {
    const error = identify === null ? "not run" : `RMSE ${number(identify)} ${state.unit}${state.together}`;
    const button = element(byId("others"), "button", { type: "button" }, `${step}: ${change} (${error})`);
    button.addEventListener("click", () => act("back", { step }));
    byId("others").append(" ");
  }
  if (state.others.length) byId("others").prepend("Other steps: ");
}

function showMisfit() {
  const axes = Object.values(state.misfit?.axes ?? {});
  byId("where-it-fails").hidden = !axes.length;
  byId("misfit").replaceChildren();
  for (const axis of axes) {
    const name = axes.length > 1 ? `${axis.axis}: ` : "";
    for (const sentence of axis.sentences) element(byId("misfit"), "li", {}, name + sentence);
    for (const segment of axis.worst) {
      const item = element(byId("misfit"), "li");
      element(item, "button", { type: "button" }, `${name}${segment.record}, ${number(segment.start, 4)} to ${number(segment.end, 4)} s: ${percent(segment.share)} of the misfit`)
        .addEventListener("click", () => explorer?.reveal(segment.record, axis.axis, segment.start, segment.end));
    }
  }
}

function showCandidates() {
  const { diagnosis } = state;
  const scoring = !diagnosis && state.stage === "diagnose" && diagnosisProgress.scored.length > 0;
  byId("candidates").hidden = !diagnosis?.candidates.length && !scoring;
  byId("effects").replaceChildren();
  if (scoring) {
    row(byId("effects"), "th", ["effect", "explained misfit"]);
    for (const { effect, explained } of diagnosisProgress.scored.toSorted((a, b) => b.explained - a.explained))
      row(byId("effects"), "td", [effect, percent(explained)]);
  }
  if (!diagnosis) return;
  row(byId("effects"), "th", ["effect", "", "decision", "explained misfit", "estimate", "visibility", `identification RMSE with it${state.together} [${state.unit}]`, "validation RMSE", "indistinguishable from", "physics"]);
  for (const item of diagnosis.candidates) {
    const rmse = ["identify", "validate"].map((use) => (item.rmse ? number(item.rmse[use]) : ""));
    const equivalents = item.class.filter((word) => word !== item.effect).join(", ");
    const cells = row(byId("effects"), "td", [item.item ?? item.effect, "", item.decision, percent(item.explained), item.would_be, number(item.visibility, 2), ...rmse, equivalents, item.physics]);
    cells[4].classList.add("expected");
    cells[9].classList.add("note");
    if (item.decision === "missing") cells[0].parentElement.classList.add("missing");
    appendAddButton(cells[1], item.item ?? item.effect, "", "Add");
  }
}

function percent(share) {
  return `${Math.round(100 * share)} %`;
}

/** Fetch and draw the signals if they are new. */
async function showSignals() {
  const key = state.steps.map((step) => `${step.number}:${step.identify}`).join(" ");
  const none = !state.steps.some((step) => step.identify !== null);
  byId("fit").hidden = none || !explorer;
  if (none || key === shownSignals || !state.result) return;
  shownSignals = key;
  const signals = await requestJson("signals");
  const records = await Promise.all(signals.records.map(decode));
  if (!records.length) return;
  byId("fit").hidden = false;
  if (explorer) Object.assign(explorer, { floors: signals.floors }).update(records);
  else explorer = new Explorer(byId("explorer"), records, { floors: signals.floors });
}

async function refresh() {
  try { show(await requestJson("state")); } catch (error) { showError(error); }
}

async function openReport() {
  try {
    const page = window.open("", "_blank");
    const { url } = await requestJson("report", {});
    page ? (page.location = url) : (location.href = url);
  } catch (error) { showError(error); }
}

byId("run").addEventListener("click", () => act("run"));
byId("stop").addEventListener("click", () => act("stop"));
byId("undo").addEventListener("click", () => act("undo"));
byId("save").addEventListener("click", () => save("job", `${state.job.name}.yaml`).catch(showError));
byId("drive").addEventListener("click", () => save("drive", "next_experiment.csv").catch(showError));
byId("report").addEventListener("click", openReport);
byId("choose").addEventListener("change", (event) => upload(event.target.files));
for (const name of ["dragover", "dragleave", "drop"])
  byId("drop").addEventListener(name, (event) => {
    event.preventDefault();
    byId("drop").classList.toggle("over", name === "dragover");
    if (name === "drop") upload(event.dataTransfer.files);
  });
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => event.preventDefault());
setInterval(showStatus, 500);

await refresh();
if (initialFile && !state?.steps.length) await addFile(initialFile);
follow((event) => {
  if (disconnected) [disconnected, byId("error").hidden] = [false, true];
  if (event.event === "step") [convergence, diagnosisProgress].forEach((part) => part.clear());
  else if (event.event === "changed") { if (event.version !== state?.version || state?.stage) refresh(); }
  else {
    convergence.update(event);
    diagnosisProgress.update(event);
    if (state?.stage === "run" && event.event === "generation") { showStaircase(); showStatus(); }
  }
}, (error) => { disconnected = true; showError(error); });
