//! All tuned numbers of a fit, each with what was measured when it was chosen.
//!
//! "±x dB" is the fidelity of the file as resvg draws it, at equal numbers of strokes; `docs/accuracy.md` names the
//! pictures and has the whole tables. [`Recipe::of`] has the numbers of the presets, [`Recipe::check`] refuses
//! those that no fit can run with. A checkpoint is bound to its recipe, so that no fit is half of one tuning and half of
//! another.

mod presets;

use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorKind, Result};
use crate::optim::AdamParams;
use crate::seed::Probing;

/// How much work to spend on a drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Preset {
    /// Quick look.
    Draft,
    /// The default.
    #[default]
    Balanced,
    /// The last tenths of a dB.
    Best,
}

/// The tuned numbers of a fit, by the phase that uses them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// How places for strokes are searched.
    pub probing: Probing,
    /// How strokes are added.
    pub stages: Stages,
    /// The soft edge.
    pub edge: Edge,
    /// What strokes may be.
    pub domain: Domain,
    /// The optimiser of all descents.
    pub optimizer: Optimizer,
    /// The joint fit of all strokes.
    pub polish: Polish,
    /// How strokes worth little make room for better ones during the joint fit.
    pub relocation: Relocation,
    /// How a drawing is brought to a palette.
    pub coloring: Coloring,
    /// How opaque strokes come to share pens.
    pub pens: Pens,
    /// The last steps against what the file looks like.
    pub settling: Settling,
    /// How the number of strokes is corrected until a fidelity is met.
    pub correction: Correction,
    /// How the background is chosen.
    pub background: BackgroundChoice,
    /// How a limited time is shared out.
    pub time: TimeShares,
}

/// How strokes are added in stages, each fitted alone on what is frozen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stages {
    /// Stages, unless the configuration says. More of them see more of what the earlier ones left over.
    pub count: usize,
    /// Each stage adds this many times the strokes of the one before. 1.35 instead of 1.6: +0.08 dB.
    pub growth: f64,
    /// Strokes of the first stage when their total is not known beforehand.
    pub first: usize,
    /// Pixels per stroke of an ordinary drawing: a guess, for progress and where stages are asked for without a
    /// budget.
    pub pixels_per_stroke: usize,
    /// Typical radius of a stage's strokes, in units of `sqrt(pixels / strokes so far)`. 0.3 instead of 0.4: +0.15 dB,
    /// flat art +0.6; 0.35: −0.05. Drafts 0.25: +0.04.
    pub scale: f32,
    /// Iterations of each stage's short fit. 200 instead of 100: +0.09 dB, gone once strokes were relocated: 120.
    /// Drafts 20 of longer steps: 0.00 at 0.94 of the time of 30.
    pub iterations: usize,
    /// Step sizes. Ends by 0.3 instead of 0.15 px: +0.34 dB without polish; 1 px: +0.1.
    pub rates: Rates,
    /// Softness of a stage's first iteration at most, in units of the final one: the scale of its strokes, where that
    /// is less.
    pub softest: f32,
    /// Where the picture decides on the number of strokes, stages end once less than this share of one is worth its
    /// price.
    pub paying_share: f64,
    /// What polish adds to the fidelity of a staged drawing at least, dB: stages end this much short of the fidelity
    /// asked for.
    pub polish_gain_db: f64,
    /// Strokes are fitted at the coarsest resolution that leaves them this typical radius, px. Less, and their edges are
    /// fitted to pixels that are not there; more, and time goes to pixels that say nothing about them. A reduced picture
    /// for large strokes: +0.15 dB at 0.8 of the time.
    pub min_scale: f32,
}

/// The soft edge of strokes, which narrows during a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Slope of the final edge at the outline, 1/px. A box of 1 px, which antialiasing rasterisers approximate, has
    /// a slope between 1 (upright edges) and √2 (diagonal ones). 1.2 instead of 1.5: +0.15 dB at 1,000
    /// strokes, +0.3 at 5,000, agreement with resvg +1.2.
    pub final_slope: f64,
    /// Share of a descent after which the edge has its final softness. 0.85: −0.07 dB.
    pub annealed: f32,
}

