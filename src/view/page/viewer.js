// A drawing while it grows and after: target, drawing and residual, layers, strokes and areas, curves. What is looked at is in the
// address after #, so that it can be kept.
//
// Where drawings come from is not the business of this file: page.js asks a server for them, and the page of web/ fits them
// itself. Both call `show` with a state:
//
//     picture            a number; another one means another picture
//     title              what it is called
//     target             what canvases can draw, or null
//     finished           whether it is fitted; svg_bytes is then the size of the file
//     done, stage, stages, polishing, settling, last     how far the fit is, as src/view/page.rs says; null when nothing was fitted
//     curve              points { time_s, strokes, psnr_db }, of which `last` is the last
//     grows, more        whether strokes can be added, and how many will be
//     scene              the drawing as src/report/scene.rs writes it; null where it is the one that was shown last
//
// and `listen` with what is done when somebody wants something: { stop(), add(strokes) }.

import { drawChart } from "./chart.js";
import { mostLike } from "./choice.js";
import { describe } from "./describe.js";
import { Edits, edited, repaintedScene } from "./edits.js";
import { Lens } from "./lens.js";
import { groups } from "./palette.js";
import { Comparison, bounds, counted, drawMarks, drawPage, drawPoints, drawRing, markAt } from "./picture.js";
import { listenToSwatches, showSwatches } from "./swatches.js";

// Number of times that the finished drawing is measured on the way from no mark to all.
const MEASURED = 60;

const element = (id) => document.getElementById(id);
const [target, drawing, residual, overlay] = ["target", "drawing", "residual", "overlay"].map(element);
// As the keys and Space go through them.
const PICTURES = ["drawing", "target", "residual"];

let state = { curve: [] };
// The drawing as it was fitted, and as it is painted.
let fitted = null;
let scene = null;
// All marks, strokes and areas, as { mark, number, stage, box }, numbers and stages from 1.
let marks = [];
let comparison = null;
// dB over marks, and the number of the last measurement.
let measured = [];
let measuring = 0;
let hidden = new Set();
// Number of marks from the back that are shown; all when it is Infinity, also of a growing drawing.
let shown = Infinity;
// True for each mark of a draft, which has fewer than were fitted; null for all.
let draft = null;
let selected = null;
// The mark under the pointer.
let hovered = null;
// The picture that is large.
let large = "drawing";
// The number of the only mark that is shown.
let alone = null;
// What is changed: marks that are hidden or deleted, colours.
let edits = new Edits();
// The share of the drawing, from the left, that shows the target instead.
let compared = 0;
// What else is painted over the drawing, and what drags do in place of moving it.
let veil = null;
let brush = null;

const lens = new Lens([target, drawing, residual], {
  size: () => scene,
  large: () => element(largest()),
  redraw: () => soon(),
  point: (x, y) => {
    selected = markAt(near(x, y), x, y)?.number ?? null;
    redraw();
  },
  hover: (place) => hover(place),
  brush: () => brush,
});

function readAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  shown = wanted.has("shown") ? Number(wanted.get("shown")) : Infinity;
  selected = Number(wanted.get("stroke")) || null;
  const numbers = (key) => new Set((wanted.get(key) ?? "").split(",").filter(Boolean).map(Number));
  hidden = numbers("hidden");
  const [veiled, gone] = ["veiled", "gone"].map(numbers);
  edits.now = { ...edits.now, veiled, gone };
  alone = Number(wanted.get("alone")) || null;
  large = PICTURES.includes(wanted.get("large")) ? wanted.get("large") : "drawing";
  const [x, y, zoom] = (wanted.get("view") ?? "").split(",").map(Number);
  lens.view = zoom > 0 ? { x, y, zoom } : { x: 0, y: 0, zoom: 0 };
}

function writeAddress() {
  const say = new URLSearchParams();
  if (shown < marks.length) say.set("shown", shown);
  if (selected) say.set("stroke", selected);
  const { veiled, gone } = edits.now, { view } = lens;
  for (const [key, numbers] of Object.entries({ hidden, veiled, gone })) {
    if (numbers.size) say.set(key, [...numbers].join());
  }
  if (alone) say.set("alone", alone);
  if (large !== "drawing") say.set("large", large);
  if (view.zoom) say.set("view", [view.x, view.y, view.zoom].map((v) => Number(v.toFixed(2))).join());
  history.replaceState(null, "", say.size ? `#${say}` : location.pathname + location.search);
}

