//! One drawing from start to end: read, fit, write, verify, report.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Result;
use strokefit::fit::{self, DEFAULT_STROKES, Fit, Observer, PIXELS_PER_STROKE, Progress, Stop};
use strokefit::image::Image;
use strokefit::metrics::{Agreement, Quality, psnr_db};
use strokefit::report::{self, Event, FitReport, Input, Judged, Run, Usage};
use strokefit::restore::Paper;
use strokefit::scene::{Dropped, Marks};
use strokefit::verify::MIN_AGREEMENT_DB;

use super::hint::Hint;
use super::interrupt::Interrupt;
use super::options::Options;
use super::output::{self, Output};
use super::pictures::{self, Pictures};
use super::progress::{Events, Watching};
use super::{Status, Verbosity, complain, input};

/// Picture to draw, and places for the results, known to be writable.
pub(super) struct Job<'a> {
    /// The SVG to go on from.
    pub(super) base: Option<&'a Path>,
    pub(super) input: &'a Path,
    pub(super) options: &'a Options,
    svg: (PathBuf, Output),
    report: Option<(PathBuf, Output)>,
    /// Pictures and animations beside the SVG.
    pictures: Pictures,
}

/// Draws a picture; the time budget started at the given instant, and the observer is told of progress.
pub(super) type Draw<'a> = dyn Fn(&Image, Instant, &mut (dyn Observer + Send)) -> Result<Fit> + 'a;

impl<'a> Job<'a> {
    /// The job that writes files of these names.
    pub(super) fn open(
        base: Option<&'a Path>,
        input: &'a Path,
        outputs: &[PathBuf],
        report: Option<&Path>,
        options: &'a Options,
    ) -> Result<Self> {
        let (svg, pictures) = pictures::split(outputs)?;
        let open = |path: &Path| Output::open(path).map(|output| (path.to_owned(), output));
        Ok(Self {
            base,
            input,
            options,
            svg: open(svg)?,
            report: report.map(open).transpose()?,
            pictures: Pictures::open(&pictures, options.film)?,
        })
    }

