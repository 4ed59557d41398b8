// The palette on the page: a swatch for each group of colours.

import { levels, hex } from "./edits.js";

const element = (id) => document.getElementById(id);

let list = [];
let chosen = null;
let background = null;
let hear = {};

// Tells what is wanted: repaint(pairs [from, to]), drop(members), background(null).
export function listenToSwatches(listener) {
  hear = listener;
}

// Shows the groups of palette.js. `paper` is the colour of the background, null without one.
export function showSwatches(groups, paper) {
  [list, background] = [groups, paper];
  element("palette").hidden = list.length === 0;
  const boxes = element("swatches");
  const active = boxes.contains(document.activeElement) ? [...boxes.children].indexOf(document.activeElement) : -1;
  boxes.replaceChildren(...list.map(swatch));
  if (active >= 0) boxes.children[Math.min(active, list.length - 1)]?.focus();
  if (chosen !== null && !list[chosen]) chosen = null;
  showEditor();
}

const isPaper = ({ members }) => background !== null && members.includes(background);
const named = (group) => `${group.color}${isPaper(group) ? ", with the background" : ""}`;

function swatch(group, k) {
  const button = document.createElement("button");
  button.className = "swatch";
  button.draggable = true;
  button.style.background = group.color;
  button.title = `${named(group)}, ${Math.round(100 * group.share)} % of the drawing`;
  button.setAttribute("aria-label", `colour ${named(group)}`);
  button.setAttribute("aria-pressed", k === chosen);
  button.addEventListener("click", () => {
    chosen = chosen === k ? null : k;
    showSwatches(list, background);
    if (chosen !== null) element("swatch-color").focus();
  });
  button.addEventListener("dragstart", (event) => event.dataTransfer.setData("text/x-swatch", String(k)));
  button.addEventListener("dragover", (event) => {
    if (event.dataTransfer.types.includes("text/x-swatch")) event.preventDefault();
  });
  button.addEventListener("drop", (event) => {
    const from = event.dataTransfer.getData("text/x-swatch");
    if (from === "") return;
    event.preventDefault();
    event.stopPropagation();
    merge(Number(from), k);
  });
  return button;
}

function merge(from, into) {
  if (from === into || !list[from] || !list[into]) return;
  const { members, color } = { ...list[from], color: list[into].color };
  chosen = null;
  hear.repaint([...members, ...list[into].members].map((member) => [member, color]));
}

// Moves all colours of the chosen group by as much as its swatch.
function recolour(color) {
  const group = list[chosen];
  if (!group) return;
  const [from, to] = [levels(group.color), levels(color)];
  const moved = (member) => hex(levels(member).map((level, k) => level + to[k] - from[k]));
  hear.repaint(group.members.map((member) => [member, moved(member)]));
}

function showEditor() {
  const group = list[chosen];
  element("swatch").hidden = !group;
  element("palette-hint").hidden = Boolean(group);
  if (!group) return;
  element("swatch-color").value = group.color;
  const others = list.map((other, k) => [other, k]).filter(([, k]) => k !== chosen);
  const options = others.map(([other, k]) => new Option(other.color, k));
  element("swatch-merge").replaceChildren(new Option("choose", ""), ...options);
  element("merge-label").hidden = others.length === 0;
  element("swatch-drop").textContent = isPaper(group) ? "Remove background" : "Remove";
}

element("swatch-color").addEventListener("change", ({ target }) => recolour(target.value));
element("swatch-merge").addEventListener("change", ({ target }) => target.value !== "" && merge(chosen, Number(target.value)));
element("swatch-drop").addEventListener("click", () => {
  const group = list[chosen];
  chosen = null;
  hear.drop(group.members, isPaper(group));
});
element("swatch-done").addEventListener("click", () => {
  const back = chosen;
  chosen = null;
  showSwatches(list, background);
  element("swatches").children[back]?.focus();
});
