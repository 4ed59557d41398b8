//! strokefit turns a raster picture into an editable SVG made of *marks*: *strokes*, which are paths with round caps and
//! joins, in one colour, and *areas*, which are outlines filled with a colour or a gradient.
//!
//! It traces what is flat, puts strokes where the drawing then differs most from the picture, improves all by gradient descent
//! through a differentiable renderer, keeps those that pay, and repeats. Then it writes SVG, renders that SVG with
//! resvg, and reports how faithful the file is.
//!
//! # Quick start
//!
//! ```
//! use strokefit::fit::{Budget, Config, Fitter};
//! use strokefit::image::Image;
//!
//! // A dark bar on white.
//! let (width, height) = (48, 24);
//! let bar = |i: usize| (8..40).contains(&(i % width)) && (10..14).contains(&(i / width));
//! let plane: Vec<f32> = (0..width * height).map(|i| if bar(i) { 0.2 } else { 1.0 }).collect();
//! let picture = Image::new(width, height, [plane.clone(), plane.clone(), plane])?;
//!
//! let config = Config { budget: Budget { strokes: Some(4), ..Budget::default() }, ..Config::default() };
//! let drawing = Fitter::new(config).fit(&picture)?;
//! assert!(drawing.svg().starts_with("<svg"));
//!
//! // What it looks like, a character per 2×2 px.
//! let dark = |x: usize, y: usize| drawing.soft.planes()[0][y * width + x] < 0.6;
//! let row = |y: usize| (0..width).step_by(2).map(|x| if dark(x, y) { '#' } else { '.' }).collect::<String>();
//! assert_eq!(row(4), "........................");
//! assert_eq!(row(12), "....################....");
//! # Ok::<(), strokefit::Error>(())
//! ```
//!
//! # Features
//!
//! `default-features = false` builds the library alone: it reads PNG and interleaved rows, fits, writes SVG, judges it and
//! reports. It also builds for `wasm32-unknown-unknown`, where a fit runs on the thread that asks for it.
//!
//! | feature | what it adds | on by default |
//! | --- | --- | --- |
//! | `formats` | pictures other than PNG, colour profiles, and pictures embedded in the SVG of a base | yes |
//! | `animation` | frames and GIF, WebP or PNG files in the module `animation`; needs `formats` | yes |
//! | `cli` | the program and what it alone uses: `engines`, `view`, cut-outs and hatching in [`machine`]; needs the others | yes |
//!
//! # The pipeline
//!
//! Data flows one way. A module imports only from modules above its own:
//!
//! ```text
//! error  words  clock  threads    what went wrong, choices, what a platform may lack
//! math  rng                       points, draws by counter
//! coverage  scene  image          soft edges, drawings, pictures
//! metrics  loss  optim            measures, losses, optimisers
//! restore                         picture → the picture that is meant
//! shading                         smooth blocks of a picture → the gradient that they are of
//! render                          marks → canvas, ∂L/∂canvas → ∂L/∂marks, contributions
//! seed                            residual → candidates, ranked by gain in closed form
//! trace                           residual → areas, and strokes along the lines that are seen
//! outline                         stroke → the rings around it
//! svg                             drawing → SVG text
//! verify                          SVG text → resvg's render of it
//! engines                         other programs' renders of it
//! fit                             stages, polish, restricting, settling, budgets
//! report                          plain records
//! machine                         drawing → cut-outs, hatching, PDF, DXF
//! animation  view                 frames of a drawing, a live page
//! cli                             the command line
//! ```
//!
//! # Glossary
//!
//! Each word means one thing in code, messages and docs. Colours are sRGB-encoded, and channels are 0..1 unless a
//! name says otherwise; lengths are in px of the picture, with pixel centres at +0.5. *Squared error* is summed over
//! pixels and channels.
//!
//! Pictures and drawings:
//!
//! | word | meaning |
//! | --- | --- |
//! | target | the picture to reproduce, with or without alpha |
//! | damage | what a picture has been through and nobody meant, such as noise; see [`restore`] |
//! | doubt | how far the picture that is meant may be from the truth, RMS in levels of 8 bits |
//! | details | letters, dots, thin lines: small things that nothing around hides |
//! | mark | one element of a drawing: a stroke or an area; see [`scene::Mark`] |
//! | stroke | a path drawn with a pen that has round ends or square ones, with a colour and an opacity (0..1); see [`scene::Stroke`] |
//! | area | one or more closed paths, its *rings*, filled where they wind around a point (SVG's nonzero rule), with a colour or a shade and an opacity; see [`scene::Area`] |
//! | band | a line of even width with square ends and mitred corners: the path and the width of a stroke with [`scene::Cap::Butt`]; see [`scene::Band`] |
//! | sweep | a line whose width varies: the path of a stroke and a radius at each of its vertices; see [`scene::Stroke::varying`] |
//! | path | *points*, open or closed: the centre line of a stroke, or a ring; see [`scene::Path`] |
//! | shape | a closed path that is a circle, an ellipse or a rectangle, with an element of its own; see [`scene::Shape`] |
//! | point | of a path: *on* it, joined to the next by a line, or *off* it, where it is the control point of a curve |
//! | capsule | the stroke of two on-points; with equal ends it is a *dot*, the stroke of one point |
//! | scene | the drawing: size (px), background, and marks from back to front, grouped in stages |
//! | stage | marks that are added together: seeded where the residual is largest, fitted with all earlier strokes frozen, kept if they pay |
//! | layer | a group of the SVG, holding the marks of one stage or of one colour |
//! | background | the colour behind all marks; part of the drawing and of the file; absent if the drawing is transparent |
//! | shade | a gradient of an area; see [`scene::Shade`] |
//! | ground | areas on the background, behind all marks, which no fit changes: the gradient of the page, and soft shadows; part of the drawing and of the file |
//! | paint | the shade of an area as the renderer sees it; see [`render::Paint`] |
//! | backdrop | what marks are composited over: a colour or a picture, such as the canvas of frozen strokes |
//! | masking | that detail of the picture hides errors from the eye |
//! | matte | the colour that a transparent picture is flattened onto, to be looked at or measured |
//! | base | the SVG that a fit goes on from |
//! | canvas | the picture that marks render to; see [`render`] |
//! | residual | target − canvas, per channel |
//! | block, tile | 4×4 px and 32×32 px, the units of work of the renderer |
//!
//! Edges:
//!
//! | word | meaning |
//! | --- | --- |
//! | coverage | how much of a pixel a mark covers, 0..1: a soft function of the signed distance; see [`coverage`] |
//! | softness | width of the soft edge (px); it anneals towards the hard edge |
//! | edge | a coverage function with its softness |
//!
//! The fit:
//!
//! | word | meaning |
//! | --- | --- |
//! | candidate | a stroke that seeding proposes, with its best colour and opacity |
//! | region | connected pixels of one colour, antialiased ones with the nearer of the colours beside them; see `trace` |
//! | skeleton | the pixels in the middle of a region, as a graph of nodes and edges |
//! | line | a run of the skeleton that goes straight through crossings; tracing lays a stroke along it |
//! | bridge | the part of a line that another one covers |
//! | gain | squared error that a candidate would remove, in closed form |
//! | contribution | squared error that leaving a stroke out would add, exactly |
//! | price | squared error that a stroke has to remove to stay; it grows with the bytes of the stroke, and rises in a drawing better than its quality |
//! | quality | sets the price: each byte has to remove as much squared error as one pixel has at this many dB |
//! | frozen, free | strokes that are kept as they are; strokes that are fitted |
//! | polish | joint fit of all free strokes |
//! | dense, sparse | of points: how many pixels there are for each that a budget allows; dense ones change the polish |
//! | jitter | differentiating strokes a little beside their places, so that a drawing depends less on antialiasing |
//! | relocation | moving the strokes of least contribution to where candidates gain more, during the polish |
//! | survey | how the squared error depends on the vertices of all strokes, so that the gain of a new point is known |
//! | edit | marks or points in the place of others, with the squared error that it is foreseen to remove and the price of the bytes that it saves; it is made if it pays as rendered |
//! | join | making one stroke of two that look alike and meet end to end |
//! | restrict | to give strokes the colours and widths that the file may have |
//! | settle | last steps against resvg's renders of the written file |
//! | offset | difference between resvg's picture of the file and our own canvas, per channel |
//! | phase | one step in the order of a fit: a stage, the polish, the settling, … |
//! | session | a fit under way: all that its phases hand around |
//! | surface | one matte's target, backdrop and canvas; a drawing has one, a transparent drawing two |
//! | course | how long a descent runs, at what step sizes and with which edge |
//! | snapshot | what a drawing was, to the bit |
//! | aim | what settling descends towards: the target less resvg's offset |
//! | preferred colour | the colour of a stroke that fits best while all other strokes stay as they are |
//! | rehearsal | writing and rendering an unfinished drawing only to learn how long that takes |
//! | plan | how many strokes each stage adds, and their typical radius (px) |
//! | recipe | the tuned numbers that differ between presets: iterations, step sizes, shares |
//! | preset | a named recipe: draft, balanced, best |
//! | budget | limits on strokes, fidelity (dB), bytes and time (s); the first one reached stops |
//! | palette | the 8-bit colours that a drawing may have |
//! | stack | the order of colours, one layer each, that a drawing by colour has |
//! | pen | a colour and a width that many opaque strokes share; where pens are given, a width that strokes may have |
//! | sharing | giving strokes the same widths and colours where that costs little |
//! | tie | holds numbers of strokes equal while they are fitted |
//! | constraints | of shapes, and of lines that are exactly level or upright: they stay such while their points are fitted |
//! | seed | key of all random draws; *seeding* is the search for candidates |
//! | grace | how long a fit that is asked to stop may take to finish its drawing |
//! | kept background | a background that stays although a given palette has nothing like it |
//! | remark | what reading a picture has changed or left out |
//! | checkpoint | a file with the whole state of a fit, from which it goes on to the same bytes |
//! | observer | is told of progress after every iteration, and may stop the fit |
//!
//! The file and its renders:
//!
//! | word | meaning |
//! | --- | --- |
//! | page | the area of an SVG file, in px or in units such as mm |
//! | form | how strokes become elements: one each, the smallest file, classes of a style sheet, outlines |
//! | travel | how far a pen moves between strokes without drawing (px); see [`svg::travel`](fn@svg::travel) |
//! | style | colour, width and opacity of a stroke; strokes of one style may share an element |
//! | dialect | the part of SVG that strokefit writes, and reads as strokes |
//! | fidelity | the file as resvg renders it, against the target: PSNR (dB), SSIM, MSE, L1, SSIMULACRA2 |
//! | agreement | two renders against each other: PSNR (dB) and the largest difference (0..255) |
//! | soft | our own render of the drawing, at the final softness |
//! | shortfall | by how much a renderer's fidelity is below resvg's (dB) |
//! | engine | a program other than resvg that renders SVG: Inkscape, rsvg-convert, Chromium, CairoSVG |
//! | lint | findings in the text of an SVG that engines draw differently |
//! | film | a finished drawing replayed as frames; see [`animation`] |
//! | view | the live page that watches a fit, or shows a drawing |

#![warn(clippy::disallowed_methods)]

pub mod animation;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod clock;
pub mod coverage;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod engines;
mod error;
pub mod fit;
pub mod image;
pub mod loss;
pub mod machine;
pub mod math;
pub mod metrics;
pub mod optim;
mod outline;
pub mod render;
pub mod report;
pub mod restore;
#[doc(hidden)]
pub mod rng;
pub mod scene;
#[doc(hidden)]
pub mod seed;
mod shading;
pub mod svg;
#[doc(hidden)]
pub mod threads;
#[doc(hidden)]
pub mod trace;
pub mod verify;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod view;
mod words;

// The program calls the library by its name, as any other user does.
#[cfg(feature = "cli")]
extern crate self as strokefit;

pub use error::{Error, ErrorKind, Result};
