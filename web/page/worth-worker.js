// Weighs the marks of a finished drawing, beside the page.

import { levels as channels } from "./edits.js";
import { bounds, drawMarks } from "./picture.js";
import { SIDE, levelsOf } from "./worth.js";

onmessage = ({ data: { scene, target, bytes, quality, number } }) => {
  const scale = Math.min(1, SIDE / Math.max(scene.width, scene.height));
  const [width, height] = [scene.width, scene.height].map((side) => Math.max(1, Math.round(side * scale)));
  const marks = scene.stages.flat();
  const levels = levelsOf({
    masks: marks.map(masker(width, height, scale)),
    colors: marks.map(([, , color]) => channels(color)),
    background: channels(scene.background ?? "#ffffff"),
    target: picture(target, width, height, scene.background ?? "#ffffff"),
    width,
    bytes,
    share: 1 / (scale * scale),
  }, quality);
  postMessage({ levels, number });
};

function picture(image, width, height, background) {
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  context.fillStyle = background;
  context.fillRect(0, 0, width, height);
  context.imageSmoothingQuality = "high";
  context.drawImage(image, 0, 0, width, height);
  const { data } = context.getImageData(0, 0, width, height);
  return Float32Array.from({ length: 3 * width * height }, (_, i) => data[4 * Math.floor(i / 3) + (i % 3)]);
}

// Gives the coverage of a mark in its box.
function masker(across, down, scale) {
  const context = new OffscreenCanvas(across, down).getContext("2d", { willReadFrequently: true });
  return (mark) => {
    const box = bounds(mark).map((v) => v * scale);
    const [left, top] = [Math.max(0, Math.floor(box[0]) - 1), Math.max(0, Math.floor(box[1]) - 1)];
    const [width, height] = [Math.min(across, Math.ceil(box[2]) + 1) - left, Math.min(down, Math.ceil(box[3]) + 1) - top];
    if (width <= 0 || height <= 0) return { left: 0, top: 0, width: 0, height: 0, alpha: [] };
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(left, top, width, height);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    drawMarks(context, [mark]);
    const { data } = context.getImageData(left, top, width, height);
    const alpha = Uint8Array.from({ length: width * height }, (_, i) => data[4 * i + 3]);
    return { left, top, width, height, alpha };
  };
}
