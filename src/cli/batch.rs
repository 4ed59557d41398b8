//! Draws several pictures one after the other. One failure does not stop the rest; a table lists all outcomes.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::Result;
use strokefit::report::Judged;
use strokefit::view::Viewer;

use super::job::{Draw, Drawn, Job};
use super::output::{self, Output};
use super::progress::Events;
use super::{Status, Verbosity, fail, input, misuse, view};

/// Placeholder for the name of the picture without its extension.
const STEM: &str = "{stem}";

/// The path that `template` means for `input`.
pub(super) fn named(template: &Path, input: &Path) -> Result<PathBuf> {
    let Some((before, after)) = template.to_str().and_then(|text| text.split_once(STEM)) else {
        return Ok(template.to_owned());
    };
    let stem = input.file_stem().filter(|_| !input::is_stdin(input));
    let Some(stem) = stem else {
        let (name, template) = (input::name(input), template.display());
        return Err(misuse(format!(
            "{template}: {name} has no file name to replace {STEM}: name the output"
        )));
    };
    let mut path = OsString::from(before);
    path.push(stem);
    path.push(after);
    named(Path::new(&path), input)
}

/// Does the jobs in order. The outcome is a line for a single job, a table for several.
pub(super) fn run(jobs: &[Job<'_>], verbosity: Verbosity, draw: &Draw<'_>) -> Result<Status> {
    if jobs.len() > 1 && jobs.iter().any(|job| job.options.checkpoint().is_some()) {
        return Err(misuse(
            "--checkpoint saves the state of one fit: give one picture",
        ));
    }
    let options = jobs.first().map(|job| job.options);
    let events = options.and_then(|options| options.events.as_deref());
    keep_apart(jobs, events)?;
    let mut events = Events::open(events)?;
    let is_viewed = options.is_some_and(|options| options.view);
    let viewer = is_viewed.then(view::open).transpose()?;
    let draw: &Draw<'_> = &|picture, start, observer| match &viewer {
        Some(viewer) => view::watched(viewer, picture, start, observer, draw),
        None => draw(picture, start, observer),
    };
    let status = match jobs {
        [job] => one(job, &mut events, verbosity, draw, viewer.as_ref())?,
        _ => {
            let status = several(jobs, &mut events, verbosity, draw);
            viewer.as_ref().and_then(Viewer::wait);
            status
        }
    };
    events.close()?;
    Ok(status)
}

fn one(
    job: &Job<'_>,
    events: &mut Events,
    verbosity: Verbosity,
    draw: &Draw<'_>,
    viewer: Option<&Viewer>,
) -> Result<Status> {
    // Standard input cannot be read again for more strokes.
    let viewer = viewer.inspect(|viewer| viewer.offer_more(!input::is_stdin(job.input)));
    let mut attempt = |draw: &Draw<'_>| {
        let drawn = job.run(String::new(), events, verbosity, draw)?;
        verbosity.say(job.summary(&drawn));
        anyhow::Ok(drawn)
    };
    let mut drawn = attempt(draw)?;
    loop {
        let status = job.judge(&drawn, verbosity);
        if matches!(status, Status::Interrupted(_)) {
            return Ok(status);
        }
        let Some((viewer, more)) = viewer.and_then(|viewer| Some((viewer, viewer.wait()?))) else {
            return Ok(status);
        };
        let more = view::more(job.options, &drawn.judged.fit, more);
        drawn = attempt(&|picture, start, observer| {
            view::watched(viewer, picture, start, observer, &more)
        })?;
    }
}

fn several(jobs: &[Job<'_>], events: &mut Events, verbosity: Verbosity, draw: &Draw<'_>) -> Status {
    let names = jobs.iter().map(|job| job.input.display().to_string());
    let width = names.map(|name| name.chars().count()).max();
    let width = width.unwrap_or(0).max("picture".len());
    verbosity.say(format_args!(
        "{:width$}  strokes   points      bytes        s  fidelity  agreement",
        "picture"
    ));
    let (mut worst, mut done, mut failed) = (Status::Done, 0, 0);
    for (i, job) in jobs.iter().enumerate() {
        let heading = format!("{} of {} ", i + 1, jobs.len());
        let status = match job.run(heading, events, verbosity, draw) {
            Ok(drawn) => {
                verbosity.say(format_args!(
                    "{:width$}  {}",
                    job.input.display().to_string(),
                    row(&drawn)
                ));
                job.judge(&drawn, verbosity)
            }
            Err(error) => {
                failed += 1;
                fail(&error)
            }
        };
        worst = worst.or_worse(status);
        done += 1;
        if matches!(status, Status::Interrupted(_)) {
            break;
        }
    }
    verbosity.say(format_args!(
        "{} drawn, {failed} failed{}",
        done - failed,
        match jobs.len() - done {
            0 => String::new(),
            left => format!(", {left} skipped"),
        }
    ));
    worst
}

/// What the table says of a drawing, after the name of the picture.
fn row(drawn: &Drawn) -> String {
    let Judged {
        fit, svg, verdict, ..
    } = &drawn.judged;
    format!(
        "{:>7} {:>8} {:>10} {:>8.2}  {:>5.2} dB   {:>5.2} dB",
        fit.scene.len(),
        fit.scene.points(),
        svg.len(),
        drawn.wall.as_secs_f64(),
        verdict.fidelity.psnr_db,
        verdict.agreement.psnr_db,
    )
}

/// Refuses jobs if one would overwrite what another reads or writes.
fn keep_apart(jobs: &[Job<'_>], events: Option<&Path>) -> Result<()> {
    let events = events.map(|path| Output::open(path).map(|output| (path, output)));
    let events = events.transpose()?;
    let mut taken: Vec<(&Path, &Output)> = events.iter().map(|(path, o)| (*path, o)).collect();
    for (path, output) in jobs.iter().flat_map(Job::outputs) {
        if taken.iter().any(|(_, other)| *other == output) {
            return Err(clash(path, jobs.len()));
        }
        taken.push((path, output));
    }
    let inputs = jobs.iter().flat_map(|job| [Some(job.input), job.base]);
    for input in inputs.flatten().filter(|input| !input::is_stdin(input)) {
        if taken.iter().any(|(_, output)| output.is(input)) {
            let name = input.display();
            return Err(misuse(format!(
                "{name}: would be overwritten: name another output"
            )));
        }
    }
    Ok(())
}

fn clash(path: &Path, jobs: usize) -> anyhow::Error {
    let name = output::name(path);
    let remedy = match jobs {
        1 => "name another output".into(),
        _ => format!("use {STEM} in its name, and pictures with different names"),
    };
    misuse(format!(
        "{name}: two outputs would go to the same place: {remedy}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stem_goes_where_the_template_says() {
        let named =
            |template: &str, input: &str| named(Path::new(template), Path::new(input)).unwrap();
        assert_eq!(
            named("out/{stem}.svg", "in/a b.c.png"),
            Path::new("out/a b.c.svg")
        );
        assert_eq!(named("{stem}/{stem}.svg", "x.png"), Path::new("x/x.svg"));
        assert_eq!(named("plain.svg", "x.png"), Path::new("plain.svg"));
    }

    #[test]
    fn standard_input_has_no_stem() {
        let error = named(Path::new("{stem}.svg"), Path::new("-")).unwrap_err();
        assert!(error.to_string().contains("standard input"), "{error}");
    }
}
