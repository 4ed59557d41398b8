// Several files: each is drawn in turn, and all come as a zip.

import * as fitting from "./fitting.js";
import { read } from "./picture-file.js";
import { fidelity, count, size } from "./words.js";
import { distinct, zip } from "./zip.js";

const element = (id) => document.getElementById(id);
const stem = (name) => (name || "picture").replace(/\.[^.]*$/, "");

let run = 0;

export const endBatch = () => ++run;

// Draws files under the same options, the picture at most `longest` px wide or high.
export async function drawAll(files, options, longest) {
  const own = ++run;
  const lines = files.map(line);
  element("files").replaceChildren(...lines);
  element("zip").hidden = true;
  const drawn = [];
  for (const [k, file] of files.entries()) {
    head(`Drawing ${k + 1} of ${files.length}`);
    const told = (text) => (lines[k].lastChild.textContent = text);
    try {
      const drawing = await drawOne(file, options, longest, (share) => told(`${Math.round(100 * share)} %`), () => own === run);
      if (own !== run) return;
      const { strokes, svg_bytes, fidelity: { psnr_db } } = drawing.report;
      told([count(strokes, "mark"), size(svg_bytes), fidelity(psnr_db)].join(" · "));
      drawn.push({ name: `${stem(file.name)}.svg`, text: drawing.svg });
    } catch (error) {
      if (own !== run) return;
      told(error.message);
    }
  }
  head(`${drawn.length} of ${files.length} drawn`);
  if (drawn.length) offer(drawn);
  element("batch-name").focus();
}

async function drawOne(file, options, longest, tell, wanted) {
  const { picture } = await read(file, longest);
  if (!wanted()) return null;
  return new Promise((done, failed) => {
    fitting.start(picture, options, ({ progress, drawing, error }) => {
      if (progress) tell(progress.done);
      if (drawing) done(drawing);
      if (error) failed(new Error(error));
    });
  });
}

function line(file) {
  const item = document.createElement("li");
  const name = document.createElement("span"), state = document.createElement("span");
  name.textContent = file.name || "a picture";
  state.textContent = "waits";
  state.className = "quiet";
  item.append(name, state);
  return item;
}

function head(text) {
  element("batch-name").textContent = text;
}

function offer(drawn) {
  const names = distinct(drawn.map(({ name }) => name));
  const bytes = zip(drawn.map(({ text }, k) => ({ name: names[k], text })));
  const link = element("zip");
  if (link.href) URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([bytes], { type: "application/zip" }));
  link.hidden = false;
}
