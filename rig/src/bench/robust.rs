//! Clean pictures, damaged, and how much of each damage is drawn.
//!
//! Other programs trace the same pictures, where they are installed.

use std::time::Instant;

use super::damages::{common_colors, damaged};
use super::drawings::{self, attempt, record};
use super::gallery::Gallery;
use super::peers::TunedPeer;
use super::shapes::contents;
use crate::report::Damage;
use crate::report::cases::OWN;
use crate::report::robust::{RobustEntry, RobustReport};
use strokefit::fit::{Config, Fitter};
use strokefit::image::Image;
use strokefit::metrics::psnr;
use strokefit::{Result, verify};

/// A clean picture.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Its name in lines of the report.
    pub name: String,
    picture: Image,
}

impl Truth {
    /// A picture on white.
    pub fn of_picture(name: String, picture: &Image) -> Self {
        let picture = picture.flattened([1.0; 3]);
        Self { name, picture }
    }

    /// The picture of a drawing on white, its longer side as many px.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub fn of_svg(name: String, svg: &str, side: u16) -> Result<Self> {
        let picture = drawings::picture(svg, side).map_err(|error| error.within(&name))?;
        Ok(Self { name, picture })
    }
}

/// A result as it comes.
pub type Outcome<'a> = drawings::Outcome<'a, RobustEntry>;

/// Shows a result in a gallery: the damaged picture, and the drawing.
///
/// # Errors
/// As [`verify::render`].
pub fn show(gallery: &mut Gallery, outcome: Outcome<'_>) -> Result<()> {
    let entry = outcome.entry;
    if entry.failure.is_some() {
        return Ok(());
    }
    let input_db = entry.input_db.unwrap_or(f64::NAN);
    let db = entry.truth_db.unwrap_or(f64::NAN);
    let title = format!("{}, {input_db:.1} dB", entry.damage);
    let caption = format!("{} elements, {db:.1} dB", entry.found.elements);
    gallery.show(outcome, &title, &caption)
}

/// Draws all pictures with each damage and has `peers` trace them, telling each result as it comes.
///
/// # Errors
/// As `tell`, and when a picture cannot be damaged. A picture of which no SVG is made is a failure in the report.
pub fn run(
    truths: &[Truth],
    damages: &[Damage],
    peers: &[TunedPeer],
    tell: &mut dyn FnMut(Outcome<'_>) -> Result<()>,
) -> Result<RobustReport> {
    let mut entries = Vec::new();
    for truth in truths {
        let colors = common_colors(&truth.picture).len().max(2);
        for &damage in damages {
            let case = Case::new(truth, damage)?;
            let own = case.timed(OWN, || case.fitted());
            let traced = peers.iter().map(|peer| {
                let trace = || Ok((peer.trace(&case.picture, colors)?.svg, None));
                case.timed(peer.name(), trace)
            });
            record(
                std::iter::once(own).chain(traced),
                &case.picture,
                tell,
                &mut entries,
            )?;
        }
    }
    Ok(RobustReport::new(entries))
}

/// A picture with a damage.
struct Case<'a> {
    truth: &'a Truth,
    damage: Damage,
    picture: Image,
}

impl<'a> Case<'a> {
    fn new(truth: &'a Truth, damage: Damage) -> Result<Self> {
        let picture = damaged(&truth.picture, damage);
        Ok(Self {
            truth,
            damage,
            picture: picture.map_err(|error| error.within(&truth.name))?,
        })
    }

    /// Our drawing, and the damage that was recognised.
    fn fitted(&self) -> Result<(String, Option<String>)> {
        let fit = Fitter::new(Config::default()).fit(&self.picture)?;
        Ok((fit.svg(), fit.damage.map(|damage| damage.to_string())))
    }

    /// The record of what `draw` makes, and its SVG; empty if it fails.
    fn timed(
        &self,
        by: &str,
        draw: impl FnOnce() -> Result<(String, Option<String>)>,
    ) -> (RobustEntry, String) {
        let entry = RobustEntry {
            picture: self.truth.name.clone(),
            by: by.to_owned(),
            side_px: self.picture.width().max(self.picture.height()),
            damage: self.damage,
            ..RobustEntry::default()
        };
        let began = Instant::now();
        let judge = |(svg, recognised): (String, Option<String>)| {
            let wall_s = Some(began.elapsed().as_secs_f64());
            let drawn = verify::render_like(&svg, &self.picture, [1.0; 3])?;
            let entry = RobustEntry {
                recognised,
                found: contents(&svg)?,
                psnr_db: Some(psnr(&self.picture, &drawn)?),
                truth_db: Some(psnr(&self.truth.picture, &drawn)?),
                input_db: Some(psnr(&self.truth.picture, &self.picture)?),
                wall_s,
                ..entry.clone()
            };
            Ok((entry, svg))
        };
        attempt(
            || draw().and_then(judge),
            |failure| RobustEntry {
                failure,
                ..entry.clone()
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="48" height="48"><path d="M8 8h30v20h-30z" fill="#d03020"/></svg>"##;

    #[test]
    fn a_drawing_is_judged_by_the_clean_picture_and_by_its_input() {
        let truth = Truth::of_svg("bar".into(), BAR, 48).unwrap();
        let case = Case::new(&truth, Damage::Noise(8)).unwrap();
        let (entry, _) = case.timed(OWN, || Ok((BAR.into(), None)));
        assert_eq!(entry.found.elements, 1);
        let (truth_db, input_db) = (entry.truth_db.unwrap(), entry.input_db.unwrap());
        assert!(
            truth_db > 45.0 && (28.0..36.0).contains(&input_db),
            "{entry:?}"
        );
        assert!((entry.psnr_db.unwrap() - input_db).abs() < 0.5);
        let (failed, svg) = case.timed(OWN, || Ok(("no SVG".into(), None)));
        assert!(failed.failure.is_some() && svg.is_empty());
    }
}
