// Strokes on canvases. A stroke is [points, radius, colour, opacity]; points are x, y, x, y, … in px of
// the picture, back to front as in the SVG.

// Longest side, px, at which drawing and target are compared: more takes time that a fit could use.
const MAX_COMPARED = 1024;

export function drawStrokes(context, strokes) {
  context.lineCap = context.lineJoin = "round";
  for (const [points, radius, color, opacity] of strokes) {
    context.globalAlpha = opacity;
    context.strokeStyle = color;
    context.lineWidth = 2 * radius;
    trace(context, points);
    context.stroke();
  }
  context.globalAlpha = 1;
}

function trace(context, points) {
  context.beginPath();
  context.moveTo(points[0], points[1]);
  // Canvases draw no line of length 0: a dot is a short one, as in the file.
  if (points.length === 2) context.lineTo(points[0] + 0.01, points[1]);
  for (let k = 2; k < points.length; k += 2) context.lineTo(points[k], points[k + 1]);
}

// A ring around a stroke that shows on any colour; what is inside stays as it is. `px` is a CSS px.
export function drawRing(context, [points, radius], px) {
  const layer = new OffscreenCanvas(context.canvas.width, context.canvas.height).getContext("2d");
  layer.setTransform(context.getTransform());
  layer.lineCap = layer.lineJoin = "round";
  for (const [color, width] of [["#000", 6], ["#ff0", 4], [null, 0]]) {
    layer.globalCompositeOperation = color ? "source-over" : "destination-out";
    layer.strokeStyle = color ?? "#000";
    layer.lineWidth = 2 * radius + width * px;
    trace(layer, points);
    layer.stroke();
  }
  context.save();
  context.resetTransform();
  context.drawImage(layer.canvas, 0, 0);
  context.restore();
}

// The topmost of numbered strokes at (x, y), or undefined.
export function strokeAt(numbered, x, y) {
  return numbered.findLast(({ stroke: [points, radius] }) => distance(points, x, y) <= radius);
}

function distance(points, x, y) {
  let least = Math.hypot(x - points[0], y - points[1]);
  for (let k = 2; k < points.length; k += 2) {
    const [ax, ay, bx, by] = points.slice(k - 2, k + 2);
    const [dx, dy] = [bx - ax, by - ay];
    const along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
    const h = Math.min(1, Math.max(0, along));
    least = Math.min(least, Math.hypot(x - ax - h * dx, y - ay - h * dy));
  }
  return least;
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
    this.context.drawImage(target, 0, 0, ...size);
    this.target = this.pixels().data;
    this.context.scale(size[0] / width, size[1] / height);
    this.page = [0, 0, width, height];
    // What is shown of the comparison.
    this.residual = new OffscreenCanvas(...size);
  }

  pixels() {
    return this.context.getImageData(0, 0, this.canvas.width, this.canvas.height);
  }

  // Starts with the bare background; transparent pages are compared on white.
  clear(background) {
    this.context.fillStyle = background ?? "#fff";
    this.context.fillRect(...this.page);
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
