// The search: hides the words, and the chapters of the manual, that do not have what is typed.
const find = document.getElementById("find"), found = document.getElementById("found");
const cards = [...document.querySelectorAll(".cards li")];
const sections = [...document.querySelectorAll(".word, .chapter")].map((node) => ({ node, text: node.textContent.toLowerCase() }));
const textOf = (card) => {
  const target = document.querySelector(card.querySelector("a").getAttribute("href"));
  return `${card.dataset.find} ${target.textContent}`.toLowerCase();
};
const texts = cards.map(textOf);

function show() {
  const asked = find.value.toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (text) => asked.every((part) => text.includes(part));
  cards.forEach((card, place) => { card.hidden = !fits(texts[place]); });
  sections.forEach(({ node, text }) => { node.hidden = !fits(text); });
  for (const group of document.querySelectorAll(".cards"))
    group.hidden = group.previousElementSibling.hidden = ![...group.children].some((card) => !card.hidden);
  for (const group of document.querySelectorAll(".group"))
    group.hidden = ![...group.querySelectorAll(".word")].some((word) => !word.hidden);
  const words = cards.filter((card) => !card.hidden).length;
  const chapters = sections.filter(({ node }) => !node.hidden && node.matches(".chapter")).length;
  found.textContent = asked.length ? `${words} of ${cards.length} words, ${chapters} chapters of the manual` : "";
}

find.addEventListener("input", show);
find.addEventListener("keydown", (event) => {
  if (event.key === "Escape") { find.value = ""; show(); }
  if (event.key === "Enter") cards.find((card) => !card.hidden)?.querySelector("a").click();
});
document.addEventListener("keydown", (event) => {
  if (event.key === "/" && document.activeElement !== find) { event.preventDefault(); find.focus(); }
});
window.addEventListener("hashchange", () => {
  const target = document.getElementById(location.hash.slice(1));
  if (target?.closest("[hidden]")) { find.value = ""; show(); target.scrollIntoView(); }
});
