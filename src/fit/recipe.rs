//! The presets, and what differs between them. All other tuned numbers stand beside what they tune, each with what was measured when it
//! was chosen.
//!
//! "±x dB" is the change of fidelity at equal numbers of strokes; the pages of `docs/notebook` name the pictures and have the complete
//! tables. "Half, twice" is the change at half and at twice the value, in the mean of four samples at 300 strokes; other seeds move it
//! by up to 0.1 dB, so that less says only that the number is uncritical.

mod inks;
mod presets;

use serde::{Deserialize, Serialize};

pub use inks::Inks;

/// Points are dense if a budget allows one for fewer pixels than this. With 20 instead of 16, jitter and opacities cost flat art of 500
/// strokes 0.4 dB.
const DENSE: f32 = 16.0;
/// Points are sparse if a budget of bytes, or of straight strokes, allows one for more pixels than this. A polish is then longer in
/// proportion to the pixels per point, because each point matters more.
pub(super) const SPARSE: f32 = 160.0;
/// Iterations of a drawing with areas, in units of those that it would have without. A guess: a hundred were enough for areas alone.
const AREA_SHARE: f32 = 0.4;

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

/// The tuned numbers of a fit, by the phase that uses them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Estimated distance of the picture from what it means, RMS in levels of 8 bits.
    pub doubt: f32,
    /// Least opacity. Renderers composite in 8 bits, and their rounding adds up to whole levels under many fainter strokes. Half, twice:
    /// +0.03, +0.08 dB.
    pub min_opacity: f32,
    /// Growth by stages.
    pub stages: Stages,
    /// The joint fit of all strokes.
    pub polish: Polish,
    /// Changes where points are dense.
    pub dense: Dense,
    /// Relocation: strokes of little worth make room for better ones during the polish.
    pub relocation: Relocation,
    /// Points: strokes get and lose them during the polish.
    pub points: Points,
    /// Restriction of a drawing to a palette.
    pub coloring: Recoloring,
    /// Pens that opaque strokes share.
    pub pens: Pens,
    /// Widths and colours that strokes share.
    pub sharing: Sharing,
    /// Colours of thin lines.
    pub inks: Inks,
    /// Most marks of a drawing that areas are split in.
    pub most_marks: usize,
    /// Shapes and level lines.
    pub forms: Forms,
    /// Most rounds of settling, the last steps, against renders of the written file; 0 for none. Settling as a whole: +0.1 dB
    /// at 34 dB, +1.8 at 40. Drafts have none: one round took a fifth of a draft's time for 0.09 dB, and 40 more iterations
    /// of polish bring 0.11.
    pub settling_rounds: usize,
    /// Correction of the number of strokes to meet a fidelity.
    pub correction: Correction,
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
    /// Softness at the start, in units of the final one. 1, 1.5, 2.5: −0.19, 0, +0.17 dB; 3: −0.02 against 2.4.
    pub softness: f32,
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

/// Relocation: strokes of little worth make room for better ones during the polish.
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

/// Points: strokes get and lose them during the polish. After each relocation, points are chosen once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Points {
    /// Share of the polish before which all strokes stay as they are.
    pub from: f32,
    /// Share of the polish after which no point comes or goes.
    pub until: f32,
    /// Share of the strokes that may get a point at a time.
    pub share: f32,
    /// Share of the strokes that may lose a point to another stroke at a time, where the budget has no room left.
    pub swapped: f32,
    /// Share of a budget of bytes that is filled with points before the file is written.
    pub filled: f32,
    /// Share of the polish after which bytes that are left are for points alone. A guess.
    pub alone: f32,
    /// Farthest that a new corner moves from its line at once, in units of the line's length.
    pub reach: f32,
    /// Lines and curves shorter than this, px, get no point.
    pub shortest: f32,
    /// Expected gain of a point once it is fitted, in units of the gain that is found. Five photographs of 1,024
    /// strokes: 30, 120, 200 instead of 60: −0.13, +0.04, +0.03 dB.
    pub gain: f32,
    /// Expected gain of a control point, in units of the gain that is found.
    pub smoothness: f32,
    /// Quantile of stroke worth, 0..1, at which a stroke counts as dispensable. A guess.
    pub spared: f32,
    /// Most points that a stroke loses at the end of the polish. A guess.
    pub prunings: usize,
    /// One in this many of the points and strokes that could go for bytes goes at a time. A guess: what the next round offers
    /// may be cheaper than the dearest offers of this one.
    pub at_a_time: usize,
    /// Which strokes may be joined end to end.
    pub joins: Joins,
}