/// What strokes may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Ends stay within so many px around the picture.
    pub margin: f32,
    /// Least radius, px: renderers draw widths of 1 px and less as hairlines, with other ink.
    pub min_radius: f32,
    /// Least opacity: renderers composite in 8 bits, and drift by levels under many layers fainter than this.
    pub min_opacity: f32,
}

/// The optimiser of all descents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optimizer {
    /// Adam for strokes. The memory of squares is short, since gradients shrink fast and change whenever neighbours are
    /// relocated: with β₂ 0.99 drafts have 0.15 dB less and long fits 0.06. β₁ 0.8: −0.08, 0.95: +0.02. ε 1e-7: −0.21, since small
    /// gradients are no longer normalised.
    pub strokes: AdamParams,
    /// Adam for the background.
    pub background: AdamParams,
    /// Radius, px, of a stroke whose geometry moves at the rates as they are. Others move with the root of their
    /// radius: +0.04 dB over one rate for all, where large strokes are slow and small ones jitter. In proportion to
    /// the radius: 0.00.
    pub usual_radius: f32,
    /// The factor of that root is kept between these.
    pub radius_factors: [f32; 2],
}

/// Step sizes of the optimiser by kind of parameter, per iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Ends of strokes, px.
    pub position: f32,
    /// Radius, px.
    pub radius: f32,
    /// Colours.
    pub color: f32,
    /// Opacity.
    pub opacity: f32,
    /// Factor of the last iteration; the way there is half a cosine.
    pub last: f64,
}

/// The joint fit of all strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polish {
    /// Iterations; 0 for none. 2,000 instead of 2,800: −0.12 dB at 0.75 of the time (photographs −0.05); drafts 140
    /// instead of 130: +0.04 at 1.05.
    pub iterations: usize,
    /// Share of them at the resolution of the last stage, before the full one. 0.3: part of the +0.15 dB of reduced
    /// pictures; 0.5: −0.06, 0.7: −0.13.
    pub coarse_share: f32,
    /// Step sizes. Ends by 0.1 → 0.4 → 0.8 → 1.2 → 2 → 2.5 px: +0.15, +0.05, +0.08, +0.06, +0.12 dB; 3 px: +0.05 on photographs and −0.17 on
    /// flat art. A last rate of 3 % instead of 10 %: part of the +0.06. Radius 0.8: −0.01. Colours 0.03 and opacity 0.05: −0.01. Drafts, of few
    /// iterations: ends by 1.3 px and a last rate of 20 %: +0.05 over 10 %.
    pub rates: Rates,
    /// Softness at the start, in units of the final one. 1, 1.5, 2.5: −0.19, 0, +0.17 dB; 3: −0.02 against 2.4.
    pub softness: f32,
}

/// How strokes worth little make room for better ones during the joint fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relocation {
    /// Iterations between relocations. 60, 30, 20: −0.10, 0, +0.06 dB at a fifth more time.
    pub every: usize,
    /// Share of the strokes that may be relocated at a time. 0.1, 0.2, 0.4: −0.06, 0, +0.12 dB; since gains count for
    /// more, 0.15 and 0.5: −0.02, 0.00.
    pub share: f32,
    /// Scale of relocated strokes, in units of the last stage's. 0.25, 0.4, 0.6, 0.8: +0.03, 0, −0.10, −0.34 dB; 0.5 with steps of
    /// 2.5 px: +0.12 together.
    pub scale: f32,
    /// What a candidate is reckoned to gain once it is fitted, in units of its gain as it is proposed. 1, 2, 3, 4, 5, 10: 0, +0.22, +0.28,
    /// +0.25, +0.28, +0.15 dB; flat art gains 0.47 by 4. Drafts, with less time to fit newcomers: 3.
    pub gain: f32,
    /// Share of the joint fit after which nothing is relocated: newcomers need time to settle in. 0.8, 0.95: 0.00 dB.
    pub until: f32,
    /// A relocation that fills free places tries this many times as many candidates as it may exchange.
    pub fill: usize,
}

/// Rounds of descent, between which colours or pens are chosen anew; one schedule of rates goes on over all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounds {
    /// How many.
    pub count: usize,
    /// Iterations of all rounds together, in units of those of the joint fit.
    pub iterations: f64,
    /// Step sizes, in units of those of the joint fit.
    pub rate: f32,
}

