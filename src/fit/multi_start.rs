//! Multi-start: where chance or the kind of marks decides much, a fit draws from several starts and keeps the best drawing.
//!
//! | start | when | why |
//! | --- | --- | --- |
//! | at a quality, in place of a budget | few strokes, or flat art, in a budget of strokes or bytes | a budget takes what gains most: of a flat picture it may lack an outline and have a shadow, where what pays for its bytes is whole |
//! | shorter presets, and for bytes another seed | few strokes | each has many good places, and chance decides which one it finds, which moves the fidelity by some dB; a longer preset is never worse than a shorter one |
//! | the task itself | always | |
//! | strokes alone | many areas, or unfaithful ones | gradients and other uneven colours |
//!
//! [`is_better`](Starts::is_better) says which of two drawings is better. A start by strokes alone ends when its drawing
//! [cannot win](Costs::allow) any more. One with areas runs a race before its polish: [strokes alone](Costs::winner) go on in its place if
//! they cost less up to there.

use std::ops::{ControlFlow, Range};
use std::time::Duration;

use fearless_simd::Level;

use super::base::Base;
use super::budget::price::Price;
use super::budget::{self, reduction};
use super::config::{Budget, Config, DEFAULT_QUALITY};
use super::file::RenderedFile;
use super::order::{self, Phase, Purpose};
use super::phase;
use super::recipe::Preset;
use super::result::{Fit, Stop};
use super::run::checkpoint::Checkpoint;
use super::run::finish::{Drawn, finish};
use super::run::progress::{CancelToken, Observer, Progress, Watch};
use super::run::session::Session;
use super::task::Task;
use crate::clock::Instant;
use crate::error::Result;
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::Marks;

/// Most strokes of a drawing in which chance decides much. A guess.
const FEW_STROKES: usize = 64;
/// Halvings of the range of qualities. A guess.
const HALVINGS: usize = 4;
/// The range goes so far above the usual quality where that keeps the budget, dB. A guess.
const BEYOND_DB: f64 = 16.0;
/// A drawing with areas that has at most so many marks, unless all are where they were seen, and is at least as faithful, dB, is not
/// compared with strokes alone. Both are guesses.
const FEW_MARKS: usize = 30;
const FAITHFUL_DB: f64 = 38.0;
// Bounds of a finished drawing by strokes alone, measured on nine pictures that have doubtful areas.
/// Its bytes, in units of those before the polish, which still has strokes that will not pay: 0.36 to 0.97, of eight above 0.45.
const BYTES_AFTER_POLISH: f64 = 0.45;
/// Its cost, in units of that after the polish: 0.98 to 1.23.
const COST_AFTER_POLISH: f64 = 0.9;
/// Its cost, in units of that of the unrestricted drawing, in which errors near lost details count more: 0.69 to 1.11.
const COST_AT_LAST: f64 = 0.65;
// The cost of a drawing with areas in units of that by strokes alone, before both are polished, which gains more for strokes. Of 73
// pictures, strokes win in the end on 3 of 26 below 0.63, on 18 of 28 between, and on 17 of 19 above 1.
/// Strokes alone are not tried below this.
const WON: f64 = 0.63;
/// Strokes alone are drawn instead above this.
const LOST: f64 = 1.0;
/// Both run up to where all of their marks are polished: stages take a small part of the time, and the polish of a drawing with areas
/// most of it where these do not pay.
const RACE: Phase = Phase::Polish(Purpose::Plan);
/// The share of a limited time after which a drawing by strokes alone is not begun. A guess.
const LATEST: f64 = 0.5;

