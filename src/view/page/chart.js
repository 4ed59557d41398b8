// A line chart: points [x, y], axes with a few round numbers.

const MARGIN = { left: 36, right: 8, top: 8, bottom: 20 };

export function drawChart(canvas, points, marks = []) {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  points = points.filter(([, y]) => Number.isFinite(y));
  if (points.length === 0) return;
  const [left, right] = extent(points.map(([x]) => x));
  const [low, high] = extent(points.map(([, y]) => y));
  const atX = (x) => MARGIN.left + ((x - left) / (right - left)) * (width - MARGIN.left - MARGIN.right);
  const atY = (y) => height - MARGIN.bottom - ((y - low) / (high - low)) * (height - MARGIN.top - MARGIN.bottom);
  context.fillStyle = getComputedStyle(canvas).color;
  drawAxes(context, { width, height, left, right, low, high, atX, atY });
  context.strokeStyle = getComputedStyle(canvas).color;
  context.lineWidth = 1.5;
  context.beginPath();
  for (const [x, y] of points) context.lineTo(atX(x), atY(y));
  context.stroke();
  context.fillStyle = "#c30";
  for (const [x, y] of marks) {
    context.beginPath();
    context.arc(atX(x), atY(y), 3.5, 0, 7);
    context.fill();
  }
}

function drawAxes(context, { width, height, left, right, low, high, atX, atY }) {
  context.font = "11px system-ui, sans-serif";
  context.strokeStyle = "#8884";
  context.beginPath();
  context.textAlign = "right";
  for (const y of ticks(low, high, 4)) {
    context.moveTo(MARGIN.left, atY(y));
    context.lineTo(width - MARGIN.right, atY(y));
    context.fillText(y, MARGIN.left - 4, atY(y) + 4);
  }
  context.textAlign = "center";
  for (const x of ticks(left, right, 5)) {
    context.moveTo(atX(x), MARGIN.top);
    context.lineTo(atX(x), height - MARGIN.bottom);
    context.fillText(x, Math.min(atX(x), width - 16), height - 6);
  }
  context.stroke();
}

// Least and largest, never equal.
function extent(values) {
  const least = values.reduce((a, b) => Math.min(a, b)), most = values.reduce((a, b) => Math.max(a, b));
  return most > least ? [least, most] : [least - 1, most + 1];
}

// Round numbers between two values, about `count` of them.
function ticks(from, to, count) {
  const rough = (to - from) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((step) => step >= rough);
  const values = [];
  for (let k = Math.ceil(from / step); k * step <= to; k++) values.push(Number((k * step).toPrecision(6)));
  return values;
}
