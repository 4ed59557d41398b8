//! The domains of a stroke's parameters, at the resolution of a drawing.

use crate::render::{Grid, StrokeMut};

/// Ends stay within this many px around the picture. Half, twice: +0.03, +0.08 dB.
const MARGIN: f32 = 8.0;
/// Least radius, px. Renderers draw widths of 1 px and less as hairlines, by another method.
pub(in crate::fit) const MIN_RADIUS: f32 = 0.51;

/// The domains of a stroke's parameters, to which each step of descent is clamped.
#[derive(Debug, Clone, Copy)]
pub(in crate::fit) struct Bounds {
    /// Farthest that ends are outside of the picture, px.
    margin: f32,
    /// The least opacity.
    pub(in crate::fit) min_opacity: f32,
    /// Sides of the picture, px.
    sides: [f32; 2],
    /// The radii of the thinnest and the widest pen, px of the picture, if pens are given.
    pens: Option<[f32; 2]>,
    /// Number of times that the picture is halved.
    halvings: usize,
}

impl Bounds {
    /// The bounds for a picture of `grid`'s size, which is `halvings` times halved; ends of strokes that are
    /// confined stay in the picture. If there are `radii` of pens, px of the picture, they bound all radii.
    pub(in crate::fit) fn new(
        (grid, halvings): (Grid, usize),
        is_confined: bool,
        min_opacity: f32,
        radii: &[f32],
    ) -> Self {
        Self {
            margin: if is_confined { 0.0 } else { MARGIN },
            min_opacity,
            sides: [grid.width as f32, grid.height as f32],
            pens: radii.first().zip(radii.last()).map(|(a, b)| [*a, *b]),
            halvings,
        }
    }

    /// These bounds at another resolution.
    pub(in crate::fit) fn on(self, (grid, halvings): (Grid, usize)) -> Self {
        Self {
            halvings,
            sides: [grid.width as f32, grid.height as f32],
            ..self
        }
    }

    /// The radius nearest to `scale`, px of the picture, that pens can draw; `scale` if none are given.
    pub(in crate::fit) fn drawable(&self, scale: f32) -> f32 {
        self.pens
            .map_or(scale, |[thinnest, widest]| scale.clamp(thinnest, widest))
    }

    /// The least and the largest radius at the current resolution.
    fn radii(&self) -> [f32; 2] {
        let [width, height] = self.sides;
        let any = [MIN_RADIUS, width.max(height).max(MIN_RADIUS)];
        self.pens.map_or(any, |pens| {
            pens.map(|r| r / (1_u32 << self.halvings) as f32)
        })
    }

    /// Clamps a stroke or an area to its domain. NaN stays; such a stroke is dropped later.
    pub(in crate::fit) fn apply(&self, stroke: StrokeMut<'_>) {
        let margin = self.margin;
        let [width, height] = self.sides;
        // The outline of a line whose width varies stays as that says.
        let points = stroke.points.iter_mut().filter(|_| stroke.sweep.is_none());
        for end in points {
            end[0] = end[0].clamp(-margin, width + margin);
            end[1] = end[1].clamp(-margin, height + margin);
        }
        let [least, most] = self.radii();
        let [radius, color @ .., opacity] = stroke.style;
        if !stroke.is_area {
            *radius = radius.clamp(least, most);
        }
        for color in color {
            *color = color.clamp(0.0, 1.0);
        }
        *opacity = opacity.clamp(self.min_opacity, 1.0);
    }
}
