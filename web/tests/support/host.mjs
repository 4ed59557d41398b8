// A static host for web/dist, as plain as they come.

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join } from "node:path";

import { root } from "./program.mjs";

const KINDS = {
  ".html": "text/html",
  ".css": "text/css",
  ".js": "text/javascript",
  ".wasm": "application/wasm",
  ".png": "image/png",
  ".jpg": "image/jpeg",
  ".svg": "image/svg+xml",
};

export async function host() {
  const server = createServer(async ({ url }, answer) => {
    const path = new URL(url, "http://localhost").pathname;
    const name = path.endsWith("/") ? `${path}index.html` : path;
    try {
      const body = await readFile(join(root, "web/dist", name));
      answer.writeHead(200, { "Content-Type": KINDS[extname(name)] ?? "application/octet-stream" }).end(body);
    } catch {
      answer.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const close = () => {
    server.closeAllConnections();
    return new Promise((done) => server.close(done));
  };
  return { address: `http://localhost:${server.address().port}/`, close };
}
