// strokefit for Node: the WebAssembly is read from beside this file.

import { readFile } from "node:fs/promises";

import { connect } from "./api.js";

const OWN = new URL("./wasm_bg.wasm", import.meta.url);

export const { init, fit, fitPng, animate, pdf, dxf, renderer } = connect((source = OWN) =>
  source instanceof WebAssembly.Module ? source : readFile(source),
);