/// Which strokes may be joined end to end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joins {
    /// Farthest that two ends may be apart, px.
    pub reach: f32,
    /// Farthest that two ends may be apart, in units of the mean width of both strokes.
    pub gap: f32,
    /// Largest difference of channels, of opacities, and of radii in units of the larger one.
    pub alike: f32,
    /// Most pairs at a time, as a share of the strokes.
    pub share: f32,
}

/// Rounds of descent, between which colours or pens are chosen again. One schedule of rates spans all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounds {
    /// Number of rounds.
    pub count: usize,
    /// Iterations of all rounds together, in units of those of the polish.
    pub iterations: f64,
    /// Step sizes, in units of those of the polish.
    pub rate: f32,
}

/// Restriction of a drawing to a palette.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recoloring {
    /// Rounds of choosing colours and fitting the rest. Half, twice, in 12 colours: count −0.07, −0.01 dB; iterations
    /// −0.10, +0.06; rate −0.19, −0.58.
    pub rounds: Rounds,
    /// Rounds at the end without relocation. Half, twice: 0.00, −0.01 dB.
    pub quiet_rounds: usize,
    /// Share of its Newton step that a colour takes. It is below 1 because the strokes under and over it move as well.
    /// Half, twice: −0.03, −0.05 dB.
    pub damping: f32,
    /// Iterations of k-means in a round. Half, twice: 0.00 dB.
    pub means: usize,
    /// A stroke keeps its colour if it shows in fewer pixels than this. Half, twice: 0.00 dB.
    pub min_shown: f32,
    /// Share of the pixels that show the background where it is kept: a background that a given palette does not
    /// replace. A guess.
    pub kept_share: f32,
    /// Least difference, per channel, of a kept background from all colours of the palette. A guess.
    pub kept_distance: f32,
    /// Number of neighbouring strokes that are compared to stack their colours, which takes time with its square. A guess.
    pub window: usize,
}

/// Pens (a colour and a width), for the smallest form of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pens {
    /// Rounds of fitting positions to pens, and colours of pens to positions. Half, twice: count −0.06, −0.02 dB;
    /// iterations −0.01, −0.06; rate −0.07, −0.07; the bytes change by at most 1.4 %.
    pub rounds: Rounds,
    /// Pens per opaque stroke. Fewer pens make fewer bytes and cost fidelity: 600 strokes on seven samples take 41 to
    /// 50 bytes each. At equal bytes (24,000 on the same), 0.6 has 0.1 to 1 dB less, 0.8 from 0.7 dB less to 0.1
    /// more, and 1.0 from 0.8 dB less to 0.3 more.
    pub share: f64,
    /// Ratio between neighbouring widths that a pen may have. Twice: −2.58 dB and −10.6 % of the bytes.
    pub ladder: f32,
    /// Squared contrast at the edge of a typical stroke, summed over the channels: the cost of 1 px of wrong radius for
    /// each px of edge. Half, twice: +0.02, −0.04 dB and −0.7, −0.4 % of the bytes.
    pub contrast: f32,
    /// Most strokes that may share pens with each other. The time grows with the square, as all pairs are compared.
    pub window: usize,
}

/// Widths and colours that strokes of a drawing of lines share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sharing {
    /// Growth of the squared error that is allowed to each of three steps (opaque strokes, few widths, few colours), in units of
    /// that of the drawing, before the drawing is settled. A guess, as are the other numbers.
    pub error: f64,
    /// Most strokes that are compared for their colours; drawings of more are not of a few pens.
    pub most: usize,
    /// The least opacity of a stroke that may become opaque. Less is meant to let through what is behind.
    pub nearly_opaque: f32,
    /// Share of a stroke that lies on other strokes rather than on the page.
    pub off_page: f32,
    /// A stroke of a smaller radius, px, covers few pixels in full, so that width and opacity look alike.
    pub thin: f32,
}

