//! The history of a fit, apart from the drawing.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::base::Base;
use super::drawing::{Drawing, Memento};
use super::plan::PlannedStage;
use super::result::{StageRecord, Stop};
use crate::metrics::psnr_db;

/// The history of a fit, apart from the drawing.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct History {
    /// One record per stage, those of the base included.
    pub(super) records: Vec<StageRecord>,
    /// Layers and strokes that were traced.
    pub(super) traced: [usize; 2],
    /// The current stage, or the last one.
    pub(super) stage: Option<OpenStage>,
    /// What ended the stages, and in the end the fit.
    pub(super) stop: Stop,
    pub(super) corrections: Corrections,
    /// How much worse the drawing is because its colours are stacked, dB.
    pub(super) stacking_db: Option<f64>,
    /// The drawing that the best file was written from.
    pub(super) best: Option<Memento>,
}

/// A stage that was seeded.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct OpenStage {
    pub(super) planned: PlannedStage,
    /// Time from the beginning of the fit to that of the stage.
    pub(super) began: Duration,
    /// Strokes of the drawing before the stage, and their fidelity at the stage's resolution, dB.
    pub(super) before: (usize, f64),
    /// How many of its strokes were worth their price; `None` while they are being fitted.
    pub(super) accepted: Option<usize>,
}

/// Corrections of the number of strokes, towards the fidelity asked for.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Corrections {
    /// Corrections so far.
    pub(super) count: usize,
    /// Strokes of the last drawing that was far from that fidelity, and its own, dB.
    pub(super) approached: Option<(usize, f64)>,
    /// Strokes of the last file, and its fidelity, dB.
    pub(super) before: Option<(usize, f64)>,
    /// The most strokes of a file that missed the fidelity, and the fewest of one that reached it.
    pub(super) missed: usize,
    pub(super) reached: usize,
    /// True if the last strokes that were added brought too little for others to be of use.
    pub(super) is_hopeless: bool,
    /// Fidelity of the last file, dB.
    pub(super) last_db: f64,
    /// Whether strokes were removed from the last file for bytes.
    pub(super) shortened: bool,
    /// Fidelity gained by doubling the strokes, dB.
    pub(super) db_per_doubling: f64,
    /// Bytes of the drawing once strokes share widths and colours, in units of those before.
    pub(super) restricted: f32,
    /// True if bytes that were left have been used.
    pub(super) refilled: bool,
}

impl History {
    /// The history of a new fit, with the `records` of its base's layers, that ends for `stop` unless something else
    /// ends it first.
    pub(super) fn new(records: Vec<StageRecord>, db_per_doubling: f64, stop: Stop) -> Self {
        Self {
            records,
            traced: [0; 2],
            stage: None,
            stop,
            corrections: Corrections {
                count: 0,
                approached: None,
                before: None,
                missed: 0,
                reached: usize::MAX,
                is_hopeless: false,
                last_db: 0.0,
                shortened: false,
                db_per_doubling,
                restricted: 1.0,
                refilled: false,
            },
            stacking_db: None,
            best: None,
        }
    }

    /// Records the current stage: its `iterations`, and the mean squared error `mse` after them.
    pub(super) fn record(&mut self, iterations: usize, elapsed: Duration, mse: f64) {
        let Some(OpenStage { planned, began, .. }) = self.stage else {
            return;
        };
        let psnr_db = psnr_db(mse);
        match self.records.get_mut(planned.index) {
            Some(topped_up) => {
                topped_up.iterations += iterations;
                topped_up.psnr_db = psnr_db;
            }
            None => self.records.push(StageRecord {
                index: planned.index + 1,
                strokes: 0,
                iterations,
                wall: elapsed.saturating_sub(began),
                psnr_db,
                layer_psnr_db: 0.0,
            }),
        }
    }

    /// Sets why a fit ends that aims at a fidelity of `wanted_db`, and whose best file has `best_db`.
    pub(super) fn stop_at(&mut self, wanted_db: f64, best_db: f64) {
        self.stop = match self.stop {
            _ if best_db >= wanted_db => Stop::Psnr,
            Stop::Psnr => Stop::Converged,
            other => other,
        };
    }
}

/// Adds the strokes of `base` to `drawing`, and returns the records of its layers.
pub(super) fn load(drawing: &mut Drawing, base: &Base) -> Vec<StageRecord> {
    drawing.load(&base.scene);
    let mses = drawing.layer_mses(&base.scene).into_iter();
    mses.enumerate().map(kept_layer).collect()
}

/// The record of a layer of the base, from its index and the mean squared error after it.
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
