// Fits on threads of their own, so that several run at once.

import { isMainThread, parentPort, Worker, workerData } from "node:worker_threads";

import { fitPng } from "../../pkg/node.js";

if (!isMainThread && workerData?.png) {
  const { png, options } = workerData;
  fitPng(png, options).then((drawing) => parentPort.postMessage(drawing));
}

// The drawing of a PNG file, by the WebAssembly.
export function fitElsewhere(png, options) {
  return new Promise((done, failed) => {
    const worker = new Worker(new URL(import.meta.url), { workerData: { png, options } });
    worker.once("message", done);
    worker.once("error", failed);
  });
}