/// Draws `picture`, the restored and reduced one. The `checkpoint` keeps the state of the task itself; other starts are drawn again
/// by a fit that is resumed.
pub(super) fn draw<'a>(
    task: &'a Task,
    picture: &'a Image,
    level: Level,
    (watch, since): (Watch<'a>, Instant),
    checkpoint: Option<&mut Checkpoint>,
) -> Result<Fit> {
    let config = &task.config;
    let at_qualities = task.base.is_none() && draws_at_qualities(config, picture);
    let shorter = match task.base {
        Some(_) => Vec::new(),
        None => shorter(config, picture),
    };
    let by_strokes = by_strokes_alone(config).filter(|_| task.base.is_none());
    // The usual quality, those of the search, and the shortened drawing.
    let trials = if at_qualities { HALVINGS + 2 } else { 0 } + shorter.len();
    let pixels = picture.width() * picture.height();
    let mut starts = Starts {
        task,
        picture,
        level,
        since,
        costs: Costs {
            price: task.price(pixels),
            pixels,
        },
        watch,
        trials,
        part: 0.0..0.0,
        is_stopped: false,
        is_compared: trials > 0 || by_strokes.is_some(),
        best: None,
    };
    // 1. Trials.
    if at_qualities {
        starts.search_quality()?;
    }
    for config in shorter {
        if !starts.are_stopped() {
            let drawn = starts.trial(&task.with(config), None)?;
            starts.offer(drawn);
        }
    }
    let is_halted = starts.are_stopped() && starts.watch.grace.is_zero();
    if let Some(best) = starts.best.take_if(|_| is_halted) {
        return Ok(interrupted(best.fit));
    }
    // 2. The task itself, with which all work is done, or strokes alone.
    starts.part = starts.part.end..1.0;
    let by_strokes = by_strokes.map(|config| task.with(config));
    let drawn = starts.task_itself(by_strokes.as_ref(), checkpoint)?;
    let stop = drawn.fit.stop;
    // 3. Strokes alone, where areas are doubtful.
    let has_time = |limit: Duration| since.elapsed() <= limit.mul_f64(LATEST);
    let may_compete = stop != Stop::Interrupted
        && has_doubtful_areas(&drawn, task.doubt.most())
        && config.budget.time.is_none_or(has_time);
    let mut best = starts.better(drawn);
    if let Some(by_strokes) = by_strokes.filter(|_| may_compete) {
        let file = best.file.as_ref();
        let bound = file.and_then(|file| starts.costs.of(file.mse(), file.bytes));
        let rival = starts.trial(&by_strokes, bound)?;
        starts.best = Some(best);
        best = starts.better(rival);
    }
    // A stopped fit says so, whichever drawing is the better one.
    Ok(match stop {
        Stop::Interrupted => interrupted(best.fit),
        _ => best.fit,
    })
}

/// Runs the phase that a fit is in.
fn step(session: &mut Session<'_>) -> Result<()> {
    let outcome = phase::run(session)?;
    session.mark_as_final();
    session.phase = order::next(session.phase, outcome, session.config);
    session.keep(None);
    Ok(())
}

/// The result of a fit that was stopped.
fn interrupted(fit: Fit) -> Fit {
    Fit {
        stop: Stop::Interrupted,
        ..fit
    }
}

/// True if a drawing of `picture` by `config` competes with drawings of what pays at several qualities.
fn draws_at_qualities(config: &Config, picture: &Image) -> bool {
    let Budget { strokes, bytes, .. } = config.budget;
    let is_counted = strokes.is_some() || bytes.is_some();
    if !is_counted || is_alone(config) || config.preset == Preset::Draft {
        return false;
    }
    // Areas come from tracing, which needs points and no pens that draw lines.
    let may_trace = config.allows_points() && !config.pens_draw_lines();
    let by_areas = may_trace && config.marks != Marks::Strokes;
    draws_few(config, picture) || by_areas && reduction::is_flat(picture)
}

/// The configurations by which a drawing of few strokes is drawn as well.
fn shorter(config: &Config, picture: &Image) -> Vec<Config> {
    if is_alone(config) || !draws_few(config, picture) {
        return Vec::new();
    }
    let presets: &[Preset] = match config.preset {
        Preset::Draft => &[],
        Preset::Balanced => &[Preset::Draft],
        Preset::Best => &[Preset::Draft, Preset::Balanced],
    };
    let with = |preset, seed| Config {
        preset,
        seed,
        ..config.clone()
    };
    let mut configs: Vec<Config> = presets.iter().map(|&p| with(p, config.seed)).collect();
    let by_strokes: Vec<Config> = configs.iter().filter_map(by_strokes_alone).collect();
    configs.extend(by_strokes);
    // Bytes decide which strokes stay, which is chance as well.
    if config.budget.bytes.is_some() && config.preset != Preset::Draft {
        configs.push(with(Preset::Balanced, config.seed.wrapping_add(1)));
    }
    configs
}

/// True if no other start than strokes alone is of use: a search for a fidelity tries several numbers of strokes anyway, and a limited
/// time is for one fit.
fn is_alone(config: &Config) -> bool {
    config.budget.psnr_db.is_some() || config.budget.time.is_some()
}

fn draws_few(config: &Config, picture: &Image) -> bool {
    budget::strokes(config, None, picture).is_some_and(|strokes| strokes <= FEW_STROKES)
}

