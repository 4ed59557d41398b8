// The part of the picture that canvases show: wheel, pointers, fingers and keys move it.

const MOST = 100;
// Zoom of a key or a button.
const STEP = 1.5;

// A lens over canvases. `size` gives the size of the picture, or null; `large` the canvas that `zoom` is meant for; `redraw`
// draws what is seen anew; `point(x, y, event)` is told of clicks, and `hover` of the pointer's places, px of the picture.
// While `brush` gives a function, it gets the places of drags instead.
export class Lens {
  // CSS px of the large canvas per px of the picture, 0 where all is seen, and the place in its top left corner.
  view = { zoom: 0, x: 0, y: 0 };
  #fingers = new Map();
  #drag = null;

  constructor(canvases, { size, large, redraw, point, hover, brush = () => null }) {
    Object.assign(this, { size, large, redraw, point, hover, brush });
    for (const canvas of canvases) {
      canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
      canvas.addEventListener("pointerdown", (event) => this.#down(event));
      canvas.addEventListener("pointermove", (event) => this.#move(event));
      canvas.addEventListener("pointerup", (event) => this.#up(event));
      canvas.addEventListener("pointercancel", (event) => this.#lift(event));
      canvas.addEventListener("pointerleave", () => this.hover(null));
    }
    this.canvases = canvases;
  }

  // CSS px of a canvas per px of the picture. All canvases show the same part.
  zoomOf(canvas) {
    const whole = canvas.clientWidth / this.size().width;
    return this.view.zoom ? (this.view.zoom * canvas.clientWidth) / this.large().clientWidth : whole;
  }

  place({ target, offsetX, offsetY }) {
    const zoom = this.zoomOf(target);
    return [this.view.x + offsetX / zoom, this.view.y + offsetY / zoom];
  }

  whole() {
    this.view = { zoom: 0, x: 0, y: 0 };
    this.#settle();
  }

  // Zooms by a factor; what is at a place of a canvas stays there.
  zoomBy(factor, canvas = this.large(), left = canvas.clientWidth / 2, top = canvas.clientHeight / 2) {
    if (!this.size()) return;
    const own = this.zoomOf(canvas), share = this.large().clientWidth / canvas.clientWidth;
    const [x, y] = [this.view.x + left / own, this.view.y + top / own];
    const least = this.large().clientWidth / this.size().width;
    const zoom = Math.max(least, Math.min(MOST, own * share * factor));
    this.view = zoom > least ? { zoom, x: x - (left * share) / zoom, y: y - (top * share) / zoom } : { zoom: 0, x: 0, y: 0 };
    this.#settle();
  }

  // Shows a box of the picture, half as large as what is seen.
  zoomTo([left, top, right, bottom]) {
    const { clientWidth: width, clientHeight: height } = this.large();
    const zoom = Math.min(40, width / (right - left) / 2, height / (bottom - top) / 2);
    this.view = { zoom, x: (left + right) / 2 - width / zoom / 2, y: (top + bottom) / 2 - height / zoom / 2 };
    this.#settle();
  }

  // Moves by shares of what is seen.
  moveBy(x, y) {
    const zoom = this.zoomOf(this.large());
    const [width, height] = [this.large().clientWidth / zoom, this.large().clientHeight / zoom];
    this.view = { zoom, x: this.view.x + x * width, y: this.view.y + y * height };
    this.#settle();
  }

  // Answers a key; returns whether it is one of the lens's.
  key(key) {
    const moves = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    if (key === "+" || key === "=") this.zoomBy(STEP);
    else if (key === "-") this.zoomBy(1 / STEP);
    else if (key === "0") this.whole();
    else if (moves[key] && this.view.zoom) this.moveBy(...moves[key]);
    else return false;
    return true;
  }

  // A finger moves the page over a whole picture, and the part that is seen of an enlarged one.
  #settle() {
    for (const canvas of this.canvases) canvas.style.touchAction = this.view.zoom || this.brush() ? "none" : "pan-y";
    this.redraw();
  }

  #wheel(event) {
    if (!this.size()) return;
    event.preventDefault();
    this.zoomBy(1.0015 ** -event.deltaY, event.target, event.offsetX, event.offsetY);
  }

  #down(event) {
    if (!this.size()) return;
    this.#fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    this.#drag = { from: this.place(event), moved: this.#fingers.size > 1 };
    event.target.setPointerCapture(event.pointerId);
    this.brush()?.(...this.place(event), true);
  }

  #move(event) {
    if (!this.size()) return;
    if (!this.#drag) return this.hover(this.place(event));
    const before = this.#fingers.get(event.pointerId);
    this.#fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (this.#fingers.size === 2) return this.#pinch(event, before);
    const [x, y] = this.place(event);
    const brush = this.brush();
    if (brush) return brush(x, y, false);
    const [dx, dy] = [this.#drag.from[0] - x, this.#drag.from[1] - y];
    this.#drag.moved ||= Math.hypot(dx, dy) * this.zoomOf(event.target) > 3;
    if (!this.#drag.moved || (event.pointerType === "touch" && !this.view.zoom)) return;
    this.view = { zoom: this.zoomOf(this.large()), x: this.view.x + dx, y: this.view.y + dy };
    this.redraw();
  }

  #pinch({ pointerId, target }, before) {
    const here = this.#fingers.get(pointerId);
    const [other] = [...this.#fingers].filter(([id]) => id !== pointerId).map(([, place]) => place);
    const apart = ([x, y]) => Math.max(1, Math.hypot(x - other[0], y - other[1]));
    this.zoomBy(apart(here) / apart(before), target, ...other);
  }

  #up(event) {
    if (this.#drag && !this.#drag.moved && !this.brush()) this.point(...this.place(event));
    this.#lift(event);
  }

  #lift({ pointerId }) {
    this.#fingers.delete(pointerId);
    if (this.#fingers.size === 0) this.#drag = null;
  }
}
