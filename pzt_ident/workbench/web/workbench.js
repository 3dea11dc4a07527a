import { spell } from "./about.js";
import { Candidates } from "./candidates.js";
import { Chain } from "./chain.js";
import { Commands } from "./commands.js";
import { Control } from "./control.js";
import { Devices } from "./devices.js";
import { Measurement } from "./measurement.js";
import { showMisfit } from "./misfit.js";
import { Optimizers } from "./optimizers.js";
import { Panes } from "./panes.js";
import { Parameters } from "./parameters.js";
import { element, keepingFocus } from "./parts.js";
import { Progress } from "./progress.js";
import { follow, initialFile, once, request, requestJson } from "./session.js";
import { number } from "./signals.js";
import { Steps } from "./steps.js";
import { Tabs } from "./tabs.js";

const STAGES = { run: "Identifying", diagnose: "Diagnosing", improve: "Improving", control: "Following the reference", fleet: "Identifying all devices" };
const TABS = { measurement: "Measurement", parameters: "Parameters", misfit: "Where it fails", candidates: "Candidates", steps: "Steps", optimizers: "Optimizers", control: "Control", devices: "Devices", commands: "Commands" };
const byId = (id) => document.getElementById(id);
let state = null, asking = false, newest = 0, draftModel = ["bouc_wen"], disconnected = false, failure = "", entered = null;

const tabs = new Tabs(byId("tabs"), byId("sheets"), TABS);
const { sheets } = tabs;
const panes = new Panes({ fail: showError, chooseStep: ({ number: step }) => { tabs.open("steps"); steps.reveal(step); }, onMoved: (rmse) => (tabs.current === "candidates" ? candidates.moved(rmse) : parameters.showError(rmse)) });
const page = { move: (values, effect) => panes.move(state.at, values, effect), fail: showError, clear: hideError, act, refresh };
const parameters = new Parameters(sheets.parameters, {
  ...page, polish: (values) => act("polish", { values }),
  settle: (body, undo) => {
    if (isBusy()) showError({ message: "Wait until the model is fitted, or stop that." });
    return act("settings", body).then((done) => done || undo());
  },
});
const candidates = new Candidates(sheets.candidates, { ...page, add: (effect) => act("add", { effect }) });
const steps = new Steps(sheets.steps, { ...page, back: (step) => act("back", { step }), compare: (chosen) => chosen.length === 2 && panes.showSignals(state, chosen.toSorted((a, b) => b - a)).catch(showError) });
const optimizers = new Optimizers(sheets.optimizers, { search: (form) => act("search", form), improve: (budget) => act("improve", { budget }) });
const control = new Control(sheets.control, page);
const devices = new Devices(sheets.devices, { ...page, open: openLot });
const commands = new Commands(sheets.commands, showError);
const { convergence } = optimizers;
const progress = new Progress(() => { if (state?.stage === "diagnose") { showStatus(); candidates.show(state, progress); } });
const measurement = new Measurement(sheets.measurement, byId("guess"), {
  explorer: (records, options) => panes.explore(records, options), fail: showError, upload, changed: () => keepingFocus(() => { showHeader(); showHere(); layOut(); }, () => byId(measurement.records.missing ? "confirm" : "action")),
  confirm: (form) => act("job", { ...form, model: draftModel }, "run"), draftModel: () => draftModel, setDraftModel: (words) => { draftModel = words; showChain(); },
});
const chain = new Chain(byId("blocks"), byId("more"), { setModel, add: (effect) => act("add", { effect }), remove: (effect) => act("remove", { effect }) });

const ACTS = "#action, #improve, #undo, [data-acts]";
const isBusy = () => asking || Boolean(state?.busy ?? state?.stage);

/** Request a change, then perhaps another, and show the new state or the error. Nothing happens while one is under way.
 * Returns whether it was made. */
async function act(name, body = {}, then = null) {
  if (isBusy() && name !== "stop") return false;
  let refused = null;
  [asking, failure] = [true, ""];
  hideError();
  showBusy();
  try {
    state = await requestJson(name, { ...body, at: state.at });
    if (then) state = await requestJson(then, { at: state.at });
    return true;
  } catch (error) {
    refused = error;
    return false;
  } finally {
    asking = false;
    show(state);
    if (refused) showError(refused);
    if (newest > state.version) refresh();
  }
}

