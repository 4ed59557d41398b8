//! The presets, and what differs between them. All other tuned numbers stand beside what they tune, each with what was measured when it
//! was chosen.
//!
//! "±x dB" is the change of fidelity at equal numbers of strokes; the pages of `docs/notebook` name the pictures and have the complete
//! tables. "Half, twice" is the change at half and at twice the value, in the mean of four samples at 300 strokes; other seeds move it
//! by up to 0.1 dB, so that less says only that the number is uncritical.

use serde::{Deserialize, Serialize};

/// Points are dense if a budget allows one for fewer pixels than this. With 20 instead of 16, jitter and opacities cost flat art of 500
/// strokes 0.4 dB.
const DENSE: f32 = 16.0;
/// Points are sparse if a budget of bytes, or of straight strokes, allows one for more pixels than this. A polish is then longer in
/// proportion to the pixels per point, because each point matters more.
pub(super) const SPARSE: f32 = 160.0;

/// Work to spend on a drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Preset {
    /// An eighth of the time, 2 to 3 dB worse.
    Draft,
    /// The default.
    #[default]
    Balanced,
    /// Three to five times the time, 0.7 to 0.9 dB better.
    Best,
}

/// The numbers that differ between presets, by the phase that uses them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Least opacity. Renderers composite in 8 bits, and their rounding adds up to whole levels under many fainter strokes. Half, twice:
    /// +0.03, +0.08 dB.
    pub min_opacity: f32,
    /// Growth by stages.
    pub stages: Stages,
    /// The joint fit of all strokes.
    pub polish: Polish,
    /// Changes where points are dense.
    pub dense: Dense,
    /// Relocation: strokes that contribute little make room for better ones during the polish.
    pub relocation: Relocation,
    /// Most rounds of settling, the last steps, against renders of the written file; 0 for none. Settling as a whole: +0.1 dB
    /// at 34 dB, +1.8 at 40. Drafts have none: one round took a fifth of a draft's time for 0.09 dB, and 40 more iterations
    /// of polish bring 0.11.
    pub settling_rounds: usize,
}

/// Growth in stages, each fitted with all earlier strokes frozen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stages {
    /// Typical radius of a stage's strokes, in units of `sqrt(pixels / strokes so far)`. 0.3 instead of 0.4: +0.15 dB,
    /// flat art +0.6; 0.35: −0.05. Drafts 0.25: +0.04.
    pub scale: f32,
    /// Iterations of each stage's short fit. 200 instead of 100: +0.09 dB, gone once strokes were relocated: 120.
    /// Drafts 20 of longer steps: 0.00 at 0.94 of the time of 30.
    pub iterations: usize,
    /// Iterations if a polish follows, in units of `iterations`, where a budget says how many strokes there are. 0.34
    /// instead of 1, now that strokes get points in the polish: +0.01 dB on five photographs, +0.1 on flat art, at 0.96 of
    /// the time. Where gains decide, stages as short as that end too early: a disc of 64×64 px stayed at 28 dB of 30.
    pub polished_share: f32,
    /// Step sizes. Ends by 0.3 instead of 0.15 px: +0.34 dB without polish; 1 px: +0.1.
    pub rates: Rates,
}

/// The joint fit of all strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polish {
    /// Iterations; 0 for none. 1,200 instead of 1,000: +0.02 dB on photographs of 2,300 strokes, and less than chance
    /// elsewhere. Drafts 140 instead of 130: +0.04 at 1.05 of the time.
    pub iterations: usize,
    /// Most iterations where points are sparse, in units of `iterations`. 2.5 instead of 1: eight photographs at 8,000 bytes +0.13 dB, nine
    /// other pictures at 5,000 bytes +0.34, at 1.8 of the time; 3: +0.02 and −0.02. Drafts stay short.
    pub sparse_share: f32,
    /// Share of the iterations that keep the resolution of the last stage; the rest are at full resolution. Five photographs
    /// of 768×512 px at 1,024 strokes: 0.6, 0.8 instead of 0.7: +0.02, −0.12 dB at 1.08, 0.93 of the time, and
    /// SSIMULACRA2 −1.0, −0.2. Drafts have too few iterations for that.
    pub coarse_share: f32,
    /// Step sizes. Ends by 0.1 → 0.4 → 0.8 → 1.2 → 2 → 2.5 px: +0.15, +0.05, +0.08, +0.06, +0.12 dB; 3 px: +0.05 on
    /// photographs and −0.17 on flat art. A last rate of 6 % instead of 3 %: +0.03 dB. Radius 0.8: −0.01.
    /// Colours 0.03 and opacity 0.05: −0.01. Drafts, of few iterations: ends by 1.3 px and a last rate of 20 %: +0.05
    /// over 10 %.
    pub rates: Rates,
    /// Farthest that jitter moves a stroke, px: 0, unless points are dense.
    pub jitter: f32,
}

