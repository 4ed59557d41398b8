// Fits one picture, and tells the page how it goes, or writes a drawing as another kind of file. The page ends this worker when it
// wants something else.

import { animate, dxf, fit, fitPng, init, pdf } from "./strokefit/browser.js";

// Least time between two messages, and between two drawings, ms.
const TELL = 100;
const SHOW = 250;
// The fit needs the processor: it goes on so many times as long as it took to copy the drawing.
const REST = 30;

// The first message has the WebAssembly, the second one a picture, or the text of a drawing and the kind of file that it is to be.
let ready;

onmessage = ({ data }) => {
  if (data.module) ready = init(data.module);
  else (data.kind ? convert(data) : draw(data)).catch(({ message }) => postMessage({ error: message }));
};

async function convert({ text, kind }) {
  await ready;
  postMessage({ file: await { pdf, dxf }[kind](text) });
}

async function draw({ picture: { png, pixels, width, height }, options, running }) {
  await ready;
  const watch = watcher(running);
  const drawing = await (png ? fitPng(png, options, watch) : fit(pixels, width, height, options, watch));
  // Outlines, and what lies on a foreign SVG, cannot be animated.
  const animation = await animate(drawing.svg).catch(() => null);
  postMessage({ drawing, animation });
}

function watcher(running) {
  const start = performance.now();
  let [told, shown, pause] = [-Infinity, -Infinity, 0];
  return ({ done, stage, stages, polishing, strokes, psnrDb, scene }) => {
    const now = performance.now();
    if (now - told < TELL) return true;
    told = now;
    const last = { time_s: (now - start) / 1000, strokes, psnr_db: Number.isFinite(psnrDb) ? psnrDb : null };
    const message = { progress: { done, stage, stages, polishing, last } };
    if (now - shown >= pause) {
      message.scene = scene();
      shown = performance.now();
      pause = Math.max(SHOW, REST * (shown - now));
    }
    postMessage(message);
    return isRunning(running);
  };
}

// Whether the page lets the fit go on. While it fits, a worker gets no message, and memory is shared only where a server
// sends special headers. But it can ask for an address that the page has made, and revokes in order to stop it.
function isRunning(address) {
  const request = new XMLHttpRequest();
  request.open("GET", address, false);
  try {
    request.send();
    return request.status === 200;
  } catch {
    return false;
  }
}
