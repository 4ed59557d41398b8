//! One drawing from start to end: read, fit, write, verify, report.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Result;
use strokefit::fit::{self, Fit, Observer, Progress, Stop};
use strokefit::image::Image;
use strokefit::report::{self, Event, FitReport, Input, Judged, Run, Usage};
use strokefit::scene::Dropped;
use strokefit::verify::MIN_AGREEMENT_DB;

use super::events::{Events, Phases};
use super::interrupt::Interrupt;
use super::options::Options;
use super::output::{self, Output};
use super::pictures::{Pictures, Subject};
use super::progress::Bar;
use super::{Status, Verbosity, complain, input};

/// What to draw, and where the results go.
pub(super) struct Job<'a> {
    /// The SVG to go on from.
    pub(super) base: Option<&'a Path>,
    pub(super) input: &'a Path,
    /// The SVG.
    pub(super) output: PathBuf,
    /// Pictures and animations beside it.
    pub(super) pictures: Vec<PathBuf>,
    pub(super) report: Option<PathBuf>,
    pub(super) options: &'a Options,
}

/// Draws a picture; the time budget started at the given instant, and the observer is told of progress.
pub(super) type Draw<'a> = dyn Fn(&Image, Instant, &mut (dyn Observer + Send)) -> Result<Fit> + 'a;

impl Job<'_> {
    /// Draws and writes; the bar begins with `heading`.
    pub(super) fn run(
        &self,
        outputs: &Outputs<'_>,
        events: &mut Events,
        heading: String,
        verbosity: Verbosity,
        draw: &Draw<'_>,
    ) -> Result<Drawn> {
        let start = Instant::now();
        let picture = input::picture_within(self.input, self.options.limits())?;
        let input = Input::new(self.input.display().to_string(), &picture);
        events.tell(&Event::Start(input));
        self.foretell(&picture, verbosity);
        let bar = Bar::new(verbosity.quiet, heading);
        let fit = self.watched(&picture, start, events, bar, draw)?;
        tell_stages(&fit, verbosity);
        tell_dropped(fit.dropped, verbosity);
        let judged = Judged::new(fit)?;
        outputs.svg.1.write(judged.svg.as_bytes())?;
        let drawn = Drawn {
            judged,
            wall: start.elapsed(),
        };
        let record = self.record(&drawn);
        if let Some((_, output)) = &outputs.report {
            output.write(report::json(&record)?.as_bytes())?;
        }
        outputs.pictures.write(&Subject {
            scene: drawn.judged.whole(),
            text: &drawn.judged.svg,
            target: Some(&drawn.judged.fit.target),
            scale: 1.0,
        })?;
        events.tell(&Event::Done(Box::new(record)));
        self.forget(&drawn)?;
        Interrupt::rest();
        Ok(drawn)
    }

    /// Says how much memory is about to be used.
    fn foretell(&self, picture: &Image, verbosity: Verbosity) {
        let bytes = fit::predicted_rss_bytes(picture, &self.options.config());
        verbosity.detail(format_args!("needs about {} MiB of memory", bytes >> 20));
    }

    /// Draws, showing and telling how it goes.
    fn watched(
        &self,
        picture: &Image,
        start: Instant,
        events: &mut Events,
        mut bar: Bar,
        draw: &Draw<'_>,
    ) -> Result<Fit> {
        let mut interrupt = Interrupt::watch()?;
        let mut phases = Phases::new(events, self.input.display().to_string());
        let mut observer = |progress: &Progress<'_>| {
            bar.show(progress);
            phases.watch(progress);
            interrupt.observe(progress)
        };
        let fit = draw(picture, start, &mut observer);
        phases.end();
        bar.clear();
        fit
    }

    /// Removes the checkpoint of a drawing that is written, unless there is more to be drawn of it.
    fn forget(&self, drawn: &Drawn) -> Result<()> {
        match self.options.checkpoint() {
            Some(checkpoint) if drawn.judged.fit.stop != Stop::Interrupted => {
                Ok(checkpoint.remove()?)
            }
            _ => Ok(()),
        }
    }

    fn record(&self, drawn: &Drawn) -> FitReport {
        let name = |path: &Path| path.display().to_string();
        let (input, base) = (name(self.input), self.base.map(name));
        let run = Run {
            input: &input,
            base: base.as_deref(),
            config: &self.options.config(),
            wall: drawn.wall,
            usage: Usage::now(),
        };
        FitReport::of(&drawn.judged, &run)
    }

    /// How it went, in a line.
    pub(super) fn summary(&self, drawn: &Drawn) -> String {
        format!(
            "{}: {} strokes, {} bytes, {:.2} s, fidelity {:.2} dB, agreement {:.2} dB",
            output::name(&self.output),
            drawn.judged.fit.scene.len(),
            drawn.judged.svg.len(),
            drawn.wall.as_secs_f64(),
            drawn.judged.verdict.fidelity.psnr_db,
            drawn.judged.verdict.agreement.psnr_db,
        )
    }

    /// The status of a drawing that was written. What is short of the promise is said even when quiet.
    pub(super) fn judge(&self, drawn: &Drawn) -> Status {
        let name = output::name(&self.output);
        if let Some(signal) = Interrupt::caught() {
            if drawn.judged.fit.stop == Stop::Interrupted {
                complain(format_args!(
                    "{name}: interrupted: the file holds the drawing as far as it had come"
                ));
            }
            return Status::Interrupted(signal);
        }
        if !drawn.judged.verdict.agrees() {
            complain(format_args!(
                "{name}: fidelity check failed: resvg's render agrees with the fit to {:.2} dB, less than {MIN_AGREEMENT_DB} dB: \
                 the file was kept; try --opaque or a higher --precision",
                drawn.judged.verdict.agreement.psnr_db
            ));
            return Status::Disagrees;
        }
        let reached = drawn.judged.verdict.fidelity.psnr_db;
        if let Some(wanted) = self.options.budget.psnr.filter(|wanted| reached < *wanted) {
            let stop = report::stop_word(drawn.judged.fit.stop);
            complain(format_args!(
                "{name}: target not reached: {reached:.2} dB of {wanted} (stopped by: {stop}): allow more strokes, bytes or time"
            ));
            return Status::TargetMissed;
        }
        if let Some(most) = self
            .options
            .budget
            .bytes
            .filter(|most| drawn.judged.svg.len() > *most)
        {
            complain(format_args!(
                "{name}: target not reached: {} bytes, more than {most}: allow more bytes",
                drawn.judged.svg.len()
            ));
            return Status::TargetMissed;
        }
        Status::Done
    }
}

