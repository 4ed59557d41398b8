// Workers from blobs: such a one has the content security policy of the page; one from a file would have none of its own.

export function worker(name) {
  const code = `import ${JSON.stringify(new URL(name, import.meta.url).href)};`;
  const address = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
  const started = new Worker(address, { type: "module" });
  // It has been read when the first message comes.
  started.addEventListener("message", () => URL.revokeObjectURL(address), { once: true });
  return started;
}
