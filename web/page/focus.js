// A brush that says what matters: errors count most where it has been.

import { drawOverlay, paintOver } from "./viewer.js";

const element = (id) => document.getElementById(id);
// Width of the brush, in parts of the picture's longest side.
const BRUSH = 1 / 12;

// What is painted, on transparent; null where nothing is.
let layer = null;
let last = null;

// `given(mask)` is told of a finished mask, or of null.
export function listenToFocus(size, given) {
  element("focus").addEventListener("click", () => {
    if (element("focus").getAttribute("aria-pressed") === "true") return end();
    layer ??= new OffscreenCanvas(...size()).getContext("2d", { willReadFrequently: true });
    turn(true);
    paintOver(brush, (context) => {
      context.globalAlpha = 0.5;
      context.drawImage(layer.canvas, 0, 0);
      context.globalAlpha = 1;
    });
  });
  element("focus-draw").addEventListener("click", () => {
    const mask = painted();
    end();
    given(mask);
  });
  element("focus-clear").addEventListener("click", () => {
    const had = layer !== null;
    forgetFocus();
    if (had) given(null);
  });
}

// Another picture has no focus.
export function forgetFocus() {
  end();
  layer = null;
}

function end() {
  turn(false);
  paintOver(null, null);
}

function turn(on) {
  element("focus").setAttribute("aria-pressed", on);
  element("focus-tools").hidden = !on;
}

function brush(x, y, begins) {
  const { canvas } = layer;
  layer.lineCap = "round";
  layer.strokeStyle = "#d6249f";
  layer.lineWidth = BRUSH * Math.max(canvas.width, canvas.height);
  layer.beginPath();
  layer.moveTo(...(begins || !last ? [x, y] : last));
  layer.lineTo(x + 0.01, y);
  layer.stroke();
  last = [x, y];
  drawOverlay();
}

// The mask for the fit, one byte for each pixel; null where nothing is painted.
function painted() {
  if (!layer) return null;
  const { width, height } = layer.canvas;
  const { data } = layer.getImageData(0, 0, width, height);
  const pixels = Uint8Array.from({ length: width * height }, (_, i) => data[4 * i + 3]);
  return pixels.some(Boolean) ? { pixels, width, height } : null;
}
