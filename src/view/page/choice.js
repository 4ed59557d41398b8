// Statements on single marks: which one of another drawing they hold for, and the file without some of them.

import { bounds, isArea, shadeOf, walks } from "./picture.js";

// Distance from which two marks are not taken for the same one, in widths and colours as `unlike` counts them.
const STRANGER = 40;

// The mark of `marks` most like `wanted`, both as { mark, number, stage }; undefined if none is like it.
export function mostLike(marks, wanted) {
  if (!wanted) return undefined;
  let [best, least] = [undefined, STRANGER];
  for (const other of marks) {
    const unlikeness = unlike(other.mark, wanted.mark) + (other.number === wanted.number ? 0 : 0.01);
    if (unlikeness < least) [best, least] = [other, unlikeness];
  }
  return best;
}

// Grows with the distance of the ends (px), the difference of widths (px) and that of colours (10 levels are 1).
function unlike(markA, markB) {
  if (isArea(markA) !== isArea(markB)) return Infinity;
  const [[a, radiusA, colorA, , kindsA], [b, radiusB, colorB, , kindsB]] = [markA, markB];
  const ends = (points) => [points[0], points[1], points.at(-2), points.at(-1)];
  const [from, to] = [ends(a), ends(b)];
  const apart = (i, j) => Math.hypot(from[i] - to[j], from[i + 1] - to[j + 1]);
  const straight = apart(0, 0) + apart(2, 2), turned = apart(0, 2) + apart(2, 0);
  const channels = (color) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16));
  const [p, q] = [channels(colorA), channels(colorB)];
  const colors = p.reduce((sum, level, c) => sum + Math.abs(level - q[c]), 0) / 30;
  return Math.min(straight, turned) + Math.abs(radiusA - radiusB) + colors + (kindsA === kindsB ? 0 : 1);
}

// The lines of a file that are elements of its marks, back to front, by their numbers.
export function linesOfMarks(lines) {
  // A document under the marks has elements of its own; those of layers are on lines of their own, one each.
  let inside = false;
  const places = [];
  lines.forEach((line, k) => {
    if (line.includes('inkscape:groupmode="layer"')) inside = true;
    else if (line.startsWith("</g>")) inside = false;
    else if (inside && /^<(path|circle|ellipse|rect) /.test(line)) places.push(k);
  });
  return places;
}

// The text of a file without the marks that are not `kept`, back to front; null where its elements are not its marks.
export function withoutMarks(text, kept) {
  const lines = text.split("\n");
  const places = linesOfMarks(lines);
  if (places.length !== kept.length) return null;
  // A gradient stands before the area that it is of.
  const isGradient = (k) => /^<(linear|radial)Gradient /.test(lines[k]);
  const dropped = new Set(places.filter((_, i) => !kept[i]).flatMap((k) => (isGradient(k - 1) ? [k - 1, k] : [k])));
  return lines.filter((_, k) => !dropped.has(k)).join("\n");
}

// The file of a scene's marks as { mark, stage }, an element each.
export function drawn({ width, height, background, shade, shadows = [], marks }) {
  const size = `width="${width}" height="${height}"`;
  const parts = [`<svg xmlns="http://www.w3.org/2000/svg" ${size} viewBox="0 0 ${width} ${height}">`];
  if (background) parts.push(`<rect ${size} fill="${background}"/>`);
  if (shade) parts.push(`${gradient(shade, "shade")}\n<rect ${size} fill="url(#shade)"/>`);
  shadows.forEach(([mark, blur], k) => parts.push(blur ? blurred([mark, blur], k + 1) : element(mark, `shade-0-${k + 1}`)));
  for (const stage of new Set(marks.map(({ stage }) => stage))) {
    const own = marks.filter((mark) => mark.stage === stage);
    parts.push(`<g id="stage-${stage}" fill="none" stroke-linecap="round" stroke-linejoin="round">`);
    parts.push(...own.map(({ mark }, k) => element(mark, `shade-${stage}-${k + 1}`)), "</g>");
  }
  return [...parts, "</svg>", ""].join("\n");
}

function element(mark, id) {
  const [, radius, color, opacity] = mark, shade = shadeOf(mark);
  const paint = isArea(mark) ? "fill" : "stroke";
  const width = isArea(mark) ? "" : ` stroke-width="${short(2 * radius)}"`;
  const clear = opacity < 1 ? ` ${paint}-opacity="${Number(opacity.toFixed(3))}"` : "";
  const path = (fill) => `<path d="${walks(mark).map(data).join("")}" ${paint}="${fill}"${width}${clear}/>`;
  return shade ? `${gradient(shade, id)}\n${path(`url(#${id})`)}` : path(color);
}

// The elements of a shadow, whose filter reaches as far as its blur.
function blurred([mark, blur], number) {
  const box = bounds(mark), reach = 3 * blur;
  const low = box.slice(0, 2).map((v) => Math.floor(v - reach));
  const high = box.slice(2).map((v) => Math.ceil(v + reach));
  const place = `x="${low[0]}" y="${low[1]}" width="${high[0] - low[0]}" height="${high[1] - low[1]}"`;
  const kind = 'filterUnits="userSpaceOnUse" color-interpolation-filters="sRGB"';
  const filter = `<filter id="blur-${number}" ${kind} ${place}><feGaussianBlur stdDeviation="${short(blur)}"/></filter>`;
  return filter + element(mark).replace("<path", `<path id="shadow-${number}" filter="url(#blur-${number})"`);
}

// The element of a gradient, whose colours are "rgb(r g b / a)".
function gradient({ axis, stops }, id) {
  const [kind, names] = axis.length === 4 ? ["linear", ["x1", "y1", "x2", "y2"]] : ["radial", ["cx", "cy", "r"]];
  const numbers = names.map((name, k) => `${name}="${short(axis[k])}"`).join(" ");
  const stop = ([offset, color]) => {
    const [red, green, blue, opacity] = color.match(/[\d.]+/g).map(Number);
    const hex = [red, green, blue].map((v) => v.toString(16).padStart(2, "0")).join("");
    return `<stop offset="${Number(offset.toFixed(3))}" stop-color="#${hex}" stop-opacity="${Number(opacity.toFixed(3))}"/>`;
  };
  return `<${kind}Gradient id="${id}" gradientUnits="userSpaceOnUse" ${numbers}>${stops.map(stop).join("")}</${kind}Gradient>`;
}

const short = (value) => Number(value.toFixed(2));

// A piece of one place is a line, of two a quadratic curve, of three a cubic one.
function data({ start, pieces, closed }) {
  const place = ([x, y]) => `${short(x)} ${short(y)}`;
  const parts = pieces.map((piece) => " LQC"[piece.length] + piece.map(place).join(" "));
  if (pieces.length === 0) parts.push(`h0.01`);
  return `M${place(start)}${parts.join("")}${closed ? "Z" : ""}`;
}
