// The page of a lot, kept up to date; a device opens like a run.

import { keepingFocus } from "./parts.js";
import { requestJson, save } from "./session.js";

const PAUSE = 1500; // ms between two looks at the folder
const PARTS = ["said", "told", "table"];
const byId = (id) => document.getElementById(id);
const shown = {};
let version = null;

/** Put in what has changed since the page was drawn. */
async function redraw() {
  const page = new DOMParser().parseFromString(await (await fetch(location.pathname)).text(), "text/html");
  const parts = PARTS.map((id) => [id, page.getElementById(id)?.innerHTML ?? ""]);
  keepingFocus(() => {
    for (const [id, html] of parts) if (shown[id] !== html) byId(id).innerHTML = shown[id] = html;
    document.dispatchEvent(new Event("redrawn"));
  });
}

async function look() {
  try {
    const { version: newest, of, done, broken, running, failure } = await requestJson("lot");
    const waiting = of - done - broken, progress = byId("live").querySelector("progress");
    Object.assign(progress, { max: of || 1, value: done + broken, hidden: !running && !waiting });
    tell(byId("counts"), waiting || running ? `${done} of ${of} devices done${broken ? `, ${broken} broken` : ""}` : "");
    for (const button of document.querySelectorAll("[data-file]")) button.hidden = waiting > 0 || running;
    byId("stop").hidden = !running;
    byId("go-on").hidden = running || !waiting;
    say(failure);
    if (newest !== version) {
      if (version !== null) await redraw();
      version = newest;
    }
  } catch (error) { say(error.message); }
  setTimeout(look, PAUSE);
}

function tell(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function say(message) {
  tell(byId("error"), message ?? "");
  byId("error").hidden = !message;
}

async function ask(name, body = {}) {
  try {
    await requestJson(name, body);
    return true;
  } catch (error) { say(error.message); }
  return false;
}

document.addEventListener("click", async (event) => {
  const link = event.target.closest("a[data-device]"), file = event.target.closest("button[data-file]")?.dataset.file;
  if (link) {
    event.preventDefault();
    if (await ask("device", { device: link.dataset.device })) location.href = `/${location.hash}`;
  } else if (file) save(`lot_file?name=${encodeURIComponent(file)}`, file).catch((error) => say(error.message));
});
byId("stop").addEventListener("click", () => ask("stop"));
byId("go-on").addEventListener("click", () => ask("go_on"));
look();
