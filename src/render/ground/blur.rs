//! The Gaussian blur of filters.

use crate::math;

/// Values row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Values of a row.
    pub width: usize,
    /// All values.
    pub values: Vec<f32>,
}

/// From this standard deviation on, px, boxes in a row are near enough to a Gaussian, and much faster.
const BOXES_FROM: f32 = 8.0;
/// Boxes in the place of a Gaussian.
const BOXES: usize = 5;

/// The plane with a Gaussian blur of this standard deviation, px; zeros lie around it.
pub fn blurred(plane: Plane, deviation: f32) -> Plane {
    let along = |plane: Plane| match deviation < BOXES_FROM {
        true => convolved(&plane, &gaussian(deviation)),
        false => boxed(plane, deviation),
    };
    // A Gaussian is a product of one along x and one along y: blur the rows, and then the columns as rows.
    transposed(along(transposed(along(plane))))
}

/// Half of a Gaussian of this standard deviation, from its middle on, such that the sum of the whole is 1.
fn gaussian(deviation: f32) -> Vec<f32> {
    let reach = (4.0 * deviation).ceil() as u16;
    let bell = |x: u16| {
        let x = f32::from(x) / deviation;
        math::exp(-0.5 * x * x)
    };
    // Beyond four standard deviations lies 6e-5 of the sum; the division makes up for it.
    let half: Vec<f32> = (0..=reach).map(bell).collect();
    let sum = half[0] + 2.0 * half[1..].iter().sum::<f32>();
    half.into_iter().map(|v| v / sum).collect()
}

/// Each row, convolved with a symmetric kernel.
fn convolved(plane: &Plane, half: &[f32]) -> Plane {
    let mut values = Vec::with_capacity(plane.values.len());
    for row in plane.values.chunks_exact(plane.width.max(1)) {
        let at = |x: Option<usize>| x.and_then(|x| row.get(x)).copied().unwrap_or(0.0);
        values.extend((0..row.len()).map(|x| {
            let sides = half.iter().enumerate().skip(1);
            let beside = sides.map(|(k, v)| v * (at(x.checked_sub(k)) + at(x.checked_add(k))));
            half[0] * row[x] + beside.sum::<f32>()
        }));
    }
    Plane { values, ..*plane }
}

/// Each row, blurred by boxes of two odd widths, the wider ones as many as bring the variance nearest to the Gaussian's.
fn boxed(plane: Plane, deviation: f32) -> Plane {
    // Variances of boxes in a row add up. A box of w values has (w² − 1)/12.
    let variance = |width: usize| (width * width - 1) as f32 / 12.0;
    let wanted = deviation * deviation;
    let ideal = (12.0 * wanted / BOXES as f32 + 1.0).sqrt();
    // The largest odd width that is not above the ideal one: a box of odd width shifts nothing.
    let narrow = 2 * ((ideal as usize - 1) / 2) + 1;
    let missing = wanted - BOXES as f32 * variance(narrow);
    let wide = (missing / (variance(narrow + 2) - variance(narrow))).round() as usize;
    let widths = (0..BOXES).map(|k| if k < wide { narrow + 2 } else { narrow });
    widths.fold(plane, |plane, width| means(&plane, width / 2))
}

/// The mean of each value with so many before and after it in its row.
fn means(plane: &Plane, reach: usize) -> Plane {
    // A running sum: a value enters at the front and leaves at the back. In `f64`, so that what leaves cancels what entered. Zeros
    // lie around the row, so the divisor is the same everywhere.
    let count = (2 * reach + 1) as f64;
    let mut values = Vec::with_capacity(plane.values.len());
    for row in plane.values.chunks_exact(plane.width.max(1)) {
        let mut sum: f64 = row.iter().take(reach).map(|&v| f64::from(v)).sum();
        for x in 0..row.len() {
            sum += row.get(x + reach).map_or(0.0, |&v| f64::from(v));
            values.push((sum / count) as f32);
            sum -= x
                .checked_sub(reach)
                .map_or(0.0, |first| f64::from(row[first]));
        }
    }
    Plane { values, ..*plane }
}

fn transposed(plane: Plane) -> Plane {
    let height = plane.values.len() / plane.width.max(1);
    let columns = 0..plane.width;
    let column = |x: usize| plane.values[x..].iter().step_by(plane.width).copied();
    let values = columns.flat_map(column).collect();
    Plane {
        width: height,
        values,
    }
}
