// Parts of the page without a browser: changes of a drawing, what marks are worth, zips, texts to take along.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { Edits, edited, repaintedScene } from "../../src/view/page/edits.js";
import { background, component, componentName } from "../page/take.js";
import { count, fidelity, size } from "../page/words.js";
import { levelsOf } from "../page/worth.js";
import { crc32, distinct, zip } from "../page/zip.js";

const line = (x, color) => [[x, 0, x, 40], 2, color, 1, "oo"];
const scene = { width: 90, height: 40, background: "#ffffff", stages: [[line(10, "#102030"), line(50, "#aa0000")], [line(80, "#102030")]] };
const text = `<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="90" height="40" viewBox="0 0 90 40">
<rect width="90" height="40" fill="#ffffff"/>
<g id="stage-1" inkscape:groupmode="layer" inkscape:label="Stage 1" fill="none" stroke-linecap="round">
<title>Stage 1: 2 strokes</title>
<path d="M10 0v40" stroke="#102030" stroke-width="4"/>
<path d="M50 0v40" stroke="#a00" stroke-width="4" stroke-opacity="0.5"/>
</g>
<g id="stage-2" inkscape:groupmode="layer" inkscape:label="Stage 2" fill="none" stroke-linecap="round">
<title>Stage 2: 1 stroke</title>
<path d="M80 0v40" stroke="#102030" stroke-width="4"/>
</g>
</svg>
`;
const all = [true, true, true];
const file = (edits, kept = all) => edited(text, kept, edits.now, repaintedScene(scene, edits.now));

test("colours change in the file and nothing else", () => {
  const edits = new Edits();
  assert.equal(file(edits), text);
  edits.repaint([["#102030", "#00ff00"]]);
  assert.equal(file(edits), text.replaceAll("#102030", "#00ff00"));
  // A short form of a colour is the same colour, and what was painted can be painted again.
  edits.repaint([["#00ff00", "#0000ff"], ["#aa0000", "#0000ff"]]);
  assert.equal(file(edits), text.replaceAll("#102030", "#0000ff").replace("#a00", "#0000ff"));
  assert.deepEqual(repaintedScene(scene, edits.now).stages.flat().map(([, , color]) => color), ["#0000ff", "#0000ff", "#0000ff"]);
});

test("colours change in classes, too", () => {
  const sheet = "<style>\n.background{fill:#ffffff}\n.black-line{stroke:#102030}\n.red-line{stroke:#aa0000}\n</style>\n";
  const classed = text.replace("<rect", `${sheet}<rect`).replace('fill="#ffffff"', 'class="background"')
    .replaceAll('stroke="#102030"', 'class="black-line"').replace('stroke="#a00"', 'class="red-line"');
  const edits = new Edits();
  edits.repaint([["#102030", "#00ff00"]]);
  edits.change({ background: "#123456" });
  const repainted = edited(classed, all, edits.now, repaintedScene(scene, edits.now));
  assert.equal(repainted, classed.replace("#102030", "#00ff00").replace("#ffffff", "#123456"));
});

test("a background goes, and comes in another colour", () => {
  const edits = new Edits();
  edits.change({ background: null });
  assert.ok(!file(edits).includes("<rect") && file(edits).includes("#102030"));
  assert.equal(repaintedScene(scene, edits.now).background, null);
  edits.change({ background: "#123456" });
  assert.ok(file(edits).includes('<rect width="90" height="40" fill="#123456"/>'));
});

test("changes are undone and done again, in order", () => {
  const edits = new Edits();
  edits.repaint([["#102030", "#00ff00"]]);
  const green = file(edits);
  edits.change({ gone: new Set([2]) });
  edits.undo();
  assert.equal(file(edits), green);
  edits.undo();
  edits.undo();
  assert.equal(file(edits), text);
  edits.redo();
  assert.equal(file(edits), green);
  edits.redo();
  assert.deepEqual([...edits.now.gone], [2]);
  edits.undo();
  edits.repaint([["#aa0000", "#ffff00"]]);
  edits.redo();
  assert.deepEqual([...edits.now.gone], [], "what is new has nothing after it");
});

test("changes hold for almost the same colours of a new fit", () => {
  const edits = new Edits();
  edits.repaint([["#102030", "#00ff00"]]);
  const next = { ...scene, stages: [[line(10, "#112130"), line(50, "#aa0000")]] };
  edits.adopt(next);
  assert.deepEqual(repaintedScene(next, edits.now).stages.flat().map(([, , color]) => color), ["#00ff00", "#aa0000"]);
});

// A row of pixels: white, 4 of them black under the first mark; the second is black on the first; the third is pale on white.
const row = { left: 0, top: 0, width: 4, height: 1, alpha: [255, 255, 255, 255] };
const part = { ...row, width: 1, alpha: [255] };
const pale = { ...part, left: 6 };
const target = Float32Array.from({ length: 24 }, (_, i) => (i < 12 ? 0 : 255));
const weighed = { colors: [[0, 0, 0], [0, 0, 0], [250, 250, 250]], background: [255, 255, 255], target, width: 8, bytes: [50, 50, 50], share: 1 };

