// The program that the WebAssembly is compared with, and what tests that cannot run say.

import { execFileSync } from "node:child_process";
import { appendFileSync, existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

export const root = fileURLToPath(new URL("../../../", import.meta.url));

// `STROKEFIT` names it; else it is where `cargo build --release` puts it.
export const strokefit = resolve(process.env.STROKEFIT ?? join(root, "target/release/strokefit"));
if (!existsSync(strokefit)) throw new Error(`${strokefit} is missing: run cargo build --release`);

export const sample = (name) => readFileSync(join(root, "samples", name));

// What the program draws of a picture under these flags.
export function native(picture, flags) {
  return inFolder((folder) => {
    const out = join(folder, "out.svg");
    execFileSync(strokefit, ["fit", picture, "-q", "-o", out, ...flags], { cwd: folder });
    return readFileSync(out, "utf8");
  });
}

export function inFolder(run) {
  const folder = mkdtempSync(join(tmpdir(), "strokefit-"));
  try {
    return run(folder);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

// Takes note of a test that is skipped, as tests/all/support/skip.rs does; `.ci/run` lists and counts the notes.
export function skipped(what, reason) {
  const line = `SKIPPED ${what}: ${reason}\n`;
  process.stderr.write(line);
  if (process.env.STROKEFIT_SKIPPED) appendFileSync(process.env.STROKEFIT_SKIPPED, line);
}
