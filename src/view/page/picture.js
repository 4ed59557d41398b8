// Marks on canvases: strokes, and areas, which are filled by the nonzero rule. A mark is [points, radius, colour, opacity,
// kinds], back to front as in the SVG; points are x, y, x, y, … in px of the picture, and the radius of an area is 0. Kinds
// has a letter for each point, "o" on the path, "c" for the control point of a quadratic curve, "b" for one of a cubic curve
// and "a" for a point of an arc between its ends, and then "z" if the path is closed, and so after the points of each ring of
// an area. An area with a gradient has that as a sixth, and one that is the outline of a line whose width varies has that line.

// Longest side, px, at which drawing and target are compared: more takes time that a fit could use.
const MAX_COMPARED = 1024;

// The background, its gradient, and shadows with the things that they fall on, which have no blur, if there are any.
export function drawPage(context, { width, height, background, shade, shadows = [] }) {
  const fills = [background, shade && gradient(context, shade)].filter(Boolean);
  for (const fill of fills) {
    context.fillStyle = fill;
    context.fillRect(0, 0, width, height);
  }
  for (const [mark, blur] of shadows) {
    if (blur) drawShadow(context, [mark, blur]);
    else drawMarks(context, [mark]);
  }
}

// A blur of an area. Filters of canvases are not in all browsers, but shadows are: the area itself is drawn beyond the canvas.
function drawShadow(context, [mark, blur]) {
  const { a: scale } = context.getTransform(), beyond = 4 * context.canvas.width;
  const [, , color, opacity] = mark;
  context.save();
  Object.assign(context, { shadowColor: color, shadowBlur: 2 * blur * scale, shadowOffsetX: beyond, globalAlpha: opacity, fillStyle: color });
  context.translate(-beyond / scale, 0);
  trace(context, mark);
  context.fill();
  context.restore();
}

function gradient(context, { axis, stops }) {
  const [x, y, radius] = axis;
  const fill = axis.length === 4 ? context.createLinearGradient(...axis) : context.createRadialGradient(x, y, 0, x, y, radius);
  for (const [offset, color] of stops) fill.addColorStop(offset, color);
  return fill;
}

export function drawMarks(context, marks) {
  context.lineCap = context.lineJoin = "round";
  for (const mark of marks) {
    const [, radius, color, opacity] = mark, shade = shadeOf(mark);
    context.globalAlpha = opacity;
    context.strokeStyle = context.fillStyle = shade ? gradient(context, shade) : color;
    context.lineWidth = 2 * radius;
    trace(context, mark);
    if (isArea(mark)) context.fill();
    else context.stroke();
  }
  context.globalAlpha = 1;
}

export const isArea = ([, radius]) => radius === 0;
export const shadeOf = ([, , , , , more]) => (more?.axis ? more : undefined);
// { points, kinds, widths } with a width for each point, px.
export const lineOf = ([, , , , , more]) => (more?.widths ? more : undefined);

// The numbers of areas and strokes among marks, in words.
export function counted(marks) {
  const areas = marks.filter((mark) => isArea(mark) && !lineOf(mark)).length, strokes = marks.length - areas;
  const count = (number, name) => `${number} ${name}${number === 1 ? "" : "s"}`;
  const words = [areas && count(areas, "area"), (strokes || !areas) && count(strokes, "stroke")];
  return words.filter(Boolean).join(", ");
}

function trace(context, mark) {
  context.beginPath();
  for (const { start, pieces, closed } of walks(mark)) {
    context.moveTo(...start);
    for (const piece of pieces) {
      const places = piece.flat();
      if (piece.length > 2) context.bezierCurveTo(...places);
      else if (piece.length > 1) context.quadraticCurveTo(...places);
      else context.lineTo(...places);
    }
    // Canvases draw no line of length 0: a dot is a short one, as in the file.
    if (pieces.length === 0) context.lineTo(start[0] + 0.01, start[1]);
    if (closed) context.closePath();
  }
}

// The paths of a mark, each as its places and their kinds.
export function paths([points, , , , kinds]) {
  let first = 0;
  return kinds.match(/[ocba]+z?/g).map((own) => {
    const count = own.replace("z", "").length;
    const places = Array.from({ length: count }, (_, k) => [points[2 * (first + k)], points[2 * (first + k) + 1]]);
    first += count;
    return { places, kinds: own };
  });
}

// The paths of a mark, each as its start and its pieces: an end, behind one control point or two of a curve.
export const walks = (mark) => paths(mark).map(walk);

// Halfway between two control points of quadratic curves lies an end that the file of the drawing implies.
function walk({ places, kinds }) {
  const closed = kinds.endsWith("z"), middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const isOn = places.map((_, k) => kinds[k] === "o");
  const first = Math.max(0, isOn.indexOf(true));
  const start = isOn[first] ? places[first] : middle(places.at(-1), places[0]);
  const order = places.map((_, k) => (first + k) % places.length).slice(isOn[first] ? 1 : 0);
  const pieces = [];
  let from = start, between = [], isArc = false;
  const goTo = (to) => {
    pieces.push(...(isArc ? arc(from, between[0], to) : [[...between, to]]));
    [from, between, isArc] = [to, [], false];
  };
  for (const k of order) {
    if (isOn[k]) goTo(places[k]);
    else {
      if (kinds[k] === "c" && between.length > 0) goTo(middle(between[0], places[k]));
      between.push(places[k]);
      isArc = kinds[k] === "a";
    }
  }
  if (between.length > 0 || closed) goTo(start);
  return { start, pieces, closed };
}