/// Shapes, and lines that are level or upright, where marks nearly are such.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forms {
    /// Iterations in which what is proposed is fitted; 0 for no forms. After 30, centres and radii of circles are within 0.005 px.
    pub iterations: usize,
    /// Step sizes of the points of areas and of traced strokes of the usual radius, and of radii, px. With ten times as much,
    /// circles stay 0.1 px beside their places, and are refused.
    pub rate: f32,
    /// Farthest that a path is from the shape that it becomes, px.
    pub tolerance_px: f32,
    /// Largest difference in height, or place across, of the ends of a line that is level or upright, px.
    pub level_px: f32,
    /// That difference in units of the length of the line.
    pub level_slope: f32,
    /// Most rings of an area that some of its rings leave, to be elements of their own, and of one that all of them leave. A
    /// QR code stays one area. A guess.
    pub split_rings: [usize; 2],
    /// Bytes that a form is worth to an editor, besides those that it saves. A guess.
    pub worth_bytes: usize,
    /// By how much a file with shapes may be less faithful in resvg, dB, if it is then below the second number. Rings of a pen lose
    /// 2 to 5 dB there, which other renderers do not; many thin ones would have it disagree with our render.
    pub most_lost_db: [f64; 2],
}

/// Iterations of a round of settling. 150 instead of 20: +0.005 dB.
pub(super) const SETTLING_STEPS: usize = 20;

/// Correction of the number of strokes to meet a fidelity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Fidelity that the polish is expected to regain when strokes are removed, dB.
    pub regained_db: f64,
    /// Most corrections.
    pub count: usize,
    /// Fidelity gained by doubling the strokes, dB, until it is measured on two drawings. Kodak ×5 gain 2.2 per
    /// doubling from 1,024 to 2,900 strokes.
    pub db_per_doubling: f64,
    /// Lower bound of the measured value, in units of `db_per_doubling`, which is its upper bound.
    pub least_part: f64,
    /// A fidelity is met if it is exceeded by no more than this, dB.
    pub excess_db: f64,
    /// The number of strokes is found if this share more than a number that missed the fidelity reaches it. A guess.
    pub precision: f64,
    /// Least share of the missing fidelity that more strokes have to bring, or none of them will bring the rest. Without this end,
    /// parrots-256 at 42 dB takes 23 instead of 10 s for 0.3 dB.
    pub least_gain: f64,
    /// Gain of doublings to come, in units of that of the last one, at most. A guess: with 1, a photograph whose gains rise
    /// again would be given up.
    pub hope: f64,
    /// Strokes too few for their gains to tell of those of many. A guess.
    pub few_strokes: usize,
    /// Strokes below which one more may be what is missing. A disc without antialiasing needs 9 for 30 dB, and gains nothing
    /// by the second to fourth.
    pub very_few_strokes: usize,
    /// A file that uses less than this share of its bytes gets more points. A guess.
    pub filled: f64,
    /// Layers are joined that would take more than this share of the bytes. A guess.
    pub layers_share: f64,
    /// Iterations of polish as long as the drawing is far from the fidelity, in units of those of the first polish. 0.4 instead of 0.2:
    /// kodim04 at 36 dB takes 24 instead of 11.7 s.
    pub approach_share: f64,
    /// Iterations of polish after a correction, in units of those of the first polish.
    pub polish_share: f64,
}

impl Correction {
    /// Lower bound of the measured gain by doubling the strokes, dB.
    pub(super) fn least_db_per_doubling(&self) -> f64 {
        self.db_per_doubling * self.least_part
    }
}

impl Polish {
    /// The polish of a drawing with areas. They were traced, so that they need few iterations; and edges that are softer
    /// than in the end would only move them away.
    pub(super) fn for_areas(self) -> Self {
        Self {
            iterations: (self.iterations as f32 * AREA_SHARE) as usize,
            softness: 1.0,
            ..self
        }
    }
}

impl Points {
    /// True if points come and go when a share `done` of the polish is over.
    pub(super) fn lasts(&self, done: f32) -> bool {
        (self.from..self.until).contains(&done)
    }
}

impl Recipe {
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

    /// Iterations that a stroke takes part in: those of its stage and, `is_polished`, those of the polish.
    pub(super) fn iterations(&self, is_polished: bool) -> usize {
        let polish = if is_polished {
            self.polish.iterations
        } else {
            0
        };
        self.stages.iterations + polish
    }
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
