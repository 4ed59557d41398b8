//! Charts of numbers and sheets of pictures. The one door of `plotters`.
//!
//! Charts become pictures or SVG text; sheets become pictures. The text in pictures is set in a font that is
//! part of the program, so that they look the same on every machine.

mod chart;
mod sheet;

use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

pub use chart::Chart;
pub use sheet::{Panel, Path, Sheet, framed};

use super::picture;
use strokefit::image::Image;
use strokefit::{Error, ErrorKind, Result};

/// The font under a name that viewers of SVG know, too.
const FONT: &str = "monospace";

type Root<'a> = DrawingArea<BitMapBackend<'a>, Shift>;
type Drawn = std::result::Result<(), Box<dyn std::error::Error + Send + Sync>>;

/// Runs `f` on a drawing area that is the picture.
fn draw(image: Image, f: impl FnOnce(&Root<'_>) -> Drawn) -> Result<Image> {
    register()?;
    let (width, height) = (image.width(), image.height());
    let mut rgb = image.to_rgb8();
    {
        let backend = BitMapBackend::with_buffer(&mut rgb, (width as u32, height as u32));
        let root = backend.into_drawing_area();
        f(&root)
            .and_then(|()| Ok(root.present()?))
            .map_err(|cause| undrawn(width, height, cause))?;
    }
    let (pixels, _) = rgb.as_chunks::<3>();
    picture::map(width, pixels, |pixel| {
        pixel.map(|byte| f64::from(byte) / 255.0)
    })
}

/// Makes the font known, once.
fn register() -> Result<()> {
    static KNOWN: OnceLock<bool> = OnceLock::new();
    let known = KNOWN.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, epaint_default_fonts::HACK_REGULAR).is_ok()
    });
    if *known {
        Ok(())
    } else {
        Err(Error::new(
            ErrorKind::Picture,
            "the font of the plots cannot be read",
        ))
    }
}

fn undrawn(width: usize, height: usize, cause: Box<dyn std::error::Error + Send + Sync>) -> Error {
    let message = format!("cannot draw a plot of {width}×{height} px: {cause}");
    Error::new(ErrorKind::Picture, message).caused_by(cause)
}

#[cfg(test)]
fn is_dark(image: &Image, x: std::ops::Range<usize>, y: std::ops::Range<usize>) -> bool {
    let dark = |x, y| image.planes()[0][y * image.width() + x] < 0.5;
    y.into_iter().any(|y| x.clone().any(|x| dark(x, y)))
}
