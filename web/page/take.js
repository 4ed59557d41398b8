// Ways to take a drawing along.

const element = (id) => document.getElementById(id);

// Without what only an editor needs.
export const lean = (text) => text.replace(/ xmlns:inkscape="[^"]*"/, "").replace(/ inkscape:[a-z]+="[^"]*"/g, "");

// A name of a component for a file.
export function componentName(stem) {
  const name = stem.replace(/[^A-Za-z0-9]+(.)?/g, (_, next) => (next ?? "").toUpperCase()).replace(/^[a-z]/, (first) => first.toUpperCase());
  return /^[A-Z]/.test(name) ? name : `Drawing${name}`;
}

// The text of an SVG as a component for React.
export function component(text, stem) {
  const attribute = (_, before, after) => ` ${before}${after.toUpperCase()}`;
  const sheet = (_, rules) => `<style>{\`${rules}\`}</style>`;
  const named = lean(text).trim().replace(/<style>([^<]*)<\/style>/, sheet).replaceAll(' class="', ' className="');
  const jsx = named.replace(/ ([a-z]+)-([a-z])(?=[a-z]*=")/g, attribute).replace("<svg", "<svg {...props}");
  return `export function ${componentName(stem)}(props) {\n  return (\n${jsx}\n  );\n}\n`;
}

// The text of an SVG as a background for a style sheet.
export function background(text) {
  const plain = lean(text).trim().replace(/\n/g, "").replaceAll('"', "'");
  return `background: url("data:image/svg+xml,${plain.replace(/[%#<>{}]/g, encodeURIComponent)}") center / contain no-repeat;`;
}

// A PNG of an SVG, `width`×`height` px.
async function png(text, width, height) {
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), { width, height });
    canvas.getContext("2d").drawImage(image, 0, 0, width, height);
    const blob = await new Promise((done) => canvas.toBlob(done, "image/png"));
    if (!blob) throw new Error(`this browser makes no PNG of ${width}×${height} px: take a smaller scale`);
    return blob;
  } finally {
    URL.revokeObjectURL(address);
  }
}

export function save(blob, name) {
  const saved = document.createElement("a");
  saved.href = URL.createObjectURL(blob);
  saved.download = name;
  saved.click();
  setTimeout(() => URL.revokeObjectURL(saved.href), 10_000);
}

// Answers the buttons. `drawing` gives { text, stem, width, height } as it is shown; `link` the address that has the settings;
// `convert` makes a file of a text and "pdf" or "dxf".
export function listenToTake({ drawing, link, convert }) {
  const file = (kind, type) => async () => {
    const { text, stem } = drawing();
    save(new Blob([await convert(text, kind)], { type }), `${stem}.${kind}`);
    return `saved a ${kind.toUpperCase()}`;
  };
  const ways = {
    copy: async () => copy(drawing().text, "the SVG"),
    react: async () => copy(component(drawing().text, drawing().stem), "a React component"),
    css: async () => copy(background(drawing().text), "a CSS background"),
    link: async () => copy(link(), "a link with these settings, without the picture"),
    pdf: file("pdf", "application/pdf"),
    dxf: file("dxf", "image/vnd.dxf"),
    png: async () => {
      const { text, stem, width, height } = drawing(), scale = Number(element("png-scale").value);
      save(await png(text, width * scale, height * scale), `${stem}.png`);
      return `saved a PNG of ${width * scale}×${height * scale} px`;
    },
  };
  for (const [id, way] of Object.entries(ways)) {
    element(id).addEventListener("click", () => way().then(told, (error) => told(error.message)));
  }
}

async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    throw new Error("the browser does not let this page copy: download the file instead");
  }
  return `copied ${what}, ${text.length.toLocaleString("en")} characters`;
}

function told(what) {
  element("taken").textContent = what;
}
