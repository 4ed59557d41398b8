// What the viewer does with single strokes, without a browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { drawn, mostLike, withoutStrokes } from "../../src/view/page/choice.js";

const line = (x, color = "#102030", radius = 2) => [[x, 0, x, 40], radius, color, 1, "oo"];
const numbered = (...strokes) => strokes.map((stroke, k) => ({ stroke, number: k + 1, stage: 1 }));

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

test("a file loses the strokes that are not kept and nothing else", () => {
  const text = readFileSync(new URL("../../docs/pictures/coffee-quality-20.svg", import.meta.url), "utf8");
  const count = text.split("<path ").length - 1;
  const kept = Array.from({ length: count }, (_, k) => k !== 1 && k !== count - 1);
  const part = withoutStrokes(text, kept);
  assert.equal(part.split("<path ").length - 1, count - 2);
  assert.equal(part.split("\n").length, text.split("\n").length - 2);
  assert.equal(withoutStrokes(text, kept.map(() => true)), text);
  assert.equal(withoutStrokes(text, kept.slice(1)), null);
});

test("paths of every kind are written as SVG", () => {
  const strokes = [
    [[10, 20], 2, "#102030", 1, "o"],
    [[0, 0, 10, 5, 20, 0], 1.5, "#ffffff", 0.5, "oco"],
    [[0, 0, 10, 0, 10, 10], 1, "#000000", 1, "oooz"],
  ].map((stroke) => ({ stroke, stage: 1 }));
  const text = drawn({ width: 30, height: 20, background: "#eeeeee", strokes });
  for (const part of [
    '<rect width="30" height="20" fill="#eeeeee"/>',
    'd="M10 20h0.01" stroke="#102030" stroke-width="4"/>',
    'd="M0 0Q10 5 20 0" stroke="#ffffff" stroke-width="3" stroke-opacity="0.5"/>',
    'd="M0 0L10 0L10 10L0 0Z"',
  ]) {
    assert.ok(text.includes(part), `${part} is not in ${text}`);
  }
});
