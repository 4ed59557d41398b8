//! Chroma that was kept at half the resolution, brought back along the edges of luma.
//!
//! Joint bilateral upsampling: Kopf, Cohen, Lischinski and Uyttendaele (2007).

use rayon::prelude::*;

use super::planes::Planes;
use crate::image::Half;
use crate::math;

/// Half the side of the window, in px of the half.
const REACH: isize = 2;

/// Width of the weights: in px of the half, and in levels of luma. 4 to 9 levels and 0.9 to 1.6 px differ by 0.05 dB.
const NEAR_PX: f32 = 1.2;
const ALIKE: f32 = 6.0;

/// Largest ratio of chroma's fine detail to luma's in a picture with chroma at half the resolution. Others have 0.9 to 1.05,
/// JPEG of flat art 0.3 to 0.75.
const HALVED: f64 = 0.8;

/// True if chroma has far less fine detail than luma.
pub(super) fn is_halved(planes: &Planes) -> bool {
    let [luma, chromas @ ..] = planes.planes.each_ref();
    let of = |plane: &Vec<f32>| details(plane, planes.width);
    let [fine, all] = of(luma);
    let chroma = chromas
        .map(of)
        .iter()
        .fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
    // One level per pixel is no colour.
    chroma[1] > luma.len() as f64 && chroma[0] * all < HALVED * fine * chroma[1]
}

/// The energies of a plane that its half has lost, and of its differences from one pixel to the one eight px farther.
fn details(values: &[f32], width: usize) -> [f64; 2] {
    let half = Half::of(values, width);
    let of_row = |(y, row): (usize, &[f32])| {
        let fine = row
            .iter()
            .enumerate()
            .map(|(x, value)| math::powi(f64::from(value - half.at(x, y)), 2));
        let all = row
            .iter()
            .zip(row.iter().skip(8))
            .map(|(a, b)| math::powi(f64::from(a - b), 2));
        [fine.sum::<f64>(), all.sum::<f64>()]
    };
    let rows: Vec<[f64; 2]> = values.par_chunks(width).enumerate().map(of_row).collect();
    rows.iter()
        .fold([0.0; 2], |sum, row| [sum[0] + row[0], sum[1] + row[1]])
}

/// Chromas that follow the edges of luma.
pub(super) fn along_luma(planes: &Planes) -> [Vec<f32>; 2] {
    let [luma, chromas @ ..] = planes.planes.each_ref();
    // Luma at the resolution of the chromas tells which of their pixels lie on the same side of an edge.
    let guide = Half::of(luma, planes.width);
    let halves = chromas.map(|chroma| Half::of(chroma, planes.width));
    let alike: Vec<f32> = (0..=255)
        .map(|levels| gauss(levels as f32, ALIKE))
        .collect();
    let of_row = |(y, row): (usize, &[f32])| {
        let pixel = |(x, value): (usize, &f32)| weighted(*value, [x, y], &guide, &halves, &alike);
        row.iter().enumerate().map(pixel).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<[f32; 2]>> = luma
        .par_chunks(planes.width)
        .enumerate()
        .map(of_row)
        .collect();
    [0, 1].map(|k| rows.iter().flatten().map(|values| values[k]).collect())
}

fn gauss(distance: f32, width: f32) -> f32 {
    math::exp(-distance * distance / (2.0 * width * width))
}

/// The mean of the chromas around a pixel, weighted by how near they are and how like their luma is to its own.
fn weighted(
    luma: f32,
    [x, y]: [usize; 2],
    guide: &Half,
    halves: &[Half; 2],
    alike: &[f32],
) -> [f32; 2] {
    let within = |at: usize, offset: isize, size: usize| {
        (at / 2).checked_add_signed(offset).filter(|&at| at < size)
    };
    let distance = |at: usize, half: usize| (at as f32 + 0.5) / 2.0 - (half as f32 + 0.5);
    let (mut sums, mut weights) = ([0.0; 2], 0.0);
    for row in (-REACH..=REACH).filter_map(|offset| within(y, offset, guide.height)) {
        for column in (-REACH..=REACH).filter_map(|offset| within(x, offset, guide.width)) {
            let i = row * guide.width + column;
            let [dx, dy] = [distance(x, column), distance(y, row)];
            let near = math::exp(-(dx * dx + dy * dy) / (2.0 * NEAR_PX * NEAR_PX));
            let levels = ((luma - guide.values[i]).abs() as usize).min(alike.len() - 1);
            // Where nothing is alike, what is near counts.
            let weight = near * (alike[levels] + 1e-6);
            weights += weight;
            for (sum, half) in sums.iter_mut().zip(halves) {
                *sum += weight * half.values[i];
            }
        }
    }
    sums.map(|sum| sum / weights)
}
