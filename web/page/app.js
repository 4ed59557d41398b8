// Takes pictures, has them fitted, and shows how the drawing grows.

import { drawAll, endBatch } from "./batch.js";
import { forget, listenToDetail, weigh } from "./detail.js";
import * as fitting from "./fitting.js";
import { forgetFocus, listenToFocus } from "./focus.js";
import { KINDS, link, longestSide, options, readLink, setKind } from "./options.js";
import { listenToPairs } from "./pair.js";
import { read } from "./picture-file.js";
import { listenToTake } from "./take.js";
import { asShown, listen, show } from "./viewer.js";

// The page rests so many times as long as it took to show the drawing, so that it answers at once.
const REST = 3;
// Points of the curve that are kept at most.
const CURVE = 1000;
// Drawings of a picture that are kept, so that a way back takes no fit.
const KEPT = 12;
// What is not an option of further strokes: the drawing that they are added to has settled it.
const SETTLED = { strokes: undefined, psnr: undefined, bytes: undefined, quality: undefined, background: undefined, width: undefined };

const element = (id) => document.getElementById(id);

// The file as it was given.
let file = null;
// What is drawn: { picture, options, focus, image, svg, count }, and drawings of it by their options.
let drawn = null;
let kept = new Map();
// What the viewer is told, and whether it has been.
let state = { picture: 0 };
let due = null;
// Number of the last request, so that a slow answer to an earlier one is not taken.
let asked = 0;

// Pictures come.

function take(files) {
  say(null);
  if (!files.length) return say("that is no file: drop or paste a picture, or choose a file");
  endBatch();
  forget();
  if (files.length > 1) return takeAll(files);
  [file] = files;
  return draw();
}

function takeAll(files) {
  asked += 1;
  drawn = null;
  turnTo("batch");
  return drawAll(files, options(), longestSide());
}

function turnTo(name) {
  for (const id of ["start", "batch", "work"]) element(id).hidden = id !== name;
  element("other").hidden = name === "start";
  for (const id of ["stop", "progress"]) if (name !== "work") element(id).hidden = true;
  if (name !== "work") [element("phase").textContent, element("title").textContent, document.title] = ["", "strokefit", "strokefit"];
}

// Has the picture drawn from the beginning.
async function draw() {
  const number = ++asked;
  say(null);
  try {
    const { image, picture, reduced } = await read(file, longestSide());
    if (number !== asked) return;
    kept = new Map();
    forgetFocus();
    drawn = { picture, image, options: options(), focus: null };
    turnTo("work");
    begin({ picture: number, title: file.name || "pasted picture", target: image });
    if (reduced) tell(`The picture of ${reduced.join("×")} px is drawn at ${image.width}×${image.height} px; all settings have its longest side.`);
    fitting.start(picture, drawn.options, hear);
  } catch (error) {
    if (number === asked) say(error.message);
  }
}

// Has the same picture drawn under the options that are there now. What is shown stays until it is done.
function redraw() {
  if (!drawn) return;
  say(null);
  forget();
  drawn.options = options();
  const before = drawn.focus ? undefined : kept.get(JSON.stringify(drawn.options));
  state = { ...state, finished: false, curve: [], last: null, done: 0, keeps: true };
  document.body.dataset.ready = false;
  if (before) {
    fitting.cancel();
    return hear(before);
  }
  present();
  fitting.start(drawn.picture, withFocus(drawn.options), hear);
}

const withFocus = (options) => (drawn.focus ? { ...options, focus: drawn.focus } : options);


function add(strokes) {
  const { svg, count, picture } = drawn;
  forget();
  begin({ picture: state.picture, title: state.title, target: state.target });
  fitting.start(picture, { ...withFocus(drawn.options), ...SETTLED, strokes: count + strokes, base: svg }, hear);
}

function begin({ picture, title, target }) {
  const fresh = { finished: false, grows: false, more: null, svg_bytes: null, done: 0, stage: null, stages: null, keeps: false };
  state = { ...fresh, picture, title, target, polishing: false, last: null, curve: [], scene: null };
  for (const id of ["download", "animation"]) offer(id, null);
  element("summary").value = "drawing";
  element("take").hidden = true;
  document.body.dataset.ready = false;
  present();
}

// The fit tells how it goes.

function hear(message) {
  const { progress, scene, drawing, animation, error } = message;
  if (error) {
    say(error);
    state.done = null;
  }
  if (progress) Object.assign(state, progress, { curve: thinned([...state.curve, progress.last]) });
  if (scene && !state.keeps) state.scene = scene;
  if (drawing) finish(message, drawing, animation);
  present();
}

function finish(message, drawing, animation) {
  const { svg, report, scene } = drawing;
  Object.assign(drawn, { svg, count: report.strokes });
  Object.assign(state, { finished: true, scene, svg_bytes: report.svg_bytes, grows: drawn.options.form !== "outlines" });
  if (!drawn.focus) kept.set(JSON.stringify(drawn.options), message);
  if (kept.size > KEPT) kept.delete(kept.keys().next().value);
  element("take").hidden = false;
  offer("download", svg, ".svg");
  offer("animation", animation, ".animated.svg");
  element("report").textContent = reported(report);
  weigh(drawing, drawn.image, drawn.options.quality);
}

