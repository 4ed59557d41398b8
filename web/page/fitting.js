// Fits in workers, one after the other: a fit begins with a fresh one, so that nothing of the last is left.

import { worker } from "./workers.js";

// Compiled once, for all workers.
let compiled = null;

async function compile() {
  const answer = await fetch("strokefit/wasm_bg.wasm");
  if (!answer.ok) throw new Error(`the program cannot be loaded (${answer.status}): load the page again`);
  return WebAssembly.compile(await answer.arrayBuffer());
}

function load() {
  // What failed may work later.
  compiled ??= compile().catch((error) => {
    compiled = null;
    throw error;
  });
  return compiled;
}

// The fit under way, a worker that waits for the next one, and one that warms up.
let current = null;
let spare = null;
let warming = null;

// Makes ready for a fit, so that it begins at once.
export async function prepare() {
  const module = await load();
  spare ??= work(module);
}

// A worker that is ready, and from now on nobody else's.
async function claim() {
  const module = await load();
  const one = spare ?? work(module);
  spare = null;
  return one;
}

// Draws a tiny picture that nobody sees, up to the first marks. Browsers compile what is called when it is called, for all workers:
// the first drawing of a picture comes in half the time then.
export async function warm() {
  const module = await load();
  if (current) return;
  warming = work(module);
  warming.onmessage = warming.onerror = cool;
  warming.postMessage({ picture: tiny(), options: { preset: "draft" }, running: "" });
}

function cool() {
  warming?.terminate();
  warming = null;
}

// A red disc on paper beside a gradient, so that areas are traced and strokes are seeded.
function tiny() {
  const [width, height] = [96, 64];
  const color = (x, y) => {
    if (x >= 48) return [5 * (x - 48), 4 * y, 128 + ((7 * x + 3 * y) % 31)];
    return Math.hypot(x - 24, y - 32) < 16 ? [200, 40, 40] : [240, 240, 230];
  };
  const pixels = Uint8Array.from({ length: 4 * width * height }, (_, k) => [...color((k >> 2) % width, Math.floor(k / 4 / width)), 255][k % 4]);
  return { pixels, width, height };
}

// Ends the fit that is under way, without a result, and starts another. `tell` gets the messages of worker.js.
export async function start(picture, options, tell) {
  cancel();
  cool();
  const fit = { running: URL.createObjectURL(new Blob(["running"])), worker: null };
  current = fit;
  const over = (message) => {
    if (current !== fit) return;
    tell(message);
    if (message.drawing || message.error) {
      cancel();
      // The next fit says so if this fails.
      prepare().catch(() => {});
    }
  };
  try {
    const one = await claim();
    if (current !== fit) return one.terminate();
    fit.worker = one;
    fit.worker.onmessage = ({ data }) => over(data);
    fit.worker.onerror = (event) => over({ error: `the fit broke off (${event.message ?? "its worker failed"}): try again` });
    fit.worker.postMessage({ picture, options, running: fit.running });
  } catch (error) {
    over({ error: error.message });
  }
}

// The text of a drawing as a file of another kind, "pdf" or "dxf".
export async function convert(text, kind) {
  const one = await claim();
  try {
    return await new Promise((done, failed) => {
      one.onmessage = ({ data }) => (data.error ? failed(new Error(data.error)) : done(data.file));
      one.onerror = ({ message }) => failed(new Error(`no ${kind.toUpperCase()} could be made (${message}): try again`));
      one.postMessage({ text, kind });
    });
  } finally {
    one.terminate();
    prepare().catch(() => {});
  }
}

// Lets the fit end with what it has drawn.
export function stop() {
  if (current) URL.revokeObjectURL(current.running);
}

export function cancel() {
  stop();
  current?.worker?.terminate();
  current = null;
}

function work(module) {
  const started = worker("worker.js");
  started.postMessage({ module });
  return started;
}
