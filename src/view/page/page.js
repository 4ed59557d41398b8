// Asks the program for the state of its drawing, and shows it.

import { listen, show } from "./viewer.js";

// Time between two questions, ms: while a drawing is fitted, and after, to say that the page is there.
const ASK_LIVE = 300;
const ASK_IDLE = 5000;
// The fit may need the processor: the page rests so many times as long as it took to show the drawing.
const REST = 30;

const element = (id) => document.getElementById(id);

let [picture, version, target] = [0, 0, null];

async function ask() {
  try {
    const answer = await fetch(`state?seen=${version}`);
    if (!answer.ok) throw new Error(answer.statusText);
    const state = await answer.json();
    const start = performance.now();
    await take(state);
    const live = Math.max(ASK_LIVE, REST * (performance.now() - start));
    setTimeout(ask, state.finished ? ASK_IDLE : Math.min(live, ASK_IDLE));
  } catch (error) {
    console.info(error);
    end();
  }
}

async function take(state) {
  if (state.picture !== picture) target = state.has_target ? await load(`target.png?picture=${state.picture}`) : null;
  ({ picture, version } = state);
  show({ ...state, target });
  element("done").hidden = !state.finished;
}

function load(address) {
  const image = new Image();
  return new Promise((done, failed) => {
    image.onload = () => done(image);
    image.onerror = failed;
    image.src = address;
  });
}

function end() {
  element("phase").textContent = "the program has ended; this page no longer changes";
  for (const id of ["stop", "more", "done", "download"]) element(id).hidden = true;
}

const post = (wish) => fetch(wish, { method: "POST" });

element("inside").open = true;
listen({ stop: () => post("stop"), add: (strokes) => post(`more?strokes=${strokes}`) });
element("done").addEventListener("click", () => post("done").then(end));
ask();
