//! The tuned numbers of tracing. `docs/lines.md` has the pictures that they were tried on.

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
    /// Most times that a drawing is traced. A guess.
    pub rounds: usize,
    /// Scale of the fit of traced strokes, px: they are about as far from where they belong. A guess.
    pub scale: f32,
    /// The colours of areas.
    pub colors: AreaColors,
    /// Growth of the distance to the outside towards the middle of a shape from a place that is no end of a line, px
    /// per px. A guess.
    pub growth: f32,
    /// Lines of skeletons.
    pub lines: LineJoins,
    /// Which lines go on below others.
    pub bridges: Bridges,
    /// Splines of lines.
    pub splines: Splines,
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
