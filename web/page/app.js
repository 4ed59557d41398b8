// Takes a picture, has it fitted, and shows how the drawing grows.

import * as fitting from "./fitting.js";
import { read } from "./picture-file.js";
import { listen, show } from "./viewer.js";

// The page rests so many times as long as it took to show the drawing, so that it answers at once.
const REST = 3;
// Points of the curve that are kept at most.
const CURVE = 1000;
// What is not an option of further strokes: the drawing that they are added to has settled it.
const SETTLED = { strokes: undefined, psnr: undefined, bytes: undefined, quality: undefined, background: undefined, width: undefined };

const element = (id) => document.getElementById(id);
const form = element("options");

// The file as it was given, and as it is drawn.
let file = null;
let drawn = null;
// What the viewer is told, and whether it has been.
let state = { picture: 0 };
let due = null;
// Number of the last request, so that a slow answer to an earlier one is not taken.
let asked = 0;

// A picture comes.

async function take(given) {
  if (!given) return say("that is no file: drop or paste a picture, or choose a file");
  file = given;
  element("again").disabled = false;
  await draw();
}

async function draw() {
  const number = ++asked;
  say(null);
  try {
    const { image, picture } = await read(file, Number(element("side").value));
    if (number !== asked) return;
    begin({ picture: number, title: file.name || "pasted picture", target: image });
    drawn = { picture, options: options() };
    fitting.start(picture, drawn.options, hear);
  } catch (error) {
    if (number === asked) say(error.message);
  }
}

function add(strokes) {
  const { svg, count, picture } = drawn;
  begin({ picture: state.picture, title: state.title, target: state.target });
  fitting.start(picture, { ...drawn.options, ...SETTLED, strokes: count + strokes, base: svg }, hear);
}

function begin({ picture, title, target }) {
  const fresh = { finished: false, grows: false, more: null, svg_bytes: null, done: 0, stage: null, stages: null };
  state = { ...fresh, picture, title, target, polishing: false, last: null, curve: [], scene: null };
  for (const id of ["download", "animation"]) offer(id, null);
  document.querySelector("main").hidden = false;
  present();
}

// The options that are not left as they are.
function options() {
  const fields = [...form.elements].filter(({ name }) => name);
  return Object.fromEntries(fields.map((field) => [field.name, value(field)]).filter(([, value]) => value !== ""));
}

function value({ type, value, valueAsNumber, checked }) {
  if (type === "checkbox") return checked;
  return type === "number" && value !== "" ? valueAsNumber : value.trim();
}

// The fit tells how it goes.

function hear({ progress, scene, drawing, animation, error }) {
  if (error) {
    say(error);
    state.done = null;
  }
  if (progress) Object.assign(state, progress, { curve: thinned([...state.curve, progress.last]) });
  if (scene) state.scene = scene;
  if (drawing) finish(drawing, animation);
  present();
}

function finish({ svg, report, scene }, animation) {
  Object.assign(drawn, { svg, count: report.strokes });
  Object.assign(state, { finished: true, scene, svg_bytes: report.svg_bytes, grows: drawn.options.form !== "outlines" });
  offer("download", svg, ".svg");
  offer("animation", animation, ".animated.svg");
}

function thinned(curve) {
  return curve.length > CURVE ? curve.filter((_, k) => k % 2 === 0) : curve;
}

function say(message) {
  element("message").textContent = message ?? "";
  element("message").hidden = !message;
}

// Lets a link give a text as a file, or nothing.
function offer(id, text, ending) {
  const link = element(id);
  if (link.href) URL.revokeObjectURL(link.href);
  link.removeAttribute("href");
  link.hidden = text === null;
  if (text === null) return;
  link.href = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  link.download = state.title.replace(/\.[^.]*$/, "") + ending;
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

// Files come by choice, drop and paste.

element("file").addEventListener("change", ({ target }) => target.files.length && take(target.files[0]));
element("sample").addEventListener("click", async () => {
  const answer = await fetch("sample.png");
  take(new File([await answer.blob()], "coffee.png"));
});
addEventListener("paste", ({ clipboardData }) => clipboardData.files.length && take(clipboardData.files[0]));
addEventListener("dragover", (event) => {
  event.preventDefault();
  document.body.classList.add("dragging");
});
addEventListener("dragleave", ({ relatedTarget }) => relatedTarget ?? document.body.classList.remove("dragging"));
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dragging");
  take(event.dataTransfer.files[0]);
});
form.addEventListener("submit", (event) => {
  event.preventDefault();
  draw();
});
listen({ stop: fitting.stop, add });

// The program is fetched before it is needed, and kept for when there is no network.
fitting.prepare().catch((error) => say(error.message));
navigator.serviceWorker?.register("offline.js").catch((error) => console.info(`the page is not kept: ${error.message}`));