test("a mark is kept from the quality on at which its bytes pay", () => {
  const levels = levelsOf({ masks: [row, part, pale], ...weighed }, 30);
  // 4 black pixels on white are worth 12·255², and 50 bytes at Q cost 150·255²·10^(−Q/10): they pay from 11 dB on.
  assert.ok(levels[0] > 10 && levels[0] < 12, `${levels[0]}`);
  // What adds nothing, or an error, goes at once.
  assert.deepEqual([...levels.slice(1)], [30.5, 30.5]);
});

test("marks that hide each other's worth do not both go", () => {
  const levels = levelsOf({ masks: [row, row], ...weighed, colors: [[0, 0, 0], [0, 0, 0]], bytes: [50, 50] }, 30);
  // Either alone is worth nothing as long as the other is there; one pass must not take both.
  assert.ok(Math.min(...levels) < 12, `${levels}`);
});

test("a zip has every file, with names of its own", () => {
  assert.equal(crc32(new TextEncoder().encode("123456789")), 0xcbf43926);
  assert.deepEqual(distinct(["a.svg", "a.svg", "a-2.svg", "b", "b"]), ["a.svg", "a-2.svg", "a-2-2.svg", "b", "b-2"]);
  const bytes = Buffer.from(zip([{ name: "ä.svg", text: "<svg/>" }, { name: "b.svg", text: "" }]));
  const end = bytes.length - 22;
  assert.equal(bytes.readUInt32LE(end), 0x06054b50);
  assert.equal(bytes.readUInt16LE(end + 10), 2);
  const directory = bytes.readUInt32LE(end + 16);
  assert.equal(bytes.readUInt32LE(directory), 0x02014b50);
  assert.equal(directory + bytes.readUInt32LE(end + 12), end);
  assert.equal(bytes.readUInt32LE(0), 0x04034b50);
  const name = bytes.readUInt16LE(26);
  assert.equal(bytes.subarray(30, 30 + name).toString(), "ä.svg");
  assert.equal(bytes.subarray(30 + name, 30 + name + bytes.readUInt32LE(18)).toString(), "<svg/>");
});

test("a drawing becomes a component and a background", () => {
  assert.deepEqual(["coffee-300", "3d logo", "ä", ""].map(componentName), ["Coffee300", "Drawing3dLogo", "Drawing", "Drawing"]);
  const jsx = component(text, "coffee-300");
  assert.match(jsx, /^export function Coffee300\(props\) \{\n {2}return \(\n<svg \{\.\.\.props\} xmlns=/);
  assert.ok(jsx.includes('strokeOpacity="0.5"') && jsx.includes('strokeLinecap="round"'));
  assert.ok(!/inkscape|stroke-/.test(jsx));
  const classes = '<svg><style>\n.red{fill:#f00}\n</style>\n<path class="red" d="M1 1h2v2z"/></svg>';
  const styled = component(classes, "a");
  assert.ok(styled.includes("<style>{`\n.red{fill:#f00}\n`}</style>") && styled.includes('<path className="red" d='), styled);
  const css = background(text);
  const address = css.match(/url\("data:image\/svg\+xml,([^"]*)"\)/)[1];
  assert.ok(decodeURIComponent(address).startsWith("<svg xmlns='http://www.w3.org/2000/svg' width='90'"));
  assert.ok(!/[#<>]/.test(address));
});

test("numbers are said as people say them", () => {
  assert.deepEqual([999, 1234, 54919].map(size), ["999 B", "1.2 kB", "55 kB"]);
  assert.deepEqual([count(1, "mark"), count(2313, "mark")], ["1 mark", "2,313 marks"]);
  assert.deepEqual([null, 50, 31, 20, NaN].map(fidelity), ["the same", "nearly the same", "faithful", "a sketch", ""]);
});

test("the first screen says of its examples what is so", () => {
  const page = readFileSync(new URL("../page/index.html", import.meta.url), "utf8");
  const pictures = new URL("../../docs/pictures/", import.meta.url);
  const told = [...page.matchAll(/src="examples\/([^"]*)\.svg"[\s\S]*?<span class="quiet">([^<]*)</g)];
  assert.equal(told.length, 4);
  for (const [, name, words] of told) {
    const drawing = readFileSync(new URL(`${name === "coffee-300" ? "coffee-quality-30" : name}.svg`, pictures), "utf8");
    // The rectangle of the page begins with its width.
    const marks = drawing.match(/<(path|circle|ellipse|rect x)/g).length;
    assert.equal(words, `${count(marks, "mark")}, ${size(drawing.length)}`);
  }
});
