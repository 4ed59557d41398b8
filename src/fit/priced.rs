//! Drawings of what pays, for a budget of strokes or bytes.
//!
//! Such a budget takes what gains most, however many marks that needs to be whole: of a flat picture it may lack an outline
//! and have a shadow. What pays for its bytes at a quality is whole. So such drawings compete, each by itself: at the
//! highest quality that keeps the budget, and at the next one, shortened to the budget.

use super::budget::{reduction, rivals};
use super::config::{Budget, Config, DEFAULT_QUALITY};
use super::fitter::Fitter;
use super::run::finish::Drawn;
use super::run::trials::Trials;
use crate::clock::Instant;
use crate::error::Result;
use crate::image::Image;

/// Halvings of the range of qualities. A guess.
const HALVINGS: usize = 4;

/// The range goes so far above the usual quality where that keeps the budget, dB. A guess.
const BEYOND_DB: f64 = 16.0;

/// A search by halves for the highest quality that keeps the budget.
struct Search {
    low: f64,
    high: f64,
    /// The best drawing that keeps it.
    best: Option<Drawn>,
    /// The drawing of the least quality that exceeds it.
    excessive: Option<Drawn>,
}

impl Search {
    /// Takes the drawing of a quality into account.
    fn take(&mut self, drawn: Drawn, quality: f64) {
        if drawn.keeps_budget() {
            self.low = quality;
            self.best = Some(drawn.or_better(self.best.take()));
        } else {
            self.high = quality;
            self.excessive = Some(drawn);
        }
    }
}

impl Fitter<'_> {
    /// Number of drawings of what pays that `picture` has, at most.
    pub(super) fn most_of_what_pays(&self, picture: &Image) -> usize {
        match self.base.is_none() && rivals::has_priced(&self.config, picture) {
            // The usual quality, the qualities of the search, and the shortened drawing.
            true => HALVINGS + 2,
            false => 0,
        }
    }

    /// The best drawing of `picture` of what pays that keeps the budget, of those with rivals.
    pub(super) fn best_of_what_pays(
        &self,
        picture: &Image,
        since: Instant,
        trials: &mut Trials<'_>,
    ) -> Result<Option<Drawn>> {
        let usual = self.config.quality;
        let mut search = Search {
            low: 0.0,
            high: usual.unwrap_or(DEFAULT_QUALITY),
            best: None,
            excessive: None,
        };
        let drawn = self.priced(usual, picture, since, trials)?;
        // A photograph of a dark sky has much of one colour, too, but needs many strokes for the rest. Of a few, each counts.
        let most = rivals::FEW;
        let allowed = self.config.budget.strokes.unwrap_or(usize::MAX);
        let is_short = drawn.strokes().min(allowed) <= most;
        let is_flat = drawn.has_areas() || is_short && reduction::is_flat(picture);
        // The usual quality first: if it keeps the budget, higher ones are searched, otherwise lower ones.
        search.take(drawn, search.high);
        // A photograph is drawn as well by what gains most.
        if !is_flat || trials.are_stopped() {
            return Ok(search.best);
        }
        if search.best.is_some() {
            search.high += BEYOND_DB;
        }
        for _ in 0..HALVINGS {
            let quality = (search.low + search.high) / 2.0;
            let drawn = self.priced(Some(quality), picture, since, trials)?;
            search.take(drawn, quality);
            if trials.are_stopped() {
                return Ok(search.best);
            }
        }
        let Some(excessive) = search.excessive else {
            return Ok(search.best);
        };
        // The drawing just beyond the budget is the base of one more fit, which shortens it to the budget.
        let rival = Fitter {
            base: Some(excessive.into_base()),
            ..self.rival(self.config.clone())
        };
        let shortened = rival
            .draw(picture, since, trials.next(), true)?
            .without_base();
        Ok(Some(shortened.or_better(search.best)))
    }

    /// The drawing of what pays at a `quality`, the usual one if `None`, to be compared by the budget.
    fn priced(
        &self,
        quality: Option<f64>,
        picture: &Image,
        since: Instant,
        trials: &mut Trials<'_>,
    ) -> Result<Drawn> {
        let mut rival = self.rival(Config {
            budget: Budget::default(),
            quality,
            ..self.config.clone()
        });
        // Whole, a drawing is worth more than one whose shapes are elements of their own.
        rival.most_marks = self.config.budget.strokes;
        let drawn = rival.draw(picture, since, trials.next(), true)?;
        Ok(drawn.for_budget(self.config.budget))
    }
}