export function show(next) {
  const another = next.picture !== state.picture;
  const replaced = another && state.picture !== undefined;
  const finishedNow = next.finished && (another || !state.finished);
  state = next;
  if (another) [fitted, scene, comparison, marks, measured, draft] = [null, null, null, [], [], null];
  if (replaced) [selected, alone, edits, shown] = [null, null, new Edits(), Infinity];
  if (replaced) lens.whole();
  if (state.scene) takeScene(state.scene);
  showState();
  if (state.scene || finishedNow) redraw();
  if (state.scene && state.finished) showPalette();
  if (finishedNow) measure();
  document.body.dataset.ready = state.finished;
}

function takeScene(next) {
  const before = marks;
  [fitted, draft, hovered] = [next, null, null];
  edits.adopt(fitted);
  paintScene();
  if (before.length) follow(before);
  element("panels").style.setProperty("--aspect", scene.width / scene.height);
  if (state.target && !comparison) comparison = new Comparison(state.target, scene.width, scene.height);
  showControls();
}

function paintScene() {
  scene = repaintedScene(fitted, edits.now);
  let number = 0;
  marks = scene.stages.flatMap((list, k) => list.map((mark) => ({ mark, number: ++number, stage: k + 1, box: bounds(mark) })));
}

// In another drawing marks have other numbers: what was said of one holds for the one that is most like it.
function follow(before) {
  const now = (number) => mostLike(marks, before[number - 1])?.number ?? null;
  const all = (numbers) => (numbers.size ? new Set([...numbers].map(now).filter(Boolean)) : numbers);
  [selected, alone] = [selected && now(selected), alone && now(alone)];
  edits.renumber(all);
}

function change(part) {
  edits.change(part);
  showEdited();
}

function showEdited() {
  paintScene();
  showPalette();
  measured = [];
  measure();
  redraw();
}

function showPalette() {
  const paper = scene.shade ? null : scene.background;
  const left = scene.stages.map(() => []);
  for (const { mark, stage, number } of marks) if (!edits.now.gone.has(number)) left[stage - 1].push(mark);
  showSwatches(groups({ ...scene, stages: left }), paper);
}

// Marks that may be at a place.
function near(x, y) {
  return marks.filter((each) => {
    const [left, top, right, bottom] = each.box;
    return x >= left && x <= right && y >= top && y <= bottom && isShown(each);
  });
}

function hover(place) {
  const next = place && !brush ? (markAt(near(...place), ...place)?.number ?? null) : null;
  if (next === hovered) return;
  hovered = next;
  drawOverlay();
}

// Numbers and curves.

function showState() {
  element("title").textContent = document.title = `strokefit: ${state.title}`;
  element("phase").textContent = phase();
  element("progress").value = state.finished ? 1 : (state.done ?? 0);
  element("progress").hidden = state.done == null;
  element("stop").hidden = state.finished || state.done == null;
  element("more").hidden = !state.grows;
  element("download").hidden = !scene || !element("download").href;
  for (const id of ["target-panel", "residual-panel", "compare"]) element(id).hidden = !state.target;
  element("pictures").hidden = !state.target;
  element("panels").classList.toggle("single", !state.target);
  const shownLarge = state.target ? large : "drawing";
  for (const name of PICTURES) {
    element(`${name}-panel`).classList.toggle("large", name === shownLarge);
    document.querySelector(`[data-large=${name}]`).setAttribute("aria-pressed", name === shownLarge);
  }
  element("stroke-chart").hidden = !state.target || !state.finished;
  element("time-chart").hidden = state.curve.length === 0;
  drawChart(element("over-time"), state.curve.map(({ time_s, psnr_db }) => [time_s, psnr_db ?? NaN]));
}

function phase() {
  const queued = state.more && !state.finished ? `, then ${state.more} more` : "";
  return underway() + queued;
}

