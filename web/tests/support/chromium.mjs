// Chromium, driven by its DevTools protocol through a pipe.

import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { delimiter, join } from "node:path";

import { skipped } from "./program.mjs";

const PROGRAMS = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
// Longest wait for what a page is to do, ms; the machine may be busy.
const PATIENCE = 300_000;

// The browser; null, with a note, where the tests in `file` cannot run.
export function locateFor(file) {
  const program = locate();
  if (program) return program;
  const engines = process.env.STROKEFIT_ENGINES?.split(",") ?? [];
  if (engines.includes("chromium")) throw new Error("chromium is required but not installed");
  skipped(file, "chromium is not installed: apt-get install chromium");
  return null;
}

function locate() {
  const folders = (process.env.PATH ?? "").split(delimiter);
  return PROGRAMS.flatMap((name) => folders.map((folder) => join(folder, name))).find(existsSync) ?? null;
}

export class Chromium {
  #answers = new Map();
  #listeners = new Set();
  #number = 0;

  constructor(program, flags = []) {
    this.folder = mkdtempSync(join(tmpdir(), "strokefit-"));
    this.process = spawn(
      program,
      ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe",
        "--force-color-profile=srgb", "--no-first-run", "--hide-scrollbars", `--user-data-dir=${join(this.folder, "profile")}`, ...flags],
      { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] },
    );
    this.ended = new Promise((done) => {
      this.process.once("exit", (code, signal) => done(`${program} ended: ${signal ?? code}`)).once("error", done);
    });
    this.ended.then((how) => this.#abandon(new Error(how)));
    // What could not be written is told by how the process ended.
    this.process.stdio[3].on("error", () => {});
    let text = "";
    this.process.stdio[4].setEncoding("utf8").on("data", (part) => {
      const messages = (text + part).split("\0");
      text = messages.pop();
      messages.forEach((message) => this.#take(JSON.parse(message)));
    });
  }

  #take(message) {
    const { done, failed } = this.#answers.get(message.id) ?? {};
    this.#answers.delete(message.id);
    if (message.error) failed?.(new Error(message.error.message));
    else done?.(message.result);
    if (message.method) this.#listeners.forEach((listener) => listener(message));
  }

  // A process that has ended answers nothing.
  #abandon(error) {
    this.send = () => Promise.reject(error);
    this.#answers.forEach(({ failed }) => failed(error));
    this.#answers.clear();
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.#number;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((done, failed) => this.#answers.set(id, { done, failed }));
  }

  listen(listener) {
    this.#listeners.add(listener);
  }

  async open(address, width = 1200, height = 900) {
    // Without a size, which a window has and a tab of Chromium 156 may not have; `resize` gives it.
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page(this, sessionId);
    await page.send("Page.enable");
    await page.send("Runtime.enable");
    await page.send("Network.enable");
    await page.resize(width, height);
    await page.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: this.folder, eventsEnabled: true });
    await page.go(address);
    return page;
  }

  async close() {
    this.send("Browser.close").catch(() => {});
    await this.ended;
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
  }
}

export class Page {
  // Addresses that were asked for, and what was complained about.
  requests = [];
  complaints = [];

  constructor(browser, session) {
    this.browser = browser;
    this.session = session;
    browser.listen(({ sessionId, method, params }) => {
      if (sessionId !== session) return;
      if (method === "Network.requestWillBeSent") this.requests.push(params.request.url);
      if (method === "Runtime.exceptionThrown") this.complaints.push(params.exceptionDetails.exception?.description);
    });
  }

  send(method, params) {
    return this.browser.send(method, params, this.session);
  }

  async go(address) {
    await this.send("Page.navigate", { url: address });
    await this.until("document.readyState === 'complete'");
  }

  resize(width, height) {
    return this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
  }

  // The value of an expression, once it is settled.
  async value(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", {
      expression,
      awaitPromise: true,
      returnByValue: true,
      userGesture: true,
    });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  async until(condition) {
    const start = Date.now();
    while (!(await this.value(condition).catch(() => false))) {
      if (Date.now() - start > PATIENCE) throw new Error(`never: ${condition}\n${await this.value("document.body.innerText")}`);
      await new Promise((done) => setTimeout(done, 20));
    }
  }

  // Drops files in the middle of the page.
  async drop(...files) {
    const data = { items: [], files, dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) {
      await this.send("Input.dispatchDragEvent", { type, x: 300, y: 100, data });
    }
  }

  async choose(file) {
    const { root } = await this.send("DOM.getDocument");
    const { nodeId } = await this.send("DOM.querySelector", { nodeId: root.nodeId, selector: "#file" });
    await this.send("DOM.setFileInputFiles", { files: [file], nodeId });
  }

  // Clicks on a link, and returns the name of the file that comes.
  async download(id) {
    const saved = new Promise((done) => {
      this.browser.listen(({ method, params }) => {
        if (method === "Browser.downloadWillBegin") this.name = params.suggestedFilename;
        if (method === "Browser.downloadProgress" && params.state === "completed") done(this.name);
      });
    });
    await this.value(`document.getElementById(${JSON.stringify(id)}).click()`);
    return join(this.browser.folder, await saved);
  }

  // Presses a key; `text` is what it writes.
  async press(key, { ctrl = false, shift = false, text = undefined } = {}) {
    const modifiers = (ctrl ? 2 : 0) + (shift ? 8 : 0);
    await this.send("Input.dispatchKeyEvent", { type: "keyDown", key, code: key, modifiers, text });
    await this.send("Input.dispatchKeyEvent", { type: "keyUp", key, code: key, modifiers });
  }

  // Drags the mouse through places; one alone is a click.
  async mouse(...places) {
    const at = (type, [x, y], buttons) => this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons, clickCount: 1 });
    await at("mouseMoved", places[0], 0);
    await at("mousePressed", places[0], 1);
    for (const place of places.slice(1)) await at("mouseMoved", place, 1);
    await at("mouseReleased", places.at(-1), 0);
  }

  async screenshot() {
    const { data } = await this.send("Page.captureScreenshot", { format: "png", captureBeyondViewport: true });
    return Buffer.from(data, "base64");
  }
}
