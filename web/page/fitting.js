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

// The fit under way, and a worker that waits for the next one.
let current = null;
let spare = null;

// Makes ready for a fit, so that it begins at once.
export async function prepare() {
  const module = await load();
  spare ??= work(module);
}

// Ends the fit that is under way, without a result, and starts another. `tell` gets the messages of worker.js.
export async function start(picture, options, tell) {
  cancel();
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
    await prepare();
    if (current !== fit) return;
    [fit.worker, spare] = [spare, null];
    fit.worker.onmessage = ({ data }) => over(data);
    fit.worker.onerror = (event) => over({ error: `the fit broke off (${event.message ?? "its worker failed"}): try again` });
    fit.worker.postMessage({ picture, options, running: fit.running });
  } catch (error) {
    over({ error: error.message });
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
