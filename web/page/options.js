// What is asked of a fit: fields, kinds of pictures that set them, and links that hold them.

// Fields by kind, and what they mean. Others are as by default.
export const KINDS = {
  any: { sets: {}, says: "areas for what is filled, strokes for lines and for the rest" },
  logo: { sets: { opaque: true, colors: "12" }, says: "opaque marks, at most 12 colours" },
  drawing: { sets: { marks: "strokes", opaque: true }, says: "opaque strokes alone, as a pen draws them" },
  photograph: { sets: { marks: "strokes", side: "700" }, says: "strokes alone, the picture at most 700 px wide or high" },
  plotter: {
    sets: { marks: "strokes", opaque: true, colors: "#000000", background: "none", pens: "0.7mm", width: "120mm", order: "travel", group: "color" },
    says: "one black pen of 0.7 mm on 120 mm, short ways between strokes, no background",
  },
  cutter: {
    sets: { marks: "areas", opaque: true, colors: "6", background: "none", group: "color" },
    says: "areas alone, at most 6 colours with a layer each, no background",
  },
};

const form = () => document.getElementById("options");
const fields = () => [...form().elements].filter(({ name }) => name);

// The options that are not left as they are; `side` is not one of the fit.
export function options() {
  return Object.fromEntries(Object.entries(given()).filter(([name]) => name !== "side"));
}

export const longestSide = () => Number(form().elements.side.value);

function given() {
  return Object.fromEntries(fields().map((field) => [field.name, value(field)]).filter(([, value]) => value !== ""));
}

function value({ type, value, valueAsNumber, checked }) {
  if (type === "checkbox") return checked;
  return type === "number" && value !== "" ? valueAsNumber : value.trim();
}

const isDefault = (field) => {
  if (field.type === "checkbox") return field.checked === field.defaultChecked;
  if (field.options) return field.selectedIndex === Math.max(0, [...field.options].findIndex((option) => option.defaultSelected));
  return field.value === field.defaultValue;
};

// Sets the fields of a kind, and all others to what they are by default.
export function setKind(name) {
  form().reset();
  put(KINDS[name].sets);
}

function put(values) {
  for (const [name, value] of Object.entries(values)) {
    const field = form().elements[name];
    if (!field?.name) continue;
    if (field.type === "checkbox") field.checked = value === true || value === "true";
    else field.value = value;
  }
}

// A link to this page with the fields that are changed, never the picture.
export function link() {
  const say = new URLSearchParams();
  for (const field of fields().filter((field) => !isDefault(field))) say.set(field.name, value(field));
  return `${location.origin}${location.pathname}${say.size ? `?${say}` : ""}`;
}

// Puts what a link holds into the fields; returns whether it holds something.
export function readLink() {
  const wanted = new URLSearchParams(location.search);
  put(Object.fromEntries(wanted));
  return fields().some((field) => !isDefault(field));
}