    /// Every file that is written.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (&Path, &Output)> {
        let own = [&self.svg].into_iter().chain(&self.report);
        own.map(|(path, output)| (path.as_path(), output))
            .chain(self.pictures.all())
    }

    /// Draws and writes; the bar begins with `heading`. A failure is an event too.
    pub(super) fn run(
        &self,
        heading: String,
        events: &mut Events,
        verbosity: Verbosity,
        draw: &Draw<'_>,
    ) -> Result<Drawn> {
        let drawn = self.drawn(heading, events, verbosity, draw);
        if let Err(error) = &drawn {
            let (path, error) = (self.input.display().to_string(), Hint::split(error).0);
            events.tell(&Event::Failed { path, error });
        }
        drawn
    }

    fn drawn(
        &self,
        heading: String,
        events: &mut Events,
        verbosity: Verbosity,
        draw: &Draw<'_>,
    ) -> Result<Drawn> {
        let start = Instant::now();
        let (picture, remarks) = input::picture_within(self.input, self.options.limits())?;
        let name = self.input.display().to_string();
        let input = Input::new(name.clone(), &picture).remarking(&remarks);
        for remark in &remarks {
            let line = format!("{}: {remark}", input::name(self.input));
            if remark.is_warning() {
                verbosity.say(line);
            } else {
                verbosity.detail(line);
            }
        }
        events.tell(&Event::Start(input.clone()));
        let memory = fit::predicted_rss_bytes(&picture, &self.options.config());
        verbosity.detail(format_args!("needs about {} MiB of memory", memory >> 20));
        // Draws, showing and telling how it goes.
        let mut watching = Watching::new(heading, name.clone(), events, verbosity);
        let mut interrupt = Interrupt::watch()?;
        let fit = draw(&picture, start, &mut |progress: &Progress<'_>| {
            watching.watch(progress);
            interrupt.observe(progress)
        });
        watching.end(matches!(&fit, Ok(fit) if fit.stop != Stop::Interrupted));
        let fit = fit?;
        tell_omitted(&fit, input::name(self.input), verbosity);
        let judged = Judged::new(fit)?;
        // The SVG comes first: what goes wrong later leaves the drawing there.
        let subject = self.options.subject(&judged)?;
        self.svg.1.write(&subject.drawing(&self.svg.0)?)?;
        let wall = start.elapsed();
        let base = self.base.map(|path| path.display().to_string());
        let run = Run {
            input: &name,
            base: base.as_deref(),
            config: &self.options.config(),
            wall,
            usage: Usage::now(),
        };
        let record = FitReport {
            input: Input {
                damage: judged.fit.damage,
                ..input
            },
            ..FitReport::of(&judged, &run)
        };
        if let Some((_, output)) = &self.report {
            output.write(report::json(&record)?.as_bytes())?;
        }
        self.pictures.write(&subject)?;
        drop(subject);
        events.tell(&Event::Done(Box::new(record)));
        // A checkpoint has served, unless there is more to be drawn.
        if let Some(checkpoint) = self.options.checkpoint()
            && judged.fit.stop != Stop::Interrupted
        {
            checkpoint.remove()?;
        }
        Interrupt::rest();
        Ok(Drawn { judged, wall })
    }

    /// Outcome in a line.
    pub(super) fn summary(&self, drawn: &Drawn) -> String {
        let Judged {
            fit, svg, verdict, ..
        } = &drawn.judged;
        format!(
            "{}: {}, {} bytes, {:.2} s, fidelity {:.2} dB, agreement {:.2} dB",
            output::name(&self.svg.0),
            fit.scene.counted(),
            svg.len(),
            drawn.wall.as_secs_f64(),
            verdict.fidelity.psnr_db,
            verdict.agreement.psnr_db,
        )
    }

    /// The status of a drawing that was written. What is short of the promise is said even when quiet.
    pub(super) fn judge(&self, drawn: &Drawn, verbosity: Verbosity) -> Status {
        let name = output::name(&self.svg.0);
        let Judged {
            fit, svg, verdict, ..
        } = &drawn.judged;
        let config = self.options.config();
        if let Some(signal) = Interrupt::caught() {
            if fit.stop == Stop::Interrupted {
                complain(format_args!(
                    "{name}: interrupted: the file holds the drawing as far as it had come"
                ));
            }
            return Status::Interrupted(signal);
        }
        let missed = |why: String| {
            complain(format_args!("{name}: target not reached: {why}"));
            Status::TargetMissed
        };
        let is_open = config.is_open() && self.base.is_none();
        if is_dithered(&drawn.judged, is_open) {
            verbosity.say(format_args!(
                "{name}: the picture is of dots or noise finer than strokes: blur it, or give the picture before it was dithered"
            ));
        }
        let strokes = fit.scene.len();
        if is_open && fit.stop == Stop::Strokes && 10 * strokes >= 9 * DEFAULT_STROKES {
            verbosity.say(format_args!(
                "{name}: more strokes would pay, but {strokes} are the most unless --strokes or --quality asks for more"
            ));
        }
        if let Some(seen) = lost(&drawn.judged).filter(|_| is_open) {
            verbosity.say(format_args!(
                "{name}: much of the picture is lost (SSIMULACRA2 {seen:.0}): --quality {CLOSE} keeps more"
            ));
        }
        if config.paper == Paper::White && !is_relit(fit) {
            complain(format_args!(
                "{name}: nothing became white: no paper was found that is not white already, and with --literal or --psnr none is looked for"
            ));
        }
        let budget = config.budget;
        if let Some(most) = budget.bytes.filter(|_| is_blank(&drawn.judged)) {
            return missed(format!(
                "no stroke fits in {most} bytes: the empty page takes {}, and a first stroke about {FIRST_STROKE_BYTES} more",
                svg.len()
            ));
        }
        if config.marks == Marks::Areas && is_blank(&drawn.judged) {
            complain(format_args!(
                "{name}: the page is empty: the picture has no areas of one colour or gradient: give --marks auto"
            ));
            return Status::Failed;
        }
        tell_poor(&drawn.judged, &name);
        if !drawn.judged.holds() {
            complain(format_args!(
                "{name}: fidelity check failed: {}: the file was kept; try --opaque or a higher --precision",
                disagreement(&verdict.agreement)
            ));
            return Status::Disagrees;
        }
        if drawn.judged.is_tiny() && verdict.agreement.psnr_db < MIN_AGREEMENT_DB {
            complain(format_args!(
                "{name}: strokes are as wide as the pixels of so small a picture: draw it at 16 times its size, enlarged without smoothing"
            ));
        }
        let reached = verdict.fidelity.psnr_db;
        if let Some(wanted) = budget.psnr_db.filter(|wanted| reached < *wanted) {
            let remedy = self.remedy(fit.stop);
            return missed(format!("{reached:.2} dB of {wanted}: {remedy}"));
        }
        if let Some(most) = budget.bytes.filter(|most| svg.len() > *most) {
            let bytes = svg.len();
            return missed(format!("{bytes} bytes, more than {most}: allow more bytes"));
        }
        Status::Done
    }

    /// Advice on how a drawing that ended for this reason comes nearer to the fidelity asked for.
    fn remedy(&self, stop: Stop) -> String {
        let looks = self.options.limiting_looks();
        match stop {
            Stop::Strokes if self.options.config().budget.strokes.is_some() => "allow more strokes".into(),
            Stop::Bytes => "allow more bytes".into(),
            Stop::Time => "allow more time".into(),
            Stop::Interrupted => "let it end".into(),
            _ if !looks.is_empty() => format!("leave out {}", looks.join(", ")),
            Stop::Strokes => "allow more strokes, by --strokes".into(),
            _ => "what is missing is finer than strokes: draw the picture at twice its size, or without its noise".into(),
        }
    }
}

