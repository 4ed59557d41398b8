// strokefit: turns a picture into an editable SVG of strokes and areas. A fit runs on the thread that calls it, and holds it until
// it is over: in a page, call it from a worker.

/** What to draw. The names are those of the command line's options. */
export interface Options {
  /** At most so many strokes. */
  strokes?: number;
  /** Stop when the file reaches so many dB of PSNR: 25 is rough, 30 fair, 35 good. */
  psnr?: number;
  /** At most so many bytes of SVG. */
  bytes?: number;
  /** At most so many seconds. It makes the drawing depend on the machine. */
  time?: number;
  /** 0 to 60; higher keeps more. A stroke is kept while every byte it costs removes at least the squared error that one pixel has
   * at so many dB. 30 if there is no limit on strokes, dB or bytes. */
  quality?: number;
  /** How much time to spend for a better drawing. `balanced` if it is left out. */
  preset?: "draft" | "balanced" | "best";
  /** What the drawing is made of: areas for what is filled and strokes for lines and for the rest (`auto`), or one of them
   * alone. `auto` if it is left out. */
  marks?: "auto" | "strokes" | "areas";
  /** A good drawing after every layer, at some dB less in the end. */
  progressive?: boolean;
  /** Draw noise, traces of JPEG and other damage of the picture as they are. */
  literal?: boolean;
  /** What becomes of the paper of a page that was scanned or photographed: it keeps its colour, or becomes white; `own` if it is left out. */
  paper?: "own" | "white";
  /** What soft shadows are drawn with: a filter, or steps of opacity for programs that ignore filters; `filter` if it is left out. */
  blurs?: "filter" | "steps";
  /** Which errors count: those that people see, or all alike, for a tenth of a dB more; if it is left out, `exact` with `psnr`, and `eye` without. */
  look?: "eye" | "exact";
  /** Opaque strokes only. */
  opaque?: boolean;
  /** Coverage function of soft edges: `smoothstep`, `sigmoid`, `tanh` or `atan[:K]`; `A>B` changes from A to B during the fit. */
  coverage?: string;
  /** Most points of a stroke, 2 or more; as many as pay if it is left out. */
  points?: number;
  /** Number of stages, each a layer of the SVG. */
  stages?: number;
  /** Whether all strokes are fitted jointly after the stages; true if it is left out. */
  polish?: boolean;
  /** `auto`, `none`, `#rrggbb` or a name such as `white`. */
  background?: string;
  /** Key of all random draws, 0 or more. */
  seed?: number;
  /** At most so many colours, or these. */
  colors?: number | string[];
  /** Only these widths of strokes: lengths such as `0.3mm,0.8mm` on a page of a `width`, or numbers in px. */
  pens?: string;
  /** What an element of the SVG holds; with `css`, colours and widths are in classes of a style sheet. */
  form?: "plain" | "smallest" | "css" | "powerstroke" | "outlines";
  /** What a layer of the SVG holds. */
  group?: "stage" | "color" | "object";
  /** In which order the strokes of a layer come: as they were fitted, or with little travel of a pen between them. */
  order?: "fitted" | "travel";
  /** Decimals of coordinates and widths, 0 to 6. */
  precision?: number;
  /** Width of the page, such as `120mm`. */
  width?: string;
  /** A mask of the picture's size, with samples as `fit` takes them: errors count most where it is white. */
  focus?: { pixels: Uint8Array | Uint8ClampedArray; width: number; height: number };
  /** The text of an SVG to go on from: limits count all of it. Strokes of a drawing by strokefit are fitted further. */
  base?: string;
  /** Whether the strokes of the base stay as they are. */
  freezeBase?: boolean;
}

/**
 * Points x, y, x, y, … and radius, px; colour `#rrggbb`; opacity, 0 to 1; kinds of the points, `o` on the path, `c` for
 * the control point of a quadratic curve, `b` for one of the two of a cubic curve and `a` for a point that a circular arc
 * goes through, and then `z` if the path is closed. An area has the radius 0, and its rings one after the other, each
 * with its `z`; it is filled by the nonzero rule.
 */
export type Mark = [points: number[], radius: number, color: string, opacity: number, kinds: string];

/** A drawing as canvases draw it. */
export interface Scene {
  /** px of the picture. */
  width: number;
  height: number;
  /** `#rrggbb`; null if the drawing is transparent. */
  background: string | null;
  /** Strokes and areas, back to front, stage by stage. */
  stages: Mark[][];
}

/** The state of a fit after an iteration. */
export interface Progress {
  /** Fraction of the planned work that is done, 0 to 1, never decreasing. */
  done: number;
  /** The stage under way, from 1; one past the last during polish. */
  stage: number;
  /** How many stages are planned; 0 if that depends on how much each of them gains. */
  stages: number;
  /** Whether strokes are being polished. */
  polishing: boolean;
  /** Strokes and areas. */
  strokes: number;
  /** Fidelity so far, dB. */
  psnrDb: number;
  /** True if the drawing is a trial: a fit may make several, one after the other, and keep the best one. */
  isTrial: boolean;
  /** The drawing so far; only to be called before `onProgress` returns. It takes time: do not call it at every iteration. */
  scene(): Scene;
}