/// How a drawing is brought to a palette.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coloring {
    /// Rounds of choosing colours and fitting the rest.
    pub rounds: Rounds,
    /// Rounds at the end that relocate no stroke.
    pub quiet_rounds: usize,
    /// Share of its Newton step that a colour takes: the strokes under and over it take theirs as well.
    pub damping: f32,
    /// Iterations of k-means in a round.
    pub means: usize,
    /// Pixels that a stroke has to show in for its colour to matter.
    pub min_shown: f32,
}

/// How opaque strokes come to share pens (a colour and a width), for the smallest form of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pens {
    /// Rounds of fitting places to pens and colours of pens to places.
    pub rounds: Rounds,
    /// Pens per opaque stroke. Fewer pens make fewer bytes and cost fidelity: 600 strokes on seven samples take 41 to
    /// 50 bytes each. At equal bytes (24,000 on the same), 0.6 has 0.1 to 1 dB less, 0.8 from 0.7 dB less to 0.1
    /// more, and 1.0 from 0.8 dB less to 0.3 more.
    pub share: f64,
    /// Each width that a pen may have is this many times the one before.
    pub ladder: f32,
    /// Squared contrast at the edge of a typical stroke, summed over the channels: what a px of wrong radius costs for
    /// each px of edge.
    pub contrast: f32,
    /// Strokes that may share pens: their pairs are all compared.
    pub window: usize,
}

/// The last steps, against what the file really looks like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settling {
    /// Rounds; 0 for none. Settling as a whole: +0.1 dB at 34 dB, +1.8 at 40. Drafts have none: one round took a fifth
    /// of a draft's time for 0.09 dB, and 40 more iterations of polish bring 0.11.
    pub rounds: usize,
    /// Iterations of each round. 150 instead of 20: +0.005 dB.
    pub iterations: usize,
    /// Step sizes, in units of those of the joint fit.
    pub rate: f32,
    /// How much farther than that colours and opacities go, as the strokes hardly move.
    pub color_rate: f32,
    /// How far strokes move in a round, in units of the round before. What programs make of an edge changes with its
    /// place, so that a correction holds only for edges that stay where they are.
    pub next_pace: f32,
    /// By how many dB the browser's picture may be less faithful than resvg's. At 0 photographs would lose in resvg
    /// what nobody sees in a browser; an engine counts as faithful within 0.6.
    pub browser_db: f64,
    /// Share of the offset that a round takes from the target. All of it is more than comes back on edges; with less
    /// the browser stays behind.
    pub offset_taken: f64,
    /// How much a round adds to the browser's share for each dB that its picture is off the aim.
    pub share_per_db: f64,
}

/// How the number of strokes is corrected until a fidelity is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Corrections at most.
    pub count: usize,
    /// Fidelity gained by doubling the strokes, dB, until two drawings have told; Kodak ×5 gain 2.2 from 1,024 to 2,900
    /// strokes for each doubling.
    pub db_per_doubling: f64,
    /// What two drawings tell is believed down to this part of that.
    pub least_part: f64,
    /// A fidelity is met well enough when exceeded by no more than this, dB.
    pub excess_db: f64,
    /// Share of the joint fit's iterations that follow a correction.
    pub polish_share: f64,
}

/// How the background is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackgroundChoice {
    /// Share of the pixels that one colour must have to be taken for the background; below it, the mean is.
    pub prevailing_share: f64,
    /// Share of the pixels in translucent areas that opaque strokes can leave out; beyond it, the picture is laid on
    /// white for them.
    pub translucent_share: f64,
    /// Alpha between these is translucent.
    pub translucent: [f32; 2],
}

