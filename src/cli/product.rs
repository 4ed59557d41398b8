//! The drawing as its files hold it: as it was fitted, or made for a machine from that.

use std::borrow::Cow;

use anyhow::Result;
use strokefit::machine::{self, Hatch};
use strokefit::report::Judged;
use strokefit::scene::{MIN_WIDTH, Scene};
use strokefit::svg::{self, Form, Length, WriteOptions};

use super::drawing::Drawing;
use super::misuse;

/// Decimals of cut-outs: corners where three areas meet are rounded, and a gap of a hundredth of a px along a page would show.
const CUTOUT_PRECISION: u8 = 4;

/// What is written.
pub(super) struct Product<'a> {
    /// The marks; `None` if they lie on another SVG and are only a part of the drawing.
    pub(super) scene: Option<Cow<'a, Scene>>,
    /// The SVG.
    pub(super) text: Cow<'a, str>,
}

impl<'a> Product<'a> {
    /// The drawing, made into what was asked for.
    pub(super) fn of(judged: &'a Judged, asked: &Drawing) -> Result<Self> {
        let whole = judged.whole();
        let made = match (asked.hatch, whole) {
            (None, _) if !asked.cutout => None,
            (_, None) => {
                return Err(misuse(
                    "the SVG is not made of strokes and areas only: leave out --cutout and --hatch",
                ));
            }
            (Some(hatch), Some(scene)) => Some(hatched(scene, hatch, judged, asked)?),
            (None, Some(scene)) => Some(machine::cut_out(scene)?),
        };
        let Some(scene) = made else {
            let outlines = |scene: &'a Scene| match judged.fit.file.form {
                Form::Outlines => Cow::Owned(machine::outlined(scene)),
                _ => Cow::Borrowed(scene),
            };
            return Ok(Self {
                scene: whole.map(outlines),
                text: Cow::Borrowed(&judged.svg),
            });
        };
        let file = judged.fit.file;
        let precision = match asked.cutout {
            true => file.precision.max(CUTOUT_PRECISION),
            false => file.precision,
        };
        let options = WriteOptions {
            precision,
            width: svg::page_width(&judged.svg),
            ..file
        };
        Ok(Self {
            text: Cow::Owned(svg::write(&scene, &options)),
            scene: Some(Cow::Owned(scene)),
        })
    }
}

/// The drawing with its areas filled by lines.
fn hatched(scene: &Scene, hatch: Hatch, judged: &Judged, asked: &Drawing) -> Result<Scene> {
    let page = svg::page_width(&judged.svg);
    let sides = scene.page.unwrap_or([scene.width, scene.height]);
    let page_px = page.map_or(f64::from(sides[0]), Length::px);
    let spacing = hatch.spacing.px() / page_px * f64::from(scene.width);
    if spacing < MIN_WIDTH {
        return Err(misuse(format!(
            "the hatching of {} is {spacing:.2} px of the picture apart, and a stroke {MIN_WIDTH} px or more wide: \
             enlarge the picture, or give a larger distance",
            hatch.spacing
        )));
    }
    let pen = match &asked.options.config.pens {
        Some(pens) => thinnest(pens.radii(page, &judged.fit.target)?),
        None => None,
    };
    let spacing = spacing as f32;
    Ok(machine::hatched(
        scene,
        spacing,
        pen.unwrap_or(spacing),
        hatch.degrees,
    )?)
}

/// The width of the thinnest pen of these radii.
fn thinnest(radii: Vec<f32>) -> Option<f32> {
    radii.first().map(|radius| 2.0 * radius)
}
