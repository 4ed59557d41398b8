// What the package offers, over what the WebAssembly exports; strokefit.d.ts describes it.

import { Renderer, checkedSize } from "./gradients.js";
import load, {
  Renderer as NativeRenderer, Target, __wbg_reset_state, animate as animateText, dxf as dxfOf, fit as fitTarget, lastPanic, pdf as pdfOf,
} from "./wasm.js";

// The functions of the package. `locate` says what to load: an address, bytes, or a module that is compiled already.
export function connect(locate) {
  let loaded;
  const init = async (source) => {
    loaded ??= load({ module_or_path: locate(source) });
    await loaded;
  };
  const fit = async (pixels, width, height, options, onProgress) => {
    await init();
    return draw(() => Target.fromPixels(bytes(pixels), width, height), options, onProgress);
  };
  const fitPng = async (png, options, onProgress) => {
    await init();
    return draw(() => Target.fromPng(bytes(png)), options, onProgress);
  };
  const converts = (convert) => async (svg) => {
    await init();
    return guarded(() => convert(svg));
  };
  const [animate, pdf, dxf] = [animateText, pdfOf, dxfOf].map(converts);
  const renderer = async (width, height, { softness = 1.2, coverage = "smoothstep" } = {}) => {
    checkedSize(width, height, softness);
    await init();
    const native = guarded(() => new NativeRenderer(width, height, coverage, softness));
    return new Renderer(native, width, height, guarded);
  };
  return { init, fit, fitPng, animate, pdf, dxf, renderer };
}

function draw(read, { focus, ...options } = {}, onProgress) {
  return guarded(() => {
    const mask = focus && Target.fromPixels(bytes(focus.pixels), focus.width, focus.height);
    const drawing = fitTarget(read(), mask, JSON.stringify(words(options)), onProgress && watcher(onProgress));
    const { svg, report, scene } = drawing;
    drawing.free();
    return { svg, report: JSON.parse(report), scene: JSON.parse(scene) };
  });
}

// Colours may be a number or a list; as text they are what the command line takes.
function words({ colors, ...options }) {
  return { ...options, colors: colors?.toString() };
}

// What the WebAssembly calls after each iteration; it goes on unless `onProgress` returns false.
function watcher(onProgress) {
  return (done, stage, stages, polishing, strokes, psnrDb, isTrial, scene) => {
    const progress = { done, stage, stages, polishing, strokes, psnrDb, isTrial, scene: () => JSON.parse(scene()) };
    return onProgress(progress) !== false;
  };
}

function bytes(samples) {
  if (ArrayBuffer.isView(samples) && samples.BYTES_PER_ELEMENT === 1) {
    return new Uint8Array(samples.buffer, samples.byteOffset, samples.byteLength);
  }
  if (samples instanceof ArrayBuffer) return new Uint8Array(samples);
  throw new TypeError("the samples are no bytes: give a Uint8Array or a Uint8ClampedArray");
}

// Calls the WebAssembly. Where it traps, its memory is worth nothing any more: it starts anew.
function guarded(call) {
  try {
    return call();
  } catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError || error instanceof RangeError)) throw error;
    const reason = lastPanic() ?? error.message;
    __wbg_reset_state();
    throw new Error(`the fit broke off (${reason}): a smaller picture or fewer strokes may need less memory`, { cause: error });
  }
}