/// SSIMULACRA2 and the share of small things below which a picture is lost. By default photographs come to about 50, drawings on paper to
/// 60, unless that takes too many bytes; 30 is low quality.
const LOST: (f64, f64) = (40.0, 0.4);
/// A quality with which photographs have a SSIMULACRA2 of 65 to 80.
const CLOSE: f64 = 40.0;

/// The SSIMULACRA2 of a drawing that has little of its picture, but something. Damage that was left out is not lost.
fn lost(judged: &Judged) -> Option<f64> {
    let (fit, fidelity) = (&judged.fit, &judged.verdict.fidelity);
    let meant = fit.meant.as_ref().filter(|_| fidelity.ssimulacra2 < LOST.0);
    let beside_meant = meant.and_then(|meant| Quality::between(meant, &fit.soft).ok());
    let seen = beside_meant.map_or(fidelity.ssimulacra2, |quality| quality.ssimulacra2);
    let has_few_details = fidelity.details_kept.is_some_and(|kept| kept < LOST.1);
    (!is_blank(judged) && (seen < LOST.0 || has_few_details)).then_some(seen)
}

/// True if the light on a page, or the colour of its paper, is not that of the picture.
fn is_relit(fit: &Fit) -> bool {
    fit.damage.is_some_and(|damage| damage.uneven_light)
}

/// A drawing of as many strokes as are allowed, and yet less faithful than this, dB, is one of noise.
const NOISE_DB: f64 = 22.0;

