//! The tuned numbers of tracing. `docs/lines.md` has the pictures that they were tried on.

use crate::shading::ShadeFit;

/// The tuned numbers of tracing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracing {
    /// The share of the squared residual that has to lie in areas of few colours, or nothing is traced. Drawings of lines
    /// have 0.88 to 1.00, photographs 0.55 to 0.85.
    pub min_flat_share: f32,
    /// The share of the squared residual under a stroke that the stroke has to remove. 0.4, 0.6, 0.75: text has 200, 215,
    /// 253 strokes at equal fidelity, as bars of letters one pixel thin are hardly explained before they are fitted.
    pub explained: f32,
    /// Shapes of fewer pixels are not traced. 2, 3, 6: SSIMULACRA2 of a screenshot of a dashboard 70.5, 69.0, 64.5 in 20 kB
    /// each, as the dots of its letters are small.
    pub least_area: usize,
    /// Factor on the steps of traced strokes, which are about where they belong. 0.15, 0.25, 0.4, 1: 39 icons have 42.8,
    /// 42.8, 42.5, 40.8 dB.
    pub pace: f32,
    /// Most times that a drawing is traced before its polish where nothing is traced after it; otherwise once. 1, 2, 3 of the latter:
    /// six pictures of flat art have 37.97, 38.39, 38.61 dB in 15.9, 17.1, 18.0 kB and take 1.5, 1.9, 2.0 s; a comic of 36 dB
    /// needs 3 of the former.
    pub rounds: usize,
    /// Scale of the fit of traced strokes, px: they are about as far from where they belong. A guess.
    pub scale: f32,
    /// The colours of areas.
    pub colors: AreaColors,
    /// Growth of the distance to the outside towards the middle of a shape from a place that is no end of a line, px
    /// per px. A guess.
    pub growth: f32,
    /// Blobs, which are wider than lines.
    pub blobs: Blobs,
    /// Lines of skeletons.
    pub lines: LineJoins,
    /// Which lines go on below others.
    pub bridges: Bridges,
    /// Splines of lines.
    pub splines: Splines,
    /// Filled shapes.
    pub fills: Fills,
}

/// Search for filled shapes. Colours are in levels of 8 bits, the largest difference of a channel where nothing else is
/// said. The measured values are those of 64 drawings at 256 px (`docs/areas.md`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fills {
    /// Most colours of a picture. A guess.
    pub most_colors: usize,
    /// A pixel is flat if the pixels beside it are within this range.
    pub flat: f32,
    /// Colours are farther apart than this. 12 took #f4f4f4 for white.
    pub apart: f32,
    /// A pixel has a colour beside another one only if it is this near; or else it is a mixture. Without this rule pale
    /// edges have steps: 220 points instead of 116.
    pub exact: f32,
    /// Root of the squared error over which neither a colour nor a mixture of two explains a pixel. A guess.
    pub unexplained: f32,
    /// Shares of the pixels that have to be flat, and of the squared residual that colours and their mixtures have to
    /// explain, or there are no filled shapes. Drawings of filled shapes have 0.69 to 0.99 and 0.93 to 1, photographs
    /// 0.07 to 0.31 and 0.30 to 0.77, scanned line drawings 0.53 to 0.68 and 0.86 to 0.93.
    pub least_shares: [f32; 2],
    /// Fewest pixels of a shape.
    pub least_area: usize,
    /// A shape goes on beneath another one that has at most this share of its border with shapes farther below.
    pub exposed: f32,
    /// Outlines.
    pub outlines: Outlines,
    /// Gradients.
    pub shades: Shades,
}

/// Search for the gradients of filled shapes. All of it is a guess, in levels of 8 bits where nothing else is said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shades {
    /// Most gradients of a picture; 0 if it may have none.
    pub most: usize,
    /// Largest second difference of smooth pixels: that of rounding is 2.
    pub bend: f32,
    /// Steepest step from pixel to pixel of one gradient.
    pub steepest: f32,
    /// Fewest pixels of a gradient.
    pub least_pixels: usize,
    /// Least range of its values.
    pub least_range: f32,
    /// Blocks along the longer side of a part, whose means are fitted.
    pub blocks: usize,
    /// The share of the blocks that a gradient has to meet, and by how much more than a single colour.
    pub least_share: f32,
    /// See `least_share`.
    pub least_gain: f32,
    /// Most gradients on top of each other.
    pub most_stacked: usize,
    /// Fewest pixels of a part that may have several.
    pub least_stacked: usize,
    /// A colour with this share of a part is taken away from it if no gradient is found.
    pub flat_share: f32,
    /// Most times that colours are taken away.
    pub rounds: usize,
    /// The fit of one.
    pub fit: ShadeFit,
}

