// The page from the first look to the file that is taken along, in Chromium without a window.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { Chromium, locateFor } from "./support/chromium.mjs";
import { host } from "./support/host.mjs";
import { native, root } from "./support/program.mjs";

const program = locateFor("web/tests/use.test.mjs");
const READY = "document.body.dataset.ready === 'true'";
const COUNT = "parseInt(document.getElementById('shown-label').textContent)";
const get = (id, what = "textContent") => `document.getElementById('${id}').${what}`;
const click = (id) => `document.getElementById('${id}').click()`;
const picture = (name) => join(root, "samples", name);
const shots = process.env.STROKEFIT_SHOTS;

describe("the page in use", { skip: !program }, () => {
  let server, browser, page;

  before(async () => {
    server = await host();
    browser = new Chromium(program);
    // A link with a setting, for tests that do not take long.
    page = await browser.open(`${server.address}?preset=draft`);
    await browser.send("Browser.grantPermissions", { permissions: ["clipboardReadWrite", "clipboardSanitizedWrite"] });
  });
  after(async () => {
    await browser.close();
    await server.close();
  });

  const isSeen = (id) => page.value(`document.getElementById('${id}').checkVisibility({ visibilityProperty: true })`);
  const file = async () => readFileSync(await page.download("download"), "utf8");
  const shoot = async (name) => {
    if (!shots) return;
    mkdirSync(shots, { recursive: true });
    for (const [width, scheme] of [[1200, "light"], [420, "light"], [1200, "dark"], [420, "dark"]]) {
      await page.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
      await page.resize(width, 900);
      await page.until(`innerWidth === ${width}`);
      await new Promise((done) => setTimeout(done, 300));
      writeFileSync(join(shots, `${name}-${width}-${scheme}.png`), await page.screenshot());
    }
    await page.send("Emulation.setEmulatedMedia", { features: [] });
    await page.resize(1200, 900);
    await page.until("innerWidth === 1200");
  };
  // The place of a point of the drawing, px of the window.
  const placeOf = (x, y) =>
    page.value(`(() => { const canvas = document.getElementById('drawing'); canvas.scrollIntoView({ block: "center" });
      const box = canvas.getBoundingClientRect(); return [box.left + ${x} * box.width, box.top + ${y} * box.height]; })()`);

  it("shows no option before there is a picture, and examples to slide", async () => {
    for (const id of ["work", "options", "amount", "kinds", "download"]) assert.equal(await isSeen(id), false, id);
    for (const id of ["drop", "examples"]) assert.equal(await isSeen(id), true, id);
    await page.until("[...document.querySelectorAll('.pair img')].every((image) => image.naturalWidth > 0)");
    const line = `(() => { const pair = document.querySelector('.pair'); const slider = pair.querySelector('input'); slider.value = 20;
      slider.dispatchEvent(new Event('input')); return getComputedStyle(pair.querySelector('.over')).clipPath; })()`;
    assert.match(await page.value(line), /80%|100% - 20%/);
    await shoot("start");
  });

  it("can be entered by keyboard", async () => {
    await page.press("Tab");
    assert.equal(await page.value("document.activeElement.id"), "file");
    const { nodes } = await page.send("Accessibility.getFullAXTree");
    const controls = nodes.filter(({ role, ignored }) => !ignored && ["button", "slider", "textbox", "combobox", "link"].includes(role?.value));
    assert.ok(controls.length >= 9, `${controls.length}`);
    assert.deepEqual(controls.filter(({ name }) => !name?.value), []);
  });

  it("draws an example with a click", async () => {
    await page.value("document.querySelector('[data-picture=\"noto-hibiscus.png\"] button').click()");
    await page.until(READY);
    assert.ok((await file()) === native(picture("noto-hibiscus.png"), ["--preset", "draft"]));
    assert.equal(await isSeen("start"), false);
    await shoot("hibiscus");
  });

  it("names every control of a drawing for who cannot see it", async () => {
    await page.value("document.querySelectorAll('details').forEach((each) => (each.open = true))");
    const { nodes } = await page.send("Accessibility.getFullAXTree");
    const roles = ["button", "slider", "textbox", "spinbutton", "combobox", "link", "radio", "checkbox", "image", "ColorWell"];
    const controls = nodes.filter(({ role, ignored }) => !ignored && roles.includes(role?.value));
    assert.ok(controls.length > 40, `${controls.length}`);
    assert.deepEqual(controls.filter(({ name }) => !name?.value).map(({ role }) => role.value), []);
    await page.value("document.querySelectorAll('details').forEach((each) => (each.open = false))");
  });

  it("answers the slider at once, and fits when it rests", async () => {
    const before = await page.value(COUNT);
    const slide = (quality) => `(async () => {
      const slider = document.getElementById('amount'), start = performance.now();
      slider.value = ${quality};
      slider.dispatchEvent(new Event("input"));
      const marks = ${COUNT};
      await new Promise(requestAnimationFrame);
      return [marks, performance.now() - start, document.getElementById('summary').value];
    })()`;
    // Marks are weighed beside the page.
    await page.until("document.getElementById('amount').dataset.weighed === 'true'");
    const steps = [];
    for (const quality of [26, 22, 18, 14]) steps.push(await page.value(slide(quality)));
    const counts = steps.map(([marks]) => marks);
    assert.ok(counts.every((marks, k) => marks < (k ? counts[k - 1] : before) + 1) && counts[3] < 0.6 * before, counts.join());
    assert.ok(Math.max(...steps.map(([, ms]) => ms)) < 250, JSON.stringify(steps));
    assert.match(steps[3][2], /^\d+ marks? · [\d.]+ k?B · [a-z ]+$/);
    await page.value(slide(20));
    await page.until(`${READY} && document.querySelector('[name=quality]').value === '20'`);
    assert.ok((await file()) === native(picture("noto-hibiscus.png"), ["--preset", "draft", "--quality", "20"]));
    const fitted = await page.value(get("summary", "value"));
    // The way back takes no fit.
    await page.value(slide(14));
    await page.until(`${READY} && document.querySelector('[name=quality]').value === '14'`);
    await page.value(slide(20));
    await page.until(`document.querySelector('[name=quality]').value === '20' && ${get("summary", "value")} === '${fitted}'`);
  });

  it("sets options by kinds, and says which", async () => {
    await page.choose(picture("noto-gem.png"));
    await page.until(`${READY} && document.title.includes('noto-gem')`);
    await page.value("document.querySelector('[value=plotter]').click()");
    assert.match(await page.value(get("kind-note")), /one black pen of 0.7 mm/);
    await page.until(READY);
    const flags = "--marks strokes --opaque --palette #000000 --background none --pens 0.7mm --width 120mm --order travel --group color";
    assert.ok((await file()) === native(picture("noto-gem.png"), flags.split(" ")));
    await page.value("document.querySelector('[value=any]').click()");
    await page.until(READY);
    assert.ok((await file()) === native(picture("noto-gem.png"), []));
    // A field that is changed is of no kind.
    await page.value("{ const field = document.querySelector('[name=preset]'); field.value = 'draft'; field.dispatchEvent(new Event('input', { bubbles: true })); }");
    assert.equal(await page.value("document.querySelectorAll('[name=kind]:checked').length"), 0);
  });

  it("changes colours, merges them and removes a background without a fit", async () => {
    await page.choose(picture("bicycle.png"));
    await page.until(`${READY} && document.title.includes('bicycle')`);
    const before = await file();
    const colors = () => page.value("[...document.querySelectorAll('.swatch')].map((each) => each.getAttribute('aria-label'))");
    const swatches = await colors();
    const paper = swatches.findIndex((label) => label.endsWith("with the background"));
    const ink = swatches.findIndex((_, k) => k !== paper);
    const count = swatches.length;
    const choose = (k) => `document.querySelectorAll('.swatch')[${k}].click()`;
    await page.value(`${choose(ink)}; { const field = document.getElementById('swatch-color'); field.value = '#c00020'; field.dispatchEvent(new Event('change')); }`);
    const red = await file();
    assert.ok(!before.includes("#c00020") && red.includes("#c00020"));
    assert.equal(red.split("<path").length, before.split("<path").length);
    await page.value(`{ const [from, onto] = [1, 0].map((k) => document.querySelectorAll('.swatch')[k]), data = new DataTransfer();
      for (const [target, type] of [[from, "dragstart"], [onto, "dragover"], [onto, "drop"]]) {
        target.dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
      } }`);
    assert.equal((await colors()).length, count - 1);
    await page.press("z", { ctrl: true });
    assert.ok((await file()) === red);
    await page.value(`${choose(paper)}; document.getElementById('swatch-drop').click()`);
    assert.ok(before.includes("<rect") && !(await file()).includes("<rect"));
    await page.press("z", { ctrl: true });
    await page.press("z", { ctrl: true });
    assert.ok((await file()) === before);
    await page.press("z", { ctrl: true, shift: true });
    assert.ok((await file()) === red);
    await page.value(click("undo"));
    assert.equal(await page.value(READY), true);
  });

  it("outlines what is under the pointer, selects, hides, deletes and brings back", async () => {
    const before = await file();
    const count = await page.value(COUNT);
    const drawn = `(() => { const canvas = document.getElementById('overlay'); return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some(Boolean); })()`;
    // A tyre of the bicycle is found on a way down through a wheel.
    const [x, top] = await placeOf(0.23, 0.3);
    const [, bottom] = await placeOf(0.23, 0.9);
    assert.equal(await page.value(drawn), false);
    for (let y = top; y < bottom && !(await page.value(drawn)); y += 2) {
      await page.send("Input.dispatchMouseEvent", { type: "mouseMoved", x, y });
      if (await page.value(drawn)) await page.mouse([x, y]);
    }
    const number = Number(await page.value(get("stroke", "value")));
    assert.ok(number > 0);
    assert.match(await page.value(get("numbers")), /colour#/);
    await page.press("h");
    assert.equal(await page.value(COUNT), count - 1);
    // The tyre may be a circle.
    const elements = (text) => text.match(/<(path|circle|ellipse|rect)\b/g).length;
    assert.equal(elements(await file()), elements(before) - 1);
    await page.press("h");
    await page.press("Delete");
    assert.equal(await page.value(COUNT), count - 1);
    await page.value(click("undo"));
    assert.ok((await file()) === before);
  });

  it("zooms by wheel and keys, moves by dragging, and goes back to all", async () => {
    const place = await placeOf(0.5, 0.5);
    const zoomed = async () => /view=/.test(await page.value("location.hash"));
    await page.send("Input.dispatchMouseEvent", { type: "mouseWheel", x: place[0], y: place[1], deltaX: 0, deltaY: -400 });
    await page.until("/view=/.test(location.hash)");
    const before = await page.value("location.hash");
    await page.mouse(place, [place[0] - 80, place[1] - 40], [place[0] - 120, place[1] - 60]);
    await page.until(`location.hash !== '${before}'`);
    await page.press("0");
    await page.until("!/view=/.test(location.hash)");
    await page.press("+");
    await page.until("/view=/.test(location.hash)");
    await page.value(click("reset"));
    await page.until("!/view=/.test(location.hash)");
    assert.equal(await zoomed(), false);
    await page.press("t");
    assert.equal(await isSeen("target"), true);
    await page.press("d");
    assert.equal(await isSeen("target"), false);
  });

  it("gives the drawing as text, component, style, PNG and link", async () => {
    const svg = await file();
    const clipboard = "navigator.clipboard.readText()";
    const take = async (id, words) => {
      await page.value(`${get("taken")} = ""; ${click(id)}`);
      await page.until(`${get("taken")} !== ""`);
      assert.match(await page.value(get("taken")), words);
    };
    await page.send("Page.bringToFront");
    await take("copy", /^copied the SVG/);
    assert.ok((await page.value(clipboard)) === svg);
    await take("react", /^copied a React component/);
    assert.match(await page.value(clipboard), /^export function Bicycle\(props\)/);
    await take("css", /^copied a CSS background/);
    const shown = `(async () => { const image = new Image(); image.src = (await ${clipboard}).match(/url\\("([^"]*)"/)[1]; await image.decode(); return image.naturalWidth; })()`;
    assert.equal(await page.value(shown), 400);
    const png = readFileSync(await page.download("png"));
    assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [800, 520]);
    assert.match(readFileSync(await page.download("pdf"), "latin1"), /^%PDF-1\.5[^]*%%EOF\n$/);
    const dxf = await page.download("dxf");
    assert.ok(dxf.endsWith("bicycle.dxf"));
    assert.match(readFileSync(dxf, "utf8"), /\nLWPOLYLINE\n[^]*\nEOF\n$/);
    await page.value("{ const field = document.querySelector('[name=colors]'); field.value = '4'; field.dispatchEvent(new Event('input', { bubbles: true })); }");
    await take("link", /^copied a link/);
    assert.equal(await page.value(clipboard), `${server.address}?preset=draft&colors=4`);
  });

  it("starts with the settings of a link", async () => {
    await page.go(`${server.address}?colors=4&marks=strokes&opaque=true`);
    const values = "['colors', 'marks'].map((name) => document.querySelector(`[name=${name}]`).value)";
    assert.deepEqual(await page.value(values), ["4", "strokes"]);
    assert.equal(await page.value("document.querySelector('[name=opaque]').checked"), true);
    await page.go(`${server.address}?preset=draft`);
  });

  it("lets a brush say what matters", async () => {
    await page.choose(picture("noto-gem.png"));
    await page.until(READY);
    await page.value(click("focus"));
    await page.mouse(await placeOf(0.3, 0.3), await placeOf(0.4, 0.35), await placeOf(0.5, 0.4));
    await page.value(click("focus-draw"));
    await page.until(READY);
    const flags = ["--preset", "draft"];
    assert.ok((await file()) !== native(picture("noto-gem.png"), flags));
    await page.value(`${click("focus")}; ${click("focus-clear")}`);
    await page.until(READY);
    assert.ok((await file()) === native(picture("noto-gem.png"), flags));
  });

  it("makes a zip of several pictures, and says what it cannot read", async () => {
    await page.drop(picture("noto-gem.png"), picture("bicycle.png"), join(root, "README.md"));
    await page.until(`!document.getElementById('zip').hidden`);
    assert.equal(await page.value(get("batch-name")), "2 of 3 drawn");
    assert.match(await page.value(get("files")), /README.md is no picture/);
    const zip = readFileSync(await page.download("zip")).toString("latin1");
    for (const name of ["noto-gem", "bicycle"]) {
      assert.ok(zip.includes(`${name}.svg`) && zip.includes(native(picture(`${name}.png`), ["--preset", "draft"])));
    }
    await page.value(click("other"));
    assert.equal(await isSeen("drop"), true);
  });

  it("says what is wrong with a file", async () => {
    for (const [name, text, words] of [
      ["empty.png", "", /empty\.png is empty/],
      ["drawing.svg", "<svg/>", /is a drawing already/],
      ["photo.heic", "x", /phones save such pictures/],
      ["broken.png", "x", /may be damaged/],
    ]) {
      writeFileSync(join(browser.folder, name), text);
      await page.choose(join(browser.folder, name));
      await page.until(`${get("message")}.includes('${name}')`);
      assert.match(await page.value(get("message")), words);
    }
  });

  it("complained about nothing", () => assert.deepEqual(page.complaints, []));
});
