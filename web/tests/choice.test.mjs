// What the viewer does with single strokes, without a browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { drawn, mostLike, withoutMarks } from "../../src/view/page/choice.js";
import { bounds, counted, covers, markAt } from "../../src/view/page/picture.js";

const line = (x, color = "#102030", radius = 2) => [[x, 0, x, 40], radius, color, 1, "oo"];
const numbered = (...marks) => marks.map((mark, k) => ({ mark, number: k + 1, stage: 1 }));
// A frame of two rings, and a drop of a line and a curve.
const frame = [[0, 0, 20, 0, 20, 20, 0, 20, 5, 5, 5, 15, 15, 15, 15, 5], 0, "#204060", 1, "oooozooooz"];
const drop = [[30, 0, 50, 0, 40, 30], 0, "#a03010", 0.5, "oocz"];

test("a stroke is found again under another number", () => {
  const before = numbered(line(10), line(50), line(90));
  const after = numbered(line(0), line(10.4), line(51), line(50, "#ff0000"));
  assert.equal(mostLike(after, before[1]).number, 3);
  assert.equal(mostLike(after, before[0]).number, 2);
});

test("a stroke that is gone is not mistaken for another", () => {
  assert.equal(mostLike(numbered(line(300)), numbered(line(10))[0]), undefined);
  assert.equal(mostLike(numbered(line(10)), undefined), undefined);
});

test("of equal strokes the one of the same number is the same", () => {
  const strokes = numbered(line(10), line(10), line(10));
  assert.equal(mostLike(strokes, strokes[1]).number, 2);
});

test("an area is not mistaken for a stroke", () => {
  const closed = [frame[0], 0.3, frame[2], 1, frame[4]];
  assert.equal(mostLike(numbered(closed, frame), numbered(frame)[0]).number, 2);
  assert.equal(mostLike(numbered(closed), numbered(frame)[0]), undefined);
});

test("an area is hit where it is filled, and its topmost mark is found", () => {
  const hits = [[2, 10], [10, 10], [25, 10]].map(([x, y]) => covers(frame, x, y));
  assert.deepEqual(hits, [true, false, false]);
  // A curve: its top is at y = 15.
  assert.deepEqual([[40, 14], [40, 16], [31, 10]].map(([x, y]) => covers(drop, x, y)), [true, false, false]);
  const twice = [[0, 0, 9, 0, 9, 9, 0, 9, 3, 3, 6, 3, 6, 6, 3, 6], 0, "#000000", 1, "oooozooooz"];
  assert.ok(covers(twice, 4, 4), "what is wound around twice is filled");
  assert.equal(markAt(numbered(frame, line(2)), 2, 10).number, 2);
  assert.equal(markAt(numbered(frame, line(2)), 19, 10).number, 1);
  assert.equal(markAt(numbered(frame, line(2)), 10, 10), undefined);
});

test("cubic curves and arcs are hit where they are, and lie in their bounds", () => {
  // Three quarters of a circle around (10, 10), whose points have a smaller box, and a cubic curve whose top is at y = 7.5.
  const bow = [[20, 10, 10 - 50 ** 0.5, 10 + 50 ** 0.5, 10, 0], 1, "#000000", 1, "oao"];
  const hits = [[10, 20.8], [-0.8, 10], [10, 18.8], [17, 3]].map(([x, y]) => covers(bow, x, y));
  assert.deepEqual(hits, [true, true, false, false]);
  const box = bounds(bow);
  [-1, -1, 21, 21].forEach((side, k) => assert.ok((side - box[k]) * (k < 2 ? 1 : -1) >= -1e-3 && Math.abs(side - box[k]) < 0.5, `${box}`));
  const arch = [[0, 0, 0, 10, 20, 10, 20, 0], 0, "#000000", 1, "obboz"];
  assert.deepEqual([[10, 7.3], [10, 7.7], [1, 3]].map(([x, y]) => covers(arch, x, y)), [true, false, true]);
  // The other way around the same three points, the arc is the same.
  const turned = [[10, 0, 10 - 50 ** 0.5, 10 + 50 ** 0.5, 20, 10], 1, "#000000", 1, "oao"];
  assert.deepEqual([[10, 20.8], [17, 3]].map(([x, y]) => covers(turned, x, y)), [true, false]);
});

