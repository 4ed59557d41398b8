//! The progress of a fit, on a terminal only.

use std::time::Instant;

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
pub(super) fn place(progress: &Progress<'_>) -> String {
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