function underway() {
  if (state.finished) return `${counted(marks.map(({ mark }) => mark))}, ${state.svg_bytes} bytes`;
  if (!state.last) return "starting";
  const known = state.stages ? ` of ${state.stages}` : "";
  const place = state.settling ? "settling" : state.polishing ? "polish" : `stage ${state.stage}${known}`;
  const { strokes: count, psnr_db, time_s } = state.last;
  // Without any error there is no number of dB.
  const fidelity = psnr_db === null ? "" : `, ${psnr_db.toFixed(2)} dB in the fit`;
  return `${place}, ${count} strokes${fidelity}, ${time_s.toFixed(1)} s`;
}

// dB of the finished drawing as marks are added, by the browser's renderer: in steps, between which the page answers.
async function measure() {
  const own = ++measuring;
  if (!comparison || !state.finished || !element("inside").open) return;
  const [list, found] = [marks, []];
  const other = new Comparison(state.target, scene.width, scene.height);
  other.clear(scene);
  found.push([0, other.psnr()]);
  const step = Math.max(1, Math.ceil(list.length / MEASURED));
  for (let k = 0; k < list.length; k += step) {
    const part = list.slice(k, k + step);
    other.add(part.map(({ mark }) => mark));
    found.push([k + part.length, other.psnr()]);
    await new Promise((done) => setTimeout(done));
    if (own !== measuring) return;
  }
  measured = found;
  redraw();
}

// Controls.

function showControls() {
  const total = marks.length;
  element("shown").max = element("stroke").max = total;
  element("stage").max = scene.stages.length;
  const boxes = element("layers");
  while (boxes.children.length > scene.stages.length) boxes.lastChild.remove();
  scene.stages.forEach((list, k) => showLayer(boxes.children[k] ?? boxes.appendChild(layerBox(k + 1)), k + 1, list));
}

function layerBox(stage) {
  const label = document.createElement("label");
  const box = document.createElement("input");
  box.type = "checkbox";
  box.addEventListener("change", () => {
    if (box.checked) hidden.delete(stage);
    else hidden.add(stage);
    redraw();
  });
  label.append(box, document.createElement("span"));
  return label;
}

function showLayer(label, stage, list) {
  const [box, text] = label.children;
  box.checked = !hidden.has(stage);
  text.textContent = ` ${stage}: ${counted(list)}`;
}

function showSelected() {
  const found = marks[selected - 1], { veiled, gone } = edits.now;
  for (const id of ["zoom", "hide", "alone", "delete"]) element(id).disabled = !found;
  element("choices").hidden = !found;
  element("mark-hint").hidden = Boolean(found);
  element("undo").disabled = edits.past.length === 0;
  element("redo").disabled = edits.future.length === 0;
  const says = (id, pressed) => element(id).setAttribute("aria-pressed", pressed);
  says("hide", Boolean(found) && veiled.has(selected));
  says("alone", alone !== null && alone === selected);
  const away = veiled.size + gone.size + (alone ? 1 : 0);
  element("restore").hidden = away === 0;
  element("restore").textContent = alone ? "show all" : `bring back ${away}`;
  if (document.activeElement !== element("stroke")) element("stroke").value = found ? selected : "";
  element("numbers").replaceChildren(...(found ? describe(found, marks.length) : []));
}

// Pictures.

// Draws with the next frame, so that fast pointers do not wait.
let waiting = false;
function soon() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    redraw();
  });
}

function redraw() {
  if (!scene) return;
  const list = marks.filter(isShown).map(({ mark }) => mark);
  paint(drawing, (context) => {
    drawPage(context, scene);
    drawMarks(context, list);
    if (state.target) drawCompared(context);
  });
  drawOverlay();
  if (comparison) compare(list);
  showSliders(list);
  showSelected();
  writeAddress();
}

function compare(list) {
  if (target.clientWidth) paint(target, (context) => context.drawImage(state.target, 0, 0, scene.width, scene.height));
  comparison.clear(scene);
  comparison.add(list);
  element("shown-db").textContent = `${comparison.psnr().toFixed(2)} dB as drawn here`;
  if (!residual.clientWidth) return;
  comparison.subtract();
  paint(residual, (context) => context.drawImage(comparison.residual, 0, 0, scene.width, scene.height));
}

