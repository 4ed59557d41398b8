//! The independent judge: SVG *text* as `resvg` draws it. The one door of usvg and resvg.
//!
//! Nothing outside the text is ever read. References to files and addresses are not followed. No fonts are
//! loaded, so text is drawn only where it is outlines. Pictures embedded as `data:` are drawn in a build with
//! the feature `formats`.
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

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};

use resvg::usvg::Tree;
use serde::{Deserialize, Serialize};

pub use painting::Painting;
use painting::parse;

use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::metrics::{self, Agreement, Quality, null_is_infinite};
use crate::scene::Rgb;

pub(crate) use placement::placement;

/// Version of resvg that is built in, as far as `Cargo.toml` fixes it.
pub const RESVG_VERSION: &str = "0.49";

const WHITE: Rgb = [1.0; 3];

/// Least agreement, dB, of a drawing that is what was fitted. Ordinary drawings reach 36 to 45: what
/// remains is the 4×4 supersampling of edges and 8-bit compositing. Below this, strokes are missing
/// or misplaced, or hundreds of faint layers have drifted.
pub const MIN_AGREEMENT_DB: f64 = 30.0;

/// Size of a render.
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

/// Fidelity of a drawing, and its agreement with our own render.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The SVG as rendered against the target.
    pub fidelity: Quality,
    /// The SVG as rendered against our own soft render.
    pub agreement: Agreement,
}

impl Verdict {
    /// True if the SVG is drawn as it was fitted: agreement of [`MIN_AGREEMENT_DB`] or more, and no gap.
    pub fn agrees(&self) -> bool {
        self.agreement.psnr_db >= MIN_AGREEMENT_DB && !self.agreement.has_gap()
    }
}

/// Renders SVG text on `matte`; with alpha when that is `None`.
///
/// # Errors
/// [`ErrorKind::Svg`] when the text is no SVG, or its render would have no pixels or more than
/// 128 million; [`ErrorKind::Config`] when the scale is not a positive number.
pub fn render(svg: &str, size: Size, matte: Option<Rgb>) -> Result<Image> {
    Painting::of(&parse(svg)?, size, matte)?.image()
}

/// Renders SVG text at the target's size on white and compares it.
///
/// # Errors
/// As [`render`]; also [`ErrorKind::Svg`] when the SVG has another aspect ratio than the target.
pub fn fidelity(svg: &str, target: &Image) -> Result<Quality> {
    Quality::between(target, &render_like(svg, target, WHITE)?)
}

/// Judges SVG text on `matte`: faithful to `target`, and drawn as in `soft`, our own render of it?
///
/// # Errors
/// As [`fidelity`]; also [`ErrorKind::Picture`] when `soft` and `target` differ in size.
pub fn verify(svg: &str, target: &Image, soft: &Image, matte: Rgb) -> Result<Verdict> {
    let drawn = render_like(svg, target, matte)?;
    Ok(Verdict {
        fidelity: Quality::between(target, &drawn)?,
        agreement: Agreement::between(soft, &drawn)?,
    })
}

/// Fidelity of a drawing with transparency on each of three mattes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnMattes {
    /// PSNR on black, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub black_db: f64,
    /// PSNR on white, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub white_db: f64,
    /// PSNR on magenta, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub magenta_db: f64,
    /// SSIMULACRA2 on black.
    pub black_ssimulacra2: f64,
    /// SSIMULACRA2 on white.
    pub white_ssimulacra2: f64,
    /// SSIMULACRA2 on magenta.
    pub magenta_ssimulacra2: f64,
}

