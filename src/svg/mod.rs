//! Scenes as SVG text and back: [`fn@write`] and [`read`]. The one door of `quick-xml`.
//!
//! The dialect is small on purpose, so that every renderer agrees on it and the file stays easy to
//! edit:
//!
//! ```text
//! <svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="…" width="W" height="H" viewBox="0 0 W H">
//! <rect width="W" height="H" fill="#rrggbb"/>                        the background, if any
//! <g id="stage-1" inkscape:groupmode="layer" inkscape:label="Stage 1" fill="none" stroke-linecap="round">
//! <title>Stage 1: 2 strokes</title>
//! <path d="M1.5 2L30.25 4" stroke="#rrggbb" stroke-width="2.5"/>      a capsule
//! <path d="M1.5 2h0.01" stroke="#rrggbb" stroke-width="8" stroke-opacity="0.502"/>   a dot
//! </g>
//! </svg>
//! ```
//!
//! - One unit is one px of the picture, but in the smallest form. `width` and `height` equal the `viewBox`, unless the page has a
//!   [`Length`] as its width.
//! - In the plain form, strokes end to end of one look are one path, `M1 2L3 4L5 6`, if they are opaque; the layer
//!   then has `stroke-linejoin="round"`.
//! - In the smallest form any strokes of one look that follow each other are one path, `M1 2L3 4M7 8l1 2`, if
//!   they are opaque or do not touch; attributes that neighbours share are on a `<g>` around them; the layer has
//!   the `stroke-width` of most of its elements, colours may be `#rgb`, numbers count the last decimal where that is
//!   shorter, by `transform="scale(0.1)"` on the layer, and [`arrange()`] has put strokes that do not
//!   touch in an order that makes use of all that.
//! - Layers by colour have ids `color-1`, `color-2`, ….
//! - A path's second point is absolute (`L`) or relative (`l`), whichever is shorter.
//! - A dot is a segment of 0.01, because many programs drop a segment of length 0 although the
//!   specification draws it. `h` marks a dot and nothing else. The 0.01 does not follow the
//!   precision of the other numbers: it neither shows nor vanishes at any of them.
//! - `stroke-opacity` is k/255 to 3 decimals, which k survives; it is left out at 1.
//! - Numbers are decimals without exponent; `0.5`, never `.5`.
//! - No dates, no random names: equal scenes give equal bytes.
//!
//! Outlines, [`Form::Outlines`], are closed paths of two lines and two arcs, and circles, with `fill`. They are for
//! other programs: [`read`] refuses them.
//!
//! Reading gives the scene as it was quantised, and arranged by the smallest form or by colour, to the bit:
//!
//! ```
//! use strokefit::scene::{Scene, Shape, Stage, Stroke};
//! use strokefit::svg::{self, WriteOptions};
//!
//! let shape = Shape::capsule([1.25, 2.0].into(), [30.0, 4.0].into());
//! let stroke = Stroke { shape, radius: 1.5, color: [1.0, 0.4, 0.0], opacity: 0.5 };
//! let page = Scene::empty(40, 10, Some([1.0; 3]));
//! let scene = Scene { stages: vec![Stage { strokes: vec![stroke] }], ..page };
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
mod element;
mod lint;
mod options;
mod outline;
mod path;
mod read;
mod write;

pub use animated::{Timing, write_animated};
pub use arrange::arrange;
pub(crate) use dialect::SVG_NAMESPACE;
pub use document::{Document, Placement, page_width};
pub use lint::{Finding, Severity, lint};
pub use options::{Form, Group, Length, WriteOptions};
pub use read::read;
pub use write::{layers, stroke_bytes, write};

#[cfg(test)]
mod tests;
