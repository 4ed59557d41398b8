//! `--verbose`: a line for each part of a fit as it ends, and now and then for one that takes long.

use std::time::{Duration, Instant};

use strokefit::fit::Progress;

use super::progress::place;

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