// Cubic curves in the place of the arc through three points, as scene/arc.rs has them; a line if they are in one.
function arc(a, m, b) {
  const [ux, uy, vx, vy] = [m[0] - a[0], m[1] - a[1], b[0] - m[0], b[1] - m[1]];
  const bulge = (ux * vy - uy * vx) / (Math.hypot(ux, uy) * Math.hypot(vx, vy) + ux * vx + uy * vy);
  return bulge && Number.isFinite(bulge) ? bent(a, b, bulge) : [[b]];
}

// A bulge is the tangent of a quarter of an arc's sweep. Arcs of more than 45° are halved.
function bent(a, b, bulge) {
  const [x, y] = [b[0] - a[0], b[1] - a[1]];
  if (Math.abs(bulge) > 0.2) {
    const halfway = [(a[0] + b[0] + bulge * y) / 2, (a[1] + b[1] - bulge * x) / 2], half = bulge / (1 + Math.hypot(1, bulge));
    return [...bent(a, halfway, half), ...bent(halfway, b, half)];
  }
  const along = (1 - bulge ** 2) / 3, beside = (2 * bulge) / 3;
  const handle = (p, sign) => [p[0] + sign * along * x + beside * y, p[1] + sign * along * y - beside * x];
  return [[handle(a, 1), handle(b, -1), b]];
}

// A ring around a mark that shows on any colour; what is inside stays as it is. `px` is a CSS px.
export function drawRing(context, mark, px) {
  const layer = new OffscreenCanvas(context.canvas.width, context.canvas.height).getContext("2d");
  layer.setTransform(context.getTransform());
  layer.lineCap = layer.lineJoin = "round";
  trace(layer, mark);
  for (const [color, width] of [["#000", 6], ["#ff0", 4]]) {
    layer.strokeStyle = color;
    layer.lineWidth = 2 * mark[1] + width * px;
    layer.stroke();
  }
  layer.globalCompositeOperation = "destination-out";
  layer.lineWidth = 2 * mark[1];
  if (isArea(mark)) layer.fill();
  else layer.stroke();
  context.save();
  context.resetTransform();
  context.drawImage(layer.canvas, 0, 0);
  context.restore();
}

// The points of a mark that is more than a capsule: squares on its paths, circles where control points are.
export function drawPoints(context, mark, px) {
  for (const path of paths(mark)) drawPathPoints(context, path, px);
}

function drawPathPoints(context, { places, kinds }, px) {
  if (places.length < 3 && !/[cba]/.test(kinds)) return;
  context.lineWidth = px;
  context.strokeStyle = "#06c";
  context.setLineDash([3 * px, 3 * px]);
  context.beginPath();
  for (const place of places) context.lineTo(...place);
  if (kinds.endsWith("z")) context.closePath();
  context.stroke();
  context.setLineDash([]);
  places.forEach(([x, y], k) => {
    const side = 7 * px;
    context.beginPath();
    if (kinds[k] === "o") context.rect(x - side / 2, y - side / 2, side, side);
    else context.arc(x, y, side / 2, 0, 2 * Math.PI);
    context.fillStyle = kinds[k] === "o" ? "#fff" : "#9cf";
    context.fill();
    context.stroke();
  });
}

// The topmost of numbered marks at (x, y), or undefined.
export function markAt(numbered, x, y) {
  return numbered.findLast(({ mark }) => covers(mark, x, y));
}

// True if a mark is there: a stroke within its radius, an area where its rings wind around the place.
export function covers(mark, x, y) {
  const lines = walks(mark).map(polyline);
  if (isArea(mark)) return lines.reduce((sum, line) => sum + winding(line, x, y), 0) !== 0;
  const [line] = lines;
  const gaps = line.slice(1).map((to, k) => gap(line[k], to, x, y));
  return Math.min(Math.hypot(x - line[0][0], y - line[0][1]), ...gaps) <= mark[1];
}

// How often a closed polyline goes around (x, y).
function winding(line, x, y) {
  return line.slice(1).reduce((sum, [bx, by], k) => {
    const [ax, ay] = line[k];
    const side = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
    if (ay <= y && by > y && side > 0) return sum + 1;
    return ay > y && by <= y && side < 0 ? sum - 1 : sum;
  }, 0);
}

// Chords of a curve, as far as a pointer can tell.
const CHORDS = 16;

function polyline({ start, pieces }) {
  const line = [start];
  for (const piece of pieces) line.push(...chords(line.at(-1), piece));
  return line;
}

function chords(start, piece) {
  if (piece.length === 1) return piece;
  return Array.from({ length: CHORDS }, (_, i) => {
    const t = (i + 1) / CHORDS, u = 1 - t;
    const weights = piece.length === 2 ? [u * u, 2 * u * t, t * t] : [u ** 3, 3 * u * u * t, 3 * u * t * t, t ** 3];
    return [0, 1].map((axis) => [start, ...piece].reduce((sum, place, k) => sum + weights[k] * place[axis], 0));
  });
}

// From (x, y) to the segment from a to b.
function gap([ax, ay], [bx, by], x, y) {
  const [dx, dy] = [bx - ax, by - ay];
  const along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
  const h = Math.min(1, Math.max(0, along));
  return Math.hypot(x - ax - h * dx, y - ay - h * dy);
}

// Left, top, right, bottom of a mark.
export function bounds(mark) {
  const places = walks(mark).flatMap(({ start, pieces }) => [start, ...pieces.flat()]);
  const [xs, ys] = [0, 1].map((axis) => places.map((place) => place[axis]));
  const extreme = (along, of) => along.reduce((a, b) => of(a, b)), radius = mark[1];
  return [...[xs, ys].map((along) => extreme(along, Math.min) - radius), ...[xs, ys].map((along) => extreme(along, Math.max) + radius)];
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

  add(marks) {
    drawMarks(this.context, marks);
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
