//! Sums over tiles: the results of each tile for its strokes and segments, added up in tile order.
//!
//! The strokes are cut in shares, which the threads take one by one, so that no two of them write to one place.

use std::ops::Range;

use super::TileWork;
use super::gradients::{Gradients, add};
use super::kernel::Sums;
use super::polylines::{CHUNK, Polylines};
use super::strokes::{STYLE, Strokes};

/// Most shares.
const SHARES: usize = 16;

/// Consecutive strokes and their sums.
pub(super) struct Share<'a> {
    ids: Range<usize>,
    /// The derivatives by their numbers.
    numbers: &'a mut [f32],
    /// Their contributions; empty if nobody asks for them.
    contributions: &'a mut [f32],
    /// The derivatives by their vertices.
    slopes: &'a mut [[f32; 2]],
}

/// Cuts all sums into shares of consecutive strokes.
pub(super) fn shares<'a>(
    strokes: &Strokes,
    polylines: &Polylines,
    mut slopes: &'a mut [[f32; 2]],
    gradients: &'a mut Gradients,
) -> Vec<Share<'a>> {
    // The cut depends on the number of strokes alone, not on the threads. Each share starts at a multiple of `size`.
    let size = CHUNK.max(strokes.len().div_ceil(SHARES));
    let (mut numbers, mut contributions) = (
        gradients.strokes.as_mut_slice(),
        gradients.contribution.as_mut_slice(),
    );
    // Cut all sums at the same strokes, so that each share can be written without a lock.
    let share = |start: usize| {
        let ids = start..strokes.len().min(start + size);
        let count = strokes.range(ids.end - 1).end - strokes.range(start).start;
        let vertices = polylines.firsts[ids.end] - polylines.firsts[start];
        let contribution = ids.len().min(contributions.len());
        Share {
            ids,
            numbers: numbers.split_off_mut(..count).unwrap_or_default(),
            contributions: contributions
                .split_off_mut(..contribution)
                .unwrap_or_default(),
            slopes: slopes
                .split_off_mut(..vertices as usize)
                .unwrap_or_default(),
        }
    };
    (0..strokes.len()).step_by(size).map(share).collect()
}

impl Share<'_> {
    /// Adds the sums of the `tiles`.
    pub(super) fn gather(&mut self, strokes: &Strokes, polylines: &Polylines, tiles: &[TileWork]) {
        let before = strokes.range(self.ids.start).start;
        let first = polylines.firsts[self.ids.start];
        for Sums {
            strokes: styles,
            segments,
            ..
        } in tiles.iter().map(|work| &work.sums)
        {
            // A tile lists its strokes in drawing order, so that the share's are one run.
            let [start, end] = [self.ids.start, self.ids.end]
                .map(|id| styles.partition_point(|row| (row.id as usize) < id));
            for row in &styles[start..end] {
                let stroke = row.id as usize;
                // The style is the last numbers of a stroke. Its points get their part in `hand_back`.
                let end = strokes.range(stroke).end - before;
                add(&mut self.numbers[end - STYLE..end], &row.style);
                if let Some(contribution) = self.contributions.get_mut(stroke - self.ids.start) {
                    *contribution += row.contribution;
                }
            }
            // So are their segments.
            let [start, end] = [start, end].map(|at| {
                let row = styles.get(at);
                row.map_or(segments.len(), |row| row.first as usize)
            });
            for row in &segments[start..end] {
                // The two ends of a segment are neighbours in the list of vertices, so one addition of four numbers serves both.
                let slopes = &mut self.slopes[(row.id - first) as usize..];
                add(slopes.as_flattened_mut(), row.ends.as_flattened());
            }
        }
    }

    /// The derivatives by points, from those by vertices.
    pub(super) fn hand_back(&mut self, strokes: &Strokes, polylines: &Polylines, least: usize) {
        let before = strokes.range(self.ids.start).start;
        let first = polylines.firsts[self.ids.start];
        for i in self.ids.clone() {
            let stroke = strokes.get(i);
            let [start, end] = [i, i + 1].map(|i| (polylines.firsts[i] - first) as usize);
            let slopes = &self.slopes[start..end];
            let range = strokes.range(i);
            let numbers = &mut self.numbers[range.start - before..range.end - before];
            let (points, _) = numbers.as_chunks_mut();
            polylines.hand_back(i, stroke, least, slopes, &mut points[..stroke.points.len()]);
        }
    }
}
