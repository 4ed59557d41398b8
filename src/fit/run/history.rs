//! The history of a fit, apart from the drawing.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::fit::base::Base;
use crate::fit::budget::plan::PlannedStage;
use crate::fit::descent::ties::Ties;
use crate::fit::drawing::{Drawing, Snapshot};
use crate::fit::result::{StageRecord, Stop};
use crate::metrics::psnr_db;

/// The history of a fit, apart from the drawing.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::fit) struct History {
    /// One record per stage, the base's stages included.
    pub(in crate::fit) records: Vec<StageRecord>,
    /// Layers and strokes that were traced.
    pub(in crate::fit) traced: [usize; 2],
    /// The pixels near details that the polish lost, row by row; errors count more there since then.
    pub(in crate::fit) lost: Vec<u32>,
    /// By how much the price was lowered, dB, because the polished drawing was below the floor.
    pub(in crate::fit) eased_db: f64,
    /// The cost before the polish, in units of that by strokes alone, if these have been compared.
    pub(in crate::fit) lead: Option<f64>,
    /// The current stage, or the last one.
    pub(in crate::fit) stage: Option<OpenStage>,
    /// Reason that ended the stages, and in the end the fit.
    pub(in crate::fit) stop: Stop,
    pub(in crate::fit) corrections: Corrections,
    /// Numbers of strokes that stay equal while the drawing settles.
    pub(in crate::fit) ties: Ties,
    /// Loss of fidelity because the colours are stacked, dB.
    pub(in crate::fit) stacking_db: Option<f64>,
    /// The drawing that the best file was written from.
    pub(in crate::fit) best: Option<Snapshot>,
}

/// A stage that was seeded.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(in crate::fit) struct OpenStage {
    pub(in crate::fit) planned: PlannedStage,
    /// Time from the beginning of the fit to the beginning of the stage.
    pub(in crate::fit) began: Duration,
    /// Strokes of the drawing before the stage, and their fidelity at the stage's resolution, dB.
    pub(in crate::fit) before: (usize, f64),
    /// Number of its strokes that were worth their price; `None` while they are being fitted.
    pub(in crate::fit) accepted: Option<usize>,
}

/// Corrections of the number of strokes, towards the fidelity asked for, and of bytes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::fit) struct Corrections {
    /// Strokes of the last drawing that was far from that fidelity, and its own, dB.
    pub(in crate::fit) approached: Option<(usize, f64)>,
    /// Strokes of each file that was measured, and its fidelity, dB.
    pub(in crate::fit) files: Vec<(usize, f64)>,
    /// Fidelity of the last file, dB.
    pub(in crate::fit) last_db: f64,
    /// True if strokes were removed from the last file for bytes.
    pub(in crate::fit) shortened: bool,
    /// Bytes of the drawing once strokes share widths and colours, in units of the bytes before.
    pub(in crate::fit) restricted: f32,
    /// True if bytes that were left have been used.
    pub(in crate::fit) refilled: bool,
}

impl History {
    /// The history of a new fit, with the `records` of its base's layers, that ends for `stop` unless something else
    /// ends it first.
    pub(in crate::fit) fn new(records: Vec<StageRecord>, stop: Stop) -> Self {
        Self {
            records,
            traced: [0; 2],
            lost: Vec::new(),
            eased_db: 0.0,
            lead: None,
            stage: None,
            stop,
            corrections: Corrections {
                approached: None,
                files: Vec::new(),
                last_db: 0.0,
                shortened: false,
                restricted: 1.0,
                refilled: false,
            },
            ties: Ties::default(),
            stacking_db: None,
            best: None,
        }
    }

    /// Records the current stage: its `iterations`, and the mean squared error `mse` after them.
    pub(in crate::fit) fn record(&mut self, iterations: usize, elapsed: Duration, mse: f64) {
        let Some(OpenStage { planned, began, .. }) = self.stage else {
            return;
        };
        let psnr_db = psnr_db(mse);
        match self.records.get_mut(planned.index) {
            // A stage that is topped up, or polished once more, keeps its one record.
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
}

/// Adds the strokes of `base` to `drawing`, and returns the records of its layers.
pub(in crate::fit) fn load(drawing: &mut Drawing, base: &Base) -> Vec<StageRecord> {
    drawing.load(&base.scene);
    let mses = drawing.layer_mses(&base.scene).into_iter();
    let record = |(index, mse)| StageRecord {
        index: index + 1,
        strokes: 0,
        iterations: 0,
        wall: Duration::ZERO,
        psnr_db: psnr_db(mse),
        layer_psnr_db: 0.0,
    };
    mses.enumerate().map(record).collect()
}