/// True if a picture is of dots or noise that strokes cannot draw: it says so itself, or it takes about as many strokes as it
/// may have, and still looks like nothing.
fn is_dithered(judged: &Judged, is_open: bool) -> bool {
    let Judged { fit, verdict, .. } = judged;
    let pixels = fit.target.width() * fit.target.height();
    let most = DEFAULT_STROKES.min(pixels / PIXELS_PER_STROKE);
    let is_full = is_open && 10 * fit.scene.len() >= 9 * most;
    let is_noise = is_full && verdict.fidelity.psnr_db < NOISE_DB;
    is_noise || fit.damage.is_some_and(|damage| damage.dithering > 0.0)
}

/// Bytes of a layer with one stroke, about.
const FIRST_STROKE_BYTES: usize = 250;

/// A page without strokes as faithful as this, dB, needs none.
const BLANK_DB: f64 = 40.0;

/// True if a drawing should have strokes and has none.
fn is_blank(judged: &Judged) -> bool {
    let Judged { fit, verdict, .. } = judged;
    fit.base.is_none() && fit.scene.is_empty() && verdict.fidelity.psnr_db < BLANK_DB
}

/// Difference of resvg's render from our own, in words.
fn disagreement(agreement: &Agreement) -> String {
    let Agreement {
        psnr_db, patch_abs, ..
    } = *agreement;
    if agreement.has_gap() {
        format!("resvg draws 5×5 px by {patch_abs} of 255 levels otherwise than the fit")
    } else {
        format!(
            "resvg's render agrees with the fit to {psnr_db:.2} dB, less than {MIN_AGREEMENT_DB} dB"
        )
    }
}

/// Warns if a drawing is this much worse than a page of one colour, dB.
const POOR_DB: f64 = 1.0;

/// Says that a page of one colour would be more like the picture than the drawing is.
fn tell_poor(judged: &Judged, name: &str) {
    let reached = judged.verdict.fidelity.psnr_db;
    let flat = one_color_db(&judged.fit.target);
    // A page without its shadows is unlike the photograph.
    if !is_relit(&judged.fit) && reached + POOR_DB < flat {
        complain(format_args!(
            "{name}: warning: a page of one colour would be more like the picture ({flat:.1} dB) than this drawing ({reached:.1} dB): \
             give other colours or more of them, or another --background"
        ));
    }
}

/// Fidelity of the best page of one colour, dB; transparent pictures are on white.
fn one_color_db(picture: &Image) -> f64 {
    let variance = |plane: &Vec<f32>| {
        let values = || plane.iter().map(|&value| f64::from(value));
        let mean = values().sum::<f64>() / plane.len() as f64;
        let away2 = values().map(|value| (value - mean) * (value - mean));
        away2.sum::<f64>() / plane.len() as f64
    };
    let flat = picture.on([1.0; 3]);
    psnr_db(flat.planes().iter().map(variance).sum::<f64>() / 3.0)
}

/// A drawing that was written.
pub(super) struct Drawn {
    pub(super) judged: Judged,
    /// From the start of the job until the SVG is written.
    pub(super) wall: Duration,
}

/// Says what of the picture is not drawn, or not at its size.
fn tell_omitted(fit: &Fit, name: String, verbosity: Verbosity) {
    if let Some(damage) = fit.damage {
        verbosity.say(format_args!(
            "{name}: left out, as damage: {damage} (--literal draws it)"
        ));
    }
    let Dropped {
        non_finite,
        invisible,
        off_page,
        points,
    } = fit.dropped;
    if fit.dropped.total() > 0 {
        verbosity.detail(format_args!(
            "dropped strokes: {non_finite} not finite, {invisible} invisible, {off_page} off the page"
        ));
    }
    if points > 0 {
        verbosity.detail(format_args!(
            "dropped points that rounding made superfluous: {points}"
        ));
    }
    if let Some([width, height]) = fit.scene.page {
        verbosity.say(format_args!(
            "{name}: {width}×{height} px were drawn as {}×{}, which show as much as strokes do; figures are for those",
            fit.scene.width, fit.scene.height
        ));
    }
}
