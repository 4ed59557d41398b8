//! The numbers of a recipe that no fit can run with.

use super::Recipe;
use crate::error::{Error, ErrorKind, Result};

impl Recipe {
    /// Refuses numbers that no fit can run with. Step sizes are not checked: parameters that leave their domain are
    /// clamped to it, and a stroke with NaN parameters is dropped and counted.
    ///
    /// # Errors
    /// [`ErrorKind::Config`], naming the number, its value and its domain.
    pub fn check(&self) -> Result<()> {
        self.check_counts()?;
        // Divisors, and what is drawn or moved by.
        let lengths = [
            ("stages.scale", self.stages.scale),
            ("relocation.scale", self.relocation.scale),
            ("probing.radii", smallest(self.probing.radii)),
            ("probing.lengths", smallest(self.probing.lengths)),
            ("probing.cells", self.probing.cells),
            ("recovery.weight", self.recovery.weight),
            ("masking.contrast", self.masking.contrast as f32),
            ("masking.ceiling", self.masking.ceiling as f32),
            ("domain.min_radius", self.domain.min_radius),
            ("optimizer.usual_radius", self.optimizer.usual_radius),
            ("pens.ladder − 1", self.pens.ladder - 1.0),
            ("optimizer.radius_factors", self.optimizer.radius_factors[0]),
            ("edge.final_slope", self.edge.final_slope as f32),
            ("dense.pixels", self.dense.pixels),
            ("dense.position", self.dense.position),
            ("polish.sparse", self.polish.sparse),
            ("points.per_stroke", self.points.per_stroke),
            ("points.bought", self.points.bought),
            ("points.gain", self.points.gain),
            ("points.reach", self.points.reach),
            ("points.shortest", self.points.shortest),
            ("points.smoothness", self.points.smoothness),
            (
                "correction.db_per_doubling",
                self.correction.db_per_doubling as f32,
            ),
        ];
        for (name, value) in lengths {
            demand(name, value, value.is_finite() && value > 0.0, "above 0")?;
        }
        // Parts of a whole.
        let shares = [
            ("probing.probed", self.probing.probed),
            ("edge.annealed", self.edge.annealed),
            ("domain.min_opacity", self.domain.min_opacity),
            ("dense.share", self.dense.share),
            ("dense.min_opacity", self.dense.min_opacity),
            ("polish.jitter.from", self.polish.jitter.from),
            ("stages.polished_share", self.stages.polished_share),
            ("polish.coarse_share", self.polish.coarse_share),
            ("relocation.share", self.relocation.share),
            ("recovery.polish_share", self.recovery.polish_share as f32),
            ("relocation.until", self.relocation.until),
            ("points.from", self.points.from),
            ("points.until", self.points.until),
            ("points.share", self.points.share),
            ("points.swapped", self.points.swapped),
            ("points.capsules", self.points.capsules),
            ("points.filled", self.points.filled),
            ("pens.share", self.pens.share as f32),
            ("correction.least_part", self.correction.least_part as f32),
            ("stages.paying_share", self.stages.paying_share as f32),
        ];
        for (name, value) in shares {
            demand(name, value, (0.0..=1.0).contains(&value), "0 to 1")?;
        }
        self.check_ranges()
    }

    fn check_ranges(&self) -> Result<()> {
        let margin = self.domain.margin;
        demand(
            "domain.margin",
            margin,
            (0.0..=1e6).contains(&margin),
            "0 to 1000000",
        )?;
        let longest = self.polish.sparse_share;
        let is_longer = (1.0..=MAX_SPARSE_SHARE).contains(&longest);
        demand("polish.sparse_share", longest, is_longer, "1 to 1000")?;
        let [least, most] = self.optimizer.radius_factors;
        demand(
            "optimizer.radius_factors",
            most,
            most >= least,
            "the smaller one first",
        )?;
        // The largest shape has to fit a patch.
        let radius = self.probing.radii.into_iter().fold(0.0, f32::max);
        demand("probing.radii", radius, radius <= MAX_RADIUS, "at most 1")?;
        let length = self.probing.lengths.into_iter().fold(0.0, f32::max);
        demand(
            "probing.lengths",
            length,
            length <= MAX_LENGTH,
            "at most 4.5",
        )
    }

