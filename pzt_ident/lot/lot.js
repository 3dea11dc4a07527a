const BAR = "[data-below]";
let column = null, down = false, typed = "", chosen = null; // what a bar says of itself

/** Sort and filter the table as it was chosen. */
function arrange() {
  const table = document.querySelector("#table-devices");
  if (!table) return;
  const rows = [...table.tBodies[0].rows], words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  document.querySelector("#filter").value = typed;
  const inside = chosen ? rowsOf(chosen) : rows;
  for (const row of rows) row.hidden = !inside.includes(row) || !words.every((word) => row.textContent.toLowerCase().includes(word));
  showChosen();
  document.querySelector("#shown").textContent = `${rows.filter(({ hidden }) => !hidden).length} of ${rows.length}`;
  if (column === null) return;
  for (const cell of table.tHead.rows[0].cells) cell.removeAttribute("aria-sort");
  table.tHead.rows[0].cells[column]?.setAttribute("aria-sort", down ? "descending" : "ascending");
  rows.sort((a, b) => (down ? -1 : 1) * order(valueOf(a.cells[column]), valueOf(b.cells[column])));
  table.tBodies[0].append(...rows);
}

function valueOf(cell) {
  const text = cell.dataset.value ?? cell.textContent.trim(), number = Number(text);
  return text === "" || Number.isNaN(number) ? text : number;
}

function order(a, b) {
  return typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
}

/** The rows of the devices in a bar. */
function rowsOf({ quantity, low, below }) {
  const { tHead, tBodies } = document.querySelector("#table-devices");
  const place = [...tHead.rows[0].cells].findIndex((cell) => cell.textContent.trim().startsWith(`${quantity} [`));
  return [...tBodies[0].rows].filter(({ cells }) => {
    const { classList, dataset } = cells[place];
    return !classList.contains("quiet") && Number(dataset.value) >= Number(low) && Number(dataset.value) < Number(below);
  });
}

/** Open the device of a bar, or show in the table those that are in it. */
function choose(bar) {
  const rows = rowsOf(bar.dataset), link = rows[0]?.querySelector("a");
  if (bar.dataset.count === "1" && link) return link.click();
  chosen = saidBy(bar);
  arrange();
  const button = document.querySelector("#chosen");
  button.scrollIntoView({ block: "nearest" });
  button.focus();
}

function saidBy(bar) {
  return { ...bar.dataset, said: bar.getAttribute("aria-label") };
}

/** Where the bars were drawn anew with other ends, choose the one that is where the chosen one was. */
function follow() {
  const bars = [...document.querySelectorAll(BAR)];
  if (!chosen || bars.some(isChosen)) return;
  const holds = ({ dataset: { quantity, low, below } }) => quantity === chosen.quantity && Number(low) <= Number(chosen.low) && Number(chosen.low) < Number(below);
  const successor = bars.find(holds);
  if (successor) chosen = saidBy(successor);
}

function isChosen({ dataset }) {
  return chosen?.quantity === dataset.quantity && chosen.low === dataset.low && chosen.below === dataset.below;
}

function showChosen() {
  const button = document.querySelector("#chosen");
  button.hidden = !chosen;
  if (chosen) button.textContent = `${chosen.said.split(": ")[0]} ✕`;
  for (const bar of document.querySelectorAll(BAR)) bar.setAttribute("aria-pressed", isChosen(bar));
  for (const panel of document.querySelectorAll(`[role=group]:has(> ${BAR})`)) reach(panel.querySelector("[aria-pressed=true]") ?? panel.querySelector(BAR));
}

/** Let the tabulator lead to this bar, of all bars of its panel. */
function reach(bar) {
  for (const other of bar.parentNode.querySelectorAll(BAR)) other.setAttribute("tabindex", other === bar ? 0 : -1);
}

/** Say which devices are in a bar, above it. */
function point(bar) {
  const note = document.querySelector("#pointed");
  note.hidden = !bar;
  if (!bar) return;
  note.textContent = bar.getAttribute("aria-label");
  const { left, top } = bar.getBoundingClientRect(), { offsetWidth, offsetHeight } = note;
  note.style.left = `${Math.max(4, Math.min(left, innerWidth - offsetWidth - 20))}px`;
  note.style.top = `${Math.max(4, top - offsetHeight - 4)}px`;
}

const WAYS = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity };
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") point(null);
  const bar = event.target.closest(BAR);
  if (!bar) return;
  if (event.key in WAYS) {
    const bars = [...bar.parentNode.querySelectorAll(BAR)];
    const next = bars[Math.max(0, Math.min(bars.length - 1, bars.indexOf(bar) + WAYS[event.key]))];
    reach(next);
    next.focus();
  } else if (event.key === "Enter" || event.key === " ") choose(bar);
  else return;
  event.preventDefault();
});
document.addEventListener("focusin", ({ target }) => point(target.closest(BAR)));
document.addEventListener("pointermove", ({ target, movementX, movementY }) => {
  if (movementX || movementY) point(target.closest(BAR)); // a page that moves below a mouse at rest tells of no bar
});
document.addEventListener("scroll", () => point(null), true);
document.addEventListener("click", ({ target }) => {
  const cell = target.closest("#table-devices thead th"), bar = target.closest(BAR);
  if (bar) choose(bar);
  else if (target.closest("#chosen")) {
    const before = [...document.querySelectorAll(BAR)].find(isChosen);
    chosen = null;
    arrange();
    (before ?? document.querySelector("#filter")).focus();
  } else if (cell) {
    [down, column] = [cell.getAttribute("aria-sort") === "ascending", cell.cellIndex];
    arrange();
  }
});
document.addEventListener("input", ({ target }) => {
  if (target.id !== "filter") return;
  typed = target.value;
  arrange();
});
document.addEventListener("redrawn", () => {
  follow();
  arrange();
});
arrange();
