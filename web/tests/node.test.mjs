// The package in Node: the same bytes as the program, progress, cancellation, errors.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { join } from "node:path";
import { describe, it } from "node:test";

import { animate, dxf, fit, fitPng, pdf } from "../pkg/node.js";
import { fitElsewhere } from "./support/fit.mjs";
import { inFolder, native, root, sample, strokefit } from "./support/program.mjs";

// Width and height are the first words of a PNG's first chunk.
const pixels = (name) => sample(name).readUInt32BE(16) * sample(name).readUInt32BE(20);
// The package takes colours for sRGB; the program converts those of a file with another profile.
const hasProfile = (name) => sample(name).includes("iCCP");
const pictures = readdirSync(join(root, "samples")).filter((name) => name.endsWith(".png") && !hasProfile(name));

describe("draws what the program draws", { concurrency: cpus().length }, () => {
  for (const name of pictures) {
    it(`${name}, 300 strokes`, async () => {
      // Pages draw at a third of the program's speed, and large pictures take minutes at the usual one.
      const preset = pixels(name) > 100_000 ? "draft" : "balanced";
      const { svg } = await fitElsewhere(sample(name), { strokes: 300, preset });
      assert.ok(svg === native(join(root, "samples", name), ["--strokes", "300", "--preset", preset]));
    });
  }

  // The last has alpha.
  for (const [name, options, flags] of [
    ["coffee-300.png", { opaque: true, colors: 8, form: "smallest", precision: 1 }, "--opaque --colors 8 --form smallest --precision 1"],
    ["noto-gem.png", { background: "#ffeedd", group: "color", seed: 7 }, "--background #ffeedd --group color --seed 7"],
    ["noto-gem.png", { quality: 25, progressive: true, width: "120mm" }, "--quality 25 --progressive --width 120mm"],
    ["noto-gem.png", { bytes: 9000, coverage: "sigmoid", polish: false }, "--bytes 9000 --coverage sigmoid --no-polish"],
  ]) {
    it(`${name}, ${flags}`, async () => {
      const draft = { preset: "draft", ...options };
      const { svg } = await fitElsewhere(sample(name), draft);
      assert.ok(svg === native(join(root, "samples", name), ["--preset", "draft", ...flags.split(" ")]));
    });
  }
});

it("a mask says where errors count, as for the program", async () => {
  const pixels = Uint8Array.from({ length: 256 * 256 }, (_, i) => (i % 256 < 128 ? 255 : 0));
  const options = { strokes: 60, preset: "draft" };
  const { svg } = await fitPng(sample("noto-gem.png"), { ...options, focus: { pixels, width: 256, height: 256 } });
  const drawn = inFolder((folder) => {
    const mask = join(folder, "mask.pgm");
    writeFileSync(mask, Buffer.concat([Buffer.from("P5\n256 256\n255\n"), pixels]));
    return native(join(root, "samples/noto-gem.png"), ["--strokes", "60", "--preset", "draft", "--focus", mask]);
  });
  assert.ok(svg === drawn);
  assert.ok(svg !== (await fitPng(sample("noto-gem.png"), options)).svg);
  const black = { pixels: new Uint8Array(4), width: 2, height: 2 };
  await assert.rejects(fitPng(sample("noto-gem.png"), { focus: black }), /the mask is black everywhere/);
  await assert.rejects(fitPng(sample("noto-gem.png"), { focus: { ...black, pixels: pixels.slice(0, 4) } }), /the mask of 2×2 px is none for a picture of 256×256/);
});

// A dark bar on white, opaque.
const [width, height] = [48, 24];
const isBar = (i) => i % width >= 8 && i % width < 40 && Math.floor(i / width) >= 10 && Math.floor(i / width) < 14;
const isAlpha = (k, channels) => channels % 2 === 0 && k % channels === channels - 1;
const bar = (channels) =>
  Uint8Array.from({ length: width * height * channels }, (_, k) =>
    isBar(Math.floor(k / channels)) && !isAlpha(k, channels) ? 51 : 255,
  );

