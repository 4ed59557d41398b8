//! Lines whose width varies: strokes with a radius at each vertex.
//!
//! The vertices are the points with [`is_on`](super::PathPoint::is_on), in their order: neither the on-points that control points of
//! quadratic curves imply, nor the middle points of arcs. Between two vertices the radius runs linearly with the parameter
//! of the curves between them: `(j + t)/k` on the `j`-th of `k` pieces, where `t` is the share of the angle on an arc.

use super::{Cap, Path, Rgb, Stroke};
use crate::error::{Error, ErrorKind, Result};

impl Stroke {
    /// A stroke with half a width at each vertex of its path, px, and with round ends and corners.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when there is not one radius for each vertex, when one is negative or not finite, or when none is
    /// above 0.
    pub fn varying(path: Path, radii: Vec<f64>, color: Rgb, opacity: f32) -> Result<Self> {
        let refused = |message: String| Err(Error::new(ErrorKind::Config, message));
        let vertices = path.points().iter().filter(|p| p.is_on()).count();
        if vertices != radii.len() || vertices == 0 {
            return refused(format!(
                "a line of {vertices} points on its path has {} radii: give one for each, of a path with such points",
                radii.len()
            ));
        }
        if let Some(radius) = radii.iter().find(|r| !r.is_finite() || **r < 0.0) {
            return refused(format!("a radius is {radius} px: make it 0 or more"));
        }
        let radius = radii.iter().copied().fold(0.0, f64::max);
        if radius == 0.0 {
            return refused("a line has no radius above 0: give it one, or leave it out".into());
        }
        Ok(Self {
            path,
            radius,
            radii,
            cap: Cap::Round,
            color,
            opacity,
        })
    }

    /// True if it has a radius at each vertex.
    pub fn is_varying(&self) -> bool {
        !self.radii.is_empty()
    }
}
