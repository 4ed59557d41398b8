//! Writes scenes as SVG text, and reads them back: [`fn@write`] and [`read`]. This module alone uses `quick-xml`.
//!
//! The dialect is small on purpose, so that all renderers agree on it and the file is easy to edit:
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
//! - One unit is one px of the picture, except in the smallest form. `width` and `height` equal the `viewBox`,
//!   unless the page has a [`Length`] as its width.
//! - In the plain form, opaque strokes of equal colour and width that lie end to end are one path,
//!   `M1 2L3 4L5 6`. The layer then has `stroke-linejoin="round"`.
//! - In the smallest form, neighbours of equal colour, width and opacity are one path, `M1 2L3 4M7 8l1 2`,
//!   if they are opaque or do not touch. A `<g>` holds the attributes that neighbours share, and the layer
//!   holds the most common `stroke-width`. Colours may be `#rgb`. Where that is shorter, numbers count units of
//!   the last decimal, and the layer has `transform="scale(0.1)"`. Before, [`arrange()`] reorders strokes
//!   that do not touch so that all this saves the most.
//! - Layers by colour have ids `color-1`, `color-2`, ….
//! - A path's second point is absolute (`L`) or relative (`l`), whichever is shorter.
//! - A dot is a segment of length 0.01, because many programs drop a segment of length 0 although the
//!   specification draws it. `h` marks a dot and nothing else. The 0.01 is independent of the
//!   precision: it is too short to be seen, and no precision rounds it to 0.
//! - `stroke-opacity` is k/255 with 3 decimals, enough to recover k. It is omitted at 1.
//! - Numbers are decimals without exponent; `0.5`, never `.5`.
//! - There are no dates and no random names: equal scenes give equal bytes.
//!
//! [`Form::Outlines`] writes filled outlines: closed paths of two lines and two arcs, and circles. They are for
//! other programs; [`read`] refuses them.
//!
//! Reading returns the scene to the bit as it was written: quantised, and arranged if the form asks for it.
//!
//! ```
//! use strokefit::scene::{Scene, Path, Stage, Stroke};
//! use strokefit::svg::{self, WriteOptions};
//!
//! let path = Path::line([1.25, 2.0].into(), [30.0, 4.0].into());
//! let stroke = Stroke { path, radius: 1.5, color: [1.0, 0.4, 0.0], opacity: 0.5 };
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
