//! One drawing from start to end: read, fit, write, verify, report.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Result;
use strokefit::fit::{Fit, Observer};
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::report::{self, FitReport, Input, StageEntry, Usage};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, MIN_AGREEMENT_DB, Verdict};

use super::options::Options;
use super::output::{self, Output};
use super::progress::Bar;
use super::{Status, Verbosity, complain, input, misuse};

/// What to draw, and where the results go.
pub(super) struct Job<'a> {
    pub(super) input: &'a Path,
    pub(super) output: &'a Path,
    pub(super) report: Option<&'a Path>,
    pub(super) options: &'a Options,
}

/// What draws a picture, telling the observer how it goes.
type Draw<'a> = dyn Fn(&Image, &mut (dyn Observer + Send)) -> Result<Fit> + 'a;

impl Job<'_> {
    /// Draws, and says on standard error how it went.
    pub(super) fn run(&self, verbosity: Verbosity, draw: &Draw<'_>) -> Result<Status> {
        let start = Instant::now();
        let picture = input::picture(self.input)?;
        let outputs = Outputs::open(self)?;
        let mut bar = Bar::new(verbosity.quiet);
        let fit = draw(&picture, &mut bar);
        bar.clear();
        let fit = fit?;
        tell_stages(&fit, verbosity);
        let drawn = Drawn::new(fit, self.options.look.precision)?;
        outputs.svg.write(drawn.text.as_bytes())?;
        let wall = start.elapsed();
        if let Some(output) = &outputs.report {
            output.write(&json(&self.record(&drawn, wall))?)?;
        }
        verbosity.say(self.summary(&drawn, wall));
        Ok(self.judge(&drawn))
    }

    fn record(&self, drawn: &Drawn, wall: Duration) -> FitReport {
        let Usage {
            cpu_s,
            peak_rss_bytes,
        } = Usage::now();
        FitReport {
            schema: report::SCHEMA,
            input: Input::new(self.input.display().to_string(), &drawn.fit.target),
            strokes: drawn.fit.scene.len(),
            dropped: drawn.fit.dropped,
            stages: drawn.fit.stages.iter().map(StageEntry::from).collect(),
            svg_bytes: drawn.text.len(),
            wall_s: wall.as_secs_f64(),
            cpu_s,
            peak_rss_bytes,
            stop: report::stop_word(drawn.fit.stop).into(),
            seed: self.options.look.seed,
            fidelity: drawn.verdict.fidelity,
            soft: drawn.soft,
            agreement: drawn.verdict.agreement,
        }
    }

    fn summary(&self, drawn: &Drawn, wall: Duration) -> String {
        format!(
            "{}: {} strokes, {} bytes, {:.2} s, fidelity {:.2} dB, agreement {:.2} dB",
            output::name(self.output),
            drawn.fit.scene.len(),
            drawn.text.len(),
            wall.as_secs_f64(),
            drawn.verdict.fidelity.psnr_db,
            drawn.verdict.agreement.psnr_db,
        )
    }

    /// The status of a drawing that was written. What is short of the promise is said even when quiet.
    fn judge(&self, drawn: &Drawn) -> Status {
        if !drawn.verdict.agrees() {
            complain(format_args!(
                "fidelity check failed: resvg draws the file {:.2} dB from what was fitted, the bound is {MIN_AGREEMENT_DB} dB: \
                 the file was kept; try --opaque or a higher --precision",
                drawn.verdict.agreement.psnr_db
            ));
            return Status::Disagrees;
        }
        let reached = drawn.verdict.fidelity.psnr_db;
        if let Some(wanted) = self.options.budget.psnr.filter(|wanted| reached < *wanted) {
            let stop = report::stop_word(drawn.fit.stop);
            complain(format_args!(
                "target not reached: {reached:.2} dB of {wanted} (stopped by: {stop}): allow more strokes, bytes or time"
            ));
            return Status::TargetMissed;
        }
        if let Some(most) = self
            .options
            .budget
            .bytes
            .filter(|most| drawn.text.len() > *most)
        {
            complain(format_args!(
                "target not reached: {} bytes, more than {most}: allow more",
                drawn.text.len()
            ));
            return Status::TargetMissed;
        }
        Status::Done
    }
}

/// Where the results go, known to be writable.
struct Outputs {
    svg: Output,
    report: Option<Output>,
}

impl Outputs {
    fn open(job: &Job<'_>) -> Result<Self> {
        let svg = Output::open(job.output)?;
        let report = job.report.map(Output::open).transpose()?;
        if report.as_ref() == Some(&svg) {
            return Err(misuse(format!(
                "{}: SVG and report cannot go to the same place: name another",
                job.output.display()
            )));
        }
        let outputs = Self { svg, report };
        if !input::is_stdin(job.input) && outputs.all().any(|output| output.is(job.input)) {
            return Err(misuse(format!(
                "{}: would be overwritten: name another output",
                job.input.display()
            )));
        }
        Ok(outputs)
    }

    fn all(&self) -> impl Iterator<Item = &Output> {
        [&self.svg].into_iter().chain(&self.report)
    }
}

/// A drawing with its text and the judgement of it.
struct Drawn {
    fit: Fit,
    text: String,
    soft: Quality,
    verdict: Verdict,
}

impl Drawn {
    fn new(fit: Fit, precision: u8) -> Result<Self> {
        let text = svg::write(&fit.scene, &WriteOptions { precision });
        let soft = Quality::between(&fit.target, &fit.soft)?;
        let verdict = verify::verify(&text, &fit.target, &fit.soft)?;
        Ok(Self {
            fit,
            text,
            soft,
            verdict,
        })
    }
}

fn tell_stages(fit: &Fit, verbosity: Verbosity) {
    for stage in &fit.stages {
        verbosity.detail(format_args!(
            "stage {}: {} strokes, {} iterations, {:.2} s, {:.2} dB",
            stage.index,
            stage.strokes,
            stage.iterations,
            stage.wall.as_secs_f64(),
            stage.psnr_db
        ));
    }
}

/// A record as indented JSON.
pub(super) fn json(record: &impl serde::Serialize) -> Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec_pretty(record)?;
    bytes.push(b'\n');
    Ok(bytes)
}
