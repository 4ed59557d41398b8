//! The phases of a fit, and the budgets that bind them.

use std::time::Instant;

use fearless_simd::Level;

use super::anneal::Anneal;
use super::config::Config;
use super::control::Control;
use super::drawing::Drawing;
use super::observer::Observer;
use super::plan::{MOST_STROKES, Plan, PlannedStage};
use super::polish::{self, Terms};
use super::price::Price;
use super::recipe::Recipe;
use super::settle::{self, Page, Written};
use super::{Fit, StageRecord, Stop, stage};
use crate::error::Result;
use crate::image::Image;
use crate::metrics::psnr_db;

/// Bytes of a typical stroke, for the first guess at what a budget of bytes holds.
const STROKE_BYTES: usize = 90;
/// What polish adds to the fidelity of a staged drawing at least, dB.
const POLISH_DB: f64 = 2.0;
/// An open plan ends when less than this share of a stage's strokes is worth its price.
const PAYING_SHARE: f64 = 0.3;
/// Fidelity gained by doubling the strokes, dB.
const DB_PER_DOUBLING: f64 = 2.8;
/// How often strokes are added or removed to meet a fidelity.
const CORRECTIONS: usize = 6;
/// A fidelity is met well enough when exceeded by no more than this, dB.
const EXCESS_DB: f64 = 0.1;
/// Share of the polish's iterations that follow a correction.
const REPOLISH: f64 = 0.4;

