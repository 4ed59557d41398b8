//! The tuned numbers of the phases of a fit, each with what was measured when it was chosen. A number that one step of tracing or
//! of rearranging points needs alone stands beside that step.
//!
//! "±x dB" is the change of fidelity at equal numbers of strokes; the pages of `docs/notebook` name the pictures and have
//! the complete tables. "Half, twice" is the change at half and at twice the value, in the mean of four samples at 300 strokes
//! (`cargo run --release --example recipe`); other seeds move it by up to 0.1 dB, so that less says only that the
//! number is uncritical. [`Recipe::of`] has the numbers of the presets, and [`Recipe::check`] refuses numbers that no
//! fit can run with. A checkpoint is bound to its recipe, so that no fit mixes two tunings.

mod check;
mod inks;
mod presets;

use serde::{Deserialize, Serialize};

use crate::math;
use crate::optim::AdamParams;
use crate::seed::Probing;
pub use inks::Inks;

/// Pixels of a picture that a screen shows well at once, 768×512: the default quality is for so many.
pub const SCREEN_PIXELS: usize = 768 * 512;

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
    /// Search for candidates.
    pub probing: Probing,
    /// Growth by stages.
    pub stages: Stages,
    /// The soft edge.
    pub edge: EdgeShape,
    /// The domains of stroke parameters.
    pub domain: Domain,
    /// The optimiser of all descents.
    pub optimizer: AdamSettings,
    /// The joint fit of all strokes.
    pub polish: Polish,
    /// Changes where points are dense.
    pub dense: Dense,
    /// Relocation: strokes of little worth make room for better ones during the polish.
    pub relocation: Relocation,
    /// Recovery of small things.
    pub recovery: Recovery,
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
    /// Shapes and level lines.
    pub forms: Forms,
    /// Visibility of errors.
    pub masking: Masking,
    /// Most rounds of settling, the last steps, against renders of the written file; 0 for none. Settling as a whole: +0.1 dB
    /// at 34 dB, +1.8 at 40. Drafts have none: one round took a fifth of a draft's time for 0.09 dB, and 40 more iterations
    /// of polish bring 0.11.
    pub settling_rounds: usize,
    /// Correction of the number of strokes to meet a fidelity.
    pub correction: Correction,
    /// To which pixels a picture is reduced.
    pub reduction: Reduction,
    /// Most strokes of a drawing that competes with those of shorter presets. A guess.
    pub rivals: usize,
    /// Division of a time limit.
    pub time: TimeShares,
    /// Losses to damage of the picture.
    pub doubts: Doubts,
}

/// Losses to damage of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doubts {
    /// Distance of the picture from what it means, RMS in levels.
    pub doubt: f32,
    /// Doubt, levels, at which a byte has to remove twice the squared error. 2.5: JPEG 75 and noise of 8 levels cost 3 dB of
    /// quality, with which 20 drawings and icons have 1.07 and 1.00 times the numbers of the clean picture in the median.
    pub double: f32,
    /// By how much the quality is lowered, dB.
    pub lost_db: f64,
    /// By how much the contrast of what is recovered has to be larger, levels per level of doubt.
    pub contrast: f32,
}

impl Recipe {
    /// This recipe for a picture that may be `doubt` levels from what it means.
    pub(super) fn in_doubt(mut self, doubt: f32) -> Self {
        self.doubts.doubt = doubt;
        self.doubts.lost_db = 10.0 * math::log10(1.0 + f64::from(doubt / self.doubts.double));
        self.recovery.contrast += self.doubts.contrast * doubt / 255.0;
        self
    }
}

