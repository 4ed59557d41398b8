//! The best of the files, and the finished fit.

use super::{Work, budget};
use crate::error::Result;
use crate::fit::settle::Written;
use crate::fit::{Fit, StageRecord, drawing, ground, settle};
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::{Dropped, Quantized, Scene, Stage};

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
        let rounded = match self.best.take() {
            Some(best) => best.rounded,
            None => settle::round(&self.drawing, self.page),
        };
        let stages = self.records(&rounded);
        let soft = self.soft(&rounded.scene)?;
        Ok(Fit {
            soft,
            scene: rounded.scene,
            base: self.base.cloned(),
            target: self.target,
            stages,
            stop: self.control.cut_by().unwrap_or(self.standing.stop),
            dropped: Dropped {
                non_finite: rounded.dropped.non_finite + self.drawing.lost(),
                ..rounded.dropped
            },
        })
    }

    /// The records of the stages that have strokes in the finished drawing, numbered as its layers, with what
    /// became of them.
    fn records(&mut self, rounded: &Quantized) -> Vec<StageRecord> {
        let mses = self.drawing.layer_mses(&rounded.scene);
        let layers = rounded.scene.stages.iter().zip(mses);
        let origins = rounded.origins.iter().enumerate();
        let record = |((number, &origin), (stage, mse)): ((_, _), (&Stage, _))| {
            Some(StageRecord {
                index: number + 1,
                strokes: stage.strokes.len(),
                layer_psnr_db: psnr_db(mse),
                ..*self.standing.records.get(origin)?
            })
        };
        origins.zip(layers).filter_map(record).collect()
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