/// A fit under way.
pub(super) struct Work<'a> {
    config: &'a Config,
    recipe: Recipe,
    anneal: Anneal,
    page: Page,
    plan: Plan,
    terms: Terms,
    target: Image,
    drawing: Drawing,
    control: Control<'a>,
    records: Vec<StageRecord>,
    /// What ended the stages.
    stop: Stop,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        target: Image,
        config: &'a Config,
        level: Level,
        observer: &'a mut (dyn Observer + Send),
    ) -> Self {
        let recipe = config.recipe.unwrap_or(Recipe::of(config.preset));
        let by_bytes = config
            .budget
            .bytes
            .map(|bytes| (bytes / STROKE_BYTES).max(1));
        let limit = [config.budget.strokes, by_bytes]
            .into_iter()
            .flatten()
            .min();
        let plan = Plan::new(config, &recipe, limit, target.width() * target.height());
        let coarsest = plan.stage(0, 0).map_or(0.0, |stage| stage.scale);
        let drawing = Drawing::new(&target, coarsest, config, level);
        let iterations = recipe.stage_iterations
            + if config.polish {
                recipe.polish_iterations
            } else {
                0
            };
        let planned = (plan.strokes() * iterations) as f64;
        Self {
            config,
            recipe,
            anneal: Anneal {
                coverage: config.coverage,
                from: 1.0,
            },
            page: Page::of(config),
            terms: Terms {
                limit: limit.unwrap_or(MOST_STROKES),
                price: Price::new(config.effective_quality(), config.file),
            },
            control: Control::new(observer, config, planned, plan.len()),
            plan,
            target,
            drawing,
            records: Vec::new(),
            stop: Stop::Strokes,
        }
    }

    /// Adds strokes stage by stage until the plan or a budget ends.
    pub(super) fn grow(&mut self) {
        while self.control.stopped().is_none() {
            let index = self.records.len();
            let Some(planned) = self.plan.stage(index, self.drawing.len()) else {
                break;
            };
            let accepted = self.add(planned);
            if (accepted as f64) < PAYING_SHARE * planned.count as f64 {
                self.stop = Stop::Converged;
                break;
            }
            let staged = self.records.last().map_or(0.0, |record| record.psnr_db);
            let later = if self.config.polish { POLISH_DB } else { 0.0 };
            if self
                .config
                .budget
                .psnr_db
                .is_some_and(|wanted| staged + later >= wanted)
            {
                self.stop = Stop::Psnr;
                break;
            }
        }
        if self.stop == Stop::Strokes && self.control.stopped().is_none() {
            self.top_up();
        }
        self.drawing.thaw();
    }

    /// Where nothing is polished, adds to the last stage the strokes that were promised but not accepted.
    fn top_up(&mut self) {
        let count = self.terms.limit.saturating_sub(self.drawing.len());
        let promised = self.config.budget.strokes.is_some() && !self.config.polish;
        let Some(last) = self.records.last_mut().filter(|_| promised && count > 0) else {
            return;
        };
        let scale = self.recipe.scale * self.drawing.spacing(self.terms.limit);
        let planned = PlannedStage {
            index: last.index - 1,
            count,
            scale,
        };
        let (recipe, price) = (&self.recipe, self.terms.price);
        stage::add(
            &mut self.drawing,
            recipe,
            self.anneal,
            planned,
            price,
            &mut self.control,
        );
        last.iterations += recipe.stage_iterations;
        last.psnr_db = psnr_db(self.drawing.mse());
    }

    fn add(&mut self, planned: PlannedStage) -> usize {
        let start = Instant::now();
        self.control.enter(planned.index);
        let price = self.terms.price;
        let accepted = stage::add(
            &mut self.drawing,
            &self.recipe,
            self.anneal,
            planned,
            price,
            &mut self.control,
        );
        let mut iterations = self.recipe.stage_iterations;
        if self.config.progressive {
            let terms = Terms {
                limit: self.drawing.len() + planned.count - accepted,
                price,
            };
            iterations += self.recipe.polish_iterations;
            self.polish_free(terms, self.recipe.polish_iterations);
        }
        self.records.push(StageRecord {
            index: planned.index + 1,
            strokes: 0,
            iterations,
            wall: start.elapsed(),
            psnr_db: psnr_db(self.drawing.mse()),
            layer_psnr_db: 0.0,
        });
        accepted
    }

    /// Fits all strokes jointly.
    pub(super) fn polish(&mut self) {
        if self.config.polish && !self.config.progressive {
            // A fidelity is met by as few strokes as may be: their number is corrected afterwards.
            let open = self.config.budget.psnr_db.is_some();
            let limit = if open {
                self.drawing.len()
            } else {
                self.terms.limit
            };
            self.control.enter(self.records.len());
            self.polish_free(
                Terms {
                    limit,
                    ..self.terms
                },
                self.recipe.polish_iterations,
            );
        }
    }

    fn polish_free(&mut self, terms: Terms, steps: usize) {
        if self.control.stopped().is_none() {
            self.control.polish();
            polish::run(
                &mut self.drawing,
                &self.recipe,
                self.anneal,
                terms,
                steps,
                &mut self.control,
            );
        }
    }

    /// Settles the drawing against its file, and adds or removes strokes until the budgets are met.
    pub(super) fn settle(&mut self) -> Result<Written> {
        self.drawing.refine(0.0);
        let mut written = self.settled()?;
        if let Some(wanted) = self.config.budget.psnr_db {
            written = self.meet_fidelity(wanted, written)?;
        }
        if let Some(most) = self.config.budget.bytes {
            written = self.meet_bytes(most, written)?;
        }
        Ok(written)
    }

    /// Settles the drawing against its file.
    fn settled(&mut self) -> Result<Written> {
        settle::run(
            &mut self.drawing,
            &self.target,
            self.page,
            &self.recipe,
            &self.control,
        )
    }

    /// The drawing of fewest strokes found that is as faithful as `wanted`, dB, or the most faithful one.
    fn meet_fidelity(&mut self, wanted: f64, first: Written) -> Result<Written> {
        let mut best = first;
        let mut current = psnr_db(best.mse);
        for _ in 0..CORRECTIONS {
            let settled = (0.0..=EXCESS_DB).contains(&(current - wanted));
            if settled || self.control.stopped().is_some() || !self.resize(wanted - current) {
                break;
            }
            let terms = Terms {
                limit: self.drawing.len(),
                ..self.terms
            };
            self.polish_free(
                terms,
                (self.recipe.polish_iterations as f64 * REPOLISH) as usize,
            );
            let written = self.settled()?;
            current = psnr_db(written.mse);
            let reached = |w: &Written| psnr_db(w.mse) >= wanted;
            let better = match (reached(&written), reached(&best)) {
                (true, true) => written.scene.len() < best.scene.len(),
                (false, false) => written.mse < best.mse,
                (reaches, _) => reaches,
            };
            if better {
                best = written;
            }
        }
        self.stop = if psnr_db(best.mse) >= wanted {
            Stop::Psnr
        } else {
            self.stop
        };
        Ok(best)
    }

    /// Adds or removes the strokes that are reckoned to change the fidelity by `missing_db`; false where
    /// there is none to add or to remove.
    fn resize(&mut self, missing_db: f64) -> bool {
        let strokes = self.drawing.len();
        let factor = (missing_db / DB_PER_DOUBLING).clamp(-1.0, 1.0).exp2();
        let wanted = ((strokes as f64 * factor) as usize).clamp(1, self.terms.limit);
        if missing_db > 0.0 {
            let count = wanted
                .max(strokes + 1)
                .min(self.terms.limit)
                .saturating_sub(strokes);
            let scale = self.recipe.scale * self.drawing.spacing(wanted);
            let index = self.records.len();
            let added = count > 0
                && self.add(PlannedStage {
                    index,
                    count,
                    scale,
                }) > 0;
            self.drawing.thaw();
            added
        } else {
            self.remove(strokes - wanted.min(strokes))
        }
    }

    /// Removes the `count` strokes worth least; false when `count` is 0.
    fn remove(&mut self, count: usize) -> bool {
        let worth = self.drawing.judge().worth;
        let mut order: Vec<usize> = (0..worth.len()).collect();
        order.sort_by(|&i, &j| worth[i].total_cmp(&worth[j]).then(i.cmp(&j)));
        let mut keep = vec![true; worth.len()];
        order.into_iter().take(count).for_each(|i| keep[i] = false);
        self.drawing.retain_free(&keep);
        count > 0
    }

    /// Removes the strokes worth least until the file has at most `most` bytes.
    fn meet_bytes(&mut self, most: usize, first: Written) -> Result<Written> {
        let mut written = first;
        while written.bytes > most && self.drawing.len() > 0 {
            self.stop = Stop::Bytes;
            let share = (written.bytes - most) as f64 / written.bytes as f64;
            self.remove(((self.drawing.len() as f64 * share).ceil() as usize).max(1));
            written = self.settled()?;
        }
        Ok(written)
    }

    /// The finished fit.
    pub(super) fn finish(mut self, written: Written) -> Fit {
        let layers = self.drawing.layer_mses(&written.scene);
        for (record, (stage, mse)) in self
            .records
            .iter_mut()
            .zip(written.scene.stages.iter().zip(layers))
        {
            record.strokes = stage.strokes.len();
            record.layer_psnr_db = psnr_db(mse);
        }
        Fit {
            soft: self.drawing.soft(&written.scene),
            scene: written.scene,
            target: self.target,
            stages: self.records,
            stop: self.control.stopped().unwrap_or(self.stop),
            dropped: written.dropped,
        }
    }
}
