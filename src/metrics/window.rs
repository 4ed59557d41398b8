//! Means, sums and extremes of windows.

use std::collections::VecDeque;

use rayon::prelude::*;

use crate::image::Image;

/// Replaces each value by the mean of the window of 2`radius` + 1 rows and columns around it, as far as that is in the
/// picture.
pub(crate) fn average(values: &mut [f64], width: usize, radius: usize) {
    // A row is a picture 1 px wide, if it is turned.
    let rows = values.par_chunks_exact_mut(width);
    rows.for_each(|row| average_rows(row, 1, radius));
    average_rows(values, width, radius);
}

/// Replaces each row of `width` values by the mean of the rows at most `radius` away.
fn average_rows(values: &mut [f64], width: usize, radius: usize) {
    let height = values.len() / width;
    let row = |y: usize| y * width..(y + 1) * width;
    // Rows are needed once more after they are replaced.
    let mut before = VecDeque::new();
    // A running sum of the rows in reach: the next row enters, the first one leaves.
    let mut sums = vec![0.0; width];
    for y in 0..radius.min(height) {
        add(&mut sums, &values[row(y)]);
    }
    for y in 0..height {
        if y + radius < height {
            add(&mut sums, &values[row(y + radius)]);
        }
        let count = in_reach(y, height, radius) as f64;
        for (value, sum) in values[row(y)].iter_mut().zip(&sums) {
            before.push_back(*value);
            *value = sum / count;
        }
        if y >= radius {
            let gone = before.drain(..width);
            sums.iter_mut().zip(gone).for_each(|(sum, v)| *sum -= v);
        }
    }
}

fn add(sums: &mut [f64], values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v);
}

/// Number of the `length` places that are at most `radius` away from place `i`.
fn in_reach(i: usize, length: usize, radius: usize) -> usize {
    length.min(i + radius + 1) - i.saturating_sub(radius)
}

/// The extreme value of the window of 2`reach` + 1 rows and columns around each pixel, as far as that is in the picture.
pub(crate) fn extremes(
    values: &[f32],
    width: usize,
    reach: usize,
    pick: impl Fn(f32, f32) -> f32 + Copy + Sync,
) -> Vec<f32> {
    let height = values.len() / width;
    let merge = |out: &mut [f32], others: &[f32]| {
        let values = out.iter_mut().zip(others);
        values.for_each(|(value, other)| *value = pick(*value, *other));
    };
    // One column, or row, of the window at a time, so that many pixels are compared at once.
    let mut across = values.to_vec();
    let rows = across.par_chunks_exact_mut(width);
    rows.zip(values.par_chunks_exact(width))
        .for_each(|(out, row)| {
            for shift in 1..(reach + 1).min(width) {
                merge(out, &row[shift..]);
                merge(&mut out[shift..], row);
            }
        });
    let mut out = across.clone();
    // A square window is a row of columns: the extremes down the columns of the extremes across.
    let rows = out.par_chunks_exact_mut(width).enumerate();
    rows.for_each(|(y, out)| {
        for other in y.saturating_sub(reach)..(y + reach + 1).min(height) {
            merge(out, &across[other * width..(other + 1) * width]);
        }
    });
    out
}

/// Rows and columns of a patch, px; fewer where the picture has fewer.
const SIDE: usize = 5;

/// Largest absolute difference of a channel's mean over a patch, 0..1, of two pictures of one size. Antialiasing makes two
/// renders of one drawing differ along all edges, by much in single pixels and by nothing on average. A missing part differs in
/// the mean of a whole patch.
pub(super) fn max_patch_abs(a: &Image, b: &Image) -> f32 {
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

/// Sums over a window around each pixel of a row of two planes: of the values of both, of their squares and of their product.
pub(super) struct Moments<'a> {
    /// Weights of the samples, from the middle of the window outwards.
    taps: &'a [f32],
    /// Sums down the columns.
    down: [Vec<f32>; 5],
    /// And along the row.
    both: [Vec<f32>; 5],
}

