// The colours of plots.

/** Of dots, from low to high values. */
export const HEAT = ["#30123b", "#4559cb", "#3e9bfe", "#18d7cc", "#46f783", "#a4fc3b", "#e1dc37", "#fda330", "#ef5911", "#b81f02", "#7a0402"];

/** A colour of the page's style sheet, such as "--model". */
export function colour(name) {
  return name.startsWith("--") ? getComputedStyle(document.documentElement).getPropertyValue(name).trim() : name;
}

/** Red, green and blue of a colour of the style sheet, 0 to 255. */
export function rgb(name) {
  const hex = colour(name);
  return [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16));
}
