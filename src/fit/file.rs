//! The drawing as a written file, and resvg's render of that file.

use rayon::prelude::*;

use super::base::Base;
use super::config::{Background, Config};
use super::drawing::Drawing;
use super::drawing::surface::Surface;
use crate::error::Result;
use crate::image::Image;
use crate::scene::{Quantized, Scene};
use crate::svg::WriteOptions;
use crate::{metrics, verify};

/// Writes the drawing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Writer<'a> {
    base: Option<&'a Base>,
    /// True if the file has a rectangle of the background's colour.
    pub(super) has_background: bool,
    options: WriteOptions,
    /// Size of the picture, px, if the drawing is of a reduced one.
    page: Option<[u32; 2]>,
    /// True if no path may run off the page.
    is_confined: bool,
}

/// A drawing as it is written to a file, and resvg's render of that.
#[derive(Debug, Clone)]
pub(super) struct RenderedFile {
    pub(super) rounded: Quantized,
    /// resvg's renders, one per surface.
    pub(super) drawn: Vec<Image>,
    /// Bytes of SVG.
    pub(super) bytes: usize,
    /// Their mean squared errors.
    pub(super) errors: Vec<f64>,
}

impl RenderedFile {
    /// The mean squared error, on the matte where it is largest.
    pub(super) fn mse(&self) -> f64 {
        self.errors.iter().copied().fold(0.0, f64::max)
    }
}

impl<'a> Writer<'a> {
    pub(super) fn of(config: &Config, base: Option<&'a Base>, page: Option<[u32; 2]>) -> Self {
        let has_background = match base {
            Some(base) => base.document.is_none() && base.scene.background.is_some(),
            None => config.background != Background::None,
        };
        Self {
            base,
            has_background,
            options: config.file,
            page: base.map_or(page, |base| base.scene.page),
            is_confined: config.is_confined(),
        }
    }

    /// Rounds `drawing` to the numbers that its file holds.
    pub(super) fn round(&self, drawing: &Drawing) -> Quantized {
        let scene = Scene {
            page: self.page,
            ..drawing.scene(self.has_background)
        };
        let scene = if self.is_confined {
            scene.confined()
        } else {
            scene
        };
        scene.quantized(self.options.precision)
    }

    /// Bytes of `drawing` as a file.
    pub(super) fn bytes(&self, drawing: &Drawing) -> usize {
        self.text(&self.round(drawing)).len()
    }

    fn text(&self, rounded: &Quantized) -> String {
        Base::write(self.base, &rounded.scene, &self.options)
    }

    /// Rounds and writes `drawing`, and renders the file.
    pub(super) fn render(&self, drawing: &Drawing) -> Result<RenderedFile> {
        let rounded = self.round(drawing);
        let text = self.text(&rounded);
        let render = |surface: &Surface| {
            let image = verify::render_like(&text, surface.picture(), surface.matte)?;
            let mse = metrics::mse(surface.picture(), &image)?;
            Ok((image, mse))
        };
        let rendered: Result<Vec<_>> = drawing.surfaces.par_iter().map(render).collect();
        let (drawn, errors): (Vec<_>, Vec<_>) = rendered?.into_iter().unzip();
        Ok(RenderedFile {
            rounded,
            drawn,
            bytes: text.len(),
            errors,
        })
    }
}
