//! Fineness: how much of a picture's detail is finer than two pixels.

use super::average;
use crate::image::Image;
use crate::math;

/// Half the side of the window that detail is in, px.
const REACH: usize = 4;

/// The share of the squared detail of the green channel, which is what differs from the mean of 9×9 px, that the picture halved and
/// enlarged again lacks; `None` if there is hardly any.
pub(crate) fn fine_share(picture: &Image) -> Option<f64> {
    let width = picture.width();
    let [_, plane, _] = picture.planes();
    // Detail that survives halving and enlarging is coarser than two pixels.
    let half = Half::of(plane, width);
    let mut means: Vec<f64> = plane.iter().map(|v| f64::from(*v)).collect();
    average(&mut means, width, REACH);
    let [mut fine, mut all] = [0.0; 2];
    for (i, (value, mean)) in plane.iter().zip(means).enumerate() {
        fine += math::powi(f64::from(value - half.at(i % width, i / width)), 2);
        all += math::powi(f64::from(*value) - mean, 2);
    }
    // A hundredth of the pixels at an edge of full contrast.
    (all > 1e-4 * plane.len() as f64).then(|| fine / all)
}

/// A plane at half the size, each pixel the mean of 2×2.
pub(crate) struct Half {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f32>,
}

impl Half {
    /// The half of a plane, rows of `width`; the last row and column count twice where their number is odd.
    pub(crate) fn of(values: &[f32], width: usize) -> Self {
        let rows: Vec<&[f32]> = values.chunks(width).collect();
        let pairs = rows.chunks(2).map(|pair| (pair[0], pair[pair.len() - 1]));
        let mean = |(top, bottom): (&[f32], &[f32])| {
            let quads = top.chunks(2).zip(bottom.chunks(2));
            let sum = |pair: &[f32]| pair[0] + pair[pair.len() - 1];
            quads
                .map(|(a, b)| (sum(a) + sum(b)) / 4.0)
                .collect::<Vec<_>>()
        };
        Self {
            width: width.div_ceil(2),
            height: rows.len().div_ceil(2),
            values: pairs.flat_map(mean).collect(),
        }
    }

    /// The value at pixel (x, y) of the whole plane, interpolated between the pixels of the half.
    pub(crate) fn at(&self, x: usize, y: usize) -> f32 {
        let beside = |at: usize, size: usize| {
            // A pixel's centre is a quarter of a half-size pixel from the centre of the one it lies in, towards the neighbour on
            // its side: linear weights ¾ and ¼. At the border the neighbour is the pixel itself.
            let own = at / 2;
            let other = if at.is_multiple_of(2) {
                own.saturating_sub(1)
            } else {
                own + 1
            };
            (own, other.min(size - 1))
        };
        let ((x, left), (y, above)) = (beside(x, self.width), beside(y, self.height));
        let at = |x: usize, y: usize| self.values[y * self.width + x];
        let row = |y: usize| 0.75 * at(x, y) + 0.25 * at(left, y);
        0.75 * row(y) + 0.25 * row(above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enlarged_disc_has_no_fine_detail() {
        let disc = |softness: f32| {
            let value = |x: usize, y: usize, _| {
                let [x, y] = [x, y].map(|v| v as f32 - 47.5);
                (((x * x + y * y).sqrt() - 30.0) / softness + 0.5).clamp(0.0, 1.0)
            };
            Image::from_fn(96, 96, 1, value).unwrap()
        };
        let share = |softness| fine_share(&disc(softness)).unwrap();
        assert!(share(1.0) > 0.15, "{}", share(1.0));
        assert!(share(3.0) < 0.1, "{}", share(3.0));
        assert_eq!(fine_share(&Image::filled(96, 96, [0.5; 3]).unwrap()), None);
    }
}
