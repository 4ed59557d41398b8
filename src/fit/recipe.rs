//! How much work each phase of a fit spends, and at what step sizes.

use super::config::Preset;

/// The tuned numbers of a fit. [`Recipe::of`] has those of the presets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Stages, unless the configuration says.
    pub stages: usize,
    /// Each stage adds this many times the strokes of the one before.
    pub growth: f64,
    /// Typical radius of a stage's strokes, in units of `sqrt(pixels / strokes so far)`.
    pub scale: f32,
    /// Cells that are looked at per stroke wanted; the best of them are probed.
    pub oversampling: f32,
    /// Iterations of each stage's short fit.
    pub stage_iterations: usize,
    /// Step sizes of the stages.
    pub stage_rates: Rates,
    /// Iterations of the joint fit; 0 for none.
    pub polish_iterations: usize,
    /// Share of them at the resolution of the last stage, before the full one.
    pub coarse_share: f32,
    /// Step sizes of the joint fit.
    pub polish_rates: Rates,
    /// Iterations between relocations.
    pub relocate_every: usize,
    /// Share of the strokes that may be relocated at a time.
    pub relocate_share: f32,
    /// Scale of relocated strokes, in units of the last stage's.
    pub relocate_scale: f32,
    /// What a candidate is reckoned to gain once it is fitted, in units of its gain as it is proposed.
    pub relocate_gain: f32,
    /// Softness at the start of the joint fit, in units of the final one.
    pub polish_softness: f32,
    /// Rounds of settling against the rendered file; 0 for none.
    pub settle_rounds: usize,
    /// Iterations of each round.
    pub settle_iterations: usize,
    /// Their step sizes, in units of those of the joint fit.
    pub settle_rate: f32,
}

/// Step sizes of the optimiser by kind of parameter, per iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
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

impl Recipe {
    /// The recipe of a preset.
    pub fn of(preset: Preset) -> Self {
        let balanced = Self {
            stages: 8,
            growth: 1.35,
            scale: 0.3,
            oversampling: 2.5,
            stage_iterations: 120,
            stage_rates: Rates {
                position: 1.0,
                radius: 0.3,
                color: 0.02,
                opacity: 0.02,
                last: 0.1,
            },
            polish_iterations: 2800,
            coarse_share: 0.3,
            polish_rates: Rates {
                position: 2.5,
                radius: 0.5,
                color: 0.02,
                opacity: 0.03,
                last: 0.03,
            },
            relocate_every: 30,
            relocate_share: 0.3,
            relocate_scale: 0.5,
            relocate_gain: 4.0,
            polish_softness: 2.4,
            settle_rounds: 5,
            settle_iterations: 20,
            settle_rate: 0.02,
        };
        match preset {
            Preset::Draft => Self {
                scale: 0.25,
                stage_iterations: 20,
                stage_rates: Rates {
                    position: 1.5,
                    ..balanced.stage_rates
                },
                polish_iterations: 130,
                polish_rates: Rates {
                    position: 1.3,
                    radius: 0.3,
                    last: 0.2,
                    ..balanced.polish_rates
                },
                relocate_every: 20,
                relocate_scale: 0.4,
                relocate_gain: 3.0,
                // Iterations bring more than what a round takes.
                settle_rounds: 0,
                ..balanced
            },
            Preset::Balanced => balanced,
            Preset::Best => Self {
                polish_iterations: 8000,
                relocate_every: 20,
                ..balanced
            },
        }
    }

    /// Iterations that a stroke takes part in, about: those of its stage, and of the polish if there is one.
    pub(super) fn iterations(&self, is_polished: bool) -> usize {
        let polish = if is_polished {
            self.polish_iterations
        } else {
            0
        };
        self.stage_iterations + polish
    }

    /// Whether strokes are relocated before iteration `step`, when a share `done` of the polish is over:
    /// newcomers need time to settle in.
    pub(super) fn relocates(&self, step: usize, done: f32) -> bool {
        step > 0 && step.is_multiple_of(self.relocate_every) && done < LAST_RELOCATION
    }
}

/// Share of the polish after which nothing is relocated.
const LAST_RELOCATION: f32 = 0.9;
