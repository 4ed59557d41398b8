// The slider from few marks to many: it answers with marks of the drawing that is there, and has it fitted when it rests.

import { linesOfMarks } from "./choice.js";
import { shownDb, showDraft } from "./viewer.js";
import { count, fidelity, size } from "./words.js";
import { worker } from "./workers.js";

const element = (id) => document.getElementById(id);
// How long the slider rests before a fit begins, ms.
const REST = 700;
// Pixels that the default quality of 30 is for, as in src/fit/recipe.rs.
const SCREEN_PIXELS = 768 * 512;
const DEFAULT_QUALITY = 30;

let weigher = null;
// The drawing whose marks are weighed: { number, quality, bytes, frame, levels, report }.
let weighed = null;
let number = 0;
let resting = null;

// `refit(quality)` has the picture fitted.
export function listenToDetail(refit) {
  const slider = element("amount");
  slider.addEventListener("input", () => {
    draft(Number(slider.value));
    clearTimeout(resting);
    resting = setTimeout(rest, REST);
  });
  slider.addEventListener("change", () => {
    clearTimeout(resting);
    resting = setTimeout(rest, REST / 2);
  });
  const rest = () => refit(Number(slider.value));
}

// No fit will follow from the slider any more.
export function forget() {
  clearTimeout(resting);
  weighed = null;
}

export function defaultQuality({ width, height }) {
  return DEFAULT_QUALITY - 10 * Math.log10(Math.max(1, (width * height) / SCREEN_PIXELS));
}

// Takes a finished drawing: its text, report, scene, and the picture; `asked` is the quality that was asked for.
export async function weigh({ svg, report, scene }, target, asked) {
  const quality = asked ?? defaultQuality(scene);
  const bytes = bytesOf(svg, scene);
  weighed = { number: ++number, quality, bytes, frame: svg.length - bytes.reduce((a, b) => a + b, 0), levels: null, report };
  element("amount").value = quality;
  element("amount").dataset.weighed = "false";
  summarize();
  const image = await createImageBitmap(target);
  weigher ??= listen(worker("worth-worker.js"));
  weigher.postMessage({ scene, target: image, bytes, quality, number }, [image]);
}

function listen(started) {
  started.addEventListener("message", ({ data }) => {
    if (weighed?.number !== data.number) return;
    weighed.levels = data.levels;
    element("amount").dataset.weighed = "true";
  });
  started.addEventListener("error", ({ message }) => console.info(`marks are not weighed: ${message}`));
  return started;
}

// The bytes of each mark's element, back to front.
function bytesOf(svg, scene) {
  const marks = scene.stages.flat();
  const lines = svg.split("\n"), places = linesOfMarks(lines);
  return places.length === marks.length ? places.map((k) => lines[k].length + 1) : marks.map(() => svg.length / marks.length);
}

// Shows the marks that pay at a quality, of those that are there.
function draft(quality) {
  if (!weighed) return;
  const { levels, bytes } = weighed;
  const share = 10 ** ((quality - weighed.quality) / 15);
  const kept = levels ? Array.from(levels, (level) => level <= quality) : bytes.map((_, k) => k < share * bytes.length);
  const all = kept.every(Boolean);
  showDraft(all ? null : kept);
  const marks = kept.filter(Boolean).length;
  const weight = bytes.reduce((sum, own, k) => sum + (kept[k] ? own : 0), weighed.frame);
  const more = quality > weighed.quality + 0.5 ? "more when it rests" : fidelity(shownDb());
  element("summary").value = [count(marks, "mark"), size(weight), more].join(" · ");
}

function summarize() {
  const { report } = weighed;
  element("summary").value = [count(report.strokes, "mark"), size(report.svg_bytes), fidelity(report.fidelity.psnr_db)].join(" · ");
}
