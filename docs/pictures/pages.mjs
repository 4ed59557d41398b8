// Takes the pictures of the page (web.png) and of the live page of the program (view.png), in Chromium, in 256 colours:
//
//     node docs/pictures/pages.mjs
//
// after `cargo build --release` (or with STROKEFIT=PROGRAM) and `web/build.sh`. Python needs Pillow.

import { execFileSync, spawn } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";

import { Chromium, locateFor } from "../../web/tests/support/chromium.mjs";
import { host } from "../../web/tests/support/host.mjs";
import { root, strokefit } from "../../web/tests/support/program.mjs";

const READY = "document.body.dataset.ready === 'true'";
// What follows a drawing: its marks are weighed, its curve is measured.
const SETTLED = 3000;
const QUANTIZE = `import sys
from PIL import Image
picture = Image.open(sys.argv[1]).convert("RGB")
picture.quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(sys.argv[1], optimize=True)`;

const browser = new Chromium(locateFor("docs/pictures/pages.mjs"));
const rest = () => new Promise((done) => setTimeout(done, SETTLED));

async function keep(page, name) {
  const file = join(root, "docs/pictures", name);
  writeFileSync(file, await page.screenshot());
  execFileSync("python3", ["-c", QUANTIZE, file]);
}

async function takeWeb() {
  const server = await host();
  const page = await browser.open(server.address, 1200, 860);
  await page.drop(join(root, "samples/noto-hibiscus.png"));
  await page.until(READY);
  // The handle lays the picture over a third of the drawing.
  await page.value("{ const slider = document.getElementById('compare'); slider.value = 33; slider.dispatchEvent(new Event('input')); }");
  await rest();
  await keep(page, "web.png");
  await server.close();
}

async function takeView() {
  const files = ["docs/pictures/coffee-quality-30.svg", "samples/coffee-300.png"];
  const program = spawn(strokefit, ["view", ...files], { cwd: root, stdio: ["ignore", "ignore", "pipe"] });
  const lines = createInterface({ input: program.stderr });
  const address = await new Promise((done) => lines.on("line", (line) => line.includes("http://") && done(line.match(/http\S+/)[0])));
  const page = await browser.open(`${address}#stroke=401`, 1000, 880);
  await page.until(READY);
  await rest();
  await keep(page, "view.png");
  program.kill();
}

await takeWeb();
await takeView();
await browser.close();
