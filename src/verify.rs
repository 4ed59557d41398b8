//! The independent judge: SVG *text* as `resvg` draws it. The one door of usvg, resvg and
//! tiny-skia.
//!
//! Nothing outside the text is ever read: references to files and addresses are not followed, and
//! no fonts are loaded, so text that is not outlines is not drawn. Pictures embedded as `data:`
//! are.
//!
//! ```
//! use strokefit::verify::{self, Size};
//!
//! let stroke = r#"<path d="M4 7L16 3" stroke="black" stroke-width="4" stroke-linecap="round"/>"#;
//! let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10">{stroke}</svg>"#);
//! let picture = verify::render(&text, Size::Scale(1.0), Some([1.0; 3]))?;
//!
//! let dark = |x: usize, y: usize| picture.planes()[0][y * 20 + x] < 0.5;
//! let row = |y| (0..20).map(|x| if dark(x, y) { '#' } else { '.' }).collect::<String>();
//! assert_eq!((1..9).map(row).collect::<Vec<_>>(), [
//!     "..............###...",
//!     "...........#######..",
//!     "........##########..",
//!     ".....############...",
//!     "...############.....",
//!     "..##########........",
//!     "..#######...........",
//!     "...###..............",
//! ]);
//! # Ok::<(), strokefit::Error>(())
//! ```

mod limits;
mod painting;
mod placement;
mod references;

use std::panic::{self, AssertUnwindSafe};

use resvg::tiny_skia::{Color, Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::roxmltree::{self, Document, ParsingOptions};
use resvg::usvg::{Options, Tree};
use serde::{Deserialize, Serialize};

use limits::Embedded;
pub use painting::Painting;

use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::metrics::{self, Agreement, Quality, null_is_infinite};
use crate::scene::Rgb;
use crate::svg::SVG_NAMESPACE;

pub(crate) use placement::placement;

/// Version of resvg that is built in, as far as `Cargo.toml` fixes it.
pub const RESVG_VERSION: &str = "0.49";

/// Most pixels of a render: the raster takes 4 bytes each, its [`Image`] up to 16 more.
const MAX_PIXELS: f64 = (1_u64 << 27) as f64;

const WHITE: Rgb = [1.0; 3];

/// Least agreement, dB, of a drawing that is what was fitted. Ordinary drawings reach 36 to 45: what
/// remains is the 4×4 supersampling of edges and 8-bit compositing. Below this, strokes are missing
/// or misplaced, or hundreds of faint layers have drifted.
pub const MIN_AGREEMENT_DB: f64 = 30.0;

/// How large to render.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// So many px per unit of the SVG's own size.
    Scale(f64),
    /// Exactly so many px, each axis scaled as needed.
    Exact {
        /// Width in px.
        width: u32,
        /// Height in px.
        height: u32,
    },
}

/// What the judge says of a drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The SVG as rendered against the target.
    pub fidelity: Quality,
    /// The SVG as rendered against our own soft render.
    pub agreement: Agreement,
}

impl Verdict {
    /// Whether the SVG is drawn as it was fitted: agreement of [`MIN_AGREEMENT_DB`] or more.
    pub fn agrees(&self) -> bool {
        self.agreement.psnr_db >= MIN_AGREEMENT_DB
    }
}

/// Renders SVG text on `ground`, or with alpha when `None`.
///
/// # Errors
/// [`ErrorKind::Svg`] when the text is no SVG, or its render would have no pixels or more than
/// 128 million; [`ErrorKind::Config`] when the scale is not a positive number.
pub fn render(svg: &str, size: Size, ground: Option<Rgb>) -> Result<Image> {
    draw(&parse(svg)?, size, ground)
}

/// Renders SVG text at the target's size on white and compares it.
///
/// # Errors
/// As [`render`]; also [`ErrorKind::Svg`] when the SVG has another aspect ratio than the target.
pub fn fidelity(svg: &str, target: &Image) -> Result<Quality> {
    Quality::between(target, &render_like(svg, target, WHITE)?)
}

/// Judges SVG text: faithful to `target`, and drawn as in `soft`, our own render of it?
///
/// # Errors
/// As [`fidelity`]; also [`ErrorKind::Picture`] when `soft` and `target` differ in size.
pub fn verify(svg: &str, target: &Image, soft: &Image) -> Result<Verdict> {
    let drawn = render_like(svg, target, WHITE)?;
    Ok(Verdict {
        fidelity: Quality::between(target, &drawn)?,
        agreement: Agreement::between(soft, &drawn)?,
    })
}

