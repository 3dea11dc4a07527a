import { element, named } from "./parts.js";

/** A word as the link to its section in the atlas, `href`, in a tab of its own; `doc` says what it is. */
export function about(parent, word, href, doc = "") {
  return named(parent, "a", { class: "about", href, target: "_blank", title: `${doc} More about ${word} in a new tab.`.trim() }, word);
}

/** A sentence in which each word of the catalogue is, where it is first named, the link to its section. */
export function sentence(parent, tag, text, { blocks, effects }) {
  const paragraph = element(parent, tag);
  const left = new Map([...blocks, ...effects].map((item) => [item.name, item.about]));
  for (const part of text.split(/\b(\w+(?:\.\w+)*)\b/)) {
    const [word] = part.split(".");
    if (left.has(word)) about(paragraph, part, left.get(word));
    else paragraph.append(part);
    left.delete(word);
  }
  return paragraph;
}