/// Where the results go, known to be writable.
pub(super) struct Outputs<'a> {
    svg: (&'a Path, Output),
    report: Option<(&'a Path, Output)>,
    pictures: Pictures<'a>,
}

impl<'a> Outputs<'a> {
    pub(super) fn open(job: &'a Job<'_>) -> Result<Self> {
        let open = |path: &'a PathBuf| Output::open(path).map(|output| (path.as_path(), output));
        Ok(Self {
            svg: open(&job.output)?,
            report: job.report.as_ref().map(open).transpose()?,
            pictures: Pictures::open(&job.pictures, &job.options.film)?,
        })
    }

    /// Every file that is written.
    pub(super) fn all(&self) -> impl Iterator<Item = (&'a Path, &Output)> {
        let own = [&self.svg].into_iter().chain(&self.report);
        own.map(|(path, output)| (*path, output))
            .chain(self.pictures.all())
    }
}

/// A drawing that was written.
pub(super) struct Drawn {
    pub(super) judged: Judged,
    /// From the start of the job until the SVG is written.
    pub(super) wall: Duration,
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

fn tell_dropped(dropped: Dropped, verbosity: Verbosity) {
    let Dropped {
        non_finite,
        invisible,
        off_page,
        points,
    } = dropped;
    if dropped.total() > 0 {
        verbosity.detail(format_args!(
            "dropped strokes: {non_finite} not finite, {invisible} invisible, {off_page} off the page"
        ));
    }
    if points > 0 {
        verbosity.detail(format_args!(
            "dropped points that rounding made superfluous: {points}"
        ));
    }
}
