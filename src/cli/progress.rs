//! The progress of a fit: a bar on a terminal, and with `--verbose` a line for each part as it ends, and now and then for one
//! that takes long.

use std::time::{Duration, Instant};

use strokefit::fit::Progress;

use super::bar::Bar;

/// Shows the progress of a fit.
pub(super) struct FitBar {
    bar: Bar,
    started: Instant,
    /// Strokes moved so far, each once an iteration.
    moves: u64,
}

impl FitBar {
    /// A bar that begins with `heading`.
    pub(super) fn new(quiet: bool, heading: String) -> Self {
        Self {
            bar: Bar::new(quiet, heading),
            started: Instant::now(),
            moves: 0,
        }
    }

    /// Shows how far the fit has come.
    pub(super) fn show(&mut self, progress: &Progress<'_>) {
        self.moves += progress.strokes as u64;
        let rate = self.moves as f64 / self.started.elapsed().as_secs_f64().max(1e-3);
        self.bar.show(progress.done, || caption(progress, rate));
    }

    /// Takes the bar off the screen, until the fit goes on.
    pub(super) fn clear(&mut self) {
        self.bar.clear();
    }
}

/// Where the fit stands, and how many strokes it moves in a second.
fn caption(progress: &Progress<'_>, rate: f64) -> String {
    let Progress {
        strokes, psnr_db, ..
    } = *progress;
    let (place, thousands) = (place(progress), rate / 1e3);
    format!("{place}, {strokes} strokes, {psnr_db:.2} dB, {thousands:.0} k moves/s")
}

/// The part of the fit that is under way; how many stages there will be is not always planned.
fn place(progress: &Progress<'_>) -> String {
    let Progress { stage, stages, .. } = *progress;
    let part = match stages {
        _ if progress.settling => "settling".into(),
        _ if progress.polishing => "polish".into(),
        0 => format!("stage {stage}"),
        _ => format!("stage {stage} of {stages}"),
    };
    match progress.is_trial {
        true => format!("trial, {part}"),
        false => part,
    }
}

/// Time after which a part that has not ended is told of, and told of again.
const PATIENCE: Duration = Duration::from_secs(5);

/// State of the part under way.
struct Part {
    place: String,
    began: Instant,
    told: Instant,
    iterations: usize,
    strokes: usize,
    psnr_db: f64,
}

/// Follows one fit.
#[derive(Default)]
pub(super) struct Narration(Option<Part>);

impl Narration {
    /// Notes how far the fit has come, and gives the line that is due, if one is.
    pub(super) fn watch(&mut self, progress: &Progress<'_>) -> Option<String> {
        let (place, now) = (place(progress), Instant::now());
        let ended = if self.0.as_ref().is_some_and(|part| part.place == place) {
            None
        } else {
            self.end()
        };
        let part = self.0.get_or_insert(Part {
            place,
            began: now,
            told: now,
            iterations: 0,
            strokes: 0,
            psnr_db: 0.0,
        });
        part.iterations += 1;
        (part.strokes, part.psnr_db) = (progress.strokes, progress.psnr_db);
        if now - part.told < PATIENCE {
            return ended;
        }
        part.told = now;
        let percent = 100.0 * progress.done;
        Some(format!("{}, {percent:.0} % of all", part.line()))
    }

    /// The line of the last part, which has ended.
    pub(super) fn end(&mut self) -> Option<String> {
        self.0.take().map(|part| part.line())
    }
}

impl Part {
    fn line(&self) -> String {
        let Self {
            place,
            began,
            iterations,
            strokes,
            psnr_db,
            ..
        } = self;
        let wall_s = began.elapsed().as_secs_f64();
        format!(
            "{place}: {strokes} strokes, {iterations} iterations, {wall_s:.2} s, {psnr_db:.2} dB"
        )
    }
}