test("marks are counted in words", () => {
  const lists = [[], [line(1)], [frame], [line(1), line(2), frame, drop]];
  assert.deepEqual(lists.map(counted), ["0 strokes", "1 stroke", "1 area", "2 areas, 2 strokes"]);
});

test("a file loses the strokes that are not kept and nothing else", () => {
  const text = readFileSync(new URL("../../docs/pictures/coffee-quality-20.svg", import.meta.url), "utf8");
  const count = text.split("<path ").length - 1;
  const kept = Array.from({ length: count }, (_, k) => k !== 1 && k !== count - 1);
  const part = withoutMarks(text, kept);
  assert.equal(part.split("<path ").length - 1, count - 2);
  assert.equal(part.split("\n").length, text.split("\n").length - 2);
  assert.equal(withoutMarks(text, kept.map(() => true)), text);
  assert.equal(withoutMarks(text, kept.slice(1)), null);
  const [circle, rect] = ['<circle cx="9" cy="9" r="5" fill="#204060"/>', '<rect x="2" y="3" width="5" height="4" fill="#204060"/>'];
  const layer = '<g id="stage-1" inkscape:groupmode="layer" inkscape:label="Stage 1">';
  const shapes = (...marks) => [layer, "<title>Stage 1</title>", ...marks, "</g>", ""].join("\n");
  assert.equal(withoutMarks(shapes(circle, rect), [true, false]), shapes(circle));
});

test("paths of every kind are written as SVG", () => {
  const marks = [
    [[10, 20], 2, "#102030", 1, "o"],
    [[0, 0, 10, 5, 20, 0], 1.5, "#ffffff", 0.5, "oco"],
    [[0, 0, 10, 0, 10, 10], 1, "#000000", 1, "oooz"],
    frame,
    drop,
    [[0, 0, 0, 10, 20, 10, 20, 0, 30, 10], 1, "#000000", 1, "obboo"],
    [[0, 0, 5, 0, 9, 0], 1, "#000000", 1, "oao"],
    [[0, 0, 1, 0.1, 2, 0], 1, "#000000", 1, "oao"],
  ].map((mark) => ({ mark, stage: 1 }));
  const text = drawn({ width: 30, height: 20, background: "#eeeeee", marks });
  for (const part of [
    '<rect width="30" height="20" fill="#eeeeee"/>',
    'd="M10 20h0.01" stroke="#102030" stroke-width="4"/>',
    'd="M0 0Q10 5 20 0" stroke="#ffffff" stroke-width="3" stroke-opacity="0.5"/>',
    'd="M0 0L10 0L10 10L0 0Z"',
    '<path d="M0 0L20 0L20 20L0 20L0 0ZM5 5L5 15L15 15L15 5L5 5Z" fill="#204060"/>',
    '<path d="M30 0L50 0Q40 30 30 0Z" fill="#a03010" fill-opacity="0.5"/>',
    'd="M0 0C0 10 20 10 20 0L30 10"',
    // An arc of three points in a row is a line, and another one cubic curves.
    'd="M0 0L9 0"',
    'd="M0 0C0.66 0.13 1.34 0.13 2 0"',
  ]) {
    assert.ok(text.includes(part), `${part} is not in ${text}`);
  }
});

test("an area keeps its gradient, and takes it away", () => {
  const shade = { axis: [0, 0, 20, 0], stops: [[0, "rgb(32 64 96 / 1)"], [0.5, "rgb(255 0 9 / 0.5)"]] };
  const marks = [{ mark: [...frame, shade], stage: 1 }, { mark: drop, stage: 1 }];
  const text = drawn({ width: 60, height: 40, marks });
  assert.match(text, /<linearGradient id="shade-1-1" gradientUnits="userSpaceOnUse" x1="0" y1="0" x2="20" y2="0">/);
  assert.match(text, /<stop offset="0.5" stop-color="#ff0009" stop-opacity="0.5"\/>/);
  assert.match(text, /fill="url\(#shade-1-1\)"/);
  const layer = text.replace('<g id="stage-1"', '<g id="stage-1" inkscape:groupmode="layer"');
  assert.ok(!withoutMarks(layer, [false, true]).includes("radient"));
  assert.ok(withoutMarks(layer, [true, false]).includes('<linearGradient id="shade-1-1"'));
});
