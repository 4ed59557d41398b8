//! Strokes are added and removed until the file is as faithful, and as short, as asked for.

use serde::{Deserialize, Serialize};

use super::{Task, Work};
use crate::fit::Stop;
use crate::fit::plan::PlannedStage;
use crate::metrics::psnr_db;

/// Fidelity gained by doubling the strokes, dB.
const DB_PER_DOUBLING: f64 = 2.8;
/// How often strokes are added or removed to meet a fidelity.
const CORRECTIONS: usize = 6;
/// A fidelity is met well enough when exceeded by no more than this, dB.
const EXCESS_DB: f64 = 0.1;
/// Share of the polish's iterations that follow a correction.
const REPOLISH: f64 = 0.4;

/// How a fidelity is approached by adding and removing strokes.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Corrections {
    /// How often that was done.
    pub(super) count: usize,
    /// Strokes before the last time, and their fidelity, dB.
    before: Option<(usize, f64)>,
    /// Fidelity of the last file, dB.
    pub(super) last_db: f64,
    db_per_doubling: f64,
}

impl Default for Corrections {
    fn default() -> Self {
        Self {
            count: 0,
            before: None,
            last_db: 0.0,
            db_per_doubling: DB_PER_DOUBLING,
        }
    }
}

impl Work<'_> {
    /// Adds or removes strokes where the last file is not as faithful as wanted, or more.
    pub(in crate::fit) fn meet_fidelity(&mut self) {
        let Some(wanted) = self.config.budget.psnr_db else {
            return;
        };
        let now = (self.drawing.len(), self.standing.corrections.last_db);
        let corrections = &mut self.standing.corrections;
        if let Some(before) = corrections.before.filter(|_| self.base.is_some()) {
            corrections.db_per_doubling = slope(before, now);
        }
        corrections.before = Some(now);
        let missing_db = wanted - corrections.last_db;
        let doublings = missing_db / corrections.db_per_doubling;
        let is_met = (0.0..=EXCESS_DB).contains(&-missing_db);
        let is_cut = self.control.cut_by().is_some();
        let ends = is_met || is_cut || self.standing.corrections.count >= CORRECTIONS;
        if ends || !self.resize(doublings) {
            self.standing.stop = self.stop_at(wanted);
        }
    }

    /// Doubles or halves the strokes `doublings` times, at most once, and sees to it that they are fitted;
    /// false where there is none to add or to remove.
    fn resize(&mut self, doublings: f64) -> bool {
        let factor = doublings.clamp(-1.0, 1.0).exp2();
        let wanted = (self.drawing.len() as f64 * factor) as usize;
        let wanted = wanted.clamp(1, self.terms.limit);
        let (added, removed) = self.change(wanted, doublings > 0.0);
        if added + removed == 0 {
            return false;
        }
        self.standing.corrections.count += 1;
        self.then(Task::MeetFidelity);
        self.then(Task::Settle);
        let steps = self.recipe.polish_iterations as f64 * REPOLISH;
        self.then(Task::Polish(steps as usize));
        if added > 0 {
            self.seed(PlannedStage {
                index: self.standing.records.len(),
                count: added,
                scale: self.recipe.scale * self.drawing.spacing(wanted),
            });
        } else {
            self.remove(removed);
        }
        true
    }

    /// How many strokes to add, at least one, or to remove, where about `wanted` are to be left.
    fn change(&self, wanted: usize, grows: bool) -> (usize, usize) {
        let (strokes, most) = (self.drawing.len(), self.terms.limit);
        if grows {
            let grown = wanted.max(strokes + 1).min(most);
            (grown.saturating_sub(strokes), 0)
        } else {
            (0, strokes.saturating_sub(wanted))
        }
    }

    /// Ends the corrections: no stroke is left that helps.
    pub(super) fn give_up(&mut self) {
        self.standing.agenda = vec![Task::MeetBytes];
        if let Some(wanted) = self.config.budget.psnr_db {
            self.standing.stop = self.stop_at(wanted);
        }
    }

    /// Why a fit ended that was to be as faithful as `wanted`, dB.
    fn stop_at(&self, wanted: f64) -> Stop {
        let best_db = self.best.as_ref().map_or(0.0, |best| psnr_db(best.mse));
        match self.standing.stop {
            _ if best_db >= wanted => Stop::Psnr,
            Stop::Psnr => Stop::Converged,
            other => other,
        }
    }

    /// Removes the strokes worth least where the best file has more bytes than allowed.
    pub(in crate::fit) fn meet_bytes(&mut self) {
        let bytes = self.best.as_ref().map_or(0, |best| best.bytes);
        let most = self.config.budget.bytes.unwrap_or(usize::MAX);
        if bytes <= most || self.drawing.len() == 0 {
            return;
        }
        if self.standing.stop != Stop::Bytes
            && let Some(best) = self.standing.best.clone()
        {
            self.drawing.resume(best);
        }
        self.standing.stop = Stop::Bytes;
        let share = (bytes - most) as f64 / bytes as f64;
        self.remove(((self.drawing.len() as f64 * share).ceil() as usize).max(1));
        self.then(Task::MeetBytes);
        self.then(Task::Settle);
    }

    /// Removes the `count` strokes worth least.
    fn remove(&mut self, count: usize) {
        let worth = self.drawing.judge().worth;
        let mut order: Vec<usize> = (0..worth.len()).collect();
        order.sort_by(|&i, &j| worth[i].total_cmp(&worth[j]).then(i.cmp(&j)));
        let mut keep = vec![true; worth.len()];
        order.into_iter().take(count).for_each(|i| keep[i] = false);
        self.drawing.retain_free(&keep);
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
