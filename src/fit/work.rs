//! The phases of a fit, and the budgets that bind them.

use std::time::{Duration, Instant};

use fearless_simd::Level;

use super::anneal::Anneal;
use super::base::Base;
use super::config::Config;
use super::control::Control;
use super::drawing::Drawing;
use super::ground::{self, Setting};
use super::observer::Observer;
use super::palette::{self, Colors, Palette};
use super::pens;
use super::plan::{Before, MOST_STROKES, Plan, PlannedStage};
use super::polish::{self, Terms};
use super::price::Price;
use super::recipe::Recipe;
use super::settle::{self, Page, Written};
use super::{Fit, StageRecord, Stop, stage};
use crate::error::Result;
use crate::image::Image;
use crate::math::Point;
use crate::metrics::psnr_db;
use crate::scene::{Shape, Stroke};
use crate::svg::{self, Form};

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

/// Bytes of a typical stroke, for the first guess at what a budget of bytes holds.
fn typical_bytes(config: &Config, target: &Image) -> usize {
    // Two thirds of the way, so that no decimal is 0, and as short as most strokes are.
    let place = |share: f32, step: f32| {
        let [x, y] = [target.width(), target.height()].map(|side| side as f32 * share);
        Point::new(x + step, y - step)
    };
    let stroke = Stroke {
        shape: Shape::capsule(place(2.0 / 3.0, 0.0), place(2.0 / 3.0, 10.0 / 3.0)),
        radius: 5.0 / 3.0,
        color: [1.0 / 3.0; 3].map(|c: f32| c + 0.01),
        opacity: if config.opaque { 1.0 } else { 2.0 / 3.0 },
    };
    svg::stroke_bytes(&stroke, &config.file).max(1)
}

