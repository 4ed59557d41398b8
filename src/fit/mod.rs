//! The fit: picture in, drawing out.
//!
//! A [`Fitter`] adds strokes in stages, on a background or on a [`Base`]. Each stage seeds new strokes where
//! the residual is largest, fits them briefly with all earlier strokes frozen, and keeps those that pay. The polish
//! then fits all strokes jointly, and relocates those of least worth to where more is to be gained; small things that got lost
//! on the way are traced again. If the file may have
//! only a few colours or pens, the strokes are restricted to those. Settling takes the last steps against what the
//! written file really looks like. Finally the fit adds or removes strokes, and fits them again, until the file is as faithful and as short as the budgets ask for.
//!
//! [`Fitter::fit`] runs the phases: `order` says which follows which, and `phase` has a file for each. The session holds
//! the whole state of a fit. Between two phases, and between two iterations of most phases, a [`Checkpoint`] can keep
//! that state, and another process can go on from it.
//!
//! | module | about |
//! | --- | --- |
//! | `order`, `phase` | the phases: which follows which, and a file for each |
//! | `priced` | drawings of what pays, for a budget of strokes or bytes |
//! | `config`, `recipe` | options, and the tuned numbers of the phases |
//! | `budget` | limits, the price of a stroke, the plan of stages, the pixels that a drawing needs |
//! | `drawing` | strokes in progress, on surfaces of target, backdrop and canvas; the objective; the background |
//! | `descent` | gradient descent and its annealing |
//! | `edits` | marks and points in the place of others, which stay if they pay |
//! | `points` | points of strokes that come and go at their price |
//! | `file` | the written file, as resvg renders it |
//! | `run`, `time` | a fit under way: session, history, checkpoint, progress, finish; its clock and its forecast |

mod base;
mod budget;
mod config;
mod descent;
mod domain;
mod drawing;
mod edits;
mod file;
mod fitter;
mod options;
mod order;
mod phase;
mod points;
mod priced;
mod recipe;
mod result;
mod run;
mod simd;
mod time;
mod widths;
mod words;

pub use base::Base;
pub use budget::memory::predicted_rss_bytes;
pub(crate) use budget::memory::rss_bytes_of;
pub use config::{
    Background, Budget, Colors, Config, DEFAULT_QUALITY, DEFAULT_STROKES, ErrorWeighting,
    Execution, MAX_STROKES, MAX_THREADS, PIXELS_PER_STROKE, SCREEN_PIXELS,
};
pub use descent::anneal::final_softness;
pub use domain::seconds;
pub use drawing::focus::Focus;
pub use drawing::objective::Objective;
pub use fitter::Fitter;
pub use options::{OPTIONS, Options};
pub use recipe::Preset;
#[doc(hidden)]
pub use recipe::{
    Correction, Dense, Forms, Inks, Joins, Pens, Points, Polish, Rates, Recipe, Recoloring,
    Relocation, Rounds, Sharing, Stages,
};
pub use result::{Fit, StageRecord, Stop};
pub use run::checkpoint::Checkpoint;
pub use run::progress::{CancelToken, Observer, Progress};
pub use simd::Simd;
pub use widths::Widths;

use crate::clock::Instant;
use crate::damage::{self, Meant};
use crate::error::Result;
use crate::image::Image;
use budget::price::Price;
use budget::{reduction, rivals};
use order::{Outcome, Phase};
use phase::{count, grow, polish, recover, restrict, settle, trace};
use run::finish::{self, Drawn};
use run::session::{Session, Watch};
use run::trials::Trials;

