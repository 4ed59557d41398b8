// A mark in words.

import { isArea, lineOf, paths } from "./picture.js";

// Number of points of a mark that are told.
const TOLD_POINTS = 24;

// Terms and texts about a mark, one of `count`.
export function describe({ mark, number, stage }, count) {
  const [, radius, color, opacity] = mark;
  const rows = [["number", `${number} of ${count}, stage ${stage}`]];
  const line = lineOf(mark), isFilled = isArea(mark) && !line;
  const shown = line ? [line.points, 0, color, opacity, line.kinds] : mark;
  rows.push(...paths(shown).map((path) => [isFilled ? "ring" : "points", told(path)]));
  if (line) rows.push(["widths", `${widths(line)} px`]);
  else if (!isFilled) rows.push(["width", `${round(2 * radius)} px`]);
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

// The widths at the points of a line, in parentheses where those are control points.
function widths({ widths, kinds }) {
  const texts = widths.slice(0, TOLD_POINTS).map((width, k) => (kinds[k] === "o" ? `${round(width)}` : `(${round(width)})`));
  if (widths.length > TOLD_POINTS) texts.push(`${widths.length - TOLD_POINTS} more`);
  return texts.join("  →  ");
}

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
