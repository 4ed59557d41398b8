// strokefit for browsers: the WebAssembly is fetched from beside this file.

import { connect } from "./api.js";

export const { init, fit, fitPng, animate, pdf, dxf, renderer } = connect((source) => source ?? new URL("./wasm_bg.wasm", import.meta.url));
