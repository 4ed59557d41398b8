// Statements on single strokes: which one of another drawing they hold for, and the file without some of them.

import { walk } from "./picture.js";

// Distance from which two strokes are not taken for the same one, in widths and colours as `unlike` counts them.
const STRANGER = 40;

// The stroke of `strokes` most like `wanted`, both as { stroke, number, stage }; undefined if none is like it.
export function mostLike(strokes, wanted) {
  if (!wanted) return undefined;
  let [best, least] = [undefined, STRANGER];
  for (const other of strokes) {
    const unlikeness = unlike(other.stroke, wanted.stroke) + (other.number === wanted.number ? 0 : 0.01);
    if (unlikeness < least) [best, least] = [other, unlikeness];
  }
  return best;
}

// Grows with the distance of the ends (px), the difference of widths (px) and that of colours (10 levels are 1).
function unlike([a, radiusA, colorA, , kindsA], [b, radiusB, colorB, , kindsB]) {
  const ends = (points) => [points[0], points[1], points.at(-2), points.at(-1)];
  const [from, to] = [ends(a), ends(b)];
  const apart = (i, j) => Math.hypot(from[i] - to[j], from[i + 1] - to[j + 1]);
  const straight = apart(0, 0) + apart(2, 2), turned = apart(0, 2) + apart(2, 0);
  const channels = (color) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16));
  const [p, q] = [channels(colorA), channels(colorB)];
  const colors = p.reduce((sum, level, c) => sum + Math.abs(level - q[c]), 0) / 30;
  return Math.min(straight, turned) + Math.abs(radiusA - radiusB) + colors + (kindsA === kindsB ? 0 : 1);
}

// The text of a file without the strokes that are not `kept`, back to front; null where its elements are not its strokes.
export function withoutStrokes(text, kept) {
  const lines = text.split("\n");
  // A document under the strokes has elements of its own; those of layers are on lines of their own, one each.
  let inside = false;
  const places = [];
  lines.forEach((line, k) => {
    if (line.includes('inkscape:groupmode="layer"')) inside = true;
    else if (line.startsWith("</g>")) inside = false;
    else if (inside && line.startsWith("<path ")) places.push(k);
  });
  if (places.length !== kept.length) return null;
  const dropped = new Set(places.filter((_, i) => !kept[i]));
  return lines.filter((_, k) => !dropped.has(k)).join("\n");
}

// The file of a scene's strokes as { stroke, stage }, an element each.
export function drawn({ width, height, background, strokes }) {
  const size = `width="${width}" height="${height}"`;
  const parts = [`<svg xmlns="http://www.w3.org/2000/svg" ${size} viewBox="0 0 ${width} ${height}">`];
  if (background) parts.push(`<rect ${size} fill="${background}"/>`);
  for (const stage of new Set(strokes.map(({ stage }) => stage))) {
    const own = strokes.filter((stroke) => stroke.stage === stage);
    parts.push(`<g id="stage-${stage}" fill="none" stroke-linecap="round" stroke-linejoin="round">`);
    parts.push(...own.map(({ stroke }) => element(stroke)), "</g>");
  }
  return [...parts, "</svg>", ""].join("\n");
}

function element(stroke) {
  const [, radius, color, opacity] = stroke;
  const look = `stroke="${color}" stroke-width="${short(2 * radius)}"`;
  const clear = opacity < 1 ? ` stroke-opacity="${Number(opacity.toFixed(3))}"` : "";
  return `<path d="${data(stroke)}" ${look}${clear}/>`;
}

const short = (value) => Number(value.toFixed(2));

// Control points follow each other; on-points are joined by lines to what comes before them.
function data(stroke) {
  const { start, pieces, closed } = walk(stroke);
  const place = ([x, y]) => `${short(x)} ${short(y)}`;
  const parts = pieces.map((piece) => (piece.length > 1 ? "Q" : "L") + piece.map(place).join(" "));
  if (pieces.length === 0) parts.push(`h0.01`);
  return `M${place(start)}${parts.join("")}${closed ? "Z" : ""}`;
}
