//! The drawing as it is written to a file, and resvg's render of that.

use super::base::Base;
use super::config::{Background, Config};
use super::drawing::Drawing;
use crate::error::Result;
use crate::image::Image;
use crate::scene::Quantized;
use crate::svg::WriteOptions;
use crate::{metrics, verify};

/// How the drawing is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Writer<'a> {
    base: Option<&'a Base>,
    /// Whether the file has a rectangle of the background's colour.
    pub(super) has_background: bool,
    options: WriteOptions,
}

/// A drawing as it is written to a file, and resvg's render of that.
#[derive(Debug, Clone)]
pub(super) struct RenderedFile {
    pub(super) rounded: Quantized,
    /// resvg's renders, one per surface.
    pub(super) drawn: Vec<Image>,
    /// Bytes of SVG.
    pub(super) bytes: usize,
    /// The mean squared error, on the matte where it is largest.
    pub(super) mse: f64,
}

impl<'a> Writer<'a> {
    pub(super) fn of(config: &Config, base: Option<&'a Base>) -> Self {
        let has_background = match base {
            Some(base) => base.document.is_none() && base.scene.background.is_some(),
            None => config.background != Background::None,
        };
        Self {
            base,
            has_background,
            options: config.file,
        }
    }

    /// Rounds `drawing` to the numbers that its file holds.
    pub(super) fn round(&self, drawing: &Drawing) -> Quantized {
        let scene = drawing.scene(self.has_background);
        scene.quantized(self.options.precision)
    }

    /// Rounds and writes `drawing`, and renders the file.
    pub(super) fn render(&self, drawing: &Drawing) -> Result<RenderedFile> {
        let rounded = self.round(drawing);
        let text = Base::write(self.base, &rounded.scene, &self.options);
        let (mut drawn, mut mse) = (Vec::new(), 0.0_f64);
        for surface in &drawing.surfaces {
            let image = verify::render_like(&text, surface.picture(), surface.matte)?;
            mse = mse.max(metrics::mse(surface.picture(), &image)?);
            drawn.push(image);
        }
        Ok(RenderedFile {
            rounded,
            bytes: text.len(),
            drawn,
            mse,
        })
    }
}
