//! The stages: which there are, when they end, and what is taken down of them.

use std::time::Duration;

use super::{Task, Work};
use crate::error::Result;
use crate::fit::base::Base;
use crate::fit::drawing::Drawing;
use crate::fit::plan::PlannedStage;
use crate::fit::stage::{self, Stage};
use crate::fit::{StageRecord, Stop, settle};
use crate::metrics::psnr_db;

/// What polish adds to the fidelity of a staged drawing at least, dB.
const POLISH_DB: f64 = 2.0;
/// An open plan ends when less than this share of a stage's strokes is worth its price.
const PAYING_SHARE: f64 = 0.3;

impl Work<'_> {
    /// Plans and seeds a stage, as long as the plan or a budget does not end.
    pub(in crate::fit) fn grow(&mut self) -> Result<()> {
        if self.is_stopped() {
            return Ok(());
        }
        if let Some(enough) = self.enough() {
            self.standing.stop = enough;
            return Ok(());
        }
        self.rehearse()?;
        let index = self.standing.records.len();
        match self.plan.stage(index, self.drawing.len()) {
            Some(mut planned) => {
                planned.count = self.control.affordable(planned.count);
                if planned.count > 0 {
                    self.then(Task::Grow);
                    self.seed(planned);
                }
            }
            None => self.top_up(),
        }
        Ok(())
    }

    /// What makes further stages superfluous, if anything does.
    fn enough(&self) -> Option<Stop> {
        let pays = self.standing.pays?;
        let staged = self.standing.records.last()?.psnr_db;
        // A base has been finished before, and gains less from polish than stages do.
        let gains = self.config.polish && self.base.is_none();
        let later = if gains { POLISH_DB } else { 0.0 };
        let wanted = self.config.budget.psnr_db;
        if !pays {
            Some(Stop::Converged)
        } else if wanted.is_some_and(|wanted| staged + later >= wanted) {
            Some(Stop::Psnr)
        } else {
            None
        }
    }

    /// Tries how long it takes to write the drawing, now and then, where the time is limited.
    pub(super) fn rehearse(&mut self) -> Result<()> {
        if self.control.wants_writing() {
            let (drawing, page) = (&self.drawing, self.page);
            let write = || settle::write(drawing, page);
            self.control.writing(drawing.len(), write)?;
        }
        Ok(())
    }

    /// Where nothing is polished, adds to the last stage the strokes that were promised but not accepted.
    fn top_up(&mut self) {
        let count = self.terms.limit.saturating_sub(self.drawing.len());
        let promised = self.config.budget.strokes.is_some() && !self.config.polish;
        let Some(last) = self
            .standing
            .records
            .last()
            .filter(|_| promised && count > 0)
        else {
            return;
        };
        let scale = self.recipe.scale * self.drawing.spacing(self.terms.limit);
        self.seed(PlannedStage {
            index: last.index - 1,
            count,
            scale,
        });
    }

    pub(super) fn seed(&mut self, planned: PlannedStage) {
        let began = self.control.elapsed();
        self.control.enter(planned.index);
        let (drawing, recipe) = (&mut self.drawing, &self.recipe);
        let seed = || Stage::seed(drawing, recipe, planned, began);
        let stage = self.control.searching(planned.count, seed);
        self.then(Task::Stage(stage));
    }

    /// An iteration of the fit of a stage, or its end.
    pub(in crate::fit) fn stage(&mut self, mut stage: Stage) {
        let (drawing, control) = (&mut self.drawing, &mut self.control);
        if control.stopped().is_none() && stage.step(drawing, &self.recipe, self.anneal, control) {
            return self.then(Task::Stage(stage));
        }
        let count = stage.planned.count;
        let accepted = stage::accept(drawing, self.terms.price);
        self.standing.pays = Some(accepted as f64 >= PAYING_SHARE * count as f64);
        if accepted == 0 && self.standing.corrections.count > 0 {
            self.give_up();
        }
        self.then(Task::Record(stage));
        if self.config.progressive {
            let limit = self.drawing.len() + count - accepted;
            self.begin_polish(limit, self.recipe.polish_iterations);
        }
    }

    /// Takes down how a stage went.
    pub(in crate::fit) fn record(&mut self, stage: &Stage) {
        let mut iterations = self.recipe.stage_iterations;
        if self.config.progressive {
            iterations += self.recipe.polish_iterations;
        }
        let psnr_db = psnr_db(self.drawing.mse());
        match self.standing.records.get_mut(stage.planned.index) {
            Some(topped_up) => {
                topped_up.iterations += iterations;
                topped_up.psnr_db = psnr_db;
            }
            None => self.standing.records.push(StageRecord {
                index: stage.planned.index + 1,
                strokes: 0,
                iterations,
                wall: self.control.elapsed().saturating_sub(stage.began),
                psnr_db,
                layer_psnr_db: 0.0,
            }),
        }
    }
}

/// Puts the strokes of `base` into `drawing`; returns the records of its layers.
pub(super) fn load(drawing: &mut Drawing, base: &Base) -> Vec<StageRecord> {
    drawing.load(&base.scene);
    let mses = drawing.layer_mses(&base.scene).into_iter();
    mses.enumerate().map(kept_layer).collect()
}

/// The record of a layer that was there before, from its index and the mean squared error after it.
fn kept_layer((index, mse): (usize, f64)) -> StageRecord {
    StageRecord {
        index: index + 1,
        strokes: 0,
        iterations: 0,
        wall: Duration::ZERO,
        psnr_db: psnr_db(mse),
        layer_psnr_db: 0.0,
    }
}
