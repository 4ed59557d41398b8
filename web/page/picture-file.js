// Files as pictures: what to show of them, and what to fit.

// Most pixels that are read: a browser holds four bytes of each.
const MOST = 150e6;

// Reads a file, and makes it smaller if a side is longer than `longest` px. Returns what canvases can draw, and
// { png } or { pixels, width, height } for the fit, and the size of a picture that was reduced.
export async function read(file, longest) {
  const image = await decode(file);
  if (image.width * image.height > MOST) throw new Error(`${file.name || "the picture"} has ${image.width}×${image.height} px, more than this page takes: make it smaller first`);
  const scale = Math.min(1, longest / Math.max(image.width, image.height));
  const data = await file.arrayBuffer();
  if (scale === 1 && isPlainPng(data)) return { image, picture: { png: data } };
  const [width, height] = [image.width, image.height].map((side) => Math.max(1, Math.round(side * scale)));
  const smaller = scale === 1 ? image : await createImageBitmap(image, { resizeWidth: width, resizeHeight: height, resizeQuality: "high" });
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  context.drawImage(smaller, 0, 0);
  const pixels = context.getImageData(0, 0, width, height).data;
  return { image: context.canvas, picture: { pixels, width, height }, reduced: scale < 1 && [image.width, image.height] };
}

async function decode(file) {
  try {
    return await createImageBitmap(file);
  } catch {
    throw new Error(reason(file));
  }
}

function reason({ name, type, size }) {
  const it = name || "this";
  if (size === 0) return `${it} is empty`;
  if (type === "image/svg+xml" || /\.svgz?$/i.test(name)) return `${it} is a drawing already: give the picture that it should be like`;
  if (/\.(heic|heif)$/i.test(name)) return `this browser cannot read ${it}: phones save such pictures; share it as a JPEG`;
  if (type && !type.startsWith("image/")) return `${it} is no picture (${type}): try a PNG, a JPEG or a WebP`;
  return `this browser cannot read ${it} as a picture, it may be damaged: try a PNG, a JPEG or a WebP`;
}

// Whether a file is a PNG that says nothing of its colours, or that they are sRGB. The fit then reads it itself, as the
// program does: canvases multiply colours by alpha and round, which is not undone to the bit. Other colours are left to
// the browser.
function isPlainPng(data) {
  const head = new Uint8Array(data, 0, Math.min(data.byteLength, 4096));
  const text = String.fromCharCode(...head);
  const end = text.indexOf("IDAT");
  const chunks = text.slice(0, end < 0 ? undefined : end);
  const says = (...names) => names.some((name) => chunks.includes(name));
  const isSrgb = !says("cICP", "iCCP") && (says("sRGB") || !says("gAMA", "cHRM"));
  return text.startsWith("\x89PNG\r\n\x1a\n") && isSrgb && !says("CgBI");
}
