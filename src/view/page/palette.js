// The colours of a drawing, in few groups.

import { hex, levels } from "./edits.js";
import { drawMarks, drawPage, shadeOf } from "./picture.js";

// Most groups that are shown.
const MOST = 14;
// Longest side, px, at which the pixels of each group are counted.
const COUNTED = 96;

// Groups of the colours of a scene, as { color, members, share }: what it is shown as, the colours in it, and its share of the
// picture, largest first.
export function groups(scene) {
  const weights = weighed(scene);
  const colors = [...weights.keys()];
  if (!colors.length) return [];
  const seeds = colors.length <= MOST ? colors : spread(colors, weights);
  const lists = new Map(seeds.map((seed) => [seed, []]));
  for (const color of colors) lists.get(nearest(color, seeds)).push(color);
  const found = [...lists.values()].filter((members) => members.length).map((members) => group(members, weights));
  const total = found.reduce((sum, { share }) => sum + share, 0) || 1;
  return found.map((each) => ({ ...each, share: each.share / total })).sort((a, b) => b.share - a.share);
}

function group(members, weights) {
  const share = members.reduce((sum, color) => sum + weights.get(color), 0);
  const mean = [0, 1, 2].map((k) => members.reduce((sum, color) => sum + weights.get(color) * levels(color)[k], 0) / share);
  return { color: members.length === 1 ? members[0] : hex(mean), members, share };
}

// Colours far from each other, the first of them the one that is seen most.
function spread(colors, weights) {
  const seen = (color) => Math.sqrt(weights.get(color));
  const seeds = [colors.reduce((a, b) => (weights.get(b) > weights.get(a) ? b : a))];
  const far = new Map(colors.map((color) => [color, apart(color, seeds[0])]));
  while (seeds.length < MOST) {
    const next = colors.reduce((a, b) => (far.get(b) * seen(b) > far.get(a) * seen(a) ? b : a));
    seeds.push(next);
    for (const color of colors) far.set(color, Math.min(far.get(color), apart(color, next)));
  }
  return [...new Set(seeds)];
}

const nearest = (color, seeds) => seeds.reduce((a, b) => (apart(b, color) < apart(a, color) ? b : a));

// Square of a distance that follows the eye roughly (compuphase.com/cmetric.htm).
function apart(a, b) {
  const [p, q] = [levels(a), levels(b)];
  const red = (p[0] + q[0]) / 512;
  const [r, g, c] = p.map((level, k) => (level - q[k]) ** 2);
  return (2 + red) * r + 4 * g + (3 - red) * c;
}

// Pixels in which each colour is the topmost, about, and a little for colours that are hidden.
function weighed(scene) {
  const scale = COUNTED / Math.max(scene.width, scene.height);
  const [width, height] = [scene.width, scene.height].map((side) => Math.max(1, Math.round(side * scale)));
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  const marks = scene.stages.flat();
  const colors = [...new Set([...(scene.background ? [scene.background] : []), ...marks.filter((mark) => !mark[5]).map(([, , color]) => color)])];
  context.scale(scale, scale);
  // Each mark is painted in the number of its colour. Edges are mixtures, which count for some other colour: it is about.
  // A gradient has no colour to be changed: a number of none.
  const counted = (k) => hex([k & 255, (k >> 8) & 255, (k >> 16) & 255]);
  const number = new Map(colors.map((color, k) => [color, counted(k)]));
  const numbered = (mark) => {
    const [points, radius, color, , kinds] = mark;
    return [points, radius, shadeOf(mark) ? counted(colors.length) : number.get(color), 1, kinds];
  };
  drawPage(context, { ...scene, shade: undefined, background: scene.background && number.get(scene.background) });
  drawMarks(context, marks.filter(([, , , opacity]) => opacity > 0.5).map(numbered));
  const weights = new Map(colors.map((color) => [color, 0.01]));
  const { data } = context.getImageData(0, 0, width, height);
  for (let i = 0; i < data.length; i += 4) {
    const color = data[i + 3] === 255 && colors[data[i] | (data[i + 1] << 8) | (data[i + 2] << 16)];
    if (color) weights.set(color, weights.get(color) + 1);
  }
  return weights;
}
