//! Colours of numbers.

use strokefit::math;

pub use strokefit::report::{heat, map};

/// 0 is black, 1 white.
pub fn gray(value: f64) -> [f64; 3] {
    [value; 3]
}

/// White on the edge of a shape, orange inside and blue outside, with a line every 4 px.
pub fn distance(d: f64) -> [f64; 3] {
    let [near, far] = if d >= 0.0 {
        [[1.0, 0.87, 0.7], [0.85, 0.35, 0.05]]
    } else {
        [[0.82, 0.9, 1.0], [0.1, 0.35, 0.7]]
    };
    let depth = 1.0 - math::exp(-d.abs() / 12.0);
    let line = if (d / 4.0 - (d / 4.0).round()).abs() < 0.1 {
        0.85
    } else {
        1.0
    };
    let edge = math::exp(-(d * d) * 2.0);
    std::array::from_fn(|k| {
        let color = (near[k] + depth * (far[k] - near[k])) * line;
        color + edge * (1.0 - color)
    })
}

/// Signed numbers: −1 red, 0 white, 1 green.
pub fn signed(value: f64) -> [f64; 3] {
    let fade = 1.0 - value.abs().min(1.0);
    if value < 0.0 {
        [1.0 - 0.2 * (1.0 - fade), fade, fade]
    } else {
        [fade, 1.0 - 0.4 * (1.0 - fade), fade]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_stay_within_their_range() {
        for i in -50..=50 {
            let value = f64::from(i) / 10.0;
            for color in [gray, distance, signed] {
                let image = map(1, &[value], color).unwrap();
                let planes = image.planes();
                assert!(
                    planes.iter().all(|p| (0.0..=1.0).contains(&p[0])),
                    "{value}"
                );
            }
        }
    }
}
