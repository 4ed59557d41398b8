//! Pictures of arrays of numbers.

use crate::error::Result;
use crate::image::Image;

/// A picture of `values`, row by row, each coloured by `color`. Rows have `width` values; an
/// incomplete last row is left out.
///
/// # Errors
/// [`ErrorKind::Picture`](crate::ErrorKind::Picture) when there is no complete row, or a colour is
/// not finite.
pub fn map<V: Copy>(width: usize, values: &[V], color: impl Fn(V) -> [f64; 3]) -> Result<Image> {
    let height = values.len().checked_div(width).unwrap_or(0);
    let mut planes: [Vec<f32>; 3] = Default::default();
    for &value in &values[..width * height] {
        for (plane, c) in planes.iter_mut().zip(color(value)) {
            plane.push(c.clamp(0.0, 1.0) as f32);
        }
    }
    Image::new(width, height, planes)
}

/// From dark blue over green to yellow, for 0 to 1; equal steps look equal.
pub fn heat(value: f64) -> [f64; 3] {
    const STOPS: [[f64; 3]; 5] = [
        [0.27, 0.0, 0.33],
        [0.23, 0.32, 0.55],
        [0.13, 0.57, 0.55],
        [0.37, 0.79, 0.38],
        [0.99, 0.91, 0.14],
    ];
    let at = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let i = (at as usize).min(STOPS.len() - 2);
    let part = at - i as f64;
    std::array::from_fn(|k| STOPS[i][k] + part * (STOPS[i + 1][k] - STOPS[i][k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incomplete_rows_are_left_out() {
        let image = map(2, &[0.0, 1.0, 0.5], heat).unwrap();
        assert_eq!((image.width(), image.height()), (2, 1));
        assert!(map(0, &[0.0], heat).is_err());
        assert!(map(4, &[0.0], heat).is_err());
    }

    #[test]
    fn colours_stay_within_their_range() {
        for i in -50..=50 {
            let value = f64::from(i) / 10.0;
            let image = map(1, &[value], heat).unwrap();
            let planes = image.planes();
            assert!(
                planes.iter().all(|p| (0.0..=1.0).contains(&p[0])),
                "{value}"
            );
        }
    }
}