/// How faithful a drawing with transparency is wherever it is laid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnGrounds {
    /// PSNR on black, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub black_db: f64,
    /// PSNR on white, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub white_db: f64,
    /// PSNR on magenta, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub magenta_db: f64,
}

/// Renders SVG text on black, on white and on magenta and compares it with `target`, laid on the same.
///
/// # Errors
/// As [`fidelity`].
pub fn on_grounds(svg: &str, target: &Image) -> Result<OnGrounds> {
    let on = |ground: Rgb| -> Result<f64> {
        metrics::psnr(
            &target.flattened(ground),
            &render_like(svg, target, ground)?,
        )
    };
    Ok(OnGrounds {
        black_db: on([0.0; 3])?,
        white_db: on([1.0; 3])?,
        magenta_db: on([1.0, 0.0, 1.0])?,
    })
}

/// A side of a picture as the renderer counts.
fn side(px: usize) -> u32 {
    u32::try_from(px).unwrap_or(u32::MAX)
}

/// Renders SVG text at the size of `target`, on `ground`.
///
/// # Errors
/// As [`fidelity`].
pub fn render_like(svg: &str, target: &Image, ground: Rgb) -> Result<Image> {
    let tree = parse(svg)?;
    let (width, height) = (side(target.width()), side(target.height()));
    check_aspect(&tree, width, height)?;
    draw(&tree, Size::Exact { width, height }, Some(ground))
}

/// Whether scaling the SVG to the target's width misses its height by no more than a px.
fn check_aspect(tree: &Tree, width: u32, height: u32) -> Result<()> {
    let (svg_width, svg_height) = (
        f64::from(tree.size().width()),
        f64::from(tree.size().height()),
    );
    let scaled = svg_height * f64::from(width) / svg_width;
    if (scaled - f64::from(height)).abs() <= 1.0 {
        return Ok(());
    }
    let message = format!(
        "the SVG of {svg_width}×{svg_height} has another aspect ratio than the picture of \
         {width}×{height} px: give the picture it was made from"
    );
    Err(Error::new(ErrorKind::Svg, message))
}

fn parse(svg: &str) -> Result<Tree> {
    let embedded = Embedded::default();
    let options = Options {
        image_href_resolver: embedded.resolver(),
        ..Options::default()
    };
    let unreadable = |e: &dyn std::fmt::Display| {
        Error::new(
            ErrorKind::Svg,
            format!("not an SVG that resvg can read: {e}"),
        )
    };
    let allow_dtd = ParsingOptions {
        allow_dtd: true,
        nodes_limit: limits::MAX_NODES,
        ..ParsingOptions::default()
    };
    let document =
        Document::parse_with_options(svg, allow_dtd).map_err(|e| unreadable(&e).caused_by(e))?;
    check_namespace(&document)?;
    references::check(&document).map_err(limits::refusal)?;
    let tree = guarded(|| Tree::from_xmltree(&document, &options))?;
    let tree = tree.map_err(|e| match e {
        resvg::usvg::Error::ElementsLimitReached
        | resvg::usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => too_much(e),
        e => unreadable(&e).caused_by(e),
    })?;
    embedded.check()?;
    Ok(tree)
}

fn too_much(error: resvg::usvg::Error) -> Error {
    let message = "the SVG has more than a million elements, also counted through <use>, or more than 1,024 \
                   levels of nesting, which resvg does not read: simplify it";
    Error::new(ErrorKind::Svg, message).caused_by(error)
}

/// resvg passes over elements of other namespaces and calls the empty page a success.
fn check_namespace(document: &Document<'_>) -> Result<()> {
    let root = document.root_element().tag_name();
    if root.name() == "svg" && root.namespace() == Some(SVG_NAMESPACE) {
        return Ok(());
    }
    let (name, namespace) = (root.name(), root.namespace().unwrap_or_default());
    let message = format!(
        "the root element is <{name}> of the namespace \"{namespace}\", so nothing would be drawn: \
         an SVG starts with <svg xmlns=\"{SVG_NAMESPACE}\">"
    );
    Err(Error::new(ErrorKind::Svg, message))
}

/// The raster of a render and how the SVG is laid on it.
struct Raster {
    width: u32,
    height: u32,
    transform: Transform,
}

