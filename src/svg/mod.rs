//! Writes scenes as SVG text, and reads them back: [`fn@write`] and [`read`]. This module alone uses `quick-xml` and
//! `svgtypes`.
//!
//! The dialect is small on purpose, so that all renderers agree on it and the file is easy to edit:
//!
//! ```text
//! <svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="…" width="W" height="H" viewBox="0 0 W H">
//! <rect width="W" height="H" fill="#rrggbb"/>                        the background, if any
//! <radialGradient id="shade" gradientUnits="userSpaceOnUse" cx="9" cy="9" r="8.5"><stop offset="0" stop-color="#rrggbb"/>
//! <stop offset="1" stop-color="#rrggbb" stop-opacity="0"/></radialGradient>              the shade, if any, on one line
//! <rect width="W" height="H" fill="url(#shade)"/>
//! <filter id="blur-1" …><feGaussianBlur stdDeviation="6"/></filter><path id="shadow-1" filter="url(#blur-1)" d="…" fill="#rrggbb"/>
//! <g id="stage-1" inkscape:groupmode="layer" inkscape:label="Stage 1" fill="none" stroke-linecap="round">
//! <title>Stage 1: 2 strokes</title>
//! <path d="M1.5 2L30.25 4" stroke="#rrggbb" stroke-width="2.5"/>      a capsule
//! <path d="M1.5 2h0.01" stroke="#rrggbb" stroke-width="8" stroke-opacity="0.502"/>   a dot
//! <path d="M1 2L3 4 9 8Q12 9 12 6T15 3z" stroke="#rrggbb" stroke-width="2.5"/>   a closed path of lines and curves
//! <path d="M20 20h9v5q-3 4-9 0zm2 1v2h3V21z" fill="#rrggbb"/>         an area of two rings, the second a hole
//! <circle cx="60" cy="20" r="8.5" fill="#rrggbb"/>                    an area or a stroke of a shape
//! <path d="…" fill="#rrggbb" strokefit:line="M1 2L9 5" strokefit:widths="0 4.5"/>    a stroke whose width varies
//! </g>
//! </svg>
//! ```
//!
//! - One unit is one px of the picture, except in the smallest form. `width` and `height` equal the `viewBox`,
//!   unless the page has a [`Length`] as its width.
//! - The shade is a `linearGradient` from `x1 y1` to `x2 y2` or a `radialGradient`, in px to the hundredth, with offsets to the
//!   thousandth. It is never in the unit of a layer, and has as many decimals with any precision.
//! - Shadows, areas with a blur, lie on the shade and below all layers, each on one line with its filter. Their numbers are in
//!   px, too, to the tenth, and those of the blur to the hundredth.
//! - A path with a `fill` is an area, and all its rings are closed; any other path is a stroke. None is both.
//! - A stroke whose width varies ([`Stroke::varying`](crate::scene::Stroke::varying)) is a path with a `fill`, too. Its `d` is the
//!   outline, `strokefit:line` its centre line, and `strokefit:widths` the full width at each vertex of that. Other programs ignore both. The
//!   outline follows from them to the last digit; where another program has changed it, the path is read as the area that is seen.
//!   The layer declares the prefix. It shares no element with others.
//! - In the form `powerstroke`, such a path also has `inkscape:original-d` and `inkscape:path-effect`, the id of Inkscape's live effect
//!   before it, `<defs><inkscape:path-effect effect="powerstroke" …/></defs>`. There Inkscape edits the line and its widths.
//! - What is a [`Shape`](crate::scene::Shape) is a `<circle>`, an `<ellipse>`, or a `<rect>` whose corners are sharp or, with
//!   `rx`, round. A line stays a path: Inkscape has no handles for a `<line>`, which takes 16 bytes more.
//! - A path with `stroke-linecap="butt"`, and with `stroke-linejoin="miter"` where it has a corner, is a
//!   stroke with [`Cap::Butt`](crate::scene::Cap::Butt). It shares no element with others. A
//!   layer with no other stroke has neither of these attributes, nor do its bands: CairoSVG takes no `butt` inside of `round`.
//! - Each `M` begins a stroke or a ring, `L` draws lines, `Q` and `T` quadratic curves, `C` and `S` cubic ones, `A` arcs of
//!   circles, and `z` closes a path. In areas, and only there, `H` and `V` draw horizontal and vertical lines. The numbers of a
//!   step are absolute or, after a small letter, relative, whichever is shorter. A step has no letter of its own if the last
//!   one serves and nothing gets longer, but never after `M`.
//! - `T` draws a curve whose control point mirrors the last one. So a run of off-points takes one pair of numbers for
//!   each, and one more at its end: the on-points that they imply are in the file, and off-points are rounded so
//!   that these are exact.
//! - `S` draws a cubic curve whose first control point mirrors the second one of the curve before.
//! - An arc, `A r r 0 large sweep x y`, goes through the point halfway that its radius and flags give exactly. So an arc is
//!   rounded to a radius of as many decimals; where none is near, as beside half circles, its halves are, and a very flat one
//!   is a cubic curve. Of a half circle the radius is half the chord, or fewer px, which SVG enlarges.
//! - A quadratic curve that turns back within 0.02 px is written as two lines, and a cubic one as two curves, because Cairo
//!   leaves a half of it out.
//! - The layer has `stroke-linejoin="round"` if a stroke in it has a join, and none of these attributes if it has only
//!   areas.
//! - In the smallest form, neighbouring strokes of equal colour, width and opacity are one path, `M1 2L3 4M7 8l1 2`,
//!   if they are opaque or do not touch. A `<g>` holds the attributes that neighbours share, and the layer
//!   holds the most common `stroke-width`. Colours may be `#rgb`. Where that is shorter, numbers count units of
//!   the last decimal, and the layer has `transform="scale(0.1)"`. Before, [`arrange()`] reorders strokes
//!   that do not touch so that all this saves the most.
//! - In the form `css`, a `<style>` comes first, with rules for single classes, `.red{fill:#rrggbb}`, `.red-line{stroke:#rrggbb}`,
//!   `.width-1{stroke-width:2.5}` and `.background{fill:#rrggbb}`, one a line. An element has a `class` in the place of these
//!   attributes. A reader takes the properties of an element's classes for its attributes, and none may come twice.
//! - With an order of little travel, strokes of a layer change places where the picture stays the same, and may be
//!   reversed; [`fn@travel`] says how far a pen moves. Labels of layers by colour then begin with their number, `1 #rrggbb`.
//! - Layers by colour have ids `color-1`, `color-2`, ….
//! - A dot is a segment of length 0.01, because many programs drop a segment of length 0 although the
//!   specification draws it. Among strokes, `h` marks a dot and nothing else. The 0.01 is independent of the
//!   precision: it is too short to be seen, and no precision rounds it to 0.
//! - `stroke-opacity` or `fill-opacity` is k/255 with 3 decimals, enough to recover k. It is omitted at 1.
//! - Numbers are decimals without exponent; `0.5`, never `.5`.
//! - There are no dates and no random names: equal scenes give equal bytes.
//!
//! [`Form::Outlines`] writes the filled outline of each stroke: a circle, two lines and two arcs, or an area. [`read`] takes
//! all of them for areas. Areas stay as they are.
//!
//! A path with any other step (an arc of an ellipse, a `T` after a line, an `S` after a `Q`) is not of this dialect, and
//! neither is one of more than [`MAX_POINTS`](crate::scene::MAX_POINTS) points: [`read`] refuses the file, and a [`Document`]
//! keeps it as it is, below new strokes. Reading leaves out points without effect: points that coincide, and on-points
//! exactly halfway between two off-points.
//!
//! Reading returns the scene to the bit as it was written: quantised, and arranged if the form asks for it. It takes numbers,
//! steps and opaque colours in any spelling of SVG.
//!
//! ```
//! use strokefit::scene::{Cap, Scene, Path, Stage, Stroke};
//! use strokefit::svg::{self, WriteOptions};
//!
//! let path = Path::line((1.25, 2.0).into(), (30.0, 4.0).into());
//! let stroke = Stroke { path, radius: 1.5, radii: Vec::new(), cap: Cap::Round, color: [1.0, 0.4, 0.0], opacity: 0.5 };
//! let page = Scene::empty(40, 10, Some([1.0; 3]));
//! let scene = Scene { stages: vec![Stage::from_iter([stroke])], ..page };
//!
//! let text = svg::write(&scene, &WriteOptions::default());
//! assert!(text.contains(r##"<path d="M1.25 2L30 4" stroke="#ff6600" stroke-width="3" stroke-opacity="0.502"/>"##));
//! assert_eq!(svg::read(&text)?, scene.quantized(2).scene);
//! # Ok::<(), strokefit::Error>(())
//! ```

mod animated;
mod arrange;
mod dialect;
mod document;
mod dom;
mod element;
mod gradient;
mod layer;
mod lint;
mod names;
mod objects;
mod options;
mod outline;
mod path;
mod read;
mod shape;
mod sheet;
mod sweep;
mod tour;
mod travel;
mod write;

pub use animated::{Timing, write_animated};
pub use arrange::arrange;
pub(crate) use dialect::SVG_NAMESPACE;
pub use document::{Document, Placement, page_width};
pub use lint::{Finding, Severity, lint};
pub(crate) use options::opaque_color;
pub use options::{Form, Group, Length, Order, WriteOptions};
pub use read::read;
pub use travel::{LayerTravel, Travel, travel};
pub use write::{layers, mark_bytes, write};

#[cfg(test)]
mod tests;
