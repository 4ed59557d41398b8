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
import { drawn, mostLike, withoutMarks } from "./choice.js";
import { Comparison, bounds, counted, drawMarks, drawPage, drawPoints, drawRing, isArea, markAt, paths } from "./picture.js";

// Number of times that the finished drawing is measured on the way from no mark to all.
const MEASURED = 60;

const element = (id) => document.getElementById(id);
const [target, drawing, residual] = ["target", "drawing", "residual"].map(element);
// As the keys and Space go through them.
const PICTURES = ["drawing", "target", "residual"];

let state = { curve: [] };
let scene = null;
// All marks, strokes and areas, as { mark, number, stage }, numbers and stages from 1.
let marks = [];
let comparison = null;
let measured = [];
// Part of the picture that is seen: px of the picture per CSS px is 1 / zoom.
let view = { zoom: 0, x: 0, y: 0 };
let hidden = new Set();
// Number of marks from the back that are shown; all when it is Infinity, also of a growing drawing.
let shown = Infinity;
let selected = null;
// The picture that is large.
let large = "drawing";
// Marks by their numbers: those not shown, the only one shown, and those that are gone.
let [veiled, alone, gone] = [new Set(), null, new Set()];
// The share of the drawing, from the left, that shows the target instead.
let compared = 0;

function readAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  shown = wanted.has("shown") ? Number(wanted.get("shown")) : Infinity;
  selected = Number(wanted.get("stroke")) || null;
  const numbers = (key) => new Set((wanted.get(key) ?? "").split(",").filter(Boolean).map(Number));
  [hidden, veiled, gone] = ["hidden", "veiled", "gone"].map(numbers);
  alone = Number(wanted.get("alone")) || null;
  large = PICTURES.includes(wanted.get("large")) ? wanted.get("large") : "drawing";
  const [x, y, zoom] = (wanted.get("view") ?? "").split(",").map(Number);
  view = zoom > 0 ? { x, y, zoom } : { x: 0, y: 0, zoom: 0 };
}

function writeAddress() {
  const say = new URLSearchParams();
  if (shown < marks.length) say.set("shown", shown);
  if (selected) say.set("stroke", selected);
  for (const [key, numbers] of Object.entries({ hidden, veiled, gone })) {
    if (numbers.size) say.set(key, [...numbers].join());
  }
  if (alone) say.set("alone", alone);
  if (large !== "drawing") say.set("large", large);
  if (view.zoom) say.set("view", [view.x, view.y, view.zoom].map((v) => Number(v.toFixed(2))).join());
  history.replaceState(null, "", say.size ? `#${say}` : location.pathname);
}

export function show(next) {
  const another = next.picture !== state.picture;
  const replaced = another && state.picture !== undefined;
  const finishedNow = next.finished && (another || !state.finished);
  state = next;
  if (another) [scene, comparison, marks, measured] = [null, null, [], []];
  if (replaced) [selected, alone, veiled, gone] = [null, null, new Set(), new Set()];
  if (state.scene) takeScene(state.scene);
  showState();
  if (state.scene || finishedNow) redraw();
  if (finishedNow && comparison) measure();
  document.body.dataset.ready = state.finished;
}

function takeScene(next) {
  const before = marks;
  scene = next;
  let number = 0;
  marks = scene.stages.flatMap((list, k) => list.map((mark) => ({ mark, number: ++number, stage: k + 1 })));
  if (before.length) follow(before);
  element("panels").style.setProperty("--aspect", scene.width / scene.height);
  if (state.target && !comparison) comparison = new Comparison(state.target, scene.width, scene.height);
  showControls();
}

// In another drawing marks have other numbers: what was said of one holds for the one that is most like it.
function follow(before) {
  const now = (number) => mostLike(marks, before[number - 1])?.number ?? null;
  const all = (numbers) => new Set([...numbers].map(now).filter(Boolean));
  [selected, alone] = [selected && now(selected), alone && now(alone)];
  [veiled, gone] = [all(veiled), all(gone)];
}

// Numbers and curves.