/// Growth in stages, each fitted with all earlier strokes frozen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stages {
    /// Number of stages, unless the configuration sets it. With more stages, seeding sees the residual more often.
    /// Half, twice: −0.05, +0.04 dB.
    pub count: usize,
    /// Strokes of a stage, in units of those of the stage before. 1.35 instead of 1.6: +0.08 dB;
    /// twice: −0.05.
    pub growth: f64,
    /// Strokes of the first stage if the total is not known in advance. Half, twice, at the default quality: −0.04, +0.06
    /// dB at −0.8, −4.5 % of the bytes.
    pub first: usize,
    /// Pixels per stroke of an ordinary drawing: a guess, for the report of progress and for a number of stages without
    /// a budget.
    pub pixels_per_stroke: usize,
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
    /// Greatest softness of a stage's first iteration, in units of the final one. A stage begins with the scale of its
    /// strokes (px) if that is less. Half, twice: +0.03, −0.10 dB.
    pub softest: f32,
    /// Growing ends when less than this share of a stage's strokes is worth its price. Half, twice, at the
    /// default quality: +0.11, −0.04 dB at +0.7, −5.6 % of the bytes.
    pub paying_share: f64,
    /// Growing ends this much below the fidelity asked for, dB. The polish brings 5 dB on photographs and 15 on flat art, and a search
    /// from below begins with few strokes. 8 instead of 12: kodim04 at 36 dB takes 32.8 instead of 11.7 s.
    pub polish_gain_db: f64,
    /// The least that a stage has to add to the fidelity for each doubling of the strokes, where a fidelity is asked for, dB. Photographs
    /// gain 2.2; flat art, whose edges strokes of two points follow badly, falls from 2 to 0.1.
    pub least_slope_db: f64,
}

/// The soft edge of strokes, which narrows during a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeShape {
    /// Slope of the final edge at the outline, 1/px. A box of 1 px, which antialiasing rasterisers approximate, has
    /// a slope between 1 (upright edges) and √2 (diagonal ones). 1.2 instead of 1.5: +0.15 dB at 1,000
    /// strokes, +0.3 at 5,000, agreement with resvg +1.2. Half, twice: −2.26, −1.10.
    pub final_slope: f64,
    /// Share of a descent after which the edge has its final softness. 0.85: −0.07 dB; 0.55 instead of 0.7, with points:
    /// +0.02 dB.
    pub annealed: f32,
}

/// The domains of stroke parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Ends stay within this many px around the picture. Half, twice: +0.03, +0.08 dB.
    pub margin: f32,
    /// Least radius, px. Renderers draw widths of 1 px and less as hairlines, by another method.
    pub min_radius: f32,
    /// Least opacity. Renderers composite in 8 bits, and their rounding adds up to whole levels under many fainter
    /// strokes. Half, twice: +0.03, +0.08 dB.
    pub min_opacity: f32,
}

/// The optimiser of all descents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamSettings {
    /// Adam for strokes. β₂ is small because gradients shrink fast and change whenever neighbours are relocated. β₂
    /// 0.99: −0.15 dB for drafts, −0.06 for long fits. β₁ 0.8: −0.08; 0.95: +0.02. ε 1e-7, which no longer normalises
    /// small gradients: −0.21.
    pub strokes: AdamParams,
    /// Adam for strokes in the polish at a reduced resolution, where they are far from where they end. β₂ 0.8 instead of
    /// 0.9: five photographs of 1,024 strokes have as many dB after a sixth fewer iterations.
    pub reduced: AdamParams,
    /// Adam for the background.
    pub background: AdamParams,
    /// Radius, px, of a stroke whose geometry moves at the rates as given. Other strokes move in proportion to the
    /// square root of their radius: +0.04 dB over one rate for all, with which large strokes are slow and small ones
    /// jitter. In proportion to the radius itself: 0.00. Half, twice: +0.04, +0.01.
    pub usual_radius: f32,
    /// Bounds of the factor that this gives.
    pub radius_factors: [f32; 2],
    /// Step sizes of the colours of areas, in units of those of strokes. A guess: traced colours are right within a level.
    pub area_color: f32,
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

