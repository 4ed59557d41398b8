// Strokes on canvases. A stroke is [points, radius, colour, opacity, kinds]; points are x, y, x, y, … in px of
// the picture, back to front as in the SVG. Kinds has a letter for each point, "o" on the path and "c" for the control
// point of a curve, and then "z" if the path is closed.

// Longest side, px, at which drawing and target are compared: more takes time that a fit could use.
const MAX_COMPARED = 1024;

// The background and the shade, if there are any.
export function drawPage(context, { width, height, background, shade }) {
  const fills = [background, shade && gradient(context, shade)].filter(Boolean);
  for (const fill of fills) {
    context.fillStyle = fill;
    context.fillRect(0, 0, width, height);
  }
}

function gradient(context, { axis, stops }) {
  const [x, y, radius] = axis;
  const fill = axis.length === 4 ? context.createLinearGradient(...axis) : context.createRadialGradient(x, y, 0, x, y, radius);
  for (const [offset, color] of stops) fill.addColorStop(offset, color);
  return fill;
}

export function drawStrokes(context, strokes) {
  context.lineCap = context.lineJoin = "round";
  for (const stroke of strokes) {
    const [, radius, color, opacity] = stroke;
    context.globalAlpha = opacity;
    context.strokeStyle = color;
    context.lineWidth = 2 * radius;
    trace(context, stroke);
    context.stroke();
  }
  context.globalAlpha = 1;
}

function trace(context, stroke) {
  const { start, pieces, closed } = walk(stroke);
  context.beginPath();
  context.moveTo(...start);
  for (const piece of pieces) {
    const places = piece.flat();
    if (piece.length > 1) context.quadraticCurveTo(...places);
    else context.lineTo(...places);
  }
  // Canvases draw no line of length 0: a dot is a short one, as in the file.
  if (pieces.length === 0) context.lineTo(start[0] + 0.01, start[1]);
  if (closed) context.closePath();
}

// A path as its start and its pieces, each an end, or a control point and an end. Halfway between two control points
// lies an end that the file of the drawing implies.
export function walk([points, , , , kinds]) {
  const closed = kinds.endsWith("z"), middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const places = points.flatMap((x, k) => (k % 2 ? [] : [[x, points[k + 1]]]));
  const isOn = places.map((_, k) => kinds[k] === "o");
  const first = Math.max(0, isOn.indexOf(true));
  const start = isOn[first] ? places[first] : middle(places.at(-1), places[0]);
  const order = places.map((_, k) => (first + k) % places.length).slice(isOn[first] ? 1 : 0);
  const pieces = [];
  let control = null;
  for (const k of order) {
    if (control) pieces.push([control, isOn[k] ? places[k] : middle(control, places[k])]);
    else if (isOn[k]) pieces.push([places[k]]);
    control = isOn[k] ? null : places[k];
  }
  if (control) pieces.push([control, start]);
  else if (closed) pieces.push([start]);
  return { start, pieces, closed };
}

// A ring around a stroke that shows on any colour; what is inside stays as it is. `px` is a CSS px.
export function drawRing(context, stroke, px) {
  const layer = new OffscreenCanvas(context.canvas.width, context.canvas.height).getContext("2d");
  layer.setTransform(context.getTransform());
  layer.lineCap = layer.lineJoin = "round";
  for (const [color, width] of [["#000", 6], ["#ff0", 4], [null, 0]]) {
    layer.globalCompositeOperation = color ? "source-over" : "destination-out";
    layer.strokeStyle = color ?? "#000";
    layer.lineWidth = 2 * stroke[1] + width * px;
    trace(layer, stroke);
    layer.stroke();
  }
  context.save();
  context.resetTransform();
  context.drawImage(layer.canvas, 0, 0);
  context.restore();
}

