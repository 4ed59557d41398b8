//! The raster of a render: its size, its pixels, and how the SVG is scaled onto it.

use resvg::tiny_skia::{Color, Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::Tree;

use super::{Size, guarded, limits};
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::scene::Rgb;

/// Most pixels of a render: the raster takes 4 bytes each, its [`Image`] up to 16 more.
const MAX_PIXELS: f64 = (1_u64 << 27) as f64;

/// Draws the tree on `matte`, or on nothing.
pub(super) fn draw(tree: &Tree, size: Size, matte: Option<Rgb>) -> Result<Image> {
    let raster = Raster::new(tree, size)?;
    raster.afford(tree)?;
    let mut pixmap = raster.pixmap()?;
    if let Some(color) = matte {
        pixmap.fill(opaque(color));
    }
    guarded(|| resvg::render(tree, raster.transform, &mut pixmap.as_mut()))?;
    image(&pixmap)
}

/// The raster of a render and how the SVG is laid on it.
pub(super) struct Raster {
    width: u32,
    height: u32,
    pub(super) transform: Transform,
}

impl Raster {
    pub(super) fn new(tree: &Tree, size: Size) -> Result<Self> {
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
        // The larger of both scales makes the estimate an upper bound.
        let scale = f64::from(self.transform.sx.max(self.transform.sy));
        limits::check(tree, scale, f64::from(self.width) * f64::from(self.height))
    }

    pub(super) fn pixmap(&self) -> Result<Pixmap> {
        Pixmap::new(self.width, self.height).ok_or_else(|| {
            let message = format!(
                "no memory for a render of {}×{} px: scale it down",
                self.width, self.height
            );
            Error::new(ErrorKind::Svg, message)
        })
    }
}

/// The colour as tiny-skia has it.
pub(super) fn opaque([r, g, b]: Rgb) -> Color {
    let byte = |v: f32| (v * 255.0 + 0.5) as u8;
    Color::from_rgba8(byte(r), byte(g), byte(b), 255)
}

/// Picture of the pixmap, with its alpha.
pub(super) fn image(pixmap: &Pixmap) -> Result<Image> {
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