/// The joint fit of all strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polish {
    /// Iterations; 0 for none. 1,200 instead of 1,000: +0.02 dB on photographs of 2,300 strokes, and less than chance
    /// elsewhere. Drafts 140 instead of 130: +0.04 at 1.05 of the time.
    pub iterations: usize,
    /// Points are sparse if a budget of bytes, or of straight strokes, allows one for more pixels than this. A polish is
    /// then longer in proportion to the pixels per point, because each point matters more.
    pub sparse: f32,
    /// Most iterations where points are sparse, in units of `iterations`. 2.5 instead of 1: eight photographs at 8,000 bytes +0.13 dB, nine
    /// other pictures at 5,000 bytes +0.34, at 1.8 of the time; 3: +0.02 and −0.02. Drafts stay short.
    pub sparse_share: f32,
    /// Iterations of a drawing with areas, in units of those that it would have without. A guess: a hundred were enough for areas alone.
    pub area_share: f32,
    /// Share of the iterations that keep the resolution of the last stage; the rest are at full resolution. Five photographs
    /// of 768×512 px at 1,024 strokes: 0.6, 0.8 instead of 0.7: +0.02, −0.12 dB at 1.08, 0.93 of the time, and
    /// SSIMULACRA2 −1.0, −0.2. Drafts have too few iterations for that.
    pub coarse_share: f32,
    /// Step sizes. Ends by 0.1 → 0.4 → 0.8 → 1.2 → 2 → 2.5 px: +0.15, +0.05, +0.08, +0.06, +0.12 dB; 3 px: +0.05 on
    /// photographs and −0.17 on flat art. A last rate of 6 % instead of 3 %: +0.03 dB. Radius 0.8: −0.01.
    /// Colours 0.03 and opacity 0.05: −0.01. Drafts, of few iterations: ends by 1.3 px and a last rate of 20 %: +0.05
    /// over 10 %.
    pub rates: Rates,
    /// None, unless points are dense.
    pub jitter: Jitter,
    /// Softness at the start, in units of the final one. 1, 1.5, 2.5: −0.19, 0, +0.17 dB; 3: −0.02 against 2.4.
    pub softness: f32,
}

/// Strokes that are differentiated beside their places, which makes a drawing robust against antialiasing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Jitter {
    /// Farthest that a stroke moves along each axis, px; 0 for no jitter.
    pub px: f32,
    /// Share of the polish after which strokes are jittered. 0.7, 0.92 instead of 0.85, where points are dense: −0.2, −0.1 dB.
    pub from: f32,
}

/// Changes for a budget that makes points dense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dense {
    /// Points are dense if a budget allows one for fewer pixels than this. With 20 instead of 16, jitter and opacities cost
    /// flat art of 500 strokes 0.4 dB.
    pub pixels: f32,
    /// Iterations of the polish, in units of `polish.iterations`.
    pub share: f32,
    /// `polish.rates.position`. 1.0, 1.5 instead of 2.5 at a share of 0.65: four drawings of flat art +0.8, +0.6 dB, four
    /// photographs −0.2, 0.0. A share of 0.75 brings 0.1 dB. Between 16 and 20 pixels per point, both bring flat art of 500
    /// strokes 0.4 dB and cost photographs as much.
    pub position: f32,
    /// Least opacity. 0.3 instead of 0.1: eight drawings of flat art +0.4 dB, six photographs +0.06. Elsewhere 0.3
    /// costs flat art one unit of SSIMULACRA2. Not for drafts.
    pub min_opacity: f32,
    /// `polish.jitter.px`. 0.1 instead of 0: the eight +0.4 dB, text of 2,500 strokes +2.6, photographs 0.00; elsewhere −0.05. Drafts: −0.8, with the opacity.
    pub jitter: f32,
}

