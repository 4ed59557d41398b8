//! Exact coverage of filled rings: each side adds the area to its right.

use super::Plane;
use crate::math::Point;
use crate::scene::Path;

/// Farthest that chords are from curves, px.
const FLATNESS: f64 = 0.02;

/// The share of each pixel that the rings fill, where they wind in one direction and holes in the other. Rings are in px from the
/// plane's corner.
pub fn filled(rings: impl Iterator<Item = Path>, [width, height]: [usize; 2]) -> Plane {
    // A running sum along a row gives the covered shares. One column more takes the last pixel's carry.
    let stride = width + 2;
    let mut turns = vec![0.0_f64; stride * height];
    for ring in rings {
        let corners = ring.flattened(FLATNESS);
        for side in corners.windows(2) {
            add(&mut turns, stride, side[0], side[1]);
        }
    }
    let row = |row: &[f64]| {
        let mut sum = 0.0;
        let shares = row[..width].iter().map(|turn| {
            sum += turn;
            // The sign of the sum is the sense of the rings. Rings of one sense that overlap add up to more than 1.
            sum.abs().min(1.0) as f32
        });
        shares.collect::<Vec<f32>>()
    };
    Plane {
        width,
        values: turns.chunks_exact(stride).flat_map(row).collect(),
    }
}

/// Adds the side from `a` to `b`, row by row.
fn add(turns: &mut [f64], stride: usize, a: Point, b: Point) {
    let (sign, top, bottom) = if a.y <= b.y {
        (1.0, a, b)
    } else {
        (-1.0, b, a)
    };
    let [x0, y0, x1, y1] = [top.x, top.y, bottom.x, bottom.y];
    if y1 <= y0 {
        return;
    }
    // A level side covers nothing to its right, so only others have a slope and need one.
    let slope = (x1 - x0) / (y1 - y0);
    let rows = turns.len() / stride;
    let (first, last) = (
        y0.max(0.0) as usize,
        (y1.ceil().max(0.0) as usize).min(rows),
    );
    for row in first..last {
        // The part of the side within this row of pixels.
        let (from, to) = (y0.max(row as f64), y1.min(row as f64 + 1.0));
        let across = [from, to].map(|y| x0 + (y - y0) * slope);
        let row = &mut turns[row * stride..(row + 1) * stride];
        add_in_row(row, sign * (to - from), across);
    }
}

/// Adds a side of this signed `height` within a row, between two places across.
fn add_in_row(row: &mut [f64], height: f64, across: [f64; 2]) {
    // Beyond the left border a side covers all of the row, beyond the right one nothing: clamping says the same.
    let most = (row.len() - 2) as f64;
    let [left, right] =
        [across[0].min(across[1]), across[0].max(across[1])].map(|x| x.clamp(0.0, most));
    let (first, last) = (left.floor(), right.ceil().max(left.floor() + 1.0));
    let width = right - left;
    // Integral of the share of the side that lies to the left of x, for x from the left border of a pixel to the right one.
    let covered = |x: f64| match width > 0.0 {
        true => {
            let share = ((x - left) / width).clamp(0.0, 1.0);
            0.5 * share * share * width + (x - right).max(0.0)
        }
        false => (x - left).max(0.0),
    };
    // Store differences between neighbours, whose running sum is the covered share of each pixel.
    let mut before = 0.0;
    let pixels = row.iter_mut().enumerate().skip(first as usize);
    for (k, turn) in pixels.take((last - first) as usize) {
        let share = covered(k as f64 + 1.0) - covered(k as f64);
        *turn += height * (share - before);
        before = share;
    }
    row[last as usize] += height * (1.0 - before);
}