describe("fit", () => {
  it("takes one to four channels, and typed arrays of bytes", async () => {
    const grey = await fit(bar(1), width, height, { strokes: 4 });
    assert.match(grey.svg, /^<svg/);
    for (const pixels of [bar(2), bar(3), bar(4), new Uint8ClampedArray(bar(4))]) {
      assert.equal((await fit(pixels, width, height, { strokes: 4 })).svg, grey.svg);
    }
  });

  it("reports what it drew", async () => {
    const { report, scene, svg } = await fit(bar(3), width, height, { strokes: 4 });
    assert.equal(report.svg_bytes, svg.length);
    assert.equal(report.strokes, scene.stages.flat().length);
    // The drawing of a bar is the bar, so that its fidelity is infinite.
    assert.equal(report.fidelity.psnr_db, null, JSON.stringify(report.fidelity));
    assert.equal(report.fidelity.ssimulacra2, 100);
    assert.deepEqual([scene.width, scene.height, scene.background], [width, height, "#ffffff"]);
  });

  it("tells of progress, with the drawing so far", async () => {
    const seen = [];
    const { scene } = await fit(bar(3), width, height, { strokes: 4 }, (progress) => {
      seen.push({ ...progress, drawn: progress.scene().stages.flat().length });
    });
    assert.ok(seen.length > 10);
    assert.ok(seen.every(({ done }, k) => k === 0 || done >= seen[k - 1].done));
    assert.ok(seen.every(({ strokes, drawn }) => strokes === drawn));
    const last = seen.at(-1);
    assert.ok(last.done <= 1 && last.psnrDb > seen[0].psnrDb);
    assert.ok(scene.stages.flat().length <= 4);
  });

  it("ends early when it is told to", async () => {
    let calls = 0;
    const { report, svg } = await fit(bar(3), width, height, { strokes: 4 }, () => ++calls < 3);
    assert.equal(report.stop, "interrupted");
    assert.equal(calls, 3);
    assert.match(svg, /<\/svg>\s*$/);
  });

  it("passes on what the watcher throws, and goes on working", async () => {
    const boom = new Error("boom");
    const thrown = fit(bar(3), width, height, {}, () => {
      throw boom;
    });
    await assert.rejects(thrown, (error) => error === boom);
    assert.match((await fit(bar(3), width, height)).svg, /^<svg/);
  });

  it("goes on from a drawing", async () => {
    const first = await fit(bar(3), width, height, { strokes: 2 });
    // One bar is drawn exactly. So there is a second one.
    const isNew = (k) => isBar(Math.floor(k / 3) + 10 * width);
    const both = bar(3).map((value, k) => (isNew(k) ? 51 : value));
    const second = await fit(both, width, height, { strokes: 5, base: first.svg });
    assert.ok(second.report.strokes > first.report.strokes);
    assert.ok(second.report.fidelity.psnr_db > 25, JSON.stringify(second.report.fidelity));
    assert.equal(second.report.base.strokes, first.report.strokes);
  });

  it("says what is wrong, and what would be right", async () => {
    const png = sample("noto-gem.png");
    for (const [call, words] of [
      [() => fit(bar(3), width, height, { strkes: 5 }), /no option is called strkes: give strokes/],
      [() => fit(bar(3), width, height, { strokes: 1.5 }), /strokes is 1\.5: give a whole number/],
      [() => fit(bar(3), width, height, { preset: "drft" }), /preset is "drft".*draft, balanced or best/],
      [() => fit(bar(3), width, height, { base: "nonsense" }), /SVG/],
      [() => fit(bar(3), width, height + 1), /3456 samples are not 1 to 4 for each of 48×25 px/],
      [() => fit(bar(3), 0, height), /0×24/],
      [() => fit([1, 2, 3], 1, 1), /give a Uint8Array/],
      [() => fitPng(png.subarray(0, 900)), /the picture/],
      [() => animate("<svg/>"), /./],
      [() => pdf("<svg/>"), /./],
      [() => dxf("<svg/>"), /./],
    ]) {
      await assert.rejects(call, words);
    }
  });
});

describe("animate", () => {
  it("makes an SVG that draws itself", async () => {
    const { svg } = await fit(bar(3), width, height, { strokes: 4 });
    const animated = await animate(svg);
    assert.match(animated, /<animate attributeName="stroke-dasharray"/);
    assert.equal(animated.match(/<path/g).length, svg.match(/<path/g).length);
  });
});

describe("pdf and dxf", () => {
  it("have circles of a disc beside a square, as its SVG has", async () => {
    const pixels = Uint8Array.from({ length: 128 * 64 }, (_, i) => {
      const [x, y] = [i % 128, Math.floor(i / 128)];
      if (x >= 80 && x < 112 && y >= 16 && y < 48) return 120;
      return 255 - Math.round(200 * Math.min(Math.max(21 - Math.hypot(x - 29.8, y - 33.1), 0), 1));
    });
    const { svg } = await fit(pixels, 128, 64);
    assert.equal(svg.match(/<circle/g)?.length, 1, svg);
    assert.equal((await dxf(svg)).match(/\nCIRCLE\n/g).length, 1);
    assert.match(await animate(svg), /<circle[^]*<animate[^]*<\/circle>/);
  });
  it("are the files that the program makes of a drawing", async () => {
    const svg = native(join(root, "samples/noto-gem.png"), ["--preset", "draft", "--width", "80mm"]);
    const made = inFolder((folder) => {
      writeFileSync(join(folder, "a.svg"), svg);
      return ["pdf", "dxf"].map((kind) => {
        execFileSync(strokefit, ["render", "a.svg", "-q", "-o", `a.${kind}`], { cwd: folder });
        return readFileSync(join(folder, `a.${kind}`));
      });
    });
    assert.ok(made[0].equals(await pdf(svg)));
    assert.ok(made[1].toString() === (await dxf(svg)));
  });
});

it("a trap ends in an error, and the next fit works", () => {
  const script = `
    import { fit } from ${JSON.stringify(new URL("../pkg/node.js", import.meta.url).href)};
    const large = fit(new Uint8Array(3000 * 3000), 3000, 3000);
    console.log(await large.then(() => "drawn", (error) => error.message));
    console.log((await fit(new Uint8Array(64 * 64).fill(200), 64, 64)).svg.slice(0, 4));`;
  const said = inFolder((folder) => {
    const file = join(folder, "trap.mjs");
    writeFileSync(file, script);
    // Of 64 KiB: memory for the small picture alone.
    return execFileSync(process.execPath, ["--wasm-max-mem-pages=800", file], { encoding: "utf8" });
  });
  assert.match(said, /^the fit broke off \(.*\): a smaller picture or fewer strokes may need less memory\n<svg\n$/);
});
