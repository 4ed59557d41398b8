//! The drawing as its files hold it: as it was fitted, or made for a machine from that.

use std::borrow::Cow;

use anyhow::Result;
use strokefit::fit::Widths;
use strokefit::machine::{self, Hatch, Sheet};
use strokefit::report::Judged;
use strokefit::scene::{MIN_WIDTH, Scene};
use strokefit::svg::{self, Form, Group, WriteOptions};

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

/// What is made of a drawing before it is written.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct Made {
    /// Write filled outlines instead of strokes, one for each, for programs that ignore strokes
    #[arg(long, conflicts_with_all = ["cutout", "hatch"])]
    pub(super) outline: bool,
    /// Write what is seen of each colour as one path, for cutters: areas do not overlap, share their borders, and end at the
    /// page. All is opaque; the background is one of the areas unless it is none
    #[arg(long, conflicts_with = "hatch")]
    pub(super) cutout: bool,
    /// Fill areas with lines for a plotter, so far apart, such as 0.5mm, at an angle, 45 degrees if none is given. The lines
    /// are as wide as the thinnest pen, or as they are far apart
    #[arg(long, value_name = "DISTANCE[:ANGLE]", allow_hyphen_values = true)]
    pub(super) hatch: Option<Hatch>,
}

impl<'a> Product<'a> {
    /// The drawing of a fit with these pens, made into what was asked for.
    pub(super) fn of(judged: &'a Judged, made: &Made, pens: Option<&Widths>) -> Result<Self> {
        let page = svg::page_width(&judged.svg);
        let radii = pens.map(|pens| pens.radii(page, &judged.fit.target));
        let radii = radii.transpose()?.unwrap_or_default();
        let pen = radii.first().map(|radius| 2.0 * radius);
        let file = WriteOptions {
            width: page,
            ..judged.fit.file
        };
        if !made.is_for_machines() {
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
        made.product(whole, &file, pen)
    }
}

impl Made {
    /// True if a cutter or a plotter reads the file.
    pub(super) fn is_for_machines(&self) -> bool {
        self.cutout || self.hatch.is_some()
    }

    /// The drawing that is made of a scene, in a file with these options; `pen` is the width of the pen that hatches, px of the
    /// picture.
    pub(super) fn product(
        &self,
        scene: &Scene,
        file: &WriteOptions,
        pen: Option<f32>,
    ) -> Result<Product<'static>> {
        let (made, text) = if let Some(hatch) = self.hatch {
            let made = hatched(scene, hatch, pen, file)?;
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
}

/// The drawing with its areas filled by the lines of a pen; without one, lines are as wide as they are far apart.
fn hatched(scene: &Scene, hatch: Hatch, pen: Option<f32>, file: &WriteOptions) -> Result<Scene> {
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
    let pen = pen.map_or(spacing, f64::from);
    Ok(machine::hatched(scene, spacing, pen, hatch.degrees)?)
}