/// Renders SVG text on black, white and magenta, and compares it with `target` on the same matte.
///
/// # Errors
/// As [`fidelity`].
pub fn on_mattes(svg: &str, target: &Image) -> Result<OnMattes> {
    // On a single matte a wrong alpha can hide: a colour that equals the matte looks clear. Magenta, unlike the other two, differs
    // between channels.
    let on = |matte: Rgb| -> Result<(f64, f64)> {
        let (target, drawn) = (target.flattened(matte), render_like(svg, target, matte)?);
        let psnr_db = metrics::psnr(&target, &drawn)?;
        Ok((psnr_db, metrics::ssimulacra2(&target, &drawn)?))
    };
    let (black_db, black_ssimulacra2) = on([0.0; 3])?;
    let (white_db, white_ssimulacra2) = on([1.0; 3])?;
    let (magenta_db, magenta_ssimulacra2) = on([1.0, 0.0, 1.0])?;
    Ok(OnMattes {
        black_db,
        white_db,
        magenta_db,
        black_ssimulacra2,
        white_ssimulacra2,
        magenta_ssimulacra2,
    })
}

/// A side of a picture as the renderer counts.
fn side(px: usize) -> u32 {
    u32::try_from(px).unwrap_or(u32::MAX)
}

/// Renders SVG text at the size of `target`, on `matte`.
///
/// # Errors
/// As [`fidelity`].
pub fn render_like(svg: &str, target: &Image, matte: Rgb) -> Result<Image> {
    let tree = parse(svg)?;
    let (width, height) = (side(target.width()), side(target.height()));
    check_aspect(&tree, width, height)?;
    Painting::of(&tree, Size::Exact { width, height }, Some(matte))?.image()
}

/// Checks that scaling the SVG to the target's width misses its height by no more than a px.
fn check_aspect(tree: &Tree, width: u32, height: u32) -> Result<()> {
    let (svg_width, svg_height) = (
        f64::from(tree.size().width()),
        f64::from(tree.size().height()),
    );
    // A px of slack, because both sides of a picture are rounded.
    let scaled = svg_height * f64::from(width) / svg_width;
    if (scaled - f64::from(height)).abs() <= 1.0 {
        return Ok(());
    }
    let message = format!(
        "the SVG ({svg_width}×{svg_height}) and the picture ({width}×{height} px) differ in aspect ratio: \
         give the picture that the SVG was made from"
    );
    Err(Error::new(ErrorKind::Svg, message))
}

/// Runs resvg, and turns its panic into an error: no SVG may bring the judge down, and resvg's arithmetic
/// has corners that no check of ours foresees. Where panics end the program, as in WebAssembly, this one does, too.
fn guarded<R>(judge: impl FnOnce() -> R) -> Result<R> {
    // The flag is per thread: panics of other threads, at the same time, still reach the hook.
    GUARDED.set(true);
    let outcome = panic::catch_unwind(AssertUnwindSafe(judge));
    GUARDED.set(false);
    outcome.map_err(|_| {
        let message =
            "resvg cannot draw the SVG, because its numbers are too large or too extreme: simplify it";
        Error::new(ErrorKind::Svg, message)
    })
}

thread_local! {
    /// True while this thread runs resvg.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Keeps the process's panic hook from reporting panics of resvg, which are errors here. For programs: a library
/// leaves the hook as it is.
pub fn silence_panics() {
    let others = panic::take_hook();
    panic::set_hook(Box::new(move |what| {
        if !GUARDED.get() {
            others(what);
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cap, Path, Scene, Stage, Stroke};
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
    fn a_render_has_alpha_or_a_matte() {
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
        let stroke = |path| Stroke {
            path,
            radius: 3.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.8, 0.2, 0.4],
            opacity: 1.0,
        };
        let dot = stroke(Path::dot((30.5, 10.5).into()));
        let line = stroke(Path::line((5.0, 5.0).into(), (20.0, 15.0).into()));
        let page = Scene::empty(40, 20, Some([0.2, 0.4, 0.6]));
        svg::write(
            &Scene {
                stages: vec![Stage::from_iter([dot, line])],
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
        let verdict = verify(&svg, &picture, &picture, WHITE).unwrap();
        assert_eq!(
            (verdict.fidelity.psnr_db, verdict.agreement.max_abs),
            (f64::INFINITY, 0)
        );
    }

    #[test]
    fn a_drawing_of_something_else_disagrees() {
        let black = Image::filled(40, 20, [0.0; 3]).unwrap();
        assert!(!verify(&drawing(), &black, &black, WHITE).unwrap().agrees());
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
