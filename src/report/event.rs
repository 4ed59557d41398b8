//! Events of a running command: each is a record for one line of JSON.

use serde::Serialize;

use super::{FitReport, Input};

/// Something that happened to one picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Event {
    /// The picture was read; work begins.
    Start(Input),
    /// The strokes of a stage were fitted.
    Stage(PhaseEntry),
    /// The strokes of all stages were fitted jointly; of one stage, where layers are polished alone.
    Polish(PhaseEntry),
    /// The files are written: the last event of a picture.
    Done(Box<FitReport>),
    /// Nothing was drawn: the last event of a picture.
    Failed {
        /// The picture as it was named.
        path: String,
        /// Why, in one line.
        error: String,
    },
}

/// A part of a fit that has ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseEntry {
    /// The picture as it was named.
    pub path: String,
    /// Index of the stage, from 1; one past the last for the polish of all. A stage that keeps no stroke in the
    /// end is no layer, and those after it are then numbered otherwise in the report.
    pub stage: usize,
    /// Strokes in the drawing.
    pub strokes: usize,
    /// Iterations of the optimiser.
    pub iterations: usize,
    /// Time since the start of the fit, s.
    pub elapsed_s: f64,
    /// Fidelity of the soft render, dB, at the resolution that is fitted at; `null` when perfect.
    pub psnr_db: Option<f64>,
    /// Part of the planned work that is done, 0..1.
    pub done: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_is_a_flat_object_with_its_name() {
        let phase = PhaseEntry {
            path: "a.png".into(),
            stage: 2,
            strokes: 9,
            iterations: 40,
            elapsed_s: 0.5,
            psnr_db: None,
            done: 0.25,
        };
        let expected = serde_json::json!({
            "event": "stage", "path": "a.png", "stage": 2, "strokes": 9, "iterations": 40,
            "elapsed_s": 0.5, "psnr_db": null, "done": 0.25,
        });
        assert_eq!(serde_json::to_value(Event::Stage(phase)).unwrap(), expected);
    }
}