/// A fit under way.
pub(super) struct Work<'a> {
    config: &'a Config,
    recipe: Recipe,
    anneal: Anneal,
    base: Option<&'a Base>,
    page: Page<'a>,
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
        picture: &Image,
        config: &'a Config,
        base: Option<&'a Base>,
        level: Level,
        observer: &'a mut (dyn Observer + Send),
    ) -> Result<Self> {
        let recipe = config.recipe.unwrap_or(Recipe::of(config.preset));
        let kept_bytes = base.map_or(0, Base::bytes);
        let by_bytes = config
            .budget
            .bytes
            .map(|bytes| bytes.saturating_sub(kept_bytes) / typical_bytes(config, picture))
            .map(|strokes| strokes.max(1));
        let limit = [config.budget.strokes, by_bytes]
            .into_iter()
            .flatten()
            .min();
        let most = MOST_STROKES.saturating_sub(base.map_or(0, Base::elements));
        let before = Before {
            layers: base.map_or(0, |base| base.scene.stages.len()),
            strokes: base.map_or(0, |base| base.scene.len()),
        };
        let pixels = picture.width() * picture.height();
        let plan = Plan::new(config, &recipe, limit, before, pixels);
        let first = plan.stage(before.layers, before.strokes);
        // A reduced picture flatters a base: whether a fidelity is reached is told at full resolution.
        let whole = base.is_some() && config.budget.psnr_db.is_some();
        let first = first.filter(|_| !whole);
        let coarsest = first.map_or(0.0, |stage| stage.scale);
        let mut setting = Setting::new(picture, config.background, base, coarsest)?;
        let mut drawing = Drawing::new(&mut setting, config, level);
        let mut records = Vec::new();
        if let Some(Base { scene, .. }) = base {
            drawing.load(scene);
            records = drawing
                .layer_mses(scene)
                .into_iter()
                .enumerate()
                .map(kept_layer)
                .collect();
        }
        let iterations = recipe.stage_iterations
            + if config.polish {
                recipe.polish_iterations
            } else {
                0
            };
        let planned = (plan.strokes() * iterations) as f64;
        Ok(Self {
            config,
            recipe,
            base,
            anneal: Anneal {
                coverage: config.coverage,
                from: 1.0,
            },
            page: Page::of(config, base),
            terms: Terms {
                limit: limit.unwrap_or(most).min(most),
                price: Price::new(config.effective_quality(), config.file),
            },
            control: Control::new(observer, config, planned, plan.len()),
            plan,
            target: setting.target,
            drawing,
            records,
            stop: Stop::Strokes,
        })
    }

    /// The base as it is, if it meets a budget already.
    pub(super) fn met_already(&mut self) -> Result<Option<Written>> {
        if self.base.is_none() {
            return Ok(None);
        }
        let written = settle::write(&self.drawing, self.page)?;
        let budget = self.config.budget;
        let met = [
            (
                Stop::Strokes,
                budget.strokes.is_some_and(|n| self.drawing.len() >= n),
            ),
            (
                Stop::Psnr,
                budget.psnr_db.is_some_and(|db| psnr_db(written.mse) >= db),
            ),
            (
                Stop::Bytes,
                budget.bytes.is_some_and(|n| written.bytes >= n),
            ),
        ];
        let Some(&(stop, _)) = met.iter().find(|(_, met)| *met) else {
            return Ok(None);
        };
        self.stop = stop;
        self.drawing.refine(0.0);
        Ok(Some(written))
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
            // A base has been finished before, and gains less from polish than stages do.
            let later = if self.config.polish && self.base.is_none() {
                POLISH_DB
            } else {
                0.0
            };
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
        let recipe = self.restricted();
        settle::run(&mut self.drawing, self.page, &recipe, &self.control)
    }

    /// The palette of the drawing, if it has to have one.
    fn palette(&mut self) -> Option<Palette> {
        let colors = &self.config.colors;
        if *colors == Colors::Free {
            return None;
        }
        let strokes = self.drawing.len();
        let mut wishes = self.drawing.wishes(0.0);
        if !self.page.has_ground {
            // No background is drawn.
            wishes.truncate(strokes);
        }
        let is_given = self.page.has_ground && self.drawing.background_fixed;
        let ground = self.drawing.background().filter(|_| is_given);
        Palette::new(colors, &wishes, ground)
    }

    /// Brings the drawing to the colours and pens that it may have, and returns the recipe that leaves them as they are.
    fn restricted(&mut self) -> Recipe {
        let mut recipe = self.recipe;
        if let Some(mut palette) = self.palette() {
            let (anneal, control) = (self.anneal, &mut self.control);
            let terms = Terms {
                limit: self.drawing.len(),
                ..self.terms
            };
            palette::run(
                &mut self.drawing,
                &mut palette,
                &recipe,
                anneal,
                terms,
                control,
            );
            recipe.polish_rates = palette::without_color(recipe.polish_rates);
        }
        if self.config.file.form == Form::Smallest {
            let (anneal, control) = (self.anneal, &mut self.control);
            let keep_colors = self.config.colors != Colors::Free;
            pens::run(&mut self.drawing, keep_colors, &recipe, anneal, control);
            recipe.polish_rates = pens::without_pen(recipe.polish_rates);
        }
        recipe
    }

    /// The drawing of fewest strokes found that is as faithful as `wanted`, dB, or the most faithful one.
    fn meet_fidelity(&mut self, wanted: f64, first: Written) -> Result<Written> {
        let mut best = first;
        let mut current = psnr_db(best.mse);
        let mut db_per_doubling = DB_PER_DOUBLING;
        for _ in 0..CORRECTIONS {
            let settled = (0.0..=EXCESS_DB).contains(&(current - wanted));
            let doublings = (wanted - current) / db_per_doubling;
            let before = (self.drawing.len(), current);
            if settled || self.control.stopped().is_some() || !self.resize(doublings) {
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
            if self.base.is_some() {
                db_per_doubling = slope(before, (self.drawing.len(), current));
            }
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
        self.stop = match self.stop {
            _ if psnr_db(best.mse) >= wanted => Stop::Psnr,
            Stop::Psnr => Stop::Converged,
            other => other,
        };
        Ok(best)
    }

    /// Doubles or halves the strokes `doublings` times, at most once; false where there is none to add or
    /// to remove.
    fn resize(&mut self, doublings: f64) -> bool {
        let strokes = self.drawing.len();
        let factor = doublings.clamp(-1.0, 1.0).exp2();
        let wanted = ((strokes as f64 * factor) as usize).clamp(1, self.terms.limit);
        if doublings > 0.0 {
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
    pub(super) fn finish(mut self, written: Written) -> Result<Fit> {
        let layers = self.drawing.layer_mses(&written.scene);
        for (record, (stage, mse)) in self
            .records
            .iter_mut()
            .zip(written.scene.stages.iter().zip(layers))
        {
            record.strokes = stage.strokes.len();
            record.layer_psnr_db = psnr_db(mse);
        }
        let mut softs = self.drawing.soft(&written.scene);
        let soft = match softs.as_slice() {
            [black, white] => ground::transparent(black, white)?,
            _ => softs.remove(0),
        };
        Ok(Fit {
            soft,
            scene: written.scene,
            base: self.base.cloned(),
            target: self.target,
            stages: self.records,
            stop: self.control.stopped().unwrap_or(self.stop),
            dropped: written.dropped + self.drawing.lost(),
        })
    }
}

/// Fidelity gained by doubling the strokes, dB, told from two drawings of so many strokes and dB each: what
/// the new strokes of a refined drawing bring depends on its base.
fn slope((few, few_db): (usize, f64), (many, many_db): (usize, f64)) -> f64 {
    let doublings = (many.max(1) as f64 / few.max(1) as f64).log2();
    let slope = (many_db - few_db) / doublings;
    if slope.is_finite() {
        slope.clamp(DB_PER_DOUBLING / 8.0, DB_PER_DOUBLING)
    } else {
        DB_PER_DOUBLING
    }
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