impl Fitter<'_> {
    /// Draws `picture`.
    ///
    /// A picture with alpha gives a transparent drawing, unless a background colour is set.
    ///
    /// # Errors
    /// - [`ErrorKind::Config`](crate::ErrorKind::Config) when an option is outside its domain, the size of the base
    ///   differs from that of the picture, the palette lacks the background of the base, or the checkpoint belongs to
    ///   another fit.
    /// - [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the base cannot be rendered.
    /// - [`ErrorKind::Io`](crate::ErrorKind::Io) when the checkpoint is damaged or cannot be written.
    pub fn fit(mut self, picture: &Image) -> Result<Fit> {
        let since = self.since.unwrap_or_else(Instant::now);
        self.prepare(picture)?;
        let meant = self.meant(picture)?;
        let mut fit = self.fit_meant(
            meant.as_ref().map_or(picture, |meant| &meant.picture),
            since,
        )?;
        if let Some(meant) = meant {
            // The drawing is judged by the picture that was given.
            fit.target = picture.reduced(fit.target.width(), fit.target.height());
            fit.damage = Some(meant.damage);
        }
        Ok(fit)
    }

    /// The restored picture, if `picture` is damaged and damage is not to be drawn. A given fidelity covers everything in the
    /// picture, so nothing is restored for it.
    fn meant(&mut self, picture: &Image) -> Result<Option<Meant>> {
        if self.config.literal || self.config.budget.psnr_db.is_some() {
            return Ok(None);
        }
        let meant = self.execution.install(|| damage::meant(picture))??;
        self.doubt = meant.as_ref().map_or(0.0, |meant| meant.damage.doubt());
        Ok(meant)
    }

    /// Draws the restored picture.
    fn fit_meant(mut self, picture: &Image, since: Instant) -> Result<Fit> {
        let pool = self.execution.pool()?;
        let reduced = pool.install(|| self.reduce(picture));
        let picture = reduced.as_ref().unwrap_or(picture);
        let mut nobody = ();
        let observer = self.observer.take().unwrap_or(&mut nobody);
        let rivals = self.rivals(picture);
        let priced = self.most_of_what_pays(picture);
        let (token, has_grace) = (self.token.clone(), !self.grace.is_zero());
        let mut trials = Trials::new(observer, token, has_grace, priced + rivals.len());
        let mut best = match priced {
            0 => None,
            _ => self.best_of_what_pays(picture, since, &mut trials)?,
        };
        let competes = !rivals.is_empty() || best.is_some();
        for rival in rivals {
            if !trials.are_stopped() {
                let drawn = rival.draw(picture, since, trials.next(), competes)?;
                best = Some(drawn.or_better(best));
            }
        }
        if trials.are_halted()
            && let Some(best) = best
        {
            return Ok(best.interrupted());
        }
        let by_strokes = self.by_strokes_alone();
        let competes = competes || by_strokes.is_some();
        let price = Price::of(&self.config, self.doubt, picture.width() * picture.height());
        let mut drawn = self.draw(picture, since, trials.last(), competes)?;
        let stop = drawn.fit.stop;
        if let Some(rival) = by_strokes
            && stop != Stop::Interrupted
            && drawn.has_doubtful_areas()
            && rivals::has_time_for_another(&rival.config, since.elapsed())
        {
            let rival = rival.draw(picture, since, trials.next(), true)?;
            drawn = drawn.or_cheaper(rival, price);
        }
        let drawn = drawn.or_better(best);
        // A stopped fit says so, whichever drawing is the better one.
        Ok(match stop {
            Stop::Interrupted => drawn.interrupted(),
            _ => drawn.fit,
        })
    }

    /// The picture reduced to the pixels that its drawing needs, if these are fewer, or to the size that its base was drawn at.
    fn reduce(&mut self, picture: &Image) -> Option<Image> {
        let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
        let page = [side(picture.width()), side(picture.height())];
        let [width, height] = match &self.base {
            Some(base) if base.document.is_some() || base.scene.page != Some(page) => return None,
            Some(base) => [base.scene.width, base.scene.height].map(|px| px as usize),
            None => reduction::size(picture, &self.config)?,
        };
        // A page of a given width has the proportions of the drawing.
        self.page = Some(page).filter(|_| self.config.file.width.is_none());
        self.focus = self.focus.take().map(|focus| focus.reduced(width, height));
        Some(picture.reduced(width, height))
    }

    /// The fits of the drawings that this one competes with.
    fn rivals(&self, picture: &Image) -> Vec<Fitter<'static>> {
        let configs = match self.base {
            Some(_) => Vec::new(),
            None => rivals::of(&self.config, picture),
        };
        configs
            .into_iter()
            .map(|config| self.rival(config))
            .collect()
    }

    /// The fit by strokes alone of what this one draws by areas, too.
    fn by_strokes_alone(&self) -> Option<Fitter<'static>> {
        let config = rivals::by_strokes_alone(&self.config)?;
        self.base.is_none().then(|| self.rival(config))
    }

    fn rival(&self, config: Config) -> Fitter<'static> {
        Fitter {
            execution: self.execution,
            focus: self.focus.clone(),
            page: self.page,
            doubt: self.doubt,
            token: self.token.clone(),
            ..Fitter::new(config)
        }
    }

    /// Draws `picture` once, by a configuration that was checked. A drawing that `competes` with others has a file to be
    /// compared by.
    fn draw(
        mut self,
        picture: &Image,
        since: Instant,
        observer: &mut (dyn Observer + Send),
        competes: bool,
    ) -> Result<Drawn> {
        let recipe = Recipe {
            doubt: self.doubt,
            most_marks: self.most_marks.unwrap_or(usize::MAX),
            ..self.config.recipe()
        };
        self.config.recipe = Some(recipe);
        let (config, base, focus, page) = (&self.config, self.base.as_ref(), self.focus, self.page);
        let level = self.execution.simd.require()?;
        let (token, checkpoint, grace) = (self.token, self.checkpoint, self.grace);
        self.execution.pool()?.install(|| {
            let watch = Watch {
                observer,
                token,
                grace,
            };
            let task = (config, base, focus, page);
            let mut session = Session::new(picture, task, level, watch, since)?;
            if let Some(checkpoint) = checkpoint {
                session.resume(checkpoint)?;
            }
            while session.phase != Phase::Done {
                let outcome = run(&mut session)?;
                session.mark_as_final();
                session.phase = order::next(session.phase, outcome, config);
                session.keep(None);
            }
            finish::finish(session, competes)
        })
    }
}

/// Runs the phase that `session` is in.
fn run(session: &mut Session<'_>) -> Result<Outcome> {
    Ok(match session.phase {
        Phase::Base => count::try_base(session)?,
        Phase::Trace => trace::trace_lines(session)?,
        Phase::Grow => grow::next_stage(session)?,
        Phase::Stage(purpose) => grow::stage(session, purpose)?,
        Phase::StagePolish(_) => grow::stage_polish(session)?,
        Phase::Polish(purpose) => {
            polish::polish(session, purpose)?;
            count::approach_fidelity(session)
        }
        Phase::Recover => recover::recover(session)?,
        Phase::Restrict(_) => restrict::restrict(session)?,
        Phase::Settle(_) => settle::settle(session)?,
        Phase::Compare(_) => count::compare(session),
        Phase::MeetFidelity => count::meet_fidelity(session),
        Phase::MeetBytes => count::meet_bytes(session),
        Phase::Done => Outcome::Over,
    })
}
