//! A finished drawing, its file, and the verdict on it.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::fit::{Base, Fit, Focus};
use crate::metrics::{self, Quality, null_is_infinite};
use crate::scene::Scene;
use crate::verify::{self, MIN_AGREEMENT_DB, OnMattes, Verdict};

/// Fidelity that a file may lack against our own render although it does not agree with it, dB.
const MAX_LOSS_DB: f64 = 1.0;

/// A picture of fewer pixels is small: its strokes are about as wide as its pixels.
const FEW_PIXELS: usize = 64 * 64;

/// A finished drawing with its file, judged by resvg's render.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The drawing.
    pub fit: Fit,
    /// Text of the file.
    pub svg: String,
    /// Our own soft render against the picture.
    pub soft: Quality,
    /// The file as rendered by resvg, against the picture and our own render.
    pub verdict: Verdict,
    /// Fidelity on mattes of black, white and magenta, if the picture has alpha.
    pub alpha: Option<OnMattes>,
    /// Fidelity where errors counted and elsewhere, if there was a mask.
    pub focus: Option<OnFocus>,
}

/// Fidelity of a drawing where errors counted, and where they counted less.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnFocus {
    /// PSNR of the pixels for which the mask is 0.5 or more, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub inside_db: f64,
    /// PSNR of the others, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub outside_db: f64,
}

impl Judged {
    /// Writes the drawing as SVG text, renders it with resvg, and compares.
    ///
    /// # Errors
    /// As [`verify::verify`].
    pub fn new(fit: Fit) -> Result<Self> {
        let svg = fit.svg();
        let mut soft = Quality::between(&fit.target, &fit.soft)?;
        let mut verdict = verify::verify(&svg, &fit.target, &fit.soft, fit.matte)?;
        // Noise and paper that were left out are no details.
        if let Some(meant) = &fit.meant {
            let drawn = verify::render_like(&svg, meant, fit.matte)?;
            soft.details_kept = metrics::details_kept(meant, &fit.soft)?;
            verdict.fidelity.details_kept = metrics::details_kept(meant, &drawn)?;
        }
        let has_alpha = fit.target.alpha().is_some();
        let alpha = has_alpha.then(|| verify::on_mattes(&svg, &fit.target));
        let focus = fit.focus.as_ref().map(|focus| on_focus(focus, &svg, &fit));
        Ok(Self {
            soft,
            verdict,
            alpha: alpha.transpose()?,
            focus: focus.transpose()?,
            svg,
            fit,
        })
    }

    /// The scene; `None` if its strokes lie on another SVG and are only a part of the drawing.
    pub fn whole(&self) -> Option<&Scene> {
        let lies_on_document = |base: &Base| base.document.is_some();
        let is_part = self.fit.base.as_ref().is_some_and(lies_on_document);
        (!is_part).then_some(&self.fit.scene)
    }

    /// True if the file is as good as the fit: it has all that our own render has, and resvg's render agrees with that, or is
    /// about as faithful to the picture. In a picture of few pixels, or of noise, all is edges, at which renders differ.
    pub fn holds(&self) -> bool {
        let Verdict {
            fidelity,
            agreement,
        } = self.verdict;
        let is_as_faithful = fidelity.psnr_db >= self.soft.psnr_db - MAX_LOSS_DB;
        let is_close = agreement.psnr_db >= MIN_AGREEMENT_DB;
        !agreement.has_gap() && (is_close || is_as_faithful || self.is_tiny())
    }

    /// True if strokes are about as wide as the pixels of the picture.
    pub fn is_tiny(&self) -> bool {
        self.fit.target.width() * self.fit.target.height() < FEW_PIXELS
    }
}

fn on_focus(focus: &Focus, svg: &str, fit: &Fit) -> Result<OnFocus> {
    let drawn = verify::render_like(svg, &fit.target, fit.matte)?;
    let [inside_db, outside_db] = focus.psnrs_db(&fit.target, &drawn)?;
    Ok(OnFocus {
        inside_db,
        outside_db,
    })
}