// What lies over the drawing: the mark under the pointer, the one that is selected, and a line between picture and drawing.
export function drawOverlay() {
  if (!scene || !drawing.clientWidth) return;
  const found = marks[selected - 1], under = marks[hovered - 1];
  paint(overlay, (context, px) => {
    if (veil) veil(context, px);
    if (under && under !== found) drawRing(context, under.mark, px / 2);
    if (found) {
      drawRing(context, found.mark, px);
      drawPoints(context, found.mark, px);
    }
    if (!state.target || compared === 0 || compared === 1) return;
    const end = lens.view.x + compared * drawing.clientWidth * px;
    for (const [color, width] of [["#0008", 4], ["#fff", 2]]) {
      context.fillStyle = color;
      context.fillRect(end - (width / 2) * px, lens.view.y, width * px, drawing.clientHeight * px);
    }
  });
}

function isShown({ number, stage }) {
  if (alone) return number === alone;
  const { veiled, gone } = edits.now;
  return number <= shown && (draft?.[number - 1] ?? true) && !hidden.has(stage) && !veiled.has(number) && !gone.has(number);
}

function showSliders(visible) {
  const total = marks.length, count = Math.min(shown, total);
  const begun = marks[count - 1]?.stage ?? 0;
  element("shown").value = count;
  element("shown-count").value = `${count} of ${total}`;
  element("stage").value = begun;
  element("stage-count").value = `${begun} of ${scene.stages.length}`;
  element("shown-label").textContent = counted(visible);
  [...element("layers").children].forEach((label, k) => (label.firstChild.checked = !hidden.has(k + 1)));
  const here = measured.find(([number]) => number >= count);
  if (state.finished) drawChart(element("over-strokes"), measured, here ? [here] : []);
}

// Lays the target over the left of what is seen.
function drawCompared(context) {
  if (compared === 0) return;
  const { x, y } = lens.view, zoom = lens.zoomOf(drawing);
  context.save();
  context.beginPath();
  context.rect(x, y, (compared * drawing.clientWidth) / zoom, drawing.clientHeight / zoom);
  context.clip();
  context.clearRect(0, 0, scene.width, scene.height);
  context.drawImage(state.target, 0, 0, scene.width, scene.height);
  context.restore();
}

// Lets `draw` draw in px of the picture; it is told how many of them are one CSS px.
function paint(canvas, draw) {
  const ratio = devicePixelRatio || 1;
  const width = canvas.clientWidth;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round((width * ratio * scene.height) / scene.width);
  const context = canvas.getContext("2d");
  const zoom = lens.zoomOf(canvas), { view } = lens;
  context.setTransform(zoom * ratio, 0, 0, zoom * ratio, -view.x * zoom * ratio, -view.y * zoom * ratio);
  context.imageSmoothingEnabled = zoom < 3;
  draw(context, 1 / zoom);
}

// Buttons and keys.

const largest = () => (state.target ? large : "drawing");

function on(id, event, action) {
  element(id).addEventListener(event, () => {
    action(element(id));
    redraw();
  });
}

on("shown", "input", ({ value }) => (shown = Number(value) < marks.length ? Number(value) : Infinity));
on("stage", "input", ({ value }) => {
  const count = scene.stages.slice(0, Number(value)).flat().length;
  shown = count < marks.length ? count : Infinity;
});
on("compare", "input", ({ value }) => (compared = Number(value) / 100));
on("stroke", "input", ({ value }) => (selected = Number(value) || null));
on("all", "click", () => hidden.clear());
on("none", "click", () => scene?.stages.forEach((_, k) => hidden.add(k + 1)));
element("reset").addEventListener("click", () => lens.whole());
element("zoom-in").addEventListener("click", () => lens.zoomBy(1.5));
element("zoom-out").addEventListener("click", () => lens.zoomBy(1 / 1.5));
on("alone", "click", () => (alone = alone === selected ? null : selected));
on("restore", "click", () => {
  if (alone) alone = null;
  else change({ veiled: new Set(), gone: new Set() });
});
element("zoom").addEventListener("click", () => lens.zoomTo(marks[selected - 1].box));
const wishes = { hide, delete: remove, undo: () => travel("undo"), redo: () => travel("redo") };
for (const [id, wish] of Object.entries(wishes)) element(id).addEventListener("click", wish);

