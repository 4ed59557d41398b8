//! Limits on the cost of drawing an SVG, checked before it is drawn.
//!
//! A few lines of SVG can ask for more memory and time than any machine has: pictures that unpack to
//! terabytes, layers within layers, patterns of patterns. The cost of a tree is estimated from the bounding
//! boxes of its parts, as a number of pixels written, and the estimate stops as soon as it exceeds the limit.

use std::sync::{Arc, Mutex, PoisonError};

use resvg::tiny_skia::Rect;
use resvg::usvg::filter::Kind;
use resvg::usvg::{ClipPath, Group, ImageHrefResolver, ImageKind, Mask, Node, Paint, Path, Tree};

use crate::error::{Error, ErrorKind, Result};
use crate::image;

/// Most nodes of the XML: twice what resvg reads as elements, and the text between them.
pub(super) const MAX_NODES: u32 = 4_000_000;
/// Most pixels of all embedded pictures together.
const MAX_EMBEDDED: u64 = 1 << 26;
/// Most pixels of layers that are there at the same time, 4 bytes each.
const MAX_LAYERED: f64 = (1_u64 << 28) as f64;
/// Most pixels written in all; an ordinary drawing stays below a hundredth.
const MAX_WRITTEN: f64 = (1_u64 << 35) as f64;
/// Largest side of a part, in pixels. Beyond it tiny-skia, which reckons in fixed point, may hang or panic.
const MAX_SIDE: f64 = (1_u64 << 20) as f64;
/// Cost of the smallest part, in pixels.
const LEAST: f64 = 256.0;

/// Pixels that the pictures embedded in an SVG ask for, and why one was refused.
#[derive(Debug, Clone, Default)]
pub(super) struct Embedded(Arc<Mutex<(u64, Option<String>)>>);

impl Embedded {
    /// Accepts pictures in `data:` addresses while their pixels fit the limit. Nothing else is read.
    pub(super) fn resolver(&self) -> ImageHrefResolver<'static> {
        let embedded = self.clone();
        ImageHrefResolver {
            resolve_data: Box::new(move |_, data, _| embedded.admit(data)),
            resolve_string: Box::new(|_, _| None),
        }
    }

    fn admit(&self, data: Arc<Vec<u8>>) -> Option<ImageKind> {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !cfg!(feature = "formats") {
            seen.1 = Some(
                "an embedded picture is drawn only by a build with the feature `formats`".into(),
            );
            return None;
        }
        let Some((format, width, height)) = image::stated_size(&data) else {
            seen.1 = Some("an embedded picture is not a PNG, JPEG, GIF or WebP".into());
            return None;
        };
        // The sum over all pictures counts: many small ones cost as much as a large one.
        seen.0 = seen.0.saturating_add(u64::from(width) * u64::from(height));
        if seen.0 > MAX_EMBEDDED {
            seen.1 = Some(format!(
                "the embedded pictures have more than {MAX_EMBEDDED} pixels (one has {width}×{height})"
            ));
            return None;
        }
        match format {
            "png" => Some(ImageKind::PNG(data)),
            "jpeg" => Some(ImageKind::JPEG(data)),
            "gif" => Some(ImageKind::GIF(data)),
            _ => Some(ImageKind::WEBP(data)),
        }
    }

    /// Fails when a picture was not let through.
    pub(super) fn check(&self) -> Result<()> {
        let seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &seen.1 {
            Some(reason) => Err(refusal(reason)),
            None => Ok(()),
        }
    }
}

/// Fails when drawing `tree`, `scale` px per unit, on a raster of `pixels` would cost too much.
pub(super) fn check(tree: &Tree, scale: f64, pixels: f64) -> Result<()> {
    let mut reckoning = Reckoning {
        area: scale * scale,
        pixels,
        layered: pixels,
        written: 0.0,
    };
    reckoning.group(tree.root()).map_err(refusal)
}

pub(super) fn refusal(reason: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Svg, format!("{reason}: simplify the SVG"))
}

/// The cost of the parts visited so far.
struct Reckoning {
    /// Pixels in a square of side 1 of the SVG.
    area: f64,
    /// Pixels of the raster.
    pixels: f64,
    /// Pixels of the layers that are open.
    layered: f64,
    /// Pixels written.
    written: f64,
}

type Reckoned = std::result::Result<(), &'static str>;

