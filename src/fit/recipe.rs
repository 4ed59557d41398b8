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
    /// Places probed per stroke wanted.
    pub oversampling: f32,
    /// Iterations of each stage's short fit.
    pub stage_iterations: usize,
    /// Step sizes of the stages.
    pub stage_rates: Rates,
    /// Iterations of the joint fit; 0 for none.
    pub polish_iterations: usize,
    /// Step sizes of the joint fit.
    pub polish_rates: Rates,
    /// Iterations between relocations.
    pub relocate_every: usize,
    /// Share of the strokes that may be relocated at a time.
    pub relocate_share: f64,
    /// Scale of relocated strokes, in units of the last stage's.
    pub relocate_scale: f32,
    /// Softness at the start of the joint fit, px.
    pub polish_softness: f32,
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
            growth: 1.6,
            scale: 0.6,
            oversampling: 2.0,
            stage_iterations: 40,
            stage_rates: Rates {
                position: 0.15,
                radius: 0.08,
                color: 0.02,
                opacity: 0.02,
                last: 0.1,
            },
            polish_iterations: 300,
            polish_rates: Rates {
                position: 0.1,
                radius: 0.05,
                color: 0.01,
                opacity: 0.01,
                last: 0.1,
            },
            relocate_every: 50,
            relocate_share: 0.1,
            relocate_scale: 0.4,
            polish_softness: 1.5,
        };
        match preset {
            Preset::Draft => Self {
                stage_iterations: 20,
                polish_iterations: 60,
                ..balanced
            },
            Preset::Balanced => balanced,
            Preset::Best => Self {
                polish_iterations: 2000,
                ..balanced
            },
        }
    }
}
