// What a person changes in a drawing, the way back, and the file with it.

import { drawn, withoutMarks } from "./choice.js";

// Colours that differ by at most so many levels in each channel count as one: a new fit finds them again almost.
const SAME = 10;

// `gone` and `veiled` are sets of marks' numbers; `colors` is a list of [from, to]; `background` is null if it is removed, and
// undefined if it is as the drawing has it.
const UNCHANGED = { gone: new Set(), veiled: new Set(), colors: [], background: undefined };

// The changes, with undo and redo.
export class Edits {
  now = UNCHANGED;
  past = [];
  future = [];

  change(part) {
    this.past.push(this.now);
    this.future = [];
    this.now = { ...this.now, ...part };
  }

  undo() {
    if (!this.past.length) return;
    this.future.push(this.now);
    this.now = this.past.pop();
  }

  redo() {
    if (!this.future.length) return;
    this.past.push(this.now);
    this.now = this.future.pop();
  }

  // Passes every set of marks through `follow`, since their numbers have changed.
  renumber(follow) {
    const renumbered = (edit) => ({ ...edit, gone: follow(edit.gone), veiled: follow(edit.veiled) });
    this.now = renumbered(this.now);
    [this.past, this.future] = [this.past.map(renumbered), this.future.map(renumbered)];
  }

  // Paints colours that are shown, as [from, to], also where they were painted before.
  repaint(colors) {
    const next = new Map(colors);
    const through = this.now.colors.map(([from, to]) => [from, next.get(to) ?? to]);
    const known = new Set(this.now.colors.map(([from]) => from));
    this.change({ colors: [...through, ...colors.filter(([from]) => !known.has(from))] });
  }

  // Lets the changes of colours hold for those of another scene that are almost the same.
  adopt(scene) {
    const { colors } = this.now;
    if (!colors.length) return;
    const known = new Set(colors.map(([from]) => from));
    const fresh = [...new Set(scene.stages.flat().map(([, , color]) => color))].filter((color) => !known.has(color));
    const pairs = fresh.map((color) => [color, mostAlike(color, colors)]).filter(([, to]) => to);
    this.now = { ...this.now, colors: [...colors, ...pairs] };
  }
}

export const levels = (color) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16));
export const hex = (channels) => `#${channels.map((v) => Math.round(Math.min(255, Math.max(0, v))).toString(16).padStart(2, "0")).join("")}`;

function mostAlike(color, colors) {
  const own = levels(color);
  const apart = ([from]) => Math.max(...levels(from).map((level, k) => Math.abs(level - own[k])));
  const near = colors.map((pair) => [apart(pair), pair[1]]).filter(([far]) => far <= SAME);
  return near.sort(([a], [b]) => a - b)[0]?.[1];
}

// The scene with another background and other colours.
export function repaintedScene(scene, { colors, background }) {
  if (!colors.length && background === undefined) return scene;
  const next = new Map(colors);
  const painted = (color) => next.get(color) ?? color;
  const stages = scene.stages.map((list) => list.map(([points, radius, color, ...rest]) => [points, radius, painted(color), ...rest]));
  const paper = background === undefined ? { background: scene.background && painted(scene.background) } : { background, shade: undefined, shadows: undefined };
  return { ...scene, ...paper, stages };
}

// The text of a file as it is shown: without the marks that are not `kept`, repainted. `scene` is the repainted one, which is
// written anew where the elements of the file are not its marks.
export function edited(text, kept, { colors, background }, scene) {
  const whole = kept.every(Boolean);
  const part = whole ? text : withoutMarks(text, kept);
  if (part === null) {
    const marks = scene.stages.flatMap((list, k) => list.map((mark) => ({ mark, stage: k + 1 })));
    return drawn({ ...scene, marks: marks.filter((_, k) => kept[k]) });
  }
  return repaintedText(part, colors, background);
}

function repaintedText(text, colors, background) {
  if (!colors.length && background === undefined) return text;
  const start = text.indexOf("<g");
  // A style sheet has colours, too.
  let head = painted(text.slice(0, start), colors);
  if (background === null) head = head.replace(/<(?:rect|filter) .*\n?/g, "");
  else if (background) head = head.replace(/(<rect [^>]*?fill="|\.background\{fill:)[^"}]*/, `$1${background}`);
  return head + painted(text.slice(start), colors);
}

function painted(text, colors) {
  const next = new Map(colors);
  return text.replace(/\b((?:fill|stroke)(?:="|:))#([0-9a-f]{6}|[0-9a-f]{3})/g, (all, name, digits) => {
    const long = `#${digits.length === 3 ? [...digits].map((d) => d + d).join("") : digits}`;
    return next.has(long) ? `${name}${next.get(long)}` : all;
  });
}