// What the expert's panel says of a drawing.
function reported({ strokes, areas, svg_bytes, svg_gzip_bytes, wall_s, stop, fidelity: { psnr_db, ssim, ssimulacra2 } }) {
  const whole = (value) => value.toLocaleString("en");
  const alike = psnr_db === null ? "no error" : `${psnr_db.toFixed(2)} dB`;
  return `${whole(strokes - areas)} strokes and ${whole(areas)} areas; ${alike}, SSIM ${ssim.toFixed(3)}, SSIMULACRA2 ${ssimulacra2.toFixed(1)}; ` +
    `${whole(svg_bytes)} bytes, ${whole(svg_gzip_bytes)} after gzip; ${wall_s.toFixed(1)} s, ended by: ${stop}.`;
}

function thinned(curve) {
  return curve.length > CURVE ? curve.filter((_, k) => k % 2 === 0) : curve;
}

function say(message) {
  element("message").textContent = message ?? "";
  element("message").hidden = !message;
}

const stem = () => state.title.replace(/\.[^.]*$/, "");

function tell(note) {
  element("taken").textContent = note;
}

// Lets a link give a text as a file, or nothing.
function offer(id, text, ending) {
  const link = element(id);
  if (link.href) URL.revokeObjectURL(link.href);
  link.removeAttribute("href");
  link.hidden = text === null;
  if (text === null) return;
  link.href = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  link.download = stem() + ending;
}

// Shows the state, soon and not too often.
function present() {
  due ??= setTimeout(() => {
    const start = performance.now();
    show({ ...state });
    state.scene = null;
    const rest = state.finished ? 0 : REST * (performance.now() - start);
    setTimeout(() => {
      due = null;
      if (state.scene) present();
    }, rest);
  });
}

// Files come by choice, camera, drop and paste.

for (const id of ["file", "camera"]) {
  element(id).addEventListener("change", ({ target }) => {
    const files = [...target.files];
    // The same file again is a choice, too.
    target.value = "";
    if (files.length) take(files);
  });
}
listenToPairs(async (name) => {
  const answer = await fetch(`examples/${name}`);
  take([new File([await answer.blob()], name)]);
});
addEventListener("paste", ({ clipboardData }) => clipboardData.files.length && take([...clipboardData.files]));
const brings = ({ dataTransfer }) => dataTransfer.types.includes("Files") || !dataTransfer.types.includes("text/x-swatch");
addEventListener("dragover", (event) => {
  if (!brings(event)) return;
  event.preventDefault();
  document.body.classList.add("dragging");
});
addEventListener("dragleave", ({ relatedTarget }) => relatedTarget ?? document.body.classList.remove("dragging"));
addEventListener("drop", (event) => {
  if (!brings(event)) return;
  event.preventDefault();
  document.body.classList.remove("dragging");
  take([...event.dataTransfer.files]);
});

element("other").addEventListener("click", () => {
  asked += 1;
  drawn = null;
  endBatch();
  forget();
  fitting.cancel();
  say(null);
  turnTo("start");
  element("file").focus();
});

// Options.

function sayKind(name) {
  element("kind-note").textContent = name ? `Sets: ${KINDS[name].says}.` : "Settings of your own.";
}

for (const radio of document.querySelectorAll("[name=kind]")) {
  radio.addEventListener("change", () => {
    const before = longestSide();
    setKind(radio.value);
    sayKind(radio.value);
    element("again").disabled = true;
    if (drawn) before === longestSide() ? redraw() : draw();
  });
}
element("options").addEventListener("input", () => {
  element("again").disabled = false;
  for (const radio of document.querySelectorAll("[name=kind]")) radio.checked = false;
  sayKind(null);
});
element("options").addEventListener("submit", (event) => {
  event.preventDefault();
  if (file) draw();
});
listenToDetail((quality) => {
  element("options").elements.quality.value = quality;
  for (const name of ["strokes", "psnr", "bytes"]) element("options").elements[name].value = "";
  redraw();
});
listenToFocus(() => [drawn.image.width, drawn.image.height], (focus) => {
  if (!drawn) return;
  drawn.focus = focus;
  redraw();
});
listenToTake({ drawing: () => ({ text: asShown(drawn.svg), stem: stem(), width: drawn.image.width, height: drawn.image.height }), link, convert: fitting.convert });
listen({ stop: fitting.stop, add });

const linked = readLink();
if (linked) for (const radio of document.querySelectorAll("[name=kind]")) radio.checked = false;
sayKind(linked ? null : "any");

// The program is fetched and compiled before it is needed, and kept for when there is no network.
fitting.prepare().then(fitting.warm).catch((error) => say(error.message));
navigator.serviceWorker?.register("offline.js").catch((error) => console.info(`the page is not kept: ${error.message}`));