/** What the command line writes with `--report`; docs/command-line.md describes all fields. */
export interface Report {
  schema: number;
  /** Strokes and areas. */
  strokes: number;
  /** Areas among them. */
  areas: number;
  svg_bytes: number;
  svg_gzip_bytes: number;
  wall_s: number;
  stop: "strokes" | "psnr" | "bytes" | "time" | "converged" | "interrupted";
  /** The SVG as rendered by resvg against the picture; `psnr_db` is null where they are equal, `ssimulacra2` then 100. */
  fidelity: { psnr_db: number | null; ssim: number; mse: number; l1: number; ssimulacra2: number; details_kept?: number };
  [field: string]: unknown;
}

/** A finished drawing. */
export interface Drawing {
  /** Text of the file. */
  svg: string;
  report: Report;
  /** On a base that is no drawing by strokefit: only the strokes and areas on top. */
  scene: Scene;
}

/** Is told of progress after every iteration. Returning `false` ends the fit, which is no error: the drawing is finished as far
 * as it has come. What it throws ends the fit, too, and is thrown on. */
export type OnProgress = (progress: Progress) => boolean | void;

/**
 * Draws a picture of interleaved samples, row by row: 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA, as `ImageData` has it) for
 * each pixel, 0 to 255, sRGB-encoded, with straight alpha. Equal pictures and options give the bytes that the program gives.
 */
export function fit(
  pixels: Uint8Array | Uint8ClampedArray,
  width: number,
  height: number,
  options?: Options,
  onProgress?: OnProgress,
): Promise<Drawing>;

/** Draws the picture of a PNG file; colour profiles are ignored. */
export function fitPng(png: Uint8Array | ArrayBuffer, options?: Options, onProgress?: OnProgress): Promise<Drawing>;

/** An SVG that draws itself, from the text of a drawing by strokefit. */
export function animate(svg: string): Promise<string>;

/** A PDF of a drawing by strokefit, on a page as large as its text says: curves are exact, layers those of the drawing. */
export function pdf(svg: string): Promise<Uint8Array>;

/** A DXF of a drawing by strokefit, in millimetres, with a layer for each colour: centre lines of strokes, rings of areas, circles. */
export function dxf(svg: string): Promise<string>;

/** Numbers in a row. */
export type Numbers = readonly number[] | Float32Array | Float64Array | Int32Array | Uint32Array;

/** Strokes and areas as flat arrays, back to front: n marks of m points. */
export interface Marks {
  /** x, y of each point, px: 2m numbers. */
  points: Numbers;
  /** n + 1 numbers: mark i has the points from `starts[i]` to `starts[i + 1]`, the last not included. */
  starts: Numbers;
  /** n widths, px. That of an area has no effect. */
  widths: Numbers;
  /** Red, green and blue of each mark, 0 to 1: 3n numbers. */
  colors: Numbers;
  /** n, 0 to 1. */
  opacities: Numbers;
  /** m: whether a point is on its path, and no control point. All are, if it is left out. */
  onPath?: readonly boolean[] | Uint8Array;
  /**
   * m: what a point is to its path. 0: on it; 1: the control point of a quadratic curve; 2: one of the two of a cubic curve; 3: a
   * point between two on the path that a circular arc goes through. If it is left out, as `onPath` says: 0 or 1.
   */
  kinds?: readonly number[] | Uint8Array;
  /** n: whether the last point is joined to the first. None is, if it is left out. */
  closed?: readonly boolean[] | Uint8Array;
  /** n: whether the mark is an area. None is, if it is left out. */
  filled?: readonly boolean[] | Uint8Array;
  /** The points, after the first of an area, at which another of its rings begins. */
  rings?: Numbers;
}

/** Derivatives of a loss, each in the order of what it is the derivative by. */
export interface Gradients {
  points: Float32Array;
  widths: Float32Array;
  colors: Float32Array;
  opacities: Float32Array;
  /** By red, green and blue of the background. */
  background: Float32Array;
}

/** Renders marks, and differentiates losses of the picture by all that was drawn. */
export interface Renderer {
  readonly width: number;
  readonly height: number;
  /** The picture: red, green and blue of each pixel, row by row. The background is white if it is left out. */
  render(marks: Marks, background?: Numbers): Float32Array;
  /** The derivatives by all that was drawn last, from the derivatives by the picture. These count to a ten-millionth of the largest. */
  backward(dCanvas: Numbers): Gradients;
  /** Gives its memory back. */
  free(): void;
}

/** A renderer for pictures of `width` × `height` px, for losses of one's own. `softness` is the width of the soft edge, 1.2 px if it
 * is left out; `coverage` is `smoothstep`, `sigmoid`, `tanh`, `atan`, `atan:K` or `raw`. */
export function renderer(
  width: number,
  height: number,
  options?: { softness?: number; coverage?: string },
): Promise<Renderer>;

/** Loads the WebAssembly, which else the first call does: from another place, or a module that is compiled already. */
export function init(source?: URL | string | WebAssembly.Module): Promise<void>;
