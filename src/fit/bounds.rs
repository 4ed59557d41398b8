//! The domains of a stroke's parameters, at the resolution of a drawing.

use super::recipe::Domain;
use crate::render::{Grid, StrokeMut};

/// The domains of a stroke's parameters, to which each step of descent is clamped.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    domain: Domain,
    /// Sides of the picture, px.
    sides: [f32; 2],
}

impl Bounds {
    /// The bounds for a picture of `grid`'s size; `opaque` fixes the opacity at 1.
    pub(super) fn new(grid: Grid, domain: Domain, opaque: bool) -> Self {
        let min_opacity = if opaque { 1.0 } else { domain.min_opacity };
        Self {
            domain: Domain {
                min_opacity,
                ..domain
            },
            sides: [grid.width as f32, grid.height as f32],
        }
    }

    /// The same bounds at another resolution.
    pub(super) fn on(self, grid: Grid) -> Self {
        Self {
            sides: [grid.width as f32, grid.height as f32],
            ..self
        }
    }

    pub(super) fn min_opacity(&self) -> f32 {
        self.domain.min_opacity
    }

    /// Clamps a stroke to its domain. NaN stays; such a stroke is dropped later.
    pub(super) fn apply(&self, stroke: StrokeMut<'_>) {
        let margin = self.domain.margin;
        let [width, height] = self.sides;
        for end in stroke.points {
            end[0] = end[0].clamp(-margin, width + margin);
            end[1] = end[1].clamp(-margin, height + margin);
        }
        // A recipe may ask for strokes that are wider than a small picture.
        let min_radius = self.domain.min_radius;
        let [radius, color @ .., opacity] = stroke.look;
        *radius = radius.clamp(min_radius, width.max(height).max(min_radius));
        for color in color {
            *color = color.clamp(0.0, 1.0);
        }
        *opacity = opacity.clamp(self.domain.min_opacity, 1.0);
    }
}
