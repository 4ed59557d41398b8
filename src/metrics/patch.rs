//! Largest difference of the mean of a patch.
//!
//! Antialiasing makes two renders of one drawing differ along all edges, by much in single pixels and by nothing on
//! average. A missing part differs in the mean of a whole patch.

use rayon::prelude::*;

use crate::image::Image;

/// Rows and columns of a patch, px; fewer where the picture has fewer.
pub(super) const SIDE: usize = 5;

/// Largest absolute difference of a channel's mean over a patch, 0..1, of two pictures of one size.
pub(super) fn max_abs(a: &Image, b: &Image) -> f32 {
    let (width, side) = (a.width(), SIDE.min(a.width()).min(a.height()));
    // Patches lie wholly in the picture, so all means are over equally many pixels.
    let starts = a.height() + 1 - side;
    let of_plane = |(a, b): (&Vec<f32>, &Vec<f32>)| {
        let of_row = |top: usize| {
            // Sums down the columns, then along the row: a patch costs as much as its rows are long.
            let columns: Vec<f32> = (0..width)
                .map(|x| {
                    (top..top + side)
                        .map(|y| a[y * width + x] - b[y * width + x])
                        .sum()
                })
                .collect();
            let sums = columns.windows(side).map(|patch| patch.iter().sum::<f32>());
            sums.fold(0.0_f32, |most, sum| most.max(sum.abs()))
        };
        (0..starts)
            .into_par_iter()
            .map(of_row)
            .reduce(|| 0.0, f32::max)
    };
    let planes = a.planes().iter().zip(b.planes());
    let most = planes.map(of_plane).fold(0.0, f32::max);
    most / (side * side) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A black picture with white pixels where `is_white` says so.
    fn picture(width: usize, height: usize, is_white: impl Fn(usize, usize) -> bool) -> Image {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let plane: Vec<f32> = pixels
            .map(|(x, y)| f32::from(u8::from(is_white(x, y))))
            .collect();
        Image::new(width, height, [plane.clone(), plane.clone(), plane]).unwrap()
    }

    fn black(width: usize, height: usize) -> Image {
        picture(width, height, |_, _| false)
    }

    #[test]
    fn a_gap_counts_by_its_share_of_a_patch() {
        let gap = |x: usize, y: usize| (10..15).contains(&x) && (4..6).contains(&y);
        let most = max_abs(&black(40, 20), &picture(40, 20, gap));
        assert!((most - 0.4).abs() < 1e-6, "{most}");
    }

    #[test]
    fn differences_of_both_signs_cancel() {
        let checkers = |odd: usize| picture(24, 24, move |x, y| (x + y) % 2 == odd);
        assert!(max_abs(&checkers(0), &checkers(1)) < 0.05);
    }

    #[test]
    fn a_picture_smaller_than_a_patch_is_one_patch() {
        let most = max_abs(&black(3, 3), &picture(3, 3, |x, y| x == 1 && y == 1));
        assert!((most - 1.0 / 9.0).abs() < 1e-6, "{most}");
    }
}
