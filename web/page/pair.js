// Examples: a picture over its drawing, up to a line that a slider moves.

export function listenToPairs(choose) {
  for (const pair of document.querySelectorAll(".pair")) {
    const slider = pair.querySelector("input"), frame = pair.querySelector(".frame");
    slider.addEventListener("input", () => frame.style.setProperty("--at", `${slider.value}%`));
    pair.querySelector("button").addEventListener("click", () => choose(pair.dataset.picture));
  }
}
