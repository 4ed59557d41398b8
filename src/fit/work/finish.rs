//! The best of the files, and the finished fit.

use super::{Work, budget};
use crate::error::Result;
use crate::fit::settle::Written;
use crate::fit::{Fit, drawing, ground, settle};
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::Scene;

impl Work<'_> {
    /// Ends the fit where the base as it is meets a budget already.
    pub(in crate::fit) fn try_base(&mut self) -> Result<()> {
        let written = settle::write(&self.drawing, self.page)?;
        if let Some(stop) = budget::met(&self.config.budget, self.drawing.len(), &written) {
            self.standing.stop = stop;
            self.standing.agenda.clear();
            self.drawing.refine(0.0);
            self.set_best(written);
        }
        Ok(())
    }

    /// Takes what was `written` from the drawing as it is for the best of the files.
    pub(super) fn set_best(&mut self, written: Written) {
        self.standing.best = Some(self.drawing.state());
        self.best = Some(written);
    }

    /// Writes again what was written from `state`.
    pub(super) fn restore_best(&mut self, state: Option<&drawing::State>) -> Result<()> {
        if let Some(state) = state {
            self.drawing.resume(state.clone());
            self.best = Some(settle::write(&self.drawing, self.page)?);
        }
        Ok(())
    }

    /// The finished fit.
    pub(in crate::fit) fn finish(mut self) -> Result<Fit> {
        let written = match self.best.take() {
            Some(best) => best,
            None => settle::write(&self.drawing, self.page)?,
        };
        self.record_layers(&written.scene);
        let soft = self.soft(&written.scene)?;
        Ok(Fit {
            soft,
            scene: written.scene,
            base: self.base.cloned(),
            target: self.target,
            stages: self.standing.records,
            stop: self.control.stopped().unwrap_or(self.standing.stop),
            dropped: written.dropped + self.drawing.lost(),
        })
    }

    /// Completes the records of the stages by what became of them in the finished `scene`.
    fn record_layers(&mut self, scene: &Scene) {
        let mses = self.drawing.layer_mses(scene);
        let layers = scene.stages.iter().zip(mses);
        for (record, (stage, mse)) in self.standing.records.iter_mut().zip(layers) {
            record.strokes = stage.strokes.len();
            record.layer_psnr_db = psnr_db(mse);
        }
    }

    /// Our own render of `scene`; with alpha where there is a ground of either colour.
    fn soft(&mut self, scene: &Scene) -> Result<Image> {
        let mut softs = self.drawing.soft(scene);
        match softs.as_slice() {
            [black, white] => ground::transparent(black, white),
            _ => Ok(softs.remove(0)),
        }
    }
}