function hide() {
  if (!selected) return;
  const veiled = new Set(edits.now.veiled);
  if (!veiled.delete(selected)) veiled.add(selected);
  change({ veiled });
}

function remove() {
  if (!selected) return;
  const gone = new Set([...edits.now.gone, selected]);
  [selected, alone, hovered] = [null, null, null];
  change({ gone });
}

function travel(way) {
  if (!scene) return;
  edits[way]();
  showEdited();
}

listenToSwatches({
  repaint(pairs) {
    edits.repaint(pairs);
    const background = pairs.find(([from]) => !scene.shade && from === scene.background)?.[1];
    if (background) edits.now = { ...edits.now, background };
    showEdited();
  },
  drop(members, withPaper) {
    const gone = new Set(edits.now.gone);
    for (const { mark, number } of marks) if (members.includes(mark[2])) gone.add(number);
    change({ gone, ...(withPaper && { background: null }) });
  },
});

// Which picture is large.

function enlarge(name) {
  // The part that is seen stays as large, in px of the picture.
  const before = element(largest()).clientWidth;
  large = name;
  showState();
  if (lens.view.zoom && before) lens.view.zoom *= element(largest()).clientWidth / before;
  redraw();
}

for (const button of document.querySelectorAll("[data-large]")) {
  button.addEventListener("click", () => enlarge(button.dataset.large));
}

addEventListener("keydown", (event) => {
  if (!scene || event.altKey || event.target.matches("input:not([type=range]), select, textarea")) return;
  if (event.ctrlKey || event.metaKey) {
    if (event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    return travel(event.shiftKey ? "redo" : "undo");
  }
  if (event.target.matches("input, a, summary") || (event.key === " " && event.target.matches("button"))) return;
  if (answer(event.key)) event.preventDefault();
});

// Does what a key stands for; returns whether it stands for something.
function answer(key) {
  const next = PICTURES[(PICTURES.indexOf(large) + 1) % PICTURES.length];
  const name = key === " " ? next : PICTURES.find((name) => name[0] === key.toLowerCase());
  if (name && state.target) enlarge(name);
  else if (key === "h") hide();
  else if (key === "Delete" || key === "Backspace") remove();
  else if (key === "Escape") [selected] = [null, redraw()];
  else return lens.key(key);
  return true;
}

// The file as it is shown.

const isWhole = () => marks.every(isShown) && edits.now.colors.length === 0 && edits.now.background === undefined;

// The text of a file of the drawing, with what is changed.
export function asShown(text) {
  return isWhole() ? text : edited(text, marks.map(isShown), edits.now, scene);
}

element("download").addEventListener("click", async (event) => {
  if (isWhole()) return;
  event.preventDefault();
  const link = element("download");
  const text = await (await fetch(link.href)).text();
  const saved = document.createElement("a");
  saved.href = URL.createObjectURL(new Blob([asShown(text)], { type: "image/svg+xml" }));
  saved.download = link.download || "drawing.svg";
  saved.click();
  setTimeout(() => URL.revokeObjectURL(saved.href), 10_000);
});

// Shows some marks of the drawing only, true for each that is; null for all.
export function showDraft(kept) {
  draft = kept;
  redraw();
}

// Lets drags go to `next(x, y, begins)`, px of the picture, and paints `over(context)` over the drawing; null ends it.
export function paintOver(next, over) {
  [brush, veil] = [next, over];
  drawing.style.touchAction = brush ? "none" : "";
  drawOverlay();
}

// dB of what is shown, as the browser draws it; NaN without a picture.
export const shownDb = () => parseFloat(element("shown-db").textContent);

export function listen({ stop, add }) {
  element("stop").addEventListener("click", stop);
  element("more").addEventListener("submit", (event) => {
    event.preventDefault();
    add(Number(element("strokes").value));
  });
}

function showAgain() {
  if (!scene) return;
  showState();
  redraw();
}

addEventListener("resize", showAgain);
element("inside").addEventListener("toggle", () => {
  showAgain();
  measure();
});
addEventListener("hashchange", () => {
  readAddress();
  redraw();
});

readAddress();
