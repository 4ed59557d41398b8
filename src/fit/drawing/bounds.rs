//! The domains of a stroke's parameters, at the resolution of a drawing.

use crate::fit::recipe::Domain;
use crate::render::{Grid, StrokeMut};

/// The domains of a stroke's parameters, to which each step of descent is clamped.
#[derive(Debug, Clone, Copy)]
pub(in crate::fit) struct Bounds {
    domain: Domain,
    /// Sides of the picture, px.
    sides: [f32; 2],
    /// The radii of the thinnest and the widest pen, px of the picture, if pens are given.
    pens: Option<[f32; 2]>,
    /// Number of times that the picture is halved.
    halvings: usize,
}

impl Bounds {
    /// The bounds for a picture of `grid`'s size, which is `halvings` times halved; `opaque` fixes the opacity at 1. If there
    /// are `radii` of pens, px of the picture, they bound all radii.
    pub(in crate::fit) fn new(
        (grid, halvings): (Grid, usize),
        domain: Domain,
        opaque: bool,
        radii: &[f32],
    ) -> Self {
        let min_opacity = if opaque { 1.0 } else { domain.min_opacity };
        Self {
            domain: Domain {
                min_opacity,
                ..domain
            },
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

    pub(in crate::fit) fn min_opacity(&self) -> f32 {
        self.domain.min_opacity
    }

    /// The radius nearest to `scale`, px of the picture, that pens can draw; `scale` if none are given.
    pub(in crate::fit) fn drawable(&self, scale: f32) -> f32 {
        self.pens
            .map_or(scale, |[thinnest, widest]| scale.clamp(thinnest, widest))
    }

    /// The least and the largest radius at the current resolution.
    fn radii(&self) -> [f32; 2] {
        let [width, height] = self.sides;
        // A recipe may ask for strokes that are wider than a small picture.
        let least = self.domain.min_radius;
        let any = [least, width.max(height).max(least)];
        self.pens.map_or(any, |pens| {
            pens.map(|r| r / (1_u32 << self.halvings) as f32)
        })
    }

    /// Clamps a stroke or an area to its domain. NaN stays; such a stroke is dropped later.
    pub(in crate::fit) fn apply(&self, stroke: StrokeMut<'_>) {
        let margin = self.domain.margin;
        let [width, height] = self.sides;
        for end in stroke.points {
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
        *opacity = opacity.clamp(self.domain.min_opacity, 1.0);
    }
}