/// How a limited time is shared out among descent, writing and judging. A "write" is the time that it takes to
/// round, write and render the drawing once; all parts are told from it, since it is measured as the fit goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeShares {
    /// A stroke takes as long to write and render as so many pixels do, about.
    pub stroke_px: f64,
    /// Looking at the file as a browser does: writes of the drawing …
    pub browser: f64,
    /// … and, whatever the strokes, writes of an empty page: our own render, and comparisons.
    pub browser_page: f64,
    /// What follows the fit, in writes of the drawing: the judge writes and renders it once more, the report packs it.
    pub judging: f64,
    /// The same of a transparent drawing, which is rendered on two mattes.
    pub judging_transparent: f64,
    /// What follows the fit whatever the strokes, in writes of an empty page: three comparisons, layers.
    pub judging_page: f64,
    /// Rounds of settling may take up to this part of the limit; they bring less than as much descent beyond.
    pub settling: f64,
    /// Share of a limit that is for the descent however long the rest takes.
    pub min_descent: f64,
    /// A joint fit takes this many writes at least, which are a hundred steps or more: it begins with soft edges and long
    /// steps, and one of twenty leaves a drawing of 34 dB at 25.
    pub min_polish: f64,
    /// Measuring how long a write takes may take this part of the time.
    pub rehearsals: f64,
    /// Steps that make a round of settling worth its write.
    pub min_round: f64,
    /// Weight of a new measurement in the running mean of steps.
    pub freshness: f64,
    /// A search for less than one in so many of the strokes wanted is not worth a stage.
    pub min_search: usize,
}

impl Rates {
    /// Rates that leave colours as they are.
    pub(super) fn without_color(self) -> Self {
        Self { color: 0.0, ..self }
    }

    /// Rates that leave colours and widths as they are.
    pub(super) fn without_pen(self) -> Self {
        Self {
            radius: 0.0,
            ..self.without_color()
        }
    }
}

impl Recipe {
    /// Refuses numbers that no fit can run with. Step sizes may be anything: a stroke that they throw out of all bounds
    /// is brought back, and one whose numbers become NaN is dropped and counted.
    ///
    /// # Errors
    /// [`ErrorKind::Config`], naming the number, its value and its domain.
    pub fn check(&self) -> Result<()> {
        self.check_counts()?;
        let lengths = [
            ("stages.scale", self.stages.scale),
            ("stages.min_scale", self.stages.min_scale),
            ("relocation.scale", self.relocation.scale),
            ("probing.radii", smallest(self.probing.radii)),
            ("probing.lengths", smallest(self.probing.lengths)),
            ("probing.cells", self.probing.cells),
            ("domain.min_radius", self.domain.min_radius),
            ("optimizer.usual_radius", self.optimizer.usual_radius),
            ("pens.ladder − 1", self.pens.ladder - 1.0),
            ("optimizer.radius_factors", self.optimizer.radius_factors[0]),
            ("edge.final_slope", self.edge.final_slope as f32),
            (
                "correction.db_per_doubling",
                self.correction.db_per_doubling as f32,
            ),
        ];
        for (name, value) in lengths {
            demand(name, value, value.is_finite() && value > 0.0, "above 0")?;
        }
        let shares = [
            ("probing.probed", self.probing.probed),
            ("edge.annealed", self.edge.annealed),
            ("domain.min_opacity", self.domain.min_opacity),
            ("polish.coarse_share", self.polish.coarse_share),
            ("relocation.share", self.relocation.share),
            ("relocation.until", self.relocation.until),
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
            ("stages.first", self.stages.first),
            ("stages.pixels_per_stroke", self.stages.pixels_per_stroke),
            ("relocation.every", self.relocation.every),
            ("coloring.rounds.count", self.coloring.rounds.count),
            ("pens.rounds.count", self.pens.rounds.count),
            ("pens.window", self.pens.window),
            ("time.min_search", self.time.min_search),
        ];
        let mut counts = counts.into_iter();
        counts.try_for_each(|(name, count)| demand(name, count, count > 0, "1 or more"))
    }

    /// Iterations that a stroke takes part in, about: those of its stage, and of the polish if there is one.
    pub(super) fn iterations(&self, is_polished: bool) -> usize {
        let polish = if is_polished {
            self.polish.iterations
        } else {
            0
        };
        self.stages.iterations + polish
    }
}

/// Beyond it the second stage of any drawing is its last.
const MAX_GROWTH: f64 = 100.0;
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

    #[test]
    fn the_recipes_of_all_presets_are_sound() {
        for preset in [Preset::Draft, Preset::Balanced, Preset::Best] {
            Recipe::of(preset).check().unwrap();
        }
    }

    /// What `change` makes of the default recipe is refused, with the name and the value.
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
        refused(|r| r.edge.annealed = 1.5, "edge.annealed", "1.5");
        refused(|r| r.relocation.every = 0, "relocation.every", "0");
        refused(|r| r.relocation.share = f32::NAN, "relocation.share", "NaN");
        refused(|r| r.correction.least_part = 2.0, "least_part", "2");
    }
}
