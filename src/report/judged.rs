//! A finished drawing, its file, and the verdict on it.

use crate::error::Result;
use crate::fit::{Base, Fit};
use crate::metrics::Quality;
use crate::scene::Scene;
use crate::verify::{self, OnMattes, Verdict};

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
}

impl Judged {
    /// Writes the drawing as SVG text, renders it with resvg, and compares.
    ///
    /// # Errors
    /// As [`verify::verify`].
    pub fn new(fit: Fit) -> Result<Self> {
        let svg = fit.svg();
        let soft = Quality::between(&fit.target, &fit.soft)?;
        let verdict = verify::verify(&svg, &fit.target, &fit.soft)?;
        let has_alpha = fit.target.alpha().is_some();
        let alpha = has_alpha.then(|| verify::on_mattes(&svg, &fit.target));
        Ok(Self {
            soft,
            verdict,
            alpha: alpha.transpose()?,
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

    /// Whether the file is as good as the fit. It is if resvg's render agrees with our own, or if resvg's is the one more
    /// faithful to the picture: in one of a few pixels both differ at all edges, and the file was settled for resvg.
    pub fn holds(&self) -> bool {
        self.verdict.agrees() || self.verdict.fidelity.psnr_db >= self.soft.psnr_db
    }
}