/** Change the model of the job, or the one that the next job is made with. */
function setModel(words) {
  if (state.steps.length) return act("model", { model: words });
  draftModel = words;
  keepingFocus(showChain);
  if (!measurement.empty) measurement.changed(false);
}

function showError(error) {
  byId("error").querySelector("p").textContent = error.message;
  byId("error").hidden = false;
}

function hideError() { byId("error").hidden = true; }

function show(newState) {
  state = newState;
  keepingFocus(draw, () => [byId("action"), byId("stop"), tabs.tabs[tabs.current]].find((item) => item.offsetParent !== null));
}

function draw() {
  const begun = state.steps.length > 0;
  if (state.error !== failure) {
    failure = state.error;
    if (failure) showError({ message: failure });
    else hideError();
  }
  layOut();
  showHeader();
  showChain();
  commands.show(state);
  if (begun) showResults();
  else { showHere(); measurement.show(); measurement.restore(state.draft); }
  showBusy();
}

/** Which parts of the page are there: before the first file, before there is a job, and after. */
function layOut() {
  const begun = state?.steps.length > 0;
  document.body.classList.toggle("opening", !state);
  document.body.classList.toggle("empty", !begun && measurement.empty);
  document.body.classList.toggle("begun", begun);
  byId("stairs").hidden = !begun;
  byId("guess").hidden = begun;
  byId("third").setAttribute("aria-label", begun ? "RMSE after each step" : "Read from the measurement");
  tabs.offer(begun ? Object.keys(TABS).slice(1) : ["measurement", "commands"]);
}

function showResults() {
  measurement.leave();
  panes.showStaircase(state, convergence);
  panes.showSignals(state).catch(showError);
  parameters.show(state.parameters, state.unit, state.result?.best?.rmse ?? null);
  showMisfit(sheets.misfit, state, (...segment) => panes.explorer?.reveal(...segment));
  candidates.show(state, progress);
  steps.show(state);
  optimizers.show(state);
  control.show(state);
  devices.show(state);
}

function showHeader() {
  if (!state) return;
  const begun = state.steps.length > 0, { headline } = state;
  byId("name").textContent = begun ? state.lot?.device || state.job.name : "pzt-ident workbench";
  byId("name").title = begun ? state.job.folder : state.folder;
  const [verdict, next, action] = begun
    ? [headline.verdict, headline.next, headline.action ?? (state.result && !isBusy() ? { name: "", label: "Follow a reference" } : null)]
    : measurement.empty ? ["Drop a measurement with voltage and displacement.", "Or choose a file of this folder.", null] : ["Check what was read from the measurement.", measurement.records.missing || "Then identify a model of it.", measurement.records.missing ? null : { label: "Confirm and identify" }];
  showVerdict(verdict);
  spell(byId("next"), next, state);
  byId("action").hidden = !action || action.name === "stop";
  byId("action").textContent = action?.label ?? "";
  byId("action").onclick = () => (!begun ? measurement.confirm() : action.name ? act(action.name, action.body) : tabs.open("control"));
  const idle = begun && Boolean(state.result);
  for (const [id, shown] of Object.entries({ improve: idle && action?.name !== "improve", report: idle, undo: begun && (state.steps.length > 1 || !state.lot?.device), lot: Boolean(state.lot) })) byId(id).hidden = !shown;
  byId("undo").textContent = state.steps.length > 1 ? "Undo" : "Change the measurement";
}

/** The verdict, with its first sentence large. */
function showVerdict(text) {
  const node = byId("verdict");
  if (node.textContent === text) return;
  node.replaceChildren();
  const [first, ...others] = text.split(/(?<=[a-z)][.?!]) (?=[A-Z\d])/);
  spell(element(node, "strong"), first, state);
  if (others.length) spell(element(node, "span"), ` ${others.join(" ")}`, state);
}

/** What may not be pressed while something is under way looks so, and keeps the focus. */
function showBusy() {
  const busy = isBusy();
  document.body.classList.toggle("busy", busy);
  for (const button of document.querySelectorAll(ACTS)) button.setAttribute("aria-disabled", String(busy));
  byId("stop").hidden = !state?.running;
  showStatus();
}