impl Raster {
    fn new(tree: &Tree, size: Size) -> Result<Self> {
        let (natural_width, natural_height) = (
            f64::from(tree.size().width()),
            f64::from(tree.size().height()),
        );
        let (width, height) = match size {
            Size::Exact { width, height } => (f64::from(width), f64::from(height)),
            Size::Scale(scale) if scale.is_finite() && scale > 0.0 => (
                (natural_width * scale).round().max(1.0),
                (natural_height * scale).round().max(1.0),
            ),
            Size::Scale(scale) => {
                let message = format!("the scale is {scale}: give a number above 0, such as 2");
                return Err(Error::new(ErrorKind::Config, message));
            }
        };
        if width * height > MAX_PIXELS || width < 1.0 || height < 1.0 {
            let message = format!(
                "a render of {width}×{height} px is not possible: 1 to {MAX_PIXELS} pixels are"
            );
            return Err(Error::new(ErrorKind::Svg, message));
        }
        let (x, y) = match size {
            Size::Exact { .. } => (width / natural_width, height / natural_height),
            Size::Scale(scale) => (scale, scale),
        };
        Ok(Self {
            width: width as u32,
            height: height as u32,
            transform: Transform::from_scale(x as f32, y as f32),
        })
    }

    /// Fails when drawing would cost more memory or time than any honest drawing.
    fn afford(&self, tree: &Tree) -> Result<()> {
        let scale = f64::from(self.transform.sx.max(self.transform.sy));
        limits::check(tree, scale, f64::from(self.width) * f64::from(self.height))
    }

    fn pixmap(&self) -> Result<Pixmap> {
        Pixmap::new(self.width, self.height).ok_or_else(|| {
            let message = format!(
                "no memory for a render of {}×{} px: scale it down",
                self.width, self.height
            );
            Error::new(ErrorKind::Svg, message)
        })
    }
}

fn draw(tree: &Tree, size: Size, ground: Option<Rgb>) -> Result<Image> {
    let raster = Raster::new(tree, size)?;
    raster.afford(tree)?;
    let mut pixmap = raster.pixmap()?;
    if let Some(color) = ground {
        pixmap.fill(opaque(color));
    }
    guarded(|| resvg::render(tree, raster.transform, &mut pixmap.as_mut()))?;
    image(&pixmap)
}

/// What resvg does, a panic being an error: the judge does not fall with what it judges, and its arithmetic
/// has corners that no check of ours foresees.
fn guarded<R>(judge: impl FnOnce() -> R) -> Result<R> {
    panic::catch_unwind(AssertUnwindSafe(judge)).map_err(|_| {
        let message =
            "resvg cannot draw the SVG, its numbers are too large or too odd: simplify it";
        Error::new(ErrorKind::Svg, message)
    })
}

fn opaque([r, g, b]: Rgb) -> Color {
    let byte = |v: f32| (v * 255.0 + 0.5) as u8;
    Color::from_rgba8(byte(r), byte(g), byte(b), 255)
}

fn image(pixmap: &Pixmap) -> Result<Image> {
    let pixels = pixmap.pixels();
    let plane = |channel: fn(&PremultipliedColorU8) -> u8| {
        pixels
            .iter()
            .map(move |p| straight(channel(p), p.alpha()))
            .collect()
    };
    let planes = [
        plane(|p| p.red()),
        plane(|p| p.green()),
        plane(|p| p.blue()),
    ];
    let image = Image::new(pixmap.width() as usize, pixmap.height() as usize, planes)?;
    image.with_alpha(
        pixels
            .iter()
            .map(|p| f32::from(p.alpha()) / 255.0)
            .collect(),
    )
}