/// The configuration by strokes alone, if `config` has areas as well.
fn by_strokes_alone(config: &Config) -> Option<Config> {
    (config.marks() == Marks::Auto).then(|| Config {
        marks: Marks::Strokes,
        ..config.clone()
    })
}

/// True if there are areas that strokes alone may be better than, in a picture that may be off by `doubt`: what a damage leaves is no
/// reason to doubt them.
fn has_doubtful_areas(drawn: &Drawn, doubt: f32) -> bool {
    let scene = &drawn.fit.scene;
    let db = drawn.file.as_ref().map_or(0.0, |file| psnr_db(file.mse()));
    let are_many = are_many(scene.len(), drawn.is_placed);
    let has_won = drawn.lead.is_some_and(|lead| lead < WON);
    scene.areas().next().is_some() && !has_won && (are_many || (doubt == 0.0 && db < FAITHFUL_DB))
}

/// The starts of a fit, drawn one after the other. Their observer sees them as one piece of work.
struct Starts<'a> {
    task: &'a Task,
    picture: &'a Image,
    level: Level,
    since: Instant,
    costs: Costs,
    watch: Watch<'a>,
    /// Trials that are still to come, at most.
    trials: usize,
    /// The part of all work that the current drawing is, 0..1.
    part: Range<f64>,
    /// True if the observer has stopped a drawing.
    is_stopped: bool,
    /// True if there is more than one start, so that drawings are compared by their files.
    is_compared: bool,
    best: Option<Drawn>,
}