function showStatus() {
  const { stage, since } = state ?? {};
  const doing = STAGES[stage] ?? "";
  if (byId("announced").textContent !== doing) byId("announced").textContent = doing;
  if (!stage) return void (byId("status").textContent = isBusy() ? "Working …" : "");
  const seconds = Math.max(0, Math.round(Date.now() / 1000 - since));
  const { best, done, budget, unit, together } = convergence;
  const searched = stage === "run" && Number.isFinite(best) ? `, ${Math.min(100, Math.round((100 * done) / budget))} %, best RMSE${together} ${number(best)} ${state.unit || unit}` : "";
  const said = ["diagnose", "improve"].includes(stage) && progress.sentence ? `; ${progress.sentence}` : "";
  byId("status").textContent = `${STAGES[stage] ?? stage}: ${seconds} s${searched}${said}`;
}

function showChain() {
  const begun = state.steps.length > 0;
  chain.show(begun ? state.job : { model: draftModel, effects: [] }, state, begun);
}

/** The data files of the folder, to be chosen. */
function showHere() {
  if (!state) return;
  byId("here").replaceChildren();
  const free = state.files.filter((name) => !measurement.records.files.includes(name));
  if (free.length) element(byId("here"), "span", { class: "quiet" }, "Or a file of this folder:");
  for (const name of free) element(byId("here"), "button", { type: "button" }, name).addEventListener("click", () => addFile(name));
}

async function addFile(file) {
  hideError();
  try { await measurement.add(await measurement.inspect([{ file }])); } catch { /* shown by inspect */ }
}

async function upload(list) {
  hideError();
  const messages = [];
  for (const file of list)
    try {
      if (file.size > state?.largest) throw new Error(`${file.name} is larger than ${state.largest >> 20} MiB: put it into the folder in which the workbench was started, and choose it there.`);
      await measurement.add(await (await request(`upload?name=${encodeURIComponent(file.name)}`, file, true)).json());
    } catch (error) { messages.push(error.message); }
  if (messages.length) showError({ message: messages.join("\n") });
}

async function refresh() {
  try {
    const found = await requestJson("state");
    if (!(found.version < state?.version)) show(found); // an answer that was overtaken
  } catch (error) { showError(error); }
}

/** Go to the page of the lot. */
function openLot(url) { location.href = `${url}${location.hash}`; }

async function openReport() {
  const opened = window.open("", "_blank");
  try {
    const { url } = await requestJson("report", {});
    opened ? (opened.location = url) : (location.href = url);
  } catch (error) {
    opened?.close();
    throw error;
  }
}

// The second click of a double-click is no wish of its own, however fast the answer to the first one is.
document.addEventListener("click", (event) => {
  if (!(event.detail > 1 && event.target.closest(`${ACTS}, .slide label`))) return;
  event.stopPropagation();
  event.preventDefault();
}, true);
// A file dialog opens by Enter, too: once the key is up, since a browser may take it for no wish of the user before.
addEventListener("keydown", (event) => {
  entered = event.key === "Enter" && event.target.matches("input[type=file]") ? event.target : null;
  if (entered) event.preventDefault();
});
addEventListener("keyup", (event) => { if (event.key === "Enter" && event.target === entered) entered.click(); });
byId("improve").addEventListener("click", () => act("improve", {}));
byId("stop").addEventListener("click", () => act("stop"));
byId("undo").addEventListener("click", () => act("undo"));
once(byId("report"), openReport, showError);
byId("lot").addEventListener("click", () => openLot(state.lot.url));
byId("error").querySelector("button").addEventListener("click", hideError);
byId("choose").addEventListener("change", (event) => upload(event.target.files));
addEventListener("dragover", (event) => {
  event.preventDefault();
  document.body.classList.toggle("over", !state?.steps.length && event.dataTransfer.types.includes("Files"));
});
addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("over"); });
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("over");
  if (!state?.steps.length && event.dataTransfer.files.length) upload(event.dataTransfer.files);
});
setInterval(showStatus, 500);

await refresh();
await measurement.restored;
if (initialFile && !state?.steps.length && measurement.empty) await addFile(initialFile);
follow((event) => {
  if (disconnected) { disconnected = false; hideError(); }
  if (event.event === "step") [convergence, progress].forEach((part) => part.clear());
  else if (event.event === "changed") {
    newest = event.version;
    if (!asking && (newest !== state?.version || state?.stage)) refresh();
  }
  else {
    convergence.update(event);
    progress.update(event);
    if (state?.stage === "run" && event.event === "generation") { panes.showStaircase(state, convergence); optimizers.show(state); }
    if (event.event === "stair" && !asking) refresh();
  }
}, (error) => { disconnected = true; showError(error); });
