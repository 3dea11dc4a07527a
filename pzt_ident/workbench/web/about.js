import { element, named } from "./parts.js";

/** A word as the link to its section in the atlas, `href`, in a tab of its own; `doc` says what it is. */
export function about(parent, word, href, doc = "", text = word) {
  return named(parent, "a", { class: "about", href, target: "_blank", title: `${doc} More about ${word} in a new tab.`.trim() }, text);
}

/** Where in the atlas an item of a model is, in one of its forms or not; `known` is its word in the catalogue. */
export const placeOf = (known, item) => known.forms?.[item] ?? known.about;

/** A sentence in which each word of the catalogue is, where it is first named, the link to its section. */
export function sentence(parent, tag, text, catalogue) {
  return spell(element(parent, tag), text, catalogue);
}

/** The same in an element that is there; nothing changes where it has the text already. */
export function spell(node, text, catalogue) {
  if (node.textContent === text) return node;
  node.replaceChildren();
  for (const { text: part, href } of spelled(text, catalogue)) href ? about(node, part, href) : node.append(part);
  return node;
}

/** The parts of a sentence, those with `href` a word, a word in a form (`creep.voltage`, `creep (voltage)`) or one with
 * its parameter, where it is first named. */
export function spelled(text, { blocks, effects, optimizer_words: optimizers }) {
  const known = new Map([...blocks, ...effects, ...optimizers].map((item) => [item.name, item])), linked = new Set();
  return text.split(/\b([a-z]\w*(?:\.\w+)*(?: \(\w+\))?)/).flatMap((part) => {
    const [, name, rest = "", form] = /^([a-z]\w*(?:\.\w+)*)( \((\w+)\))?$/.exec(part) ?? [];
    const item = known.get(name?.split(".")[0]), inForm = item?.forms?.[`${name}.${form}`];
    const href = item && (inForm ?? placeOf(item, name));
    if (!href || linked.has(href)) return [{ text: part }];
    linked.add(href);
    return inForm ? [{ text: part, href }] : [{ text: name, href }, { text: rest }];
  });
}
