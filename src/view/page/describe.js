// A mark in words.

import { isArea, paths } from "./picture.js";

// Number of points of a mark that are told.
const TOLD_POINTS = 24;

// Terms and texts about a mark, one of `count`.
export function describe({ mark, number, stage }, count) {
  const [, radius, color, opacity] = mark;
  const rows = [["number", `${number} of ${count}, stage ${stage}`]];
  rows.push(...paths(mark).map((path) => [isArea(mark) ? "ring" : "points", told(path)]));
  if (!isArea(mark)) rows.push(["width", `${round(2 * radius)} px`]);
  rows.push(["colour", color], ["opacity", opacity.toFixed(3)]);
  return rows.flatMap(([name, value]) => {
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = name;
    if (name === "colour") {
      const swatch = text.appendChild(document.createElement("span"));
      swatch.className = "dab";
      swatch.style.background = color;
    }
    text.append(value);
    return [term, text];
  });
}

const round = (value) => Number(value.toFixed(2));

// The points of a path. Control points are in parentheses.
function told({ places, kinds }) {
  const pairs = places.slice(0, TOLD_POINTS).map(([x, y], k) => {
    const pair = `${round(x)}, ${round(y)}`;
    return kinds[k] === "o" ? pair : `(${pair})`;
  });
  if (places.length > TOLD_POINTS) pairs.push(`${places.length - TOLD_POINTS} more`);
  if (kinds.endsWith("z")) pairs.push("start");
  return pairs.join("  →  ");
}
