// The renderer for losses of one's own: exact derivatives, and clear errors.

import assert from "node:assert/strict";
import { describe, it } from "node:test";

import { renderer } from "../pkg/node.js";

// A line, a curve, a loop, and an area with a hole.
const marks = () => ({
  points: [3, 4, 16, 6, 2, 12, 9, 3, 15, 13, 10, 9, 17, 10, 12, 15, 4, 8, 12, 8, 8, 15, 6.5, 9.5, 9.5, 9.5, 8, 12].map((v) => v + 0.13),
  starts: [0, 2, 5, 8, 14],
  widths: [3, 2, 2.5, 1],
  colors: [1, 0, 0, 0, 0.5, 1, 0.2, 0.9, 0.1, 0.3, 0.2, 0.8],
  opacities: [0.9, 0.6, 0.7, 0.5],
  onPath: [1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1].map(Boolean),
  closed: [false, false, true, false],
  filled: [false, false, false, true],
  rings: [11],
});
const [width, height] = [20, 18];
const target = Float32Array.from({ length: 3 * width * height }, (_, k) => ((k * 37) % 101) / 101);
const background = [0.2, 0.5, 0.9];
const loss = (canvas) => canvas.reduce((sum, c, k) => sum + (c - target[k]) ** 2, 0);

describe("renderer", () => {
  it("paints back to front", async () => {
    const own = await renderer(8, 8);
    const dot = { points: [4, 4], starts: [0, 1], widths: [4], colors: [1, 0, 0], opacities: [1] };
    const canvas = own.render(dot, [0, 0, 1]);
    assert.deepEqual([...canvas.slice(0, 3)], [0, 0, 1]);
    assert.deepEqual([...canvas.slice(3 * (4 * 8 + 4)).slice(0, 3)], [1, 0, 0]);
    own.free();
  });

  it("gives the derivatives that central differences give", async () => {
    const own = await renderer(width, height);
    const drawn = marks();
    const canvas = own.render(drawn, background);
    const by = own.backward(canvas.map((c, k) => 2 * (c - target[k])));
    const arrays = { points: drawn.points, colors: drawn.colors, opacities: drawn.opacities, widths: drawn.widths, background };
    for (const [name, values] of Object.entries(arrays)) {
      assert.equal(by[name].length, values.length);
      for (const k of values.keys()) {
        const at = (step) => {
          const moved = { ...drawn, background, [name]: values.map((v, i) => (i === k ? v + step : v)) };
          return loss(own.render(moved, moved.background));
        };
        const slope = (at(2e-3) - at(-2e-3)) / 4e-3;
        const isClose = Math.abs(by[name][k] - slope) < 0.02 * Math.abs(slope) + 0.05;
        assert.ok(isClose, `${name}[${k}]: ${by[name][k]}, by differences ${slope}`);
      }
    }
    own.free();
  });

  it("draws cubic curves and arcs, and differentiates them", async () => {
    const own = await renderer(width, height);
    const points = [2.1, 9.2, 3.3, 1.1, 9.4, 2.2, 9.1, 9.3, 13.2, 15.1, 17.3, 8.2];
    const bow = { points, starts: [0, 6], widths: [2], colors: [1, 0, 0], opacities: [0.9], kinds: [0, 2, 2, 0, 3, 0] };
    const by = own.backward(own.render(bow, background).map((c, k) => 2 * (c - target[k])));
    for (const k of points.keys()) {
      const at = (step) => loss(own.render({ ...bow, points: points.map((v, i) => (i === k ? v + step : v)) }, background));
      const slope = (at(2e-3) - at(-2e-3)) / 4e-3;
      assert.ok(Math.abs(by.points[k] - slope) < 0.02 * Math.abs(slope) + 0.05, `points[${k}]: ${by.points[k]}, by differences ${slope}`);
    }
    const wrong = [[0, 2, 1, 0, 3, 0], [0, 2, 2, 0, 7, 0], [0, 3, 3, 0, 0, 0]];
    for (const kinds of wrong) assert.throws(() => own.render({ ...bow, kinds }, background), /mark 0 has kinds/);
    own.free();
  });

  it("says what is wrong, and what would be right", async () => {
    const own = await renderer(width, height);
    assert.throws(() => own.backward(target), /there is no picture yet: call render first/);
    for (const [change, words] of [
      [{ points: [1, 2] }, /points has 2 numbers: give 28/],
      [{ widths: [1, NaN, 1, 1] }, /widths\[1\] is NaN: give finite numbers/],
      [{ opacities: [1, 1, 1, 1.5] }, /opacities\[3\] is 1.5: give 0 to 1/],
      [{ starts: [0, 5, 2, 8, 14] }, /starts\[1\] is 5 and starts\[2\] is 2/],
      [{ onPath: marks().points.map(() => false) }, /mark 0 is open and starts or ends off its path/],
      [{ rings: [1] }, /rings: give the points/],
    ]) {
      assert.throws(() => own.render({ ...marks(), ...change }), words);
    }
    own.render(marks());
    assert.throws(() => own.backward([1]), /dCanvas has 1 numbers: give 1080/);
    await assert.rejects(renderer(0, 4), /width is 0: give whole px from 1/);
    await assert.rejects(renderer(4, 4, { softness: 0 }), /softness is 0: give px above 0/);
    await assert.rejects(renderer(4, 4, { coverage: "soft" }), /no coverage function is called `soft`/);
    own.free();
  });
});