/// Changes for a budget that makes points dense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dense {
    /// Iterations of the polish, in units of `polish.iterations`.
    pub share: f32,
    /// `polish.rates.position`. 1.0, 1.5 instead of 2.5 at a share of 0.65: four drawings of flat art +0.8, +0.6 dB, four
    /// photographs −0.2, 0.0. A share of 0.75 brings 0.1 dB. Between 16 and 20 pixels per point, both bring flat art of 500
    /// strokes 0.4 dB and cost photographs as much.
    pub position: f32,
    /// Least opacity. 0.3 instead of 0.1: eight drawings of flat art +0.4 dB, six photographs +0.06. Elsewhere 0.3
    /// costs flat art one unit of SSIMULACRA2. Not for drafts.
    pub min_opacity: f32,
    /// `polish.jitter`. 0.1 instead of 0: the eight +0.4 dB, text of 2,500 strokes +2.6, photographs 0.00; elsewhere −0.05. Drafts: −0.8, with the opacity.
    pub jitter: f32,
}

/// Relocation: strokes that contribute little make room for better ones during the polish.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relocation {
    /// Iterations between relocations. 60, 30, 20: −0.10, 0, +0.06 dB at a fifth more time, before there were points. 24
    /// instead of 30, with as many relocations in all: +0.1 dB. 25 divides the iterations; it was not measured by itself.
    pub every: usize,
    /// Scale of relocated strokes, in units of the last stage's. 0.25, 0.4, 0.6, 0.8: +0.03, 0, −0.10, −0.34 dB;
    /// 0.5 with steps of 2.5 px: +0.12 together.
    pub scale: f32,
    /// Expected gain of a candidate once it is fitted, in units of its closed-form gain. 1, 2, 3, 4, 5, 10: 0,
    /// +0.22, +0.28, +0.25, +0.28, +0.15 dB; flat art gains 0.47 by 4. Drafts, with less time to fit newcomers: 3.
    pub gain: f32,
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
    /// Points of areas, px.
    pub area: f32,
    /// Factor on all rates in the last iteration, reached along half a cosine.
    pub last: f64,
}

impl Rates {
    /// These rates, but colours stay as they are.
    pub(super) fn without_color(self) -> Self {
        Self { color: 0.0, ..self }
    }

    /// These rates, but radii stay as they are.
    pub(super) fn without_radius(self) -> Self {
        Self {
            radius: 0.0,
            ..self
        }
    }
}

impl Recipe {
    /// The recipe of a preset.
    pub fn of(preset: Preset) -> Self {
        match preset {
            Preset::Draft => DRAFT,
            Preset::Balanced => BALANCED,
            Preset::Best => BEST,
        }
    }

    /// The recipe if a budget allows a point for each `pixels` pixels.
    pub(super) fn for_density(mut self, pixels: f32) -> Self {
        let (dense, polish) = (self.dense, &mut self.polish);
        let share = if pixels < DENSE {
            polish.jitter = dense.jitter;
            self.min_opacity = dense.min_opacity;
            polish.rates.position = dense.position;
            dense.share
        } else {
            (pixels / SPARSE).clamp(1.0, polish.sparse_share)
        };
        polish.iterations = (polish.iterations as f32 * share) as usize;
        self
    }
}

const BALANCED: Recipe = Recipe {
    min_opacity: 0.1,
    stages: Stages {
        scale: 0.3,
        iterations: 120,
        polished_share: 0.34,
        rates: Rates {
            position: 1.0,
            radius: 0.3,
            color: 0.02,
            opacity: 0.02,
            area: 0.08,
            last: 0.1,
        },
    },
    polish: Polish {
        iterations: 1000,
        sparse_share: 2.5,
        coarse_share: 0.7,
        rates: Rates {
            position: 2.5,
            radius: 0.5,
            color: 0.02,
            opacity: 0.03,
            area: 0.08,
            last: 0.06,
        },
        jitter: 0.0,
    },
    dense: Dense {
        share: 0.75,
        position: 1.5,
        min_opacity: 0.3,
        jitter: 0.1,
    },
    relocation: Relocation {
        every: 25,
        scale: 0.5,
        gain: 4.0,
    },
    settling_rounds: 5,
};

/// Few, long steps.
const DRAFT: Recipe = Recipe {
    stages: Stages {
        scale: 0.25,
        iterations: 20,
        polished_share: 1.0,
        rates: Rates {
            position: 1.5,
            ..BALANCED.stages.rates
        },
    },
    polish: Polish {
        iterations: 130,
        sparse_share: 1.0,
        coarse_share: 0.3,
        // With few iterations, steps have to be long until the end.
        rates: Rates {
            position: 1.3,
            radius: 0.3,
            last: 0.2,
            ..BALANCED.polish.rates
        },
        ..BALANCED.polish
    },
    // The steps of dense points help, but take more iterations than a draft has.
    dense: Dense {
        share: 0.9,
        position: 1.3,
        min_opacity: BALANCED.min_opacity,
        jitter: 0.0,
    },
    relocation: Relocation {
        every: 20,
        scale: 0.4,
        gain: 3.0,
    },
    settling_rounds: 0,
    ..BALANCED
};

const BEST: Recipe = Recipe {
    polish: Polish {
        iterations: 3600,
        sparse_share: 2.0,
        rates: Rates {
            last: 0.03,
            ..BALANCED.polish.rates
        },
        ..BALANCED.polish
    },
    relocation: Relocation {
        every: 20,
        ..BALANCED.relocation
    },
    ..BALANCED
};
