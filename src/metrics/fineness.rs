//! Fineness: how much of a picture's detail is finer than two pixels.

use super::average;
use crate::image::{Half, Image};
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