impl Reckoning {
    fn group(&mut self, group: &Group) -> Reckoned {
        if !group.should_isolate() {
            // Drawn straight onto the layer below: no memory of its own.
            return group.children().iter().try_for_each(|node| self.node(node));
        }
        let layer = self.seen(group.abs_layer_bounding_box().to_rect())?;
        self.layer(layer, |this| {
            group
                .children()
                .iter()
                .try_for_each(|node| this.node(node))?;
            for filter in group.filters() {
                for primitive in filter.primitives() {
                    this.filter(layer, primitive.kind())?;
                }
            }
            group.clip_path().map_or(Ok(()), |clip| this.clip(clip))?;
            group.mask().map_or(Ok(()), |mask| this.mask(mask))
        })
    }

    fn node(&mut self, node: &Node) -> Reckoned {
        match node {
            Node::Group(group) => self.group(group),
            Node::Path(path) => self.path(path),
            Node::Image(image) => {
                let seen = self.seen(image.abs_bounding_box())?;
                self.write(seen)
            }
            Node::Text(text) => self.group(text.flattened()),
        }
    }

    fn path(&mut self, path: &Path) -> Reckoned {
        // A path costs its box, at most, and its points, which count even where nothing shows.
        let points = path.data().points().len() as f64;
        let seen = self.seen(path.abs_stroke_bounding_box())?;
        self.write(seen + points)?;
        let fill = path.fill().map(|fill| fill.paint());
        let stroke = path.stroke().map(|stroke| stroke.paint());
        for paint in fill.into_iter().chain(stroke) {
            if let Paint::Pattern(pattern) = paint {
                let size = pattern.rect().width() * pattern.rect().height();
                // Patterns are drawn at the size that they have, seen or not.
                let tile = f64::from(size) * self.area;
                self.layer(tile, |this| this.group(pattern.root()))?;
            }
        }
        Ok(())
    }

    fn clip(&mut self, clip: &ClipPath) -> Reckoned {
        self.layer(self.pixels, |this| {
            this.group(clip.root())?;
            clip.clip_path().map_or(Ok(()), |clip| this.clip(clip))
        })
    }

    fn mask(&mut self, mask: &Mask) -> Reckoned {
        self.seen(mask.rect().to_rect())?;
        self.layer(2.0 * self.pixels, |this| {
            this.group(mask.root())?;
            mask.mask().map_or(Ok(()), |mask| this.mask(mask))
        })
    }

    /// A filter's step over a layer of so many pixels.
    fn filter(&mut self, layer: f64, kind: &Kind) -> Reckoned {
        let window = |x: f32, y: f32| {
            // Each pixel looks at a window whose radius grows with the scale of the render.
            let side = |radius: f32| 1.0 + 2.0 * f64::from(radius) * self.area.sqrt();
            side(x) * side(y)
        };
        let per_pixel = match kind {
            Kind::Morphology(m) => window(m.radius_x().get(), m.radius_y().get()),
            Kind::ConvolveMatrix(m) => {
                f64::from(m.matrix().columns()) * f64::from(m.matrix().rows())
            }
            Kind::Turbulence(t) => 16.0 * f64::from(t.num_octaves()),
            _ => 8.0,
        };
        if let Kind::Image(image) = kind {
            self.group(image.root())?;
        }
        self.layer(2.0 * layer, |this| this.write(layer * per_pixel))
    }

    /// Counts a further layer of so many pixels, and the work `inside` it.
    fn layer(&mut self, pixels: f64, inside: impl FnOnce(&mut Self) -> Reckoned) -> Reckoned {
        self.layered += pixels;
        if self.layered > MAX_LAYERED {
            return Err("its layers, masks and patterns need more than a GiB of memory at once");
        }
        self.write(pixels)?;
        inside(self)?;
        // The layer is merged and freed, so that layers one after another don't add up.
        self.layered -= pixels;
        Ok(())
    }

    fn write(&mut self, pixels: f64) -> Reckoned {
        self.written += pixels + LEAST;
        // Compared this way round so that NaN is refused, too.
        if self.written <= MAX_WRITTEN {
            Ok(())
        } else {
            Err("drawing it takes more than 2^35 writes of pixels")
        }
    }

    /// Pixels of the part of a box that can be seen, at most.
    fn seen(&self, bounds: Rect) -> Result<f64, &'static str> {
        let ends = [bounds.left(), bounds.top(), bounds.right(), bounds.bottom()];
        let scale = self.area.sqrt();
        // Negated as a whole so that NaN is refused, too.
        if !ends
            .iter()
            .all(|&end| f64::from(end).abs() * scale <= MAX_SIDE)
        {
            return Err("a part of it extends more than 2^20 pixels beyond the page");
        }
        // The box may be larger than the page; the renderer clips it.
        let area = f64::from(bounds.width()) * f64::from(bounds.height()) * self.area;
        Ok(area.min(self.pixels))
    }
}
