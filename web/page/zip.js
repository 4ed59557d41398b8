// Zip files, without compression: SVGs in it can be read as they are.

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n;
});

export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

const UTF8_NAMES = 0x800;
// 1 January 1980: a zip says nothing of when it was made, and equal drawings make equal ones.
const DATE = 0x21;

// The bytes of a zip of { name, text }.
export function zip(files) {
  const encoder = new TextEncoder(), parts = [], directory = [];
  let offset = 0;
  for (const { name, text } of files) {
    const [path, bytes] = [encoder.encode(name), encoder.encode(text)];
    const common = [[20, 2], [UTF8_NAMES, 2], [0, 2], [0, 2], [DATE, 2], [crc32(bytes), 4], [bytes.length, 4], [bytes.length, 4], [path.length, 2], [0, 2]];
    const local = [numbers([[0x04034b50, 4], ...common]), path, bytes];
    directory.push(numbers([[0x02014b50, 4], [20, 2], ...common, [0, 2], [0, 2], [0, 2], [0, 4], [offset, 4]]), path);
    parts.push(...local);
    offset += length(local);
  }
  const end = numbers([[0x06054b50, 4], [0, 2], [0, 2], [files.length, 2], [files.length, 2], [length(directory), 4], [offset, 4], [0, 2]]);
  return joined([...parts, ...directory, end]);
}

// Names that differ, so that none is lost.
export function distinct(names) {
  const taken = new Set();
  return names.map((name) => {
    let free = name;
    for (let k = 2; taken.has(free); k++) free = name.replace(/(\.[^.]*)?$/, `-${k}$1`);
    taken.add(free);
    return free;
  });
}

function numbers(list) {
  return Uint8Array.from(list.flatMap(([value, size]) => Array.from({ length: size }, (_, k) => Math.floor(value / 256 ** k) % 256)));
}

const length = (parts) => parts.reduce((sum, { length }) => sum + length, 0);

function joined(parts) {
  const whole = new Uint8Array(length(parts));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}
