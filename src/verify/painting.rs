//! From SVG text to pixels: the tree that resvg draws, its raster, and a picture that grows as one SVG after another is
//! drawn over it.

use resvg::tiny_skia::{Color, Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::roxmltree::{self, Document, ParsingOptions};
use resvg::usvg::{Options, Tree};

use super::limits::{self, Embedded};
use super::{Size, guarded, references};
use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, level};
use crate::scene::Rgb;
use crate::svg::SVG_NAMESPACE;

/// Most pixels of a render: the raster takes 4 bytes each, its [`Image`] up to 16 more.
const MAX_PIXELS: f64 = (1_u64 << 27) as f64;

/// Render of the parts drawn so far. Parts of a drawing, drawn one after another, give the picture of the whole to the
/// bit, because a renderer rounds after every stroke.
pub struct Painting {
    pixmap: Pixmap,
    size: Size,
}

impl Painting {
    /// Starts with the SVG text `first` on `matte`.
    ///
    /// # Errors
    /// As [`render`](super::render).
    pub fn new(first: &str, size: Size, matte: Rgb) -> Result<Self> {
        Self::of(&parse(first)?, size, Some(matte))
    }

    /// Starts with a tree on `matte`, or on nothing. Fails when that would cost more memory or time than any honest drawing.
    pub(super) fn of(tree: &Tree, size: Size, matte: Option<Rgb>) -> Result<Self> {
        let ([width, height], transform) = laid(tree, size)?;
        // The larger of both scales makes the estimate an upper bound.
        let scale = f64::from(transform.sx.max(transform.sy));
        limits::check(tree, scale, f64::from(width) * f64::from(height))?;
        let mut pixmap = Pixmap::new(width, height).ok_or_else(|| {
            let message = format!("no memory for a render of {width}×{height} px: scale it down");
            Error::new(ErrorKind::Svg, message)
        })?;
        if let Some(color) = matte {
            let [r, g, b] = color.map(level);
            pixmap.fill(Color::from_rgba8(r, g, b, 255));
        }
        let mut painting = Self { pixmap, size };
        painting.paint(tree)?;
        Ok(painting)
    }

    /// Draws another SVG text, of the same size, over it.
    ///
    /// # Errors
    /// As [`render`](super::render).
    pub fn add(&mut self, svg: &str) -> Result<()> {
        self.paint(&parse(svg)?)
    }

    fn paint(&mut self, tree: &Tree) -> Result<()> {
        let (_, transform) = laid(tree, self.size)?;
        guarded(|| resvg::render(tree, transform, &mut self.pixmap.as_mut()))
    }

    /// The picture so far, with its alpha.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](crate::ErrorKind::Picture) as [`Image::new`].
    pub fn image(&self) -> Result<Image> {
        let pixels = self.pixmap.pixels();
        let plane = |channel: fn(&PremultipliedColorU8) -> u8| {
            let straight = |p: &PremultipliedColorU8| match p.alpha() {
                // Black where nothing is seen.
                0 => 0.0,
                alpha => f32::from(channel(p)) / f32::from(alpha),
            };
            pixels.iter().map(straight).collect()
        };
        let planes = [
            plane(|p| p.red()),
            plane(|p| p.green()),
            plane(|p| p.blue()),
        ];
        let alpha = pixels.iter().map(|p| f32::from(p.alpha()) / 255.0);
        let sides = [self.pixmap.width(), self.pixmap.height()];
        let [width, height] = sides.map(|side| side as usize);
        Image::new(width, height, planes)?.with_alpha(alpha.collect())
    }
}

/// The sides of a render, px, and how the SVG is laid on it.
fn laid(tree: &Tree, size: Size) -> Result<([u32; 2], Transform)> {
    let natural = [tree.size().width(), tree.size().height()].map(f64::from);
    let [width, height] = match size {
        Size::Exact { width, height } => [width, height].map(f64::from),
        Size::Scale(scale) if scale.is_finite() && scale > 0.0 => {
            natural.map(|side| (side * scale).round().max(1.0))
        }
        Size::Scale(scale) => {
            let message = format!("the scale is {scale}: use a number above 0, such as 2");
            return Err(Error::new(ErrorKind::Config, message));
        }
    };
    if width * height > MAX_PIXELS || width < 1.0 || height < 1.0 {
        let message = format!(
            "a render of {width}×{height} px is not possible: choose a size of 1 to {MAX_PIXELS} pixels"
        );
        return Err(Error::new(ErrorKind::Svg, message));
    }
    // The sides are whole px, so an exact size may stretch one axis by a fraction of a px more than the other.
    let (x, y) = match size {
        Size::Exact { .. } => (width / natural[0], height / natural[1]),
        Size::Scale(scale) => (scale, scale),
    };
    let transform = Transform::from_scale(x as f32, y as f32);
    Ok(([width as u32, height as u32], transform))
}

/// Reads SVG text.
pub(super) fn parse(svg: &str) -> Result<Tree> {
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
    let message = "the SVG has more than a million elements, with <use> expanded, or more than 1,024 levels of \
                   nesting, and resvg cannot read it: simplify it";
    Error::new(ErrorKind::Svg, message).caused_by(error)
}

/// resvg ignores elements of other namespaces, and would call the empty page a success.
fn check_namespace(document: &Document<'_>) -> Result<()> {
    let root = document.root_element().tag_name();
    if root.name() == "svg" && root.namespace() == Some(SVG_NAMESPACE) {
        return Ok(());
    }
    let (name, namespace) = (root.name(), root.namespace().unwrap_or_default());
    let message = format!(
        "the root element is <{name}> of the namespace \"{namespace}\", so nothing would be drawn: \
         start the SVG with <svg xmlns=\"{SVG_NAMESPACE}\">"
    );
    Err(Error::new(ErrorKind::Svg, message))
}