/// Outlines of filled shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlines {
    /// Distance of the samples of an outline, px.
    pub step: f32,
    /// A corner's sides are fitted from the first to the second distance from it, px.
    pub sides: [f32; 2],
    /// The cosine of a corner's turn is below this. That of 0.62 rad.
    pub corner: f32,
    /// Farthest that an outline may be from the samples, px. 0.18, 0.3, 0.5: +0.6, 0, −2.6 dB at 1.16, 1, 0.9 times the
    /// bytes.
    pub tolerance: f32,
    /// Tolerance, px, of the polygon whose corners are the candidates for on-points.
    pub candidates: f32,
    /// Most off-points between two on-points.
    pub most_off: usize,
    /// Farthest that a hidden edge may be beyond the samples, px.
    pub hidden: f32,
}

impl Fills {
    /// The measured values.
    pub const MEASURED: Self = Self {
        most_colors: 255,
        flat: 8.0,
        apart: 5.0,
        exact: 2.5,
        unexplained: 26.0,
        least_shares: [0.6, 0.9],
        least_area: 4,
        exposed: 0.08,
        outlines: Outlines {
            step: 0.5,
            sides: [0.8, 4.5],
            corner: 0.814,
            tolerance: 0.3,
            candidates: 0.22,
            most_off: 8,
            hidden: 32.0,
        },
        shades: Shades {
            most: 64,
            bend: 3.0,
            steepest: 14.0,
            least_pixels: 40,
            least_range: 12.0,
            blocks: 40,
            least_share: 0.9,
            least_gain: 0.25,
            most_stacked: 3,
            least_stacked: 2000,
            flat_share: 0.25,
            rounds: 4,
            fit: ShadeFit {
                near: 3.0 / 255.0,
                hopeless_share: 0.1,
                stops: 6,
                rounds: 4,
                level: 1.1,
                stop_share: 0.15,
                ridge: 1e-4,
            },
        },
    };
}

/// Search for the colours of areas. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaColors {
    /// Most colours of a picture.
    pub most: usize,
    /// Pixels that colours are chosen from.
    pub samples: usize,
    /// Farthest that a pixel may be from its colour.
    pub near: f32,
    /// Farthest that the pixels of a flat area are from its colour.
    pub flat: f32,
    /// A colour is one that at least this share of the squared residual is near to.
    pub least_share: f32,
}

/// Blobs of shapes that are lines otherwise, whose usual radius is `r` px. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blobs {
    /// A disc with a radius of so many `r`, and so many px more, has room in a blob and not in lines, nor where two of those
    /// cross at 60°.
    pub room: [f32; 2],
    /// Within 2 px of a blob lines are thinner than so many `r`, and so many px more.
    pub abrupt: [f32; 2],
    /// A line is longer than so many times its width; what is shorter is a part of the blob.
    pub least_aspect: f32,
    /// Lines are as long together as this, px and in units of `r`.
    pub least_length: [f32; 2],
    /// A blob is none if lines that run across cover this share of it.
    pub covered: f32,
}

/// Lines of the edges of a skeleton. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineJoins {
    /// A hook is thinner than this share of its line's radius, and not longer than so many of its radii.
    pub hook: [f32; 2],
    /// Nodes closer than this are one, in units of their radii together.
    pub crossing: f32,
    /// A spur reaches beyond the disc around its node by less than this, px and in units of that disc's radius.
    pub spur: [f32; 2],
    /// Lines go on at a node if the cosine of their turn is above this.
    pub sharpest_turn: f32,
    /// A line is smooth at a node if the cosine of its turn there is above this.
    pub smooth_turn: f32,
}

/// Which gaps a line goes on across. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridges {
    /// Longest gap, in units of the line's radius and px.
    pub longest: [f32; 2],
    /// The cosine of the largest angle between a line's end and the gap.
    pub straight: f32,
    /// Longest gap within a blob of its colour, in units of the line's radius and px, and the cosine there.
    pub within: [f32; 2],
    /// See `within`.
    pub straight_within: f32,
    /// Most px of a gap that may show the canvas.
    pub open: usize,
    /// A line whose ends meet is a ring if it has this many places or more.
    pub least_ring: usize,
}

/// Spline of a line. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splines {
    /// The cosine of a corner's turn within `corner_reach` radii is less than this.
    pub corner: f32,
    /// Reach to either side of a place over which its turn is measured, in radii.
    pub corner_reach: f32,
    /// Farthest that a spline may be from its line, px and in units of the radius.
    pub tolerance: [f32; 2],
}
