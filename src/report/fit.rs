//! The report of `strokefit fit` and `strokefit refine`, and their events as they run.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{Input, Judged, OnFocus, SCHEMA, Usage, gzip_bytes};
use crate::fit::{Base, Config, StageRecord, Stop, rss_bytes_of};
use crate::metrics::{Agreement, Quality};
use crate::scene::Dropped;
use crate::svg::{self, Travel};
use crate::verify::OnMattes;

/// Outcome of `strokefit fit`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The picture.
    pub input: Input,
    /// Strokes and areas in the drawing.
    pub strokes: usize,
    /// Areas among them.
    #[serde(default)]
    pub areas: usize,
    /// Points of all their paths together.
    pub points: usize,
    /// Strokes and areas that were dropped because they became non-finite or could not be seen.
    pub dropped: usize,
    /// Number of them for each reason.
    pub dropped_for: Dropped,
    /// One per layer of the drawing, in order.
    pub stages: Vec<StageRecord>,
    /// Length of the SVG text in bytes.
    pub svg_bytes: usize,
    /// Its length when compressed by gzip.
    pub svg_gzip_bytes: usize,
    /// Its length, head and layers included, per stroke or area; `null` where there is none.
    pub bytes_per_stroke: Option<f64>,
    /// Wall time from the start of the command to the verdict, s.
    pub wall_s: f64,
    /// CPU time of the process, all threads, s.
    pub cpu_s: Option<f64>,
    /// Peak memory of the process, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// The prediction of that, bytes.
    pub predicted_rss_bytes: u64,
    /// Why no more was done.
    pub stop: Stop,
    /// Loss of fidelity because colours have a layer each, dB; left out if they have not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stacking_db: Option<f64>,
    /// Travel of a pen that draws the file; left out unless its order is one of little travel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel: Option<Travel>,
    /// Key of every random draw.
    pub seed: u64,
    /// The SVG as rendered by resvg against the picture.
    pub fidelity: Quality,
    /// Our own soft render against the picture.
    pub soft: Quality,
    /// The SVG as rendered by resvg against our own soft render.
    pub agreement: Agreement,
    /// A transparent drawing on black, on white and on magenta; `null` for others.
    pub alpha: Option<OnMattes>,
    /// Fidelity where a mask let errors count, and elsewhere; `null` without a mask.
    #[serde(default)]
    pub focus: Option<OnFocus>,
    /// The SVG that the drawing goes on from; `null` where there is none.
    pub base: Option<BaseEntry>,
}

/// An SVG that was refined.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BaseEntry {
    /// As it was named; `-` for standard input.
    pub path: String,
    /// Strokes and areas that were taken up.
    pub strokes: usize,
    /// Elements that were passed through as they are.
    pub elements: usize,
}

/// Facts about a run that a report has and a drawing lacks.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Name of the picture; empty if it has none.
    pub input: &'a str,
    /// Name of the SVG that the drawing goes on from; `None` leaves it out of the report.
    pub base: Option<&'a str>,
    /// The configuration of the fit.
    pub config: &'a Config,
    /// Wall time to report.
    pub wall: Duration,
    /// Resources that the process has used; [`Usage::default`] if that says nothing about this fit.
    pub usage: Usage,
}

