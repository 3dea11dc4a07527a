import { Explorer } from "./explorer.js";
import { decode } from "./signals.js";
import { Staircase } from "./staircase.js";

const content = JSON.parse(document.getElementById("content").textContent);
for (const { place, ...stairs } of content.stairs) new Staircase(document.getElementById(place), stairs);
const explorer = new Explorer(
  document.getElementById("explorer"), await Promise.all(content.records.map(decode)), { floors: content.floors },
);
for (const button of document.querySelectorAll("button.reveal"))
  button.addEventListener("click", () => {
    const { record, axis, from, to } = button.dataset;
    explorer.reveal(record, axis, Number(from), Number(to));
  });
