// From which quality on each mark of a drawing pays, so that a slider shows fewer marks at once, without a fit.
//
// A mark is worth what the squared error grows by without it: Σ 2eδ + δ² over its pixels, where e is the error of the drawing, and
// δ = −T·m·(c − B), by its colour c and coverage m, the share T of what lies above it that is seen through, and the colour B
// behind it. At quality Q a byte has to buy the squared error that one pixel has at Q dB. The marks that do not pay leave, from
// the quality that was fitted down to the least, and each changes what the others are worth.

// Longest side, px, at which worths are counted.
export const SIDE = 128;
const LEAST = 5;
const pixelError = (quality) => 3 * 255 * 255 * 10 ** (-quality / 10);

// The quality below which each mark is left out, back to front; 0 for those that stay at the least. `masks` are boxes
// { left, top, width, height, alpha } of coverage, 0 to 255 with the opacity in it; colours are [r, g, b]; `target` has three values for
// each pixel of a picture `width` px wide; one of them stands for `share` pixels of the real one.
export function levelsOf({ masks, colors, background, target, width, bytes, share }, quality) {
  const level = new Float32Array(masks.length);
  let left = masks.map((_, k) => ({ k, mask: masks[k], color: colors[k], bytes: bytes[k] }));
  for (let q = quality; q >= LEAST && left.length; q -= 1) {
    const stays = paying(left, pixelError(q) / share, { background, target, width });
    left.forEach(({ k }, i) => {
      if (!stays[i]) level[k] = q + 0.5;
    });
    left = left.filter((_, i) => stays[i]);
  }
  return level;
}

// True for each mark that is worth its bytes at a price. The marks are asked from the front: one that goes uncovers those
// behind it, so that of two that hide each other's worth one stays.
function paying(list, price, { background, target, width }) {
  const canvas = new Float32Array(target.length);
  for (let i = 0; i < canvas.length; i++) canvas[i] = background[i % 3];
  const behind = list.map(({ mask, color }) => lay(canvas, mask, color, width));
  const picture = { canvas, target, width, through: new Float32Array(target.length / 3).fill(1) };
  const stays = new Array(list.length);
  for (let i = list.length - 1; i >= 0; i--) {
    const { mask, color, bytes } = list[i];
    stays[i] = gain(mask, color, behind[i], picture) >= price * bytes;
    if (stays[i]) cover(mask, picture);
    else uncover(mask, color, behind[i], picture);
  }
  return stays;
}

// Calls `visit(m, pixel, at)` for each pixel of a mask: coverage, its number in the picture and in the mask.
function each({ left, top, width, height, alpha }, across, visit) {
  for (let y = 0, at = 0; y < height; y++) {
    for (let x = 0; x < width; x++, at++) {
      if (alpha[at]) visit(alpha[at] / 255, (top + y) * across + left + x, at);
    }
  }
}

// Lays a mark on a canvas; returns what was there.
function lay(canvas, mask, color, across) {
  const behind = new Float32Array(3 * mask.alpha.length);
  each(mask, across, (m, pixel, at) => {
    for (let c = 0; c < 3; c++) {
      const below = canvas[3 * pixel + c];
      behind[3 * at + c] = below;
      canvas[3 * pixel + c] = below + m * (color[c] - below);
    }
  });
  return behind;
}

function gain(mask, color, behind, { canvas, target, through, width }) {
  let sum = 0;
  each(mask, width, (m, pixel, at) => {
    for (let c = 0; c < 3; c++) {
      const change = -through[pixel] * m * (color[c] - behind[3 * at + c]);
      sum += change * (2 * (canvas[3 * pixel + c] - target[3 * pixel + c]) + change);
    }
  });
  return sum;
}

function cover(mask, { through, width }) {
  each(mask, width, (m, pixel) => (through[pixel] *= 1 - m));
}

function uncover(mask, color, behind, { canvas, through, width }) {
  each(mask, width, (m, pixel, at) => {
    for (let c = 0; c < 3; c++) canvas[3 * pixel + c] -= through[pixel] * m * (color[c] - behind[3 * at + c]);
  });
}
