// Numbers as people say them.

const FIDELITY = [[42, "nearly the same"], [36, "very faithful"], [31, "faithful"], [27, "fair"], [23, "rough"], [-Infinity, "a sketch"]];

// A word for dB of PSNR; null is a drawing without any error.
export const fidelity = (db) => (db === null ? "the same" : Number.isFinite(db) ? FIDELITY.find(([least]) => db >= least)[1] : "");

export function size(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  return bytes < 9950 ? `${(bytes / 1000).toFixed(1)} kB` : `${Math.round(bytes / 1000).toLocaleString("en")} kB`;
}

export const count = (number, name) => `${number.toLocaleString("en")} ${name}${number === 1 ? "" : "s"}`;
