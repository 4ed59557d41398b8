//! The price of a stroke: the squared error that its bytes have to remove.

use crate::math;
use crate::render::{Params, StrokeRef, Strokes};
use crate::svg::{WriteOptions, stroke_bytes};

/// The price of strokes, as squared error summed over pixels and channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Price {
    per_byte: f32,
    file: WriteOptions,
}

impl Price {
    /// At quality `q` each byte has to remove as much squared error as one pixel has at `q` dB: 3·10^(−q/10). Without a
    /// quality strokes are free.
    pub(super) fn new(quality: Option<f64>, file: WriteOptions) -> Self {
        let per_byte = quality.map_or(0.0, |q| 3.0 * math::powf(10.0, -q / 10.0)) as f32;
        Self { per_byte, file }
    }

    /// The price of a byte.
    pub(super) fn per_byte(&self) -> f32 {
        self.per_byte
    }

    /// The price of `stroke`.
    pub(super) fn of(&self, stroke: StrokeRef<'_>) -> f32 {
        if self.per_byte == 0.0 {
            return 0.0;
        }
        self.per_byte * stroke_bytes(&stroke.to_stroke(), &self.file) as f32
    }

    /// Bytes of a stroke.
    pub(super) fn bytes_of(&self, stroke: StrokeRef<'_>) -> usize {
        stroke_bytes(&stroke.to_stroke(), &self.file)
    }

    /// Bytes that one more point adds to a typical stroke.
    pub(super) fn point_bytes(&self) -> usize {
        let bytes = |points: &[[f32; 2]]| {
            self.bytes_of(StrokeRef {
                points,
                off: &[false; 3][..points.len()],
                closed: false,
                look: &[1.67, 0.4, 0.5, 0.6, 1.0],
            })
        };
        // In the middle of the file's numbers: steps of some px, with one sign of two.
        let points = [[123.46, 78.91], [127.82, 74.57], [134.24, 76.35]];
        bytes(&points).saturating_sub(bytes(&points[..2])).max(1)
    }

    /// The price of a point.
    pub(super) fn of_point(&self) -> f32 {
        self.per_byte * self.point_bytes() as f32
    }

    /// The price of a capsule.
    pub(super) fn of_capsule(&self, capsule: &Params) -> f32 {
        self.of(Strokes::from_iter([capsule]).get(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STROKE: Params = [10.0, 10.0, 20.0, 14.0, 2.0, 0.5, 0.25, 0.75, 1.0];

    fn price(quality: Option<f64>) -> Price {
        Price::new(quality, WriteOptions::default())
    }

    #[test]
    fn ten_db_are_a_tenth_of_the_price() {
        let (dear, cheap) = (price(Some(20.0)), price(Some(30.0)));
        assert!((dear.of_capsule(&STROKE) / cheap.of_capsule(&STROKE) - 10.0).abs() < 1e-3);
    }

    #[test]
    fn without_a_quality_strokes_are_free() {
        assert_eq!(price(None).of_capsule(&STROKE), 0.0);
    }
}