impl Starts<'_> {
    /// Searches by bisection for the highest quality at which what pays keeps the budget, and shortens the drawing just beyond it.
    fn search_quality(&mut self) -> Result<()> {
        let budget = self.task.config.budget;
        let usual = self.task.config.quality;
        let [mut low, mut high] = [0.0, usual.unwrap_or(DEFAULT_QUALITY)];
        let (mut quality, mut excessive) = (usual, None);
        for round in 0..=HALVINGS {
            let mut task = self.task.clone();
            (task.config.budget, task.config.quality) = (Budget::default(), quality);
            // Whole, a drawing is worth more than one whose shapes are elements of their own.
            task.most_marks = budget.strokes.unwrap_or(usize::MAX);
            let drawn = self.trial(&task, None)?;
            // A photograph is drawn as well by what gains most. One of a dark sky has much of one colour, too, but needs many strokes
            // for the rest; of a few, each counts.
            let scene = &drawn.fit.scene;
            let counted = scene.len().min(budget.strokes.unwrap_or(usize::MAX));
            let is_flat = scene.areas().next().is_some()
                || counted <= FEW_STROKES && reduction::is_flat(self.picture);
            // The usual quality first: if it keeps the budget, higher ones are searched, otherwise lower ones.
            let at = quality.unwrap_or(DEFAULT_QUALITY);
            let file = drawn.file.as_ref();
            if file.is_some_and(|file| budget::fits(&budget, file)) {
                low = at;
                if round == 0 {
                    high = at + BEYOND_DB;
                }
                self.offer(drawn);
            } else {
                high = at;
                excessive = Some(drawn.fit.scene);
            }
            if self.are_stopped() || round == 0 && !is_flat {
                return Ok(());
            }
            quality = Some((low + high) / 2.0);
        }
        if let Some(scene) = excessive {
            let mut task = self.task.clone();
            task.base = Some(Base {
                document: None,
                scene,
                width: None,
            });
            let mut shortened = self.trial(&task, None)?;
            shortened.fit.base = None;
            self.offer(shortened);
        }
        Ok(())
    }

    /// Draws a task that is not the last one, as far as it can cost less than `bound`.
    fn trial(&mut self, task: &Task, bound: Option<f64>) -> Result<Drawn> {
        // Each drawing gets an equal part of the work that is left. There may be fewer drawings than planned, so that the last one
        // takes all of the rest.
        let from = self.part.end;
        self.part = from..from + (1.0 - from) / (self.trials + 1) as f64;
        self.trials = self.trials.saturating_sub(1);
        let (picture, level, since) = (self.picture, self.level, self.since);
        let (costs, is_compared) = (self.costs, self.is_compared);
        let mut part = self.part(true);
        let mut session = Session::new(picture, task, level, part.watch(), since)?;
        let may_win =
            |session: &mut Session<'_>| bound.is_none_or(|bound| costs.allow(session, bound));
        while session.phase != Phase::Done && may_win(&mut session) {
            step(&mut session)?;
        }
        // A drawing that cannot win is compared as it is, at full resolution as all files are.
        if session.phase != Phase::Done {
            session.drawing.thaw();
            session.drawing.sharpen(0.0);
        }
        finish(session, is_compared)
    }

    /// Draws the task itself; or `by_strokes` alone, from where it loses against them.
    fn task_itself(
        &mut self,
        by_strokes: Option<&Task>,
        checkpoint: Option<&mut Checkpoint>,
    ) -> Result<Drawn> {
        let (task, picture, level, since) = (self.task, self.picture, self.level, self.since);
        let (costs, is_compared) = (self.costs, self.is_compared);
        let token = self.watch.token.clone();
        let unobserved = &mut ();
        let mut rival = by_strokes.map(|task| {
            let watch = Watch {
                observer: unobserved,
                token,
                grace: Duration::ZERO,
            };
            (task, watch)
        });
        let begin = |task, watch| Session::new(picture, task, level, watch, since);
        let mut part = self.part(false);
        let mut session = begin(task, part.watch())?;
        // 1. A fit that is resumed goes on with what had won.
        if let Some(checkpoint) = checkpoint {
            if let Some((by_strokes, watch)) =
                rival.take_if(|(task, _)| session.is_kept_as(task, checkpoint))
            {
                session = begin(by_strokes, watch)?.in_place_of(session);
            }
            session.resume(checkpoint)?;
        }
        // 2. The race.
        while session.phase != Phase::Done {
            if let Some((by_strokes, watch)) = rival.take_if(|_| is_up_to_race(&mut session)) {
                let mut rival = begin(by_strokes, watch)?;
                rival.progress.take_over(&mut session.progress);
                while rival.phase != RACE && rival.phase != Phase::Done {
                    step(&mut rival)?;
                }
                session.progress.take_over(&mut rival.progress);
                session = costs.winner(session, rival);
            }
            step(&mut session)?;
        }
        finish(session, is_compared)
    }

    /// The part of the work that the current drawing is.
    fn part(&mut self, is_trial: bool) -> Part<'_> {
        Part {
            observer: &mut *self.watch.observer,
            token: self.watch.token.clone(),
            grace: self.watch.grace,
            span: self.part.clone(),
            is_trial,
            is_stopped: &mut self.is_stopped,
        }
    }

    /// True if the observer or the token has stopped a drawing: no further one is to be tried.
    fn are_stopped(&self) -> bool {
        self.is_stopped || self.watch.token.is_cancelled()
    }

    /// Keeps the drawing if it is the best one so far.
    fn offer(&mut self, drawn: Drawn) {
        self.best = Some(self.better(drawn));
    }

    /// The better one of this drawing and the best one so far.
    fn better(&mut self, drawn: Drawn) -> Drawn {
        match self.best.take() {
            Some(best) if self.is_better(&best, &drawn) => best,
            _ => drawn,
        }
    }

    /// True if `a` is better than `b`. Those that keep the budget come first; then those of the least squared error and bytes at their
    /// price or, if bytes have none, by the budget.
    fn is_better(&self, a: &Drawn, b: &Drawn) -> bool {
        let (Some(file), Some(other)) = (&a.file, &b.file) else {
            return false;
        };
        let [keeps, other_keeps] = [file, other].map(|f| budget::fits(&self.task.config.budget, f));
        if keeps != other_keeps {
            return keeps;
        }
        let cost = |file: &RenderedFile| self.costs.of(file.mse(), file.bytes);
        let Some((own, others)) = cost(file).zip(cost(other)) else {
            return budget::is_better(&self.task.config.budget, file, other);
        };
        // As faithful with no more marks wins at any price of bytes, as its editor would have it.
        let wins = |a: &RenderedFile, b: &RenderedFile| {
            a.mse() <= b.mse() && a.rounded.scene.len() <= b.rounded.scene.len()
        };
        wins(file, other) || !wins(other, file) && own < others
    }
}

/// True of a drawing that is about to run a race: it has many areas that are not all where they were seen.
fn is_up_to_race(session: &mut Session<'_>) -> bool {
    let is_open = session.history.lead.is_none() && session.cut_by().is_none();
    if session.phase != RACE || !is_open {
        return false;
    }
    session.drawing.thaw();
    let marks = session.drawing.free();
    marks.has_areas() && are_many(marks.len(), session.drawing.is_placed())
}