/// Relocation: strokes of little worth make room for better ones during the polish.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relocation {
    /// Iterations between relocations. 60, 30, 20: −0.10, 0, +0.06 dB at a fifth more time, before there were points. 24
    /// instead of 30, with as many relocations in all: +0.1 dB. 25 divides the iterations; it was not measured by itself.
    pub every: usize,
    /// Share of the strokes that one relocation may move. 0.1, 0.2, 0.4: −0.06, 0, +0.12 dB; since gains are multiplied,
    /// 0.15 and 0.5: −0.02, 0.00.
    pub share: f32,
    /// Scale of relocated strokes, in units of the last stage's. 0.25, 0.4, 0.6, 0.8: +0.03, 0, −0.10, −0.34 dB;
    /// 0.5 with steps of 2.5 px: +0.12 together.
    pub scale: f32,
    /// Expected gain of a candidate once it is fitted, in units of its closed-form gain. 1, 2, 3, 4, 5, 10: 0,
    /// +0.22, +0.28, +0.25, +0.28, +0.15 dB; flat art gains 0.47 by 4. Drafts, with less time to fit newcomers: 3.
    pub gain: f32,
    /// Share of the polish after which nothing is relocated, so that new strokes have time to be fitted. 0.8, 0.95:
    /// 0.00 dB.
    pub until: f32,
    /// Share of the polish before which nothing is relocated if the drawing has areas. A guess.
    pub after_areas: f32,
    /// A relocation that has free places to fill asks for up to this many times as many candidates as it may move
    /// strokes. Half, twice: 0.00 dB.
    pub fill: usize,
}

/// Recovery of small things that the polish has lost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovery {
    /// Weight of errors near them. 5, 8, 16: a label of a map correlates by 0.957, 0.970, 0.980 with the picture; borders of
    /// 1 px take 8.8, 10.9, 13.2 kB, 75, 82, 84 % of them kept (1, 49 % in 5.6 kB).
    pub weight: f32,
    /// Least contrast of what is recovered. What people see begins here, too: see `details_kept`.
    pub contrast: f32,
    /// Rows and columns beside them that are traced, and weighed, too. A guess.
    pub reach: usize,
    /// Iterations of the polish that follows, in units of those of the first one. A guess.
    pub polish_share: f64,
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
    /// Most points per stroke, on average, of a drawing whose budget is in strokes or in dB. Bytes, or a quality, limit
    /// the points of others.
    pub per_stroke: f32,
    /// Points per stroke, on average, of a drawing whose budget is in bytes: an estimate, made before it is drawn.
    pub bought: f32,
    /// Share of a budget of bytes that is planned for strokes of two points; the rest is for more points.
    pub capsules: f32,
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
    /// The quality that sets the price of points where a fidelity is asked for, dB beyond that fidelity. A guess.
    pub beyond_db: f64,
    /// The price of the bytes of areas, in units of that of strokes' bytes. Errors of areas lie along edges, where people see
    /// them. A quarter instead of 0.35: 41 drawings of filled shapes, +0.1 dB for 1 % more bytes.
    pub area_price: f32,
    /// The price of a stroke's bytes there, in units of that of a point's: as many strokes come as it takes, but none that
    /// draws nothing. A guess.
    pub stroke_price: f32,
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
    /// Most marks of a drawing that areas are split in.
    pub most_marks: usize,
    /// Bytes that a form is worth to an editor, besides those that it saves. A guess.
    pub worth_bytes: usize,
    /// By how much a file with shapes may be less faithful in resvg, dB, if it is then below the second number. Rings of a pen lose
    /// 2 to 5 dB there, which other renderers do not; many thin ones would have it disagree with our render.
    pub most_lost_db: [f64; 2],
}

/// Masking: detail of the picture hides errors, with [`ErrorWeighting::Eye`](super::ErrorWeighting::Eye).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Masking {
    /// Rows and columns of the window to each side of a pixel.
    pub window: usize,
    /// The standard deviation of the luma in the window that halves what an error counts, of 0..1.
    pub contrast: f64,
    /// The standard deviation of the luma from which on detail hides no more, of 0..1. 0.1, 0.15, 0.2, none: Kodak in
    /// 94,000 bytes has SSIMULACRA2 11.4, 13.6, 14.0, 14.4 and 29.90, 29.85, 29.80, 29.76 dB; without a ceiling, small
    /// things of high contrast (the pupils of a cat in 20,000 bytes) are drawn worse than by exact errors.
    pub ceiling: f64,
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

