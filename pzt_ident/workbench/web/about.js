import { element, named } from "./parts.js";

/** A word as the link to its section in the atlas, `href`, in a tab of its own; `doc` says what it is. */
export function about(parent, word, href, doc = "", text = word) {
  return named(parent, "a", { class: "about", href, target: "_blank", title: `${doc} More about ${word} in a new tab.`.trim() }, text);
}

/** Where in the atlas an item of a model is, in one of its forms or not; `known` is its word in the catalogue. */
export const placeOf = (known, item) => known.forms[item] ?? known.about;

/** A sentence in which each word of the catalogue is, where it is first named, the link to its section. */
export function sentence(parent, tag, text, catalogue) {
  return spell(element(parent, tag), text, catalogue);
}

/** The same in an element that is there; nothing changes where it has the text already. */
export function spell(node, text, { blocks, effects }) {
  if (node.textContent === text) return node;
  node.replaceChildren();
  const left = new Map([...blocks, ...effects].map((item) => [item.name, item]));
  for (const part of text.split(/\b(\w+(?:\.\w+)*)\b/)) {
    const [word] = part.split(".");
    if (left.has(word)) about(node, part, placeOf(left.get(word), part));
    else node.append(part);
    left.delete(word);
  }
  return node;
}