impl<'a> Moments<'a> {
    pub(super) fn new(taps: &'a [f32], width: usize) -> Self {
        let row = || std::array::from_fn(|_| vec![0.0; width]);
        let (down, both) = (row(), row());
        Self { taps, down, both }
    }

    /// The sums of row `y` of the planes `a` and `b`, by the instructions of the caller. Beyond the border all is 0, so
    /// rows off the picture add nothing, and weights are not rescaled.
    #[inline(always)]
    pub(super) fn of_row(&mut self, a: &[f32], b: &[f32], y: usize) -> &[Vec<f32>; 5] {
        let width = self.down[0].len();
        let (height, reach) = (a.len() / width, self.taps.len());
        self.down.iter_mut().for_each(|sums| sums.fill(0.0));
        for near in (y + 1).saturating_sub(reach)..(y + reach).min(height) {
            let row = near * width..(near + 1) * width;
            let tap = self.taps[near.abs_diff(y)];
            add_row(&mut self.down, &a[row.clone()], &b[row], tap);
        }
        for (down, both) in self.down.iter().zip(&mut self.both) {
            blur(self.taps, down, both);
        }
        &self.both
    }
}

#[inline(always)]
fn add_row(sums: &mut [Vec<f32>; 5], a: &[f32], b: &[f32], tap: f32) {
    let [sum_a, sum_b, sum_aa, sum_bb, sum_ab] = sums;
    let sums = sum_a
        .iter_mut()
        .zip(sum_b)
        .zip(sum_aa)
        .zip(sum_bb)
        .zip(sum_ab);
    for ((a, b), ((((sum_a, sum_b), sum_aa), sum_bb), sum_ab)) in a.iter().zip(b).zip(sums) {
        *sum_a += tap * a;
        *sum_b += tap * b;
        *sum_aa += tap * (a * a);
        *sum_bb += tap * (b * b);
        *sum_ab += tap * (a * b);
    }
}

/// Sums of a row, each sample with those at both sides. The whole row is added, shifted by each tap's distance, so that the inner
/// loop is a plain multiply-add.
#[inline(always)]
fn blur(taps: &[f32], from: &[f32], to: &mut [f32]) {
    for (t, f) in to.iter_mut().zip(from) {
        *t = taps[0] * f;
    }
    for (shift, &tap) in taps.iter().enumerate().skip(1) {
        if shift >= from.len() {
            break;
        }
        let rest = from.len() - shift;
        for (t, f) in to[..rest].iter_mut().zip(&from[shift..]) {
            *t += tap * f;
        }
        for (t, f) in to[shift..].iter_mut().zip(&from[..rest]) {
            *t += tap * f;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_the_window() {
        let (width, height) = (5, 4);
        let values: Vec<f64> = (0..width * height).map(|i| (i * i % 7) as f64).collect();
        let mut means = values.clone();
        average(&mut means, width, 1);
        for y in 0..height {
            for x in 0..width {
                let rows = y.saturating_sub(1)..height.min(y + 2);
                let window: Vec<f64> = rows
                    .flat_map(|row| {
                        let columns = x.saturating_sub(1)..width.min(x + 2);
                        columns.map(move |column| row * width + column)
                    })
                    .map(|i| values[i])
                    .collect();
                let mean = window.iter().sum::<f64>() / window.len() as f64;
                assert!((means[y * width + x] - mean).abs() < 1e-9, "{x} {y}");
            }
        }
    }

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
        let most = max_patch_abs(&black(40, 20), &picture(40, 20, gap));
        assert!((most - 0.4).abs() < 1e-6, "{most}");
    }

    #[test]
    fn differences_of_both_signs_cancel() {
        let checkers = |odd: usize| picture(24, 24, move |x, y| (x + y) % 2 == odd);
        assert!(max_patch_abs(&checkers(0), &checkers(1)) < 0.05);
    }

    #[test]
    fn a_picture_smaller_than_a_patch_is_one_patch() {
        let most = max_patch_abs(&black(3, 3), &picture(3, 3, |x, y| x == 1 && y == 1));
        assert!((most - 1.0 / 9.0).abs() < 1e-6, "{most}");
    }
}
