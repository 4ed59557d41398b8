//! The drawing as its files hold it: as it was fitted, or made for a machine from that.

use std::borrow::Cow;

use anyhow::Result;
use strokefit::machine::{self, Hatch, Sheet};
use strokefit::report::Judged;
use strokefit::scene::{MIN_WIDTH, Scene};
use strokefit::svg::{self, Form, Group, WriteOptions};

use super::drawing::Drawing;
use super::misuse;

/// Decimals of cut-outs. Rounded corners on the border of another area leave slivers, in whose width the border's length counts.
const CUTOUT_PRECISION: u8 = 4;

/// A drawing to be written.
pub(super) struct Product<'a> {
    /// The marks; `None` if they lie on another SVG and are only a part of the drawing.
    pub(super) scene: Option<Cow<'a, Scene>>,
    /// The SVG.
    pub(super) text: Cow<'a, str>,
}

/// Choice of what is made of a drawing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Made {
    /// True if areas are cut out.
    pub(super) cutout: bool,
    /// Lines that fill areas, if they do.
    pub(super) hatch: Option<Hatch>,
    /// Width of the pen that draws them, px of the picture; without one, it is their distance.
    pub(super) pen: Option<f32>,
}

impl<'a> Product<'a> {
    /// The drawing of a fit, made into what was asked for.
    pub(super) fn of(judged: &'a Judged, asked: &Drawing) -> Result<Self> {
        let page = svg::page_width(&judged.svg);
        let pens = asked.config().pens;
        let radii = pens
            .map(|pens| pens.radii(page, &judged.fit.target))
            .transpose()?;
        let made = Made {
            cutout: asked.cutout,
            hatch: asked.hatch,
            pen: radii.and_then(|radii| Some(2.0 * radii.first()?)),
        };
        let file = WriteOptions {
            width: page,
            ..judged.fit.file
        };
        if !asked.cutout && asked.hatch.is_none() {
            let outlines = |scene: &'a Scene| match file.form {
                Form::Outlines => Cow::Owned(machine::outlined(scene)),
                _ => Cow::Borrowed(scene),
            };
            return Ok(Self {
                scene: judged.whole().map(outlines),
                text: Cow::Borrowed(&judged.svg),
            });
        }
        let whole = judged.whole().ok_or_else(|| {
            misuse("the SVG is not made of strokes and areas only: leave out --cutout and --hatch")
        })?;
        made.product(whole, &file)
    }
}

impl Made {
    /// The drawing that is made of a scene, in a file with these options.
    pub(super) fn product(&self, scene: &Scene, file: &WriteOptions) -> Result<Product<'static>> {
        let (made, text) = if let Some(hatch) = self.hatch {
            let made = self.hatched(scene, hatch, file)?;
            let text = svg::write(&made, file);
            (made, text)
        } else if self.cutout {
            let made = machine::cut_out(scene)?;
            let options = WriteOptions {
                precision: file.precision.max(CUTOUT_PRECISION),
                group: Group::Color,
                ..*file
            };
            let text = svg::write(&made, &options);
            (made, text)
        } else {
            // Straight outlines and dots have elements of their own.
            (machine::outlined(scene), svg::write(scene, file))
        };
        Ok(Product {
            scene: Some(Cow::Owned(made)),
            text: Cow::Owned(text),
        })
    }

    /// The drawing with its areas filled by lines.
    fn hatched(&self, scene: &Scene, hatch: Hatch, file: &WriteOptions) -> Result<Scene> {
        let sheet = Sheet {
            scene,
            width: file.width,
        };
        let spacing = hatch.spacing.px() / sheet.px();
        if spacing < MIN_WIDTH {
            return Err(misuse(format!(
                "the lines of --hatch are {spacing:.2} px of the picture apart, and a stroke is {MIN_WIDTH} px or more wide: \
                 enlarge the picture, or give a larger distance"
            )));
        }
        let spacing = spacing as f32;
        let pen = self.pen.unwrap_or(spacing);
        Ok(machine::hatched(scene, spacing, pen, hatch.degrees)?)
    }
}
