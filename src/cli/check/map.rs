//! The map of the places where a render differs for the eye, and where it has lost details.

use anyhow::Result;
use strokefit::image::Image;
use strokefit::metrics;
use strokefit::report::picture::{self, heat};

/// Colour of details that are lost; no score has it.
const DETAIL: [f64; 3] = [0.86, 0.08, 0.08];

/// Losses of `drawn` against `target` as PNG: of SSIMULACRA2 by colour, of details in red.
pub(super) fn png(target: &Image, drawn: &Image) -> Result<Vec<u8>> {
    let scores = metrics::ssimulacra2_map(target, drawn)?;
    let details = metrics::details_lost(target, drawn)?;
    let places: Vec<(f32, f32)> = scores.into_iter().zip(details).collect();
    let map = picture::map(target.width(), &places, |(score, detail)| {
        let score = heat(lost(score));
        let share = f64::from(detail);
        std::array::from_fn(|k| score[k] + share * (DETAIL[k] - score[k]))
    })?;
    Ok(map.encode_png()?)
}

/// 0 for the score of equal pictures, 1 for a score of 0 or less.
fn lost(score: f32) -> f64 {
    1.0 - f64::from(score) / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_bright() {
        // Stripes are lost on the right half.
        let stripes = |is_drawn: bool| {
            let value = |i: usize| match i % 128 {
                64.. if !is_drawn && i % 4 < 2 => 0.8,
                _ => 0.5,
            };
            let plane: Vec<f32> = (0..128 * 64).map(value).collect();
            Image::new(128, 64, [plane.clone(), plane.clone(), plane]).unwrap()
        };
        let map = map(&stripes(false), &stripes(true));
        let green = |x: usize| map.planes()[1][32 * 128 + x];
        let (left, right) = (green(8), green(120));
        assert!(right > left + 0.3, "{left} {right}");
    }

    #[test]
    fn a_detail_that_is_lost_is_red() {
        // One of two thin lines is lost.
        let lines = |columns: &[usize]| {
            let value = |x, _, _| if columns.contains(&x) { 0.2_f32 } else { 1.0 };
            Image::from_fn(128, 64, 1, value).unwrap()
        };
        let map = map(&lines(&[32, 96]), &lines(&[32]));
        let color = |x: usize| [0, 1, 2].map(|c| f64::from(map.planes()[c][32 * 128 + x]));
        let is_red = |x| {
            color(x)
                .iter()
                .zip(DETAIL)
                .all(|(a, b)| (a - b).abs() < 0.01)
        };
        assert_eq!([32, 96, 98].map(is_red), [false, true, false]);
    }

    fn map(target: &Image, drawn: &Image) -> Image {
        let bytes = png(target, drawn).unwrap();
        Image::decode(&bytes, "map", strokefit::image::Limits::default()).unwrap()
    }
}
