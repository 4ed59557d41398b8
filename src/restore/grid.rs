//! The grid of blocks of a JPEG, which has another place in a picture that was cropped or pasted.
//!
//! Ringing ends where its block ends: on one side of a border of blocks pixels differ a little from those beside them, on the
//! other side they are equal.

use rayon::prelude::*;

use super::cosine::SIDE;
use super::planes::Planes;

/// Differences of luma, levels, that are ringing; smaller ones are none, larger ones are edges.
const RINGING: std::ops::Range<f32> = 0.7..24.0;

/// The grid has so many times the ends of ringing of any other place, across and down. Drawings in JPEG of quality 60 to 98 have 1.41
/// and more; 130 clean pictures have 1.2 at most, and one whose discs repeat every eight pixels has 1.58. An enlargement has many ends
/// in every second place.
const DECISIVE: f32 = 1.4;

/// Fewer ends in the whole picture are chance. A guess.
const LEAST: u32 = 64;

/// The column and the row, 0 to 7, at which blocks begin, where they can be told.
pub(super) fn offset(planes: &Planes) -> [Option<usize>; 2] {
    let luma = &planes.planes[0];
    let across = ends(luma, planes.width);
    let down = ends(&transposed(luma, planes.width), planes.height);
    [across, down].map(|ends| decisive(&ends))
}

/// The ends of ringing between columns, by the place of the later column in a block.
fn ends(luma: &[f32], width: usize) -> [u32; SIDE] {
    let rows: Vec<&[f32]> = luma.chunks_exact(width).collect();
    let of_rows = |pair: &[&[f32]]| {
        let mut counts = [0; SIDE];
        let difference = |x: usize| (pair[0][x] - pair[1][x]).abs();
        for x in 1..width {
            let (before, after) = (difference(x - 1), difference(x));
            let is_end = |ringing: f32, none: f32| RINGING.contains(&ringing) && none < 0.1;
            counts[x % SIDE] += u32::from(is_end(before, after) || is_end(after, before));
        }
        counts
    };
    let sum = |a: [u32; SIDE], b: [u32; SIDE]| std::array::from_fn(|k| a[k] + b[k]);
    rows.par_windows(2).map(of_rows).reduce(|| [0; SIDE], sum)
}

/// The place that has far more ends than any other.
fn decisive(ends: &[u32; SIDE]) -> Option<usize> {
    let most = (0..SIDE).max_by_key(|k| (ends[*k], SIDE - k))?;
    let others = (0..SIDE).filter(|k| *k != most).map(|k| ends[k]);
    let is_decisive = ends[most] as f32 > DECISIVE * others.max()? as f32;
    (is_decisive && ends.iter().sum::<u32>() >= LEAST).then_some(most)
}

fn transposed(luma: &[f32], width: usize) -> Vec<f32> {
    (0..width)
        .flat_map(|x| luma.iter().skip(x).step_by(width).copied())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    /// Discs on white, with antialiasing, at places that no grid has.
    fn discs() -> Image {
        let discs = [[37.3, 41.7, 23.4], [91.2, 88.9, 30.2], [100.0, 25.0, 14.6]];
        Image::from_fn(136, 136, 1, |x, y, _| {
            let outside = discs.map(|[cx, cy, radius]| {
                let [dx, dy] = [x as f32 - cx, y as f32 - cy];
                ((dx * dx + dy * dy).sqrt() - radius).clamp(0.0, 1.0)
            });
            0.2 + 0.8 * outside.iter().fold(1.0_f32, |least, v| least.min(*v))
        })
        .unwrap()
    }

    fn found(picture: &Image) -> [Option<usize>; 2] {
        offset(&Planes::of(picture))
    }

    // JPEG is written by the program alone.
    #[cfg(feature = "cli")]
    #[test]
    fn the_grid_of_a_cropped_jpeg_is_found() {
        use crate::image::Limits;
        let jpeg = discs().encode_jpeg(75).unwrap();
        let jpeg = Image::decode(&jpeg, "JPEG", Limits::default()).unwrap();
        assert_eq!(found(&jpeg), [Some(0); 2]);
        // Three columns and five rows are cut off.
        let plane = &jpeg.planes()[0];
        let cropped = Image::from_fn(128, 128, 1, |x, y, _| plane[(y + 5) * 136 + x + 3]);
        assert_eq!(found(&cropped.unwrap()), [Some(5), Some(3)]);
    }

    #[test]
    fn a_clean_picture_has_none() {
        assert_eq!(found(&discs()), [None; 2]);
        let blank = Image::filled(40, 9, [1.0; 3]).unwrap();
        assert_eq!(found(&blank), [None; 2]);
    }
}