impl FitReport {
    /// The report of a drawing that was made in `run`.
    ///
    /// ```
    /// use std::time::Duration;
    /// use strokefit::fit::{Config, Fitter};
    /// use strokefit::image::Image;
    /// use strokefit::report::{self, FitReport, Judged, Run, Usage};
    ///
    /// let picture = Image::filled(32, 32, [0.8, 0.2, 0.1])?;
    /// let config = Config::default();
    /// let judged = Judged::new(Fitter::new(config.clone()).fit(&picture)?)?;
    /// let run = Run {
    ///     input: "red.png",
    ///     base: None,
    ///     config: &config,
    ///     wall: Duration::from_millis(20),
    ///     usage: Usage::default(),
    /// };
    /// let report = FitReport::of(&judged, &run);
    /// assert_eq!(report.strokes, 0);
    /// assert!(report::json(&report)?.starts_with("{\n  \"schema\": 1"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(judged: &Judged, run: &Run<'_>) -> Self {
        let Judged {
            fit,
            svg,
            soft,
            verdict,
            alpha,
            focus,
        } = judged;
        let strokes = fit.scene.len();
        Self {
            schema: SCHEMA,
            input: Input {
                damage: fit.damage,
                ..Input::new(run.input, &fit.target)
            },
            strokes,
            areas: fit.scene.areas().count(),
            points: fit.scene.points(),
            dropped: fit.dropped.total(),
            dropped_for: fit.dropped,
            stages: fit.stages.clone(),
            svg_bytes: svg.len(),
            svg_gzip_bytes: gzip_bytes(svg),
            bytes_per_stroke: (strokes > 0).then(|| svg.len() as f64 / strokes as f64),
            wall_s: run.wall.as_secs_f64(),
            cpu_s: run.usage.cpu_s,
            peak_rss_bytes: run.usage.peak_rss_bytes,
            predicted_rss_bytes: rss_bytes_of(&fit.target, fit.scene.page, run.config),
            stop: fit.stop,
            stacking_db: fit.stacking_db,
            travel: svg::travel(&fit.scene, &fit.file),
            seed: run.config.seed,
            fidelity: verdict.fidelity,
            soft: *soft,
            agreement: verdict.agreement,
            alpha: *alpha,
            focus: *focus,
            base: fit.base.as_ref().zip(run.base).map(BaseEntry::of),
        }
    }
}

impl BaseEntry {
    fn of((base, name): (&Base, &str)) -> Self {
        Self {
            path: name.into(),
            strokes: base.scene.len(),
            elements: base.elements(),
        }
    }
}

/// Something that happened to one picture: a line of JSON.
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
    fn the_fields_scripts_rely_on_are_there() {
        let quality = serde_json::json!({"psnr_db": null, "ssim": 1.0, "mse": 0.0, "l1": 0.0, "ssimulacra2": 100.0});
        let json = serde_json::json!({
            "schema": 1,
            "input": {"path": "a.png", "width": 4, "height": 3},
            "strokes": 9,
            "areas": 2,
            "points": 20,
            "dropped": 1,
            "dropped_for": {"non_finite": 0, "invisible": 0, "off_page": 1, "points": 5},
            "stages": [{"index": 1, "strokes": 9, "iterations": 40, "wall_s": 0.25, "psnr_db": 31.5, "layer_psnr_db": 30.5}],
            "svg_bytes": 900,
            "svg_gzip_bytes": 400,
            "bytes_per_stroke": 100.0,
            "wall_s": 0.5,
            "cpu_s": 0.75,
            "peak_rss_bytes": null,
            "predicted_rss_bytes": 12_582_912,
            "stop": "strokes",
            "seed": 7,
            "fidelity": quality,
            "soft": quality,
            "agreement": {"psnr_db": 41.0, "max_abs": 12, "patch_abs": 3},
            "alpha": {
                "black_db": 28.5, "white_db": null, "magenta_db": 29.0,
                "black_ssimulacra2": 61.5, "white_ssimulacra2": 100.0, "magenta_ssimulacra2": 60.0,
            },
            "focus": {"inside_db": 33.0, "outside_db": 21.5},
            "base": {"path": "b.svg", "strokes": 4, "elements": 0},
        });
        let report: FitReport = serde_json::from_value(json.clone()).unwrap();
        assert_eq!(report.fidelity.psnr_db, f64::INFINITY);
        assert_eq!(serde_json::to_value(&report).unwrap(), json);
        // A report from before areas has none.
        let mut former = json;
        former.as_object_mut().unwrap().remove("areas");
        let report: FitReport = serde_json::from_value(former).unwrap();
        assert_eq!(report.areas, 0);
    }

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
