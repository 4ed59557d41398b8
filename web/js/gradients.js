// The renderer for losses of one's own: checks what it is given, and packs it for the WebAssembly.

// The lowest two bits are the kind of a point: on its path, of a quadratic curve, of a cubic one, of an arc.
const ON = 0, QUAD = 1, CUBIC = 2, ARC = 3, ENDS_RING = 4, ENDS_MARK = 8, CLOSED = 16;
// Numbers of a mark besides its points: radius, red, green, blue, opacity.
const STYLE = 5;

// A `Renderer` of strokefit.d.ts, over one of the WebAssembly. `guarded` calls it.
export class Renderer {
  #native;
  #guarded;
  #marks;

  constructor(native, width, height, guarded) {
    this.#native = native;
    this.#guarded = guarded;
    Object.assign(this, { width, height });
  }

  render(marks, background = [1, 1, 1]) {
    const { numbers, kinds } = packed(marks);
    expectNumbers("background", background, 3);
    const canvas = this.#guarded(() => this.#native.render(numbers, kinds, ...background));
    this.#marks = { starts: Array.from(marks.starts), filled: Array.from(marks.filled ?? []) };
    return canvas;
  }

  backward(dCanvas) {
    if (!this.#marks) throw new Error("there is no picture yet: call render first");
    expectNumbers("dCanvas", dCanvas, 3 * this.width * this.height);
    return unpacked(this.#guarded(() => this.#native.backward(Float32Array.from(dCanvas))), this.#marks);
  }

  free() {
    this.#native.free();
  }
}

export function checkedSize(width, height, softness) {
  for (const [name, side] of Object.entries({ width, height })) {
    if (!(Number.isInteger(side) && side >= 1)) throw new RangeError(`${name} is ${side}: give whole px from 1`);
  }
  if (!(softness > 0 && softness < Infinity)) throw new RangeError(`softness is ${softness}: give px above 0`);
}

function packed({ points, starts, widths, colors, opacities, onPath, kinds: given, closed, filled, rings = [] }) {
  const count = widths?.length;
  expectNumbers("starts", starts, count + 1);
  expectNumbers("points", points, 2 * starts.at(-1));
  expectNumbers("widths", widths, count);
  expectNumbers("colors", colors, 3 * count);
  expectNumbers("opacities", opacities, count);
  const numbers = new Float32Array(points.length + STYLE * count);
  const kinds = new Uint8Array(points.length / 2);
  if (given) expectNumbers("kinds", given, kinds.length);
  const kindOf = (k) => given?.[k] ?? (onPath !== undefined && !onPath[k] ? QUAD : ON);
  const further = new Set(rings);
  let inside = 0;
  for (let i = 0, at = 0; i < count; i++) {
    const [start, end] = [starts[i], starts[i + 1]];
    if (!(Number.isInteger(start) && start < end && (i > 0 || start === 0))) {
      throw new RangeError(`starts[${i}] is ${start} and starts[${i + 1}] is ${end}: give whole numbers that rise from 0`);
    }
    if (!(opacities[i] >= 0 && opacities[i] <= 1)) throw new RangeError(`opacities[${i}] is ${opacities[i]}: give 0 to 1`);
    const isClosed = Boolean(filled?.[i] || closed?.[i]);
    if ((!isClosed || end - start === 1) && (kindOf(start) !== ON || kindOf(end - 1) !== ON)) {
      throw new RangeError(`mark ${i} is open and starts or ends off its path: close it, or add an end`);
    }
    let first = start;
    for (let k = start; k < end; k++) {
      if (filled?.[i] && k > start && further.has(k)) inside += 1;
      const isLast = k + 1 === end || (filled?.[i] && further.has(k + 1));
      kinds[k] = kindOf(k) | (filled?.[i] && isLast && ENDS_RING);
      if (!isLast) continue;
      checkPath(Array.from({ length: k + 1 - first }, (_, j) => kindOf(first + j)), i);
      first = k + 1;
    }
    kinds[end - 1] |= ENDS_MARK | (isClosed && CLOSED);
    numbers.set(points.slice(2 * start, 2 * end), at);
    at += 2 * (end - start);
    numbers.set([filled?.[i] ? 0 : widths[i] / 2, ...colors.slice(3 * i, 3 * i + 3), opacities[i]], at);
    at += STYLE;
  }
  if (inside !== rings.length) {
    throw new RangeError("rings: give the points, after the first of an area, at which another of its rings begins");
  }
  return { numbers, kinds };
}

// Refuses points of a path that no pieces are between: the Rust renders what passes here.
function checkPath(own, i) {
  if (own.some((kind) => ![ON, QUAD, CUBIC, ARC].includes(kind))) {
    throw new RangeError(`mark ${i} has kinds ${own}: give 0 on the path, 1 for quadratic and 2 for cubic curves, 3 for arcs`);
  }
  if (own.every((kind) => kind === ON || kind === QUAD)) return;
  const first = own.indexOf(ON);
  // A closed path goes on from its last point to its first.
  const around = [...own.slice(first), ...own.slice(0, first)].join("");
  if (first < 0 || !around.split(`${ON}`).every((run) => /^(1*|22|3)$/.test(run))) {
    throw new RangeError(`mark ${i} has kinds ${own}: between points on a path are any number of 1, two 2 or one 3`);
  }
}

// The derivatives in the order of the numbers, by kind. That by a width is half of that by its radius.
function unpacked(by, { starts, filled }) {
  const count = starts.length - 1;
  const points = new Float32Array(2 * starts[count]);
  const [widths, colors, opacities] = [1, 3, 1].map((each) => new Float32Array(each * count));
  let at = 0;
  for (let i = 0; i < count; i++) {
    const length = 2 * (starts[i + 1] - starts[i]);
    points.set(by.subarray(at, at + length), 2 * starts[i]);
    at += length;
    widths[i] = filled[i] ? 0 : by[at] / 2;
    colors.set(by.subarray(at + 1, at + 4), 3 * i);
    opacities[i] = by[at + 4];
    at += STYLE;
  }
  return { points, widths, colors, opacities, background: by.slice(at) };
}

function expectNumbers(name, values, count) {
  if (values?.length !== count) throw new RangeError(`${name} has ${values?.length} numbers: give ${count}`);
  const wrong = values.findIndex((value) => !Number.isFinite(value));
  if (wrong >= 0) throw new RangeError(`${name}[${wrong}] is ${values[wrong]}: give finite numbers`);
}
