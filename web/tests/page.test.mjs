// The page, as people use it, in Chromium without a window.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { Chromium, locateFor } from "./support/chromium.mjs";
import { host } from "./support/host.mjs";
import { native, root } from "./support/program.mjs";

const program = locateFor("web/tests/page.test.mjs");

const READY = "document.body.dataset.ready === 'true'";
const MESSAGE = "document.getElementById('message').textContent";
const COUNT = "Number(document.getElementById('shown-count').value.split(' of ')[1])";
const picture = (name) => join(root, "samples", name);
const set = (name, value) => `document.querySelector('[name=${name}]').value = '${value}'`;

// Where screenshots are put, to be looked at.
const shots = process.env.STROKEFIT_SHOTS;

describe("the page", { skip: !program }, () => {
  let server, browser, page;

  before(async () => {
    server = await host();
    browser = new Chromium(program);
    page = await browser.open(server.address);
  });
  after(async () => {
    await browser.close();
    await server.close().catch(() => {});
  });

  it("draws a picture that is dropped, and gives the program's bytes", async () => {
    await page.value(set("strokes", 300));
    await page.drop(picture("coffee-300.png"));
    await page.until(READY);
    const file = await page.download("download");
    assert.ok(file.endsWith("coffee-300.svg"));
    assert.ok(readFileSync(file, "utf8") === native(picture("coffee-300.png"), ["--strokes", "300"]));
    assert.equal(await page.value(COUNT), 300);
  });

  it("gives an animation", async () => {
    const file = await page.download("animation");
    assert.ok(file.endsWith("coffee-300.animated.svg"));
    assert.match(readFileSync(file, "utf8"), /<animate attributeName="visibility"/);
  });

  it("fits windows of 1,200 and 420 px", async () => {
    for (const [width, height] of [[1200, 1000], [420, 900]]) {
      await page.resize(width, height);
      await page.until(`innerWidth === ${width}`);
      const [wide, panels] = await page.value("[document.documentElement.scrollWidth, document.querySelectorAll('canvas').length]");
      assert.ok(wide <= width, `${wide} px`);
      assert.equal(panels, 6);
      if (shots) {
        mkdirSync(shots, { recursive: true });
        writeFileSync(join(shots, `page-${width}.png`), await page.screenshot());
      }
    }
    await page.resize(1200, 900);
  });

  it("compares target and drawing by a slider", async () => {
    // How much of the drawing's canvas differs from the drawing alone, as the target takes its place from the left.
    const covered = `(async () => {
      const [slider, canvas] = ["compare", "drawing"].map((id) => document.getElementById(id));
      const seen = (share) => {
        slider.value = share;
        slider.dispatchEvent(new Event("input"));
        return canvas.getContext("2d").getImageData(0, 0, canvas.width - 2, canvas.height).data;
      };
      const alone = seen(0);
      const differing = (share) => seen(share).filter((value, k) => value !== alone[k]).length / alone.length;
      return [50, 100, 0].map(differing);
    })()`;
    const [half, all, none] = await page.value(covered);
    assert.ok(all > 0.5 && half > all / 4 && half < (3 * all) / 4, `${half} ${all}`);
    assert.equal(none, 0);
  });

  it("adds strokes", async () => {
    await page.value("document.getElementById('strokes').value = 40; document.querySelector('#more button').click()");
    await page.until(`${READY} && ${COUNT} === 340`);
  });

  it("ends a fit on request, with what it has drawn", async () => {
    await page.value(`${set("strokes", 3000)}; ${set("preset", "best")}`);
    await page.choose(picture("rocket-320.png"));
    await page.until(`${COUNT} > 0 && !document.getElementById('stop').hidden && document.body.dataset.ready === 'false'`);
    await page.value("document.getElementById('stop').click()");
    await page.until(READY);
    const svg = readFileSync(await page.download("download"), "utf8");
    assert.ok(svg.match(/<path/g).length < 3000 && svg.includes('viewBox="0 0 320 214"'));
  });

  it("ends a fit when another picture comes, and answers meanwhile", async () => {
    await page.choose(picture("chelsea-cat.png"));
    await page.until(`${COUNT} > 0 && document.title.includes('chelsea')`);
    await page.value(`${set("strokes", 100)}; ${set("preset", "draft")}`);
    await page.drop(picture("noto-gem.png"));
    await page.until(`${READY} && document.title.includes('noto-gem')`);
    const svg = readFileSync(await page.download("download"), "utf8");
    assert.ok(svg === native(picture("noto-gem.png"), ["--strokes", "100", "--preset", "draft"]));
  });

  it("compares transparent pictures on white", async () => {
    // noto-gem, of the last test.
    const db = await page.value("parseFloat(document.getElementById('shown-db').textContent)");
    assert.ok(db > 20, `${db} dB`);
  });

  it("makes large pictures smaller, and says what it cannot read", async () => {
    await page.value(set("side", 500));
    await page.choose(picture("coffee-550x220.png"));
    await page.until(`${READY} && document.title.includes('550')`);
    assert.match(readFileSync(await page.download("download"), "utf8"), /viewBox="0 0 500 200"/);
    await page.drop(join(root, "README.md"));
    await page.until(`${MESSAGE}.includes('README.md')`);
    await page.value(set("background", "mauve"));
    await page.choose(picture("noto-gem.png"));
    await page.until(`${MESSAGE}.includes("'mauve' is not a background")`);
    await page.value(set("background", ""));
  });

  it("asks nobody but its own host, and may not", async () => {
    const foreign = page.requests.filter((url) => !url.startsWith(server.address) && !/^(blob|data):/.test(url));
    assert.deepEqual(foreign, []);
    const refused = `fetch("http://127.0.0.1:9/").then(() => "sent", (error) => "refused")`;
    const violated = `new Promise((done) => addEventListener("securitypolicyviolation", (e) => done(e.effectiveDirective)))`;
    assert.equal(await page.value(`(async () => { const violated = ${violated}; ${refused}; return violated; })()`), "connect-src");
    // The same in a worker as the page starts them.
    const code = `addEventListener("securitypolicyviolation", (e) => postMessage(e.effectiveDirective)); ${refused};`;
    const worker = `new Worker(URL.createObjectURL(new Blob([${JSON.stringify(code)}], { type: "text/javascript" })), { type: "module" })`;
    assert.equal(await page.value(`new Promise((done) => { ${worker}.onmessage = ({ data }) => done(data); })`), "connect-src");
  });

  it("works without a network once it has been loaded", async () => {
    await page.until("navigator.serviceWorker.controller !== null");
    await server.close();
    await page.go(`${server.address}?again`);
    await page.value(`${set("strokes", 50)}; ${set("preset", "draft")}`);
    await page.value("document.querySelector('[data-picture=\"coffee-300.png\"] button').click()");
    await page.until(READY);
    assert.equal(await page.value(COUNT), 50);
  });

  it("complained about nothing", () => assert.deepEqual(page.complaints, []));
});

describe("the page with little memory", { skip: !program }, () => {
  it("says that a fit broke off, and draws the next picture", async () => {
    const server = await host();
    const browser = new Chromium(program, ["--js-flags=--wasm-max-mem-pages=500"]);
    try {
      const page = await browser.open(server.address);
      await page.value(`${set("strokes", 50)}; ${set("preset", "draft")}`);
      const large = `Object.assign(document.createElement("canvas"), { width: 1000, height: 1000 }).toBlob((blob) => {
        const pasted = new DataTransfer();
        pasted.items.add(new File([blob], "large.png"));
        dispatchEvent(new ClipboardEvent("paste", { clipboardData: pasted }));
      })`;
      await page.value(large);
      await page.until(`${MESSAGE}.startsWith('the fit broke off')`);
      await page.choose(picture("noto-gem.png"));
      await page.until(READY);
      assert.equal(await page.value(MESSAGE), "");
    } finally {
      await browser.close();
      await server.close();
    }
  });
});