function showState() {
  element("title").textContent = document.title = `strokefit: ${state.title}`;
  element("phase").textContent = phase();
  element("progress").value = state.finished ? 1 : (state.done ?? 0);
  element("progress").hidden = state.done === null;
  element("stop").hidden = state.finished || state.done === null;
  element("more").hidden = !state.grows;
  element("download").hidden = !scene;
  for (const id of ["target-panel", "residual-panel", "compare", "compare-label"]) element(id).hidden = !state.target;
  element("panels").classList.toggle("single", !state.target);
  const shownLarge = state.target ? large : "drawing";
  for (const name of PICTURES) {
    element(`${name}-panel`).classList.toggle("large", name === shownLarge);
    element(`${name}-panel`).querySelector("button").setAttribute("aria-pressed", name === shownLarge);
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

// dB of the finished drawing as marks are added, by the browser's renderer.
function measure() {
  comparison.clear(scene);
  measured = [[0, comparison.psnr()]];
  const step = Math.max(1, Math.ceil(marks.length / MEASURED));
  for (let k = 0; k < marks.length; k += step) {
    const part = marks.slice(k, k + step);
    comparison.add(part.map(({ mark }) => mark));
    measured.push([k + part.length, comparison.psnr()]);
  }
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
  const found = marks[selected - 1];
  for (const id of ["zoom", "hide", "alone", "delete"]) element(id).disabled = !found;
  const says = (id, pressed) => element(id).setAttribute("aria-pressed", pressed);
  says("hide", Boolean(found) && veiled.has(selected));
  says("alone", alone !== null && alone === selected);
  const away = veiled.size + gone.size + (alone ? 1 : 0);
  element("restore").hidden = away === 0;
  element("restore").textContent = alone ? "show all" : `bring back ${away}`;
  if (document.activeElement !== element("stroke")) element("stroke").value = found ? selected : "";
  element("numbers").replaceChildren(...(found ? describe(found) : []));
}

// Number of points of a mark that are told.
const TOLD_POINTS = 24;

function describe({ mark, number, stage }) {
  const [, radius, color, opacity] = mark;
  const rows = [["number", `${number} of ${marks.length}, stage ${stage}`]];
  rows.push(...paths(mark).map((path) => [isArea(mark) ? "ring" : "points", told(path)]));
  if (!isArea(mark)) rows.push(["width", `${round(2 * radius)} px`]);
  rows.push(["colour", color], ["opacity", opacity.toFixed(3)]);
  return rows.flatMap(([name, value]) => {
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = name;
    if (name === "colour") {
      const swatch = text.appendChild(document.createElement("span"));
      swatch.className = "swatch";
      swatch.style.background = color;
    }
    text.append(value);
    return [term, text];
  });
}

const round = (value) => Number(value.toFixed(2));

// The points of a path. Control points are in parentheses.
function told({ places, kinds }) {
  const pairs = places.slice(0, TOLD_POINTS).map(([x, y], k) => {
    const pair = `${round(x)}, ${round(y)}`;
    return kinds[k] === "o" ? pair : `(${pair})`;
  });
  if (places.length > TOLD_POINTS) pairs.push(`${places.length - TOLD_POINTS} more`);
  if (kinds.endsWith("z")) pairs.push("start");
  return pairs.join("  →  ");
}

// Pictures.

function redraw() {
  if (!scene) return;
  const list = marks.filter(isShown).map(({ mark }) => mark);
  const found = marks[selected - 1];
  paint(drawing, (context, px) => {
    drawPage(context, scene);
    drawMarks(context, list);
    if (found) {
      drawRing(context, found.mark, px);
      drawPoints(context, found.mark, px);
    }
    if (state.target) drawCompared(context, px);
  });
  if (comparison) {
    paint(target, (context) => context.drawImage(state.target, 0, 0, scene.width, scene.height));
    comparison.clear(scene);
    comparison.add(list);
    element("shown-db").textContent = `${comparison.psnr().toFixed(2)} dB as drawn here`;
    comparison.subtract();
    paint(residual, (context) => context.drawImage(comparison.residual, 0, 0, scene.width, scene.height));
  }
  showSliders(list);
  showSelected();
  writeAddress();
}

function isShown({ number, stage }) {
  if (alone) return number === alone;
  return number <= shown && !hidden.has(stage) && !veiled.has(number) && !gone.has(number);
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

// Lays the target over the left of what is seen, up to a line.
function drawCompared(context, px) {
  if (compared === 0) return;
  const end = view.x + compared * drawing.clientWidth * px;
  context.save();
  context.beginPath();
  context.rect(view.x, view.y, end - view.x, drawing.clientHeight * px);
  context.clip();
  context.clearRect(0, 0, scene.width, scene.height);
  context.drawImage(state.target, 0, 0, scene.width, scene.height);
  context.restore();
  for (const [color, width] of [["#fff", 3], ["#000", 1]]) {
    context.fillStyle = color;
    context.fillRect(end - (width / 2) * px, view.y, width * px, drawing.clientHeight * px);
  }
}

// Lets `draw` draw in px of the picture; it is told how many of them are one CSS px.
function paint(canvas, draw) {
  const ratio = devicePixelRatio || 1;
  const width = canvas.clientWidth;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round((width * ratio * scene.height) / scene.width);
  const context = canvas.getContext("2d");
  const zoom = zoomOf(canvas);
  context.setTransform(zoom * ratio, 0, 0, zoom * ratio, -view.x * zoom * ratio, -view.y * zoom * ratio);
  context.imageSmoothingEnabled = zoom < 3;
  draw(context, 1 / zoom);
}

// Mouse and buttons.

// CSS px of a canvas per px of the picture. The address has the zoom of the large one; all show the same part.
function zoomOf(canvas) {
  const whole = canvas.clientWidth / scene.width;
  return view.zoom ? (view.zoom * canvas.clientWidth) / element(largest()).clientWidth : whole;
}

const largest = () => (state.target ? large : "drawing");

function place(event) {
  const zoom = zoomOf(event.target);
  return [view.x + event.offsetX / zoom, view.y + event.offsetY / zoom];
}

function zoomAt(event) {
  event.preventDefault();
  if (!scene) return;
  const [x, y] = place(event);
  const canvas = event.target, whole = element(largest());
  const least = whole.clientWidth / scene.width;
  const zoom = Math.max(least, Math.min(100, zoomOf(whole) * 1.0015 ** -event.deltaY));
  const own = (zoom * canvas.clientWidth) / whole.clientWidth;
  view = zoom > least ? { zoom, x: x - event.offsetX / own, y: y - event.offsetY / own } : { zoom: 0, x: 0, y: 0 };
  redraw();
}

function zoomTo({ mark }) {
  const [left, top, right, bottom] = bounds(mark);
  const whole = element(largest());
  const [width, height] = [whole.clientWidth, whole.clientHeight];
  const zoom = Math.min(40, width / (right - left) / 2, height / (bottom - top) / 2);
  view = { zoom, x: (left + right) / 2 - width / zoom / 2, y: (top + bottom) / 2 - height / zoom / 2 };
  redraw();
}

let drag = null;

function startDrag(event) {
  if (!scene) return;
  drag = { from: place(event), moved: false };
  event.target.setPointerCapture(event.pointerId);
}

function moveDrag(event) {
  if (!drag) return;
  const [x, y] = place(event);
  const [dx, dy] = [drag.from[0] - x, drag.from[1] - y];
  drag.moved ||= Math.hypot(dx, dy) * zoomOf(event.target) > 3;
  if (!drag.moved) return;
  view = { zoom: zoomOf(element(largest())), x: view.x + dx, y: view.y + dy };
  redraw();
}

function endDrag(event) {
  if (drag && !drag.moved) {
    selected = markAt(marks.filter(isShown), ...place(event))?.number ?? null;
    redraw();
  }
  drag = null;
}

for (const canvas of [target, drawing, residual]) {
  canvas.addEventListener("wheel", zoomAt, { passive: false });
  canvas.addEventListener("pointerdown", startDrag);
  canvas.addEventListener("pointermove", moveDrag);
  canvas.addEventListener("pointerup", endDrag);
}

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
on("reset", "click", () => (view = { zoom: 0, x: 0, y: 0 }));
on("hide", "click", () => veiled.delete(selected) || veiled.add(selected));
on("alone", "click", () => (alone = alone === selected ? null : selected));
on("delete", "click", () => {
  gone.add(selected);
  [selected, alone] = [null, null];
});
on("restore", "click", () => {
  if (alone) alone = null;
  else [veiled, gone] = [new Set(), new Set()];
});
element("zoom").addEventListener("click", () => zoomTo(marks[selected - 1]));

// Which picture is large.

function enlarge(name) {
  // The part that is seen stays as large, in px of the picture.
  const before = element(largest()).clientWidth;
  large = name;
  showState();
  if (view.zoom) view.zoom *= element(largest()).clientWidth / before;
  redraw();
}

for (const button of document.querySelectorAll("[data-large]")) {
  button.addEventListener("click", () => enlarge(button.dataset.large));
}

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || !scene || !state.target) return;
  if (event.target.matches("input, select, button, a, textarea")) return;
  const next = PICTURES[(PICTURES.indexOf(large) + 1) % PICTURES.length];
  const name = event.key === " " ? next : PICTURES.find((name) => name[0] === event.key.toLowerCase());
  if (!name) return;
  event.preventDefault();
  enlarge(name);
});

// The file without what is not shown.

element("download").addEventListener("click", async (event) => {
  const kept = marks.map(isShown);
  if (kept.every(Boolean)) return;
  event.preventDefault();
  const link = element("download");
  const text = await (await fetch(link.href)).text();
  const part = withoutMarks(text, kept) ?? drawn({ ...scene, marks: marks.filter(isShown) });
  const saved = document.createElement("a");
  saved.href = URL.createObjectURL(new Blob([part], { type: "image/svg+xml" }));
  saved.download = link.download || "drawing.svg";
  saved.click();
  setTimeout(() => URL.revokeObjectURL(saved.href), 10_000);
});

export function listen({ stop, add }) {
  element("stop").addEventListener("click", stop);
  element("more").addEventListener("submit", (event) => {
    event.preventDefault();
    add(Number(element("strokes").value));
  });
}

addEventListener("resize", () => {
  if (!scene) return;
  showState();
  redraw();
});
addEventListener("hashchange", () => {
  readAddress();
  redraw();
});

readAddress();