/// A premultiplied channel as a colour 0..1; black where nothing is seen.
fn straight(channel: u8, alpha: u8) -> f32 {
    if alpha == 0 {
        0.0
    } else {
        f32::from(channel) / f32::from(alpha)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Shape, Stage, Stroke};
    use crate::svg::{self, WriteOptions};

    const RED: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2" viewBox="0 0 4 2"><rect width="2" height="2" fill="#ff0000"/></svg>"##;

    fn rgb8(svg: &str, size: Size) -> Vec<u8> {
        render(svg, size, Some([1.0; 3])).unwrap().to_rgb8()
    }

    #[test]
    fn the_version_is_that_of_the_lock_file() {
        let lock = include_str!("../Cargo.lock");
        let entry = format!("name = \"resvg\"\nversion = \"{RESVG_VERSION}.");
        assert!(lock.contains(&entry), "{entry}");
    }

    #[test]
    fn a_render_has_alpha_or_a_ground() {
        let clear = render(RED, Size::Scale(1.0), None).unwrap();
        assert_eq!(
            clear.alpha(),
            Some(&[1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0][..])
        );
        assert_eq!(
            rgb8(RED, Size::Scale(1.0))[..12],
            [255, 0, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255]
        );
    }

    #[test]
    fn a_render_has_the_size_asked_for() {
        let size = |size| {
            let image = render(RED, size, None).unwrap();
            (image.width(), image.height())
        };
        assert_eq!(size(Size::Scale(2.5)), (10, 5));
        assert_eq!(size(Size::Scale(0.01)), (1, 1));
        assert_eq!(
            size(Size::Exact {
                width: 7,
                height: 9
            }),
            (7, 9)
        );
    }

    #[test]
    fn nonsense_scales_and_sizes_are_refused() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = render(RED, Size::Scale(scale), None).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Config);
        }
        let huge = RED
            .replace("width=\"4\"", "width=\"1e9\"")
            .replace("height=\"2\" viewBox", "height=\"1e9\" viewBox");
        let error = render(&huge, Size::Scale(1.0), None).unwrap_err();
        assert!(
            error.to_string().contains("1000000000×1000000000"),
            "{error}"
        );
        assert!(
            render(
                RED,
                Size::Exact {
                    width: 0,
                    height: 1
                },
                None
            )
            .is_err()
        );
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        for text in [
            "",
            "hello",
            "<svg/>",
            "<svg xmlns=\"http://www.w3.org/2000/svg\">",
            "<svg xmlns=\"https://www.w3.org/2000/svg\"/>",
        ] {
            let error = render(text, Size::Scale(1.0), None).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Svg, "{text}");
        }
    }

    #[test]
    fn files_are_never_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("red.png");
        std::fs::write(
            &file,
            Image::filled(4, 2, [1.0, 0.0, 0.0])
                .unwrap()
                .encode_png()
                .unwrap(),
        )
        .unwrap();
        for href in [
            file.display().to_string(),
            format!("file://{}", file.display()),
        ] {
            let svg = format!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><image width="4" height="2" href="{href}"/></svg>"#
            );
            assert_eq!(rgb8(&svg, Size::Scale(1.0)), [255; 24]);
        }
    }

    #[test]
    fn deep_nesting_is_no_crash() {
        let (open, close) = ("<g opacity=\"0.9\">".repeat(5000), "</g>".repeat(5000));
        let svg = RED
            .replace("<rect", &format!("{open}<rect"))
            .replace("</svg>", &format!("{close}</svg>"));
        // Drawn or refused, as resvg sees fit.
        let _ = render(&svg, Size::Scale(1.0), None);
    }

    fn drawing() -> String {
        let stroke = |shape| Stroke {
            shape,
            radius: 3.0,
            color: [0.8, 0.2, 0.4],
            opacity: 1.0,
        };
        let dot = stroke(Shape::dot([30.5, 10.5].into()));
        let line = stroke(Shape::capsule([5.0, 5.0].into(), [20.0, 15.0].into()));
        let page = Scene::empty(40, 20, Some([0.2, 0.4, 0.6]));
        svg::write(
            &Scene {
                stages: vec![Stage {
                    strokes: vec![dot, line],
                }],
                ..page
            },
            &WriteOptions::default(),
        )
    }

    #[test]
    fn the_dialect_is_drawn() {
        let pixels = rgb8(&drawing(), Size::Scale(1.0));
        let at = |x: usize, y: usize| &pixels[3 * (y * 40 + x)..][..3];
        assert_eq!(at(0, 0), [51, 102, 153], "background");
        assert_eq!(at(30, 10), [204, 51, 102], "dot");
        assert_eq!(at(12, 9), [204, 51, 102], "capsule");
    }

    #[test]
    fn a_drawing_agrees_with_its_own_render() {
        let svg = drawing();
        let picture = render(&svg, Size::Scale(1.0), None).unwrap();
        let verdict = verify(&svg, &picture, &picture).unwrap();
        assert_eq!(
            (verdict.fidelity.psnr_db, verdict.agreement.max_abs),
            (f64::INFINITY, 0)
        );
    }

    #[test]
    fn a_drawing_of_something_else_disagrees() {
        let black = Image::filled(40, 20, [0.0; 3]).unwrap();
        assert!(!verify(&drawing(), &black, &black).unwrap().agrees());
    }

    #[test]
    fn another_aspect_ratio_is_refused() {
        let error = fidelity(&drawing(), &Image::filled(20, 20, [0.0; 3]).unwrap()).unwrap_err();
        assert!(
            error.to_string().contains("40×20") && error.to_string().contains("20×20"),
            "{error}"
        );
        assert!(fidelity(&drawing(), &Image::filled(20, 10, [0.0; 3]).unwrap()).is_ok());
    }
}
