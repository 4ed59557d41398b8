//! Hard cases for fits and renderer. Each check gives a figure and a verdict. Degenerate strokes are cases of `tests/all/render.rs`.
//!
//! | group | what is hard |
//! | --- | --- |
//! | `kinks` | pixels where a distance or an edge has no derivative |
//! | `precision` | `f32` against `f64` through thousands of iterations |
//! | `pictures` | tiny, empty, noisy and extremely shaped pictures |
//! | `rates` | extreme learning rates, non-finite numbers, very long runs |
//! | `agreement` | thin and slanted strokes as resvg draws them |
//!
//! `f32` is *within x of `f64`* when no value differs by more than x times the largest value of its kind
//! (ends, radius, colour, opacity, contribution) in the scene. The bound is [`WITHIN`].

mod agreement;
mod kinks;
mod oracle;
mod pictures;
mod precision;
mod rates;

pub use agreement::AgreementMap;

use crate::report::CaseVerdict;
use crate::report::stability::{StabilityEntry, StabilityReport};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::report::Usage;

/// Gradients and contributions in `f32` may differ from `f64` by this share of the largest of their kind.
pub const WITHIN: f64 = 1e-3;

/// Extent of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// About half a minute.
    Short,
    /// All of it.
    Full,
}

/// Finding of a check.
struct Observation {
    figure: String,
    verdict: CaseVerdict,
    /// Why an exception is one.
    note: &'static str,
}

impl Observation {
    fn new(figure: String, holds: bool) -> Self {
        let verdict = if holds {
            CaseVerdict::Pass
        } else {
            CaseVerdict::Fail
        };
        Self {
            figure,
            verdict,
            note: "",
        }
    }

    /// This observation, but a failure that is known and explained by `note` is an exception.
    fn excepting(self, note: &'static str) -> Self {
        match self.verdict {
            CaseVerdict::Fail if !note.is_empty() => Self {
                verdict: CaseVerdict::Exception,
                note,
                ..self
            },
            _ => self,
        }
    }
}

/// One line of the table, before it is run.
struct Check<'a> {
    group: &'static str,
    name: String,
    what: String,
    run: Box<dyn Fn() -> Result<Observation> + 'a>,
}

impl<'a> Check<'a> {
    fn new(
        group: &'static str,
        name: impl Into<String>,
        what: impl Into<String>,
        run: impl Fn() -> Result<Observation> + 'a,
    ) -> Self {
        Self {
            group,
            name: name.into(),
            what: what.into(),
            run: Box::new(run),
        }
    }

    /// Runs it; an error is a failure, too.
    fn entry(&self) -> StabilityEntry {
        let before = Usage::now().cpu_s;
        let finding =
            (self.run)().unwrap_or_else(|error| Observation::new(error.to_string(), false));
        StabilityEntry {
            group: self.group.into(),
            name: self.name.clone(),
            checked: self.what.clone(),
            figure: finding.figure,
            verdict: finding.verdict,
            note: finding.note.into(),
            cpu_s: Usage::now()
                .cpu_s
                .zip(before)
                .map(|(after, before)| after - before),
        }
    }
}

/// Runs all checks, and those of `pictures` on top, telling each entry as it comes.
///
/// # Errors
/// When the map of agreement cannot be made. A check that cannot be run has failed.
pub fn run(
    extent: Extent,
    given: &[(String, Image)],
    tell: &mut dyn FnMut(&StabilityEntry),
) -> Result<(StabilityReport, AgreementMap)> {
    let map = AgreementMap::new(extent)?;
    let mut entries = Vec::new();
    for check in checks(extent, given, &map) {
        let entry = check.entry();
        tell(&entry);
        entries.push(entry);
    }
    Ok((StabilityReport::new(entries), map))
}

fn checks<'a>(
    extent: Extent,
    given: &'a [(String, Image)],
    map: &'a AgreementMap,
) -> impl Iterator<Item = Check<'a>> {
    let groups = [
        kinks::checks(),
        precision::checks(),
        pictures::checks(extent, given),
        rates::checks(extent),
        agreement::checks(map),
    ];
    groups.into_iter().flatten()
}
