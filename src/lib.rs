//! strokefit turns a raster picture into an editable SVG made of *strokes*: line segments with round
//! caps, which geometry calls capsules.
//!
//! It looks where picture and drawing differ most, puts strokes there, improves them for a moment by
//! gradient descent through a differentiable renderer, keeps what pays, and repeats. Then it writes SVG,
//! renders that SVG with resvg, and says how faithful the file is.
//!
//! # Words
//!
//! | word | meaning |
//! | --- | --- |
//! | target | the picture to reproduce, sRGB-encoded, 0..1 per channel |
//! | stroke | a capsule with a radius (px), a colour (sRGB-encoded) and an opacity; see [`scene`] |
//! | canvas | the picture that strokes render to; see [`render`] |
//! | residual | target − canvas |
//! | coverage | how much of a pixel a stroke covers, a soft function of the signed distance; see [`coverage`] |
//! | softness | width of the soft edge, px; it anneals towards the hard edge |
//! | worth | the squared error that a stroke removes: what leaving it out would add, exactly |
//! | stage | seed where the residual is largest, fit the new strokes alone, accept |
//! | polish | joint fit of all strokes, those worth least moving to where more is to be gained |
//! | fidelity | the SVG as rendered by resvg against the target |
//! | agreement | the SVG as rendered by resvg against our own render |
//!
//! # The pipeline
//!
//! Data flows one way, and a module imports only from those above its own:
//!
//! ```text
//! error  math  rng                what went wrong, points, draws by counter
//! sdf  coverage  scene  image     distances, soft edges, drawings, pictures
//! metrics  loss  optim            how far, how much, which way
//! render                          strokes → canvas, ∂L/∂canvas → ∂L/∂strokes, worth
//! seed                            residual → candidates ranked by closed-form gain
//! svg  verify                     drawing → text → what a renderer makes of it
//! engines  browser                what other programs make of it
//! fit                             stages, polish, settling, budgets
//! report                          plain records, tables, plots
//! animation  view                 frames of a drawing, a page that watches a fit
//! lab  bench                      experiments, measurements
//! ```
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

pub mod animation;
pub mod bench;
pub mod browser;
pub mod coverage;
pub mod engines;
mod error;
pub mod fit;
pub mod image;
pub mod lab;
pub mod loss;
pub mod math;
pub mod metrics;
pub mod optim;
pub mod render;
pub mod report;
pub mod rng;
pub mod scene;
pub mod sdf;
pub mod seed;
pub mod svg;
pub mod verify;
pub mod view;

pub use error::{Error, ErrorKind, Result};
