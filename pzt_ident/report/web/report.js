import { Explorer } from "./explorer.js";
import { element } from "./parts.js";
import { decode } from "./signals.js";
import { Staircase } from "./staircase.js";

const content = JSON.parse(document.getElementById("content").textContent);
for (const { place, ...stairs } of content.stairs) new Staircase(document.getElementById(place), stairs);
const root = document.getElementById("explorer");
const panes = Object.fromEntries(["bar", "loop", "time"].map((name) => [name, element(root, "div", { class: name === "bar" ? "explorer-bar" : `pane ${name}` })]));
const spectra = content.spectra && (({ name, axis, use }) => content.spectra.find((item) => item.name === name && item.axis === axis && item.use === use));
const explorer = new Explorer(panes, await Promise.all(content.records.map(decode)), { floors: content.floors, wheel: "focused", spectra });
for (const button of document.querySelectorAll("button.reveal"))
  button.addEventListener("click", () => {
    const { record, axis, from, to } = button.dataset;
    explorer.reveal(record, axis, Number(from), Number(to));
  });
// The workbench has an atlas of its own.
if (location.pathname.startsWith("/report/"))
  for (const article of document.querySelectorAll("#words article")) {
    article.querySelector(".atlas")?.parentElement.remove();
    element(element(article, "p"), "a", { href: `/atlas#${article.id}`, target: "_blank" }, "In the atlas, with pictures");
  }