/// True if there are so many marks that strokes alone may be better.
fn are_many(marks: usize, are_placed: bool) -> bool {
    marks > FEW_MARKS && !are_placed
}

/// The costs of drawings of a picture of so many pixels: squared error and bytes, beyond those of a perfect one of no bytes.
#[derive(Clone, Copy)]
struct Costs {
    price: Price,
    pixels: usize,
}

impl Costs {
    /// The cost of a drawing; `None` if bytes have no price.
    fn of(&self, mse: f64, bytes: usize) -> Option<f64> {
        let least = self.price.cost(0.0, self.pixels, 0)?;
        Some(self.price.cost(mse, self.pixels, bytes)? - least)
    }

    /// The cost of the drawing of a fit under way.
    fn so_far(&self, session: &mut Session<'_>) -> Option<f64> {
        self.of(session.drawing.mse(), session.bytes())
    }

    /// The winner of a race, which goes on: `session`, unless strokes alone cost less so far.
    fn winner<'a>(self, mut session: Session<'a>, mut rival: Session<'a>) -> Session<'a> {
        // The error of strokes alone is that at the resolution of their last stage, to which their edges are fitted so far.
        rival.drawing.thaw();
        let own = self.so_far(&mut session);
        let others = self.so_far(&mut rival);
        let lead = own.zip(others).map(|(own, others)| own / others);
        session.history.lead = lead;
        let is_lost = rival.cut_by().is_none() && lead.is_some_and(|lead| lead > LOST);
        match is_lost {
            true => rival.in_place_of(session),
            false => session,
        }
    }

    /// True if the drawing may still come to cost less than `bound`.
    fn allow(&self, session: &mut Session<'_>, bound: f64) -> bool {
        let least = match session.phase {
            // The polish takes most of the error away, so that the bytes decide.
            RACE => self.of(0.0, (BYTES_AFTER_POLISH * session.bytes() as f64) as usize),
            Phase::Recover => self.so_far(session).map(|cost| COST_AFTER_POLISH * cost),
            Phase::Restrict(_) => self.so_far(session).map(|cost| COST_AT_LAST * cost),
            _ => None,
        };
        least.is_none_or(|least| least < bound)
    }
}

/// The observer of one drawing of several: it reports to that of the whole fit, and remembers whether that has stopped it.
struct Part<'a> {
    observer: &'a mut (dyn Observer + Send),
    token: CancelToken,
    /// The last drawing may be finished after a stop, and reports its progress, unless this is zero.
    grace: Duration,
    /// The part of all work that the drawing is, 0..1.
    span: Range<f64>,
    is_trial: bool,
    is_stopped: &'a mut bool,
}

impl Part<'_> {
    fn watch(&mut self) -> Watch<'_> {
        Watch {
            token: self.token.clone(),
            grace: self.grace,
            observer: self,
        }
    }
}

impl Observer for Part<'_> {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        // Don't poll an observer that has stopped the fit.
        if *self.is_stopped && self.grace.is_zero() {
            return ControlFlow::Break(());
        }
        let Range { start, end } = self.span;
        let answer = self.observer.observe(&Progress {
            done: start + (end - start) * progress.done,
            is_trial: self.is_trial,
            ..*progress
        });
        *self.is_stopped |= answer.is_break();
        match *self.is_stopped {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn presets(strokes: Option<usize>, preset: Preset) -> Vec<Preset> {
        let picture = Image::filled(64, 64, [0.5; 3]).unwrap();
        let budget = Budget {
            strokes,
            ..Budget::default()
        };
        let config = Config {
            budget,
            preset,
            ..Config::default()
        };
        let configs = shorter(&config, &picture);
        configs.iter().map(|config| config.preset).collect()
    }

    #[test]
    fn few_strokes_compete_with_those_of_shorter_fits() {
        let of = |preset| presets(Some(20), preset);
        assert_eq!(of(Preset::Draft), []);
        // Each by strokes alone, too.
        assert_eq!(of(Preset::Balanced), [Preset::Draft; 2]);
        let shorter = [Preset::Draft, Preset::Balanced];
        assert_eq!(of(Preset::Best), [shorter, shorter].concat());
    }

    #[test]
    fn many_strokes_and_as_many_as_pay_have_no_rivals() {
        assert_eq!(presets(Some(65), Preset::Best), []);
        assert_eq!(presets(None, Preset::Balanced), []);
    }
}