    fn check_counts(&self) -> Result<()> {
        let growth = self.stages.growth;
        // Stages that shrink never reach the number of strokes that is wanted.
        let grows = (1.0..=MAX_GROWTH).contains(&growth);
        demand("stages.growth", growth, grows, "1 to 100")?;
        let counts = [
            ("stages.count", self.stages.count),
            ("masking.window", self.masking.window),
            ("stages.first", self.stages.first),
            ("stages.pixels_per_stroke", self.stages.pixels_per_stroke),
            ("relocation.every", self.relocation.every),
            ("coloring.rounds.count", self.coloring.rounds.count),
            ("pens.rounds.count", self.pens.rounds.count),
            ("pens.window", self.pens.window),
            ("coloring.window", self.coloring.window),
            ("points.at_a_time", self.points.at_a_time),
            ("time.min_search", self.time.min_search),
        ];
        let mut counts = counts.into_iter();
        counts.try_for_each(|(name, count)| demand(name, count, count > 0, "1 or more"))
    }
}

/// With greater growth, the second stage of any drawing would be its last.
const MAX_GROWTH: f64 = 100.0;
/// A polish that is longer by more than this never ends.
const MAX_SPARSE_SHARE: f32 = 1000.0;
/// Radius and length of the largest shape that can be probed, in units of the scale.
const MAX_RADIUS: f32 = 1.0;
const MAX_LENGTH: f32 = 4.5;

fn smallest<const N: usize>(values: [f32; N]) -> f32 {
    values.into_iter().fold(f32::INFINITY, f32::min)
}

fn demand(name: &str, value: impl std::fmt::Display, holds: bool, domain: &str) -> Result<()> {
    if holds {
        return Ok(());
    }
    let message = format!("the recipe's {name} of {value} is out of range: give {domain}");
    Err(Error::new(ErrorKind::Config, message))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Preset;

    #[test]
    fn the_recipes_of_all_presets_are_sound() {
        for preset in [Preset::Draft, Preset::Balanced, Preset::Best] {
            Recipe::of(preset).check().unwrap();
        }
    }

    /// Checks that the default recipe is refused after `change`, with the name and the value.
    fn refused(change: impl Fn(&mut Recipe), name: &str, value: &str) {
        let mut recipe = Recipe::of(Preset::Balanced);
        change(&mut recipe);
        let error = recipe.check().unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Config);
        let words = error.to_string();
        assert!(words.contains(name) && words.contains(value), "{words}");
    }

    #[test]
    fn what_no_fit_can_run_with_is_refused() {
        refused(|r| r.stages.growth = 0.9, "stages.growth", "0.9");
        refused(|r| r.stages.growth = f64::NAN, "stages.growth", "NaN");
        refused(|r| r.stages.first = 0, "stages.first", "0");
        refused(|r| r.stages.scale = 0.0, "stages.scale", "0");
        refused(|r| r.probing.radii[1] = -1.0, "probing.radii", "-1");
        refused(|r| r.probing.lengths[0] = 9.0, "probing.lengths", "9");
        refused(|r| r.domain.margin = f32::NAN, "domain.margin", "NaN");
        refused(
            |r| r.optimizer.radius_factors = [4.0, 0.25],
            "radius_factors",
            "0.25",
        );
        refused(|r| r.polish.sparse_share = 0.5, "sparse_share", "0.5");
        refused(|r| r.edge.annealed = 1.5, "edge.annealed", "1.5");
        refused(|r| r.relocation.every = 0, "relocation.every", "0");
        refused(|r| r.relocation.share = f32::NAN, "relocation.share", "NaN");
        refused(|r| r.correction.least_part = 2.0, "least_part", "2");
    }
}