// The points of a stroke that is more than a capsule: squares on the path, circles where control points are.
export function drawPoints(context, [points, , , , kinds], px) {
  const count = points.length / 2, closed = kinds.endsWith("z");
  if (count < 3 && !kinds.includes("c")) return;
  context.lineWidth = px;
  context.strokeStyle = "#06c";
  context.setLineDash([3 * px, 3 * px]);
  context.beginPath();
  for (let k = 0; k < count; k++) context.lineTo(points[2 * k], points[2 * k + 1]);
  if (closed) context.closePath();
  context.stroke();
  context.setLineDash([]);
  for (let k = 0; k < count; k++) {
    const [x, y, side] = [points[2 * k], points[2 * k + 1], 7 * px];
    context.beginPath();
    if (kinds[k] === "o") context.rect(x - side / 2, y - side / 2, side, side);
    else context.arc(x, y, side / 2, 0, 2 * Math.PI);
    context.fillStyle = kinds[k] === "o" ? "#fff" : "#9cf";
    context.fill();
    context.stroke();
  }
}

// The topmost of numbered strokes at (x, y), or undefined.
export function strokeAt(numbered, x, y) {
  return numbered.findLast(({ stroke }) => distance(stroke, x, y) <= stroke[1]);
}

// Chords of a curve, as far as a pointer can tell.
const CHORDS = 16;

function distance(stroke, x, y) {
  const { start, pieces } = walk(stroke);
  let [from, least] = [start, Math.hypot(x - start[0], y - start[1])];
  for (const piece of pieces) {
    for (const to of chords(from, piece)) {
      least = Math.min(least, gap(from, to, x, y));
      from = to;
    }
  }
  return least;
}

function chords([ax, ay], piece) {
  if (piece.length === 1) return piece;
  const [[cx, cy], [bx, by]] = piece;
  return Array.from({ length: CHORDS }, (_, i) => {
    const t = (i + 1) / CHORDS, u = 1 - t;
    return [ax * u * u + 2 * cx * u * t + bx * t * t, ay * u * u + 2 * cy * u * t + by * t * t];
  });
}

// From (x, y) to the segment from a to b.
function gap([ax, ay], [bx, by], x, y) {
  const [dx, dy] = [bx - ax, by - ay];
  const along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
  const h = Math.min(1, Math.max(0, along));
  return Math.hypot(x - ax - h * dx, y - ay - h * dy);
}

// Left, top, right, bottom of a stroke.
export function bounds([points, radius]) {
  const xs = points.filter((_, k) => k % 2 === 0), ys = points.filter((_, k) => k % 2 === 1);
  return [Math.min(...xs) - radius, Math.min(...ys) - radius, Math.max(...xs) + radius, Math.max(...ys) + radius];
}

// Compares drawings with the target at the picture's size, or less for a large one.
export class Comparison {
  constructor(target, width, height) {
    const scale = Math.min(1, MAX_COMPARED / Math.max(width, height));
    const size = [width, height].map((side) => Math.max(1, Math.round(side * scale)));
    this.canvas = new OffscreenCanvas(...size);
    this.context = this.canvas.getContext("2d", { willReadFrequently: true });
    // Transparent pages are compared on white, and so is what they should look like.
    this.context.fillStyle = "#fff";
    this.context.fillRect(0, 0, ...size);
    this.context.drawImage(target, 0, 0, ...size);
    this.target = this.pixels().data;
    this.context.scale(size[0] / width, size[1] / height);
    this.page = [0, 0, width, height];
    // Pixels of the comparison that are shown.
    this.residual = new OffscreenCanvas(...size);
  }

  pixels() {
    return this.context.getImageData(0, 0, this.canvas.width, this.canvas.height);
  }

  // Starts with the page's background.
  clear(scene) {
    this.context.fillStyle = "#fff";
    this.context.fillRect(...this.page);
    drawPage(this.context, scene);
  }

  add(strokes) {
    drawStrokes(this.context, strokes);
  }

  // PSNR of what is drawn, dB.
  psnr() {
    const drawn = this.pixels().data;
    let sum = 0;
    for (let i = 0; i < drawn.length; i++) {
      const difference = this.target[i] - drawn[i];
      sum += difference * difference;
    }
    // Alpha is 255 on both sides and adds nothing.
    return -10 * Math.log10(sum / (drawn.length * 0.75 * 255 * 255));
  }

  // Puts target − drawn, twice, on grey into this.residual.
  subtract() {
    const picture = this.pixels();
    const data = picture.data;
    for (let i = 0; i < data.length; i += 4) {
      for (let c = i; c < i + 3; c++) data[c] = 128 + 2 * (this.target[c] - data[c]);
    }
    this.residual.getContext("2d").putImageData(picture, 0, 0);
  }
}