/// To which pixels a picture is reduced before it is drawn; `docs/accuracy.md` has what was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduction {
    /// Pixels that a drawing of as many strokes as pay needs: twice the pixels of the screen that it is made for.
    pub enough_pixels: usize,
    /// Fewest pixels that a picture is reduced to, however little detail it has: the price of strokes is that of a screen.
    pub least_pixels: usize,
    /// Pixels that a stroke needs, where their number is given: a dozen for each of its points, and more for their places.
    pub pixels_per_stroke: usize,
    /// Bytes of a stroke, about.
    pub bytes_per_stroke: usize,
    /// Fidelity of a picture that was halved and enlarged again, dB, from which on its half is as good. Strokes end far
    /// below.
    pub same_db: f64,
    /// Such a fidelity of lines and sharp edges, whose places half as many pixels tell as well.
    pub nearly_same_db: f64,
    /// Share of pixels whose neighbours have their colour: flat art and drawings of lines have more, photographs mostly
    /// less.
    pub flat_share: f64,
    /// Largest difference of neighbours of one colour.
    pub one_color: f32,
    /// Largest share of the detail within 9 px that is finer than 2 px in a picture that was enlarged twice: such ones have 0.07
    /// to 0.09, others 0.16 and more.
    pub soft: f64,
    /// Smaller pictures, px, are not reduced because they are soft. A guess.
    pub least_soft_side: usize,
    /// A reduction by less than this along each side is not worth it.
    pub least_factor: f64,
}

/// Division of a time limit among descent, writing and judging. The unit of most durations is a *write*: the time to
/// round, write and render the drawing once, which is measured during the fit. With these numbers fits end within 5 % of
/// limits from half a second to ten, in a simulation of machines that draw strokes up to a quarter faster or slower
/// than expected (`the_limit_is_met_by_a_twentieth`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeShares {
    /// Time to write and render a stroke, in units of that for a pixel.
    pub stroke_px: f64,
    /// Cost of our own render of a file and the comparisons, in writes of an empty drawing.
    pub looking: f64,
    /// Cost of judging and reporting after the fit, in writes of the drawing: it is written and rendered once more, and
    /// compressed for the report.
    pub judging: f64,
    /// That cost for a transparent drawing, which is rendered on two mattes.
    pub judging_transparent: f64,
    /// Cost after the fit that does not depend on the strokes, in writes of an empty drawing: three comparisons,
    /// layers.
    pub judging_empty: f64,
    /// Most of the limit, as a share, that rounds of settling take. Beyond it, descent gains more in the same time.
    pub settling: f64,
    /// Least share of the limit for descent, however long the rest takes.
    pub min_descent: f64,
    /// Least duration of a polish, in writes: this is a hundred steps or more. A polish begins with soft edges and long
    /// steps, so that one of 20 steps takes a drawing from 34 dB to 25.
    pub min_polish: f64,
    /// Share of the time that measuring writes may take.
    pub trial_writes: f64,
    /// Least number of steps that make a round of settling worth its write.
    pub min_round: f64,
    /// Weight of a new measurement in the running mean of the duration of steps.
    pub freshness: f64,
    /// A stage is left out if there is time to search for less than one in this many of the strokes wanted.
    pub min_search: usize,
}

impl Correction {
    /// Lower bound of the measured gain by doubling the strokes, dB.
    pub(super) fn least_db_per_doubling(&self) -> f64 {
        self.db_per_doubling * self.least_part
    }
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

impl Polish {
    /// The polish of a drawing with areas. They were traced, so that they need few iterations; and edges that are softer
    /// than in the end would only move them away.
    pub(super) fn for_areas(self) -> Self {
        Self {
            iterations: (self.iterations as f32 * self.area_share) as usize,
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
        let share = if pixels < dense.pixels {
            polish.jitter.px = dense.jitter;
            self.domain.min_opacity = dense.min_opacity;
            polish.rates.position = dense.position;
            dense.share
        } else {
            (pixels / polish.sparse).clamp(1.0, polish.sparse_share)
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
