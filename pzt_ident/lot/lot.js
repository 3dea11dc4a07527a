let column = null, down = false, typed = "";

/** Sort and filter the table as it was chosen. */
function arrange() {
  const table = document.querySelector("#table-devices");
  if (!table) return;
  const rows = [...table.tBodies[0].rows], words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  document.querySelector("#filter").value = typed;
  for (const row of rows) row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
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

document.addEventListener("click", ({ target }) => {
  const cell = target.closest("#table-devices thead th");
  if (!cell) return;
  [down, column] = [cell.getAttribute("aria-sort") === "ascending", cell.cellIndex];
  arrange();
});
document.addEventListener("input", ({ target }) => {
  if (target.id !== "filter") return;
  typed = target.value;
  arrange();
});
document.addEventListener("redrawn", arrange);
arrange();
