// Files as pictures: what to show of them, and what to fit.

// Reads a file, and makes it smaller if a side is longer than `longest` px. Returns what canvases can draw, and
// { png } or { pixels, width, height } for the fit.
export async function read(file, longest) {
  const image = await decode(file);
  const scale = Math.min(1, longest / Math.max(image.width, image.height));
  const data = await file.arrayBuffer();
  if (scale === 1 && isPlainPng(data)) return { image, picture: { png: data } };
  const [width, height] = [image.width, image.height].map((side) => Math.max(1, Math.round(side * scale)));
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  context.imageSmoothingQuality = "high";
  context.drawImage(image, 0, 0, width, height);
  const pixels = context.getImageData(0, 0, width, height).data;
  return { image: context.canvas, picture: { pixels, width, height } };
}

async function decode(file) {
  try {
    return await createImageBitmap(file);
  } catch {
    throw new Error(`this browser cannot read ${file.name || "this"} as a picture: try a PNG, a JPEG or a WebP`);
  }
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
