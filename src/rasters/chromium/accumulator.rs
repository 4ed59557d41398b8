//! Coverage of each pixel by an outline.

use std::cmp::Ordering;
use std::ops::Range;

use super::outline::{Outline, Piece};
use crate::math::Point;

/// Accumulates coverage: each edge changes the coverage of everything to its right in its row, and the running
/// sum of these changes along a row is the coverage.
pub(super) struct Accumulator {
    width: usize,
    height: usize,
    /// By how much more a pixel is covered than the one to its left, row by row; each row has
    /// [`BEYOND`] more pixels than the picture.
    changes: Vec<f32>,
    /// The pixels of each row that have changes.
    spans: Vec<Range<usize>>,
}

/// An edge in a pixel changes the next one, too, and may be just beyond the picture.
const BEYOND: usize = 2;

const NOWHERE: Range<usize> = Range {
    start: usize::MAX,
    end: 0,
};

impl Accumulator {
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            changes: vec![0.0; (width + BEYOND) * height],
            spans: vec![NOWHERE; height],
        }
    }

    /// Calls `paint` with each row that `outline` covers, the first pixel, and the coverage, 0 to 255, of that
    /// and those to its right.
    pub(super) fn fill(&mut self, outline: &Outline, paint: impl FnMut(usize, usize, &[u8])) {
        let rows = if outline.is_convex {
            self.add_sides(outline)
        } else {
            self.add_winding(outline)
        };
        self.paint(rows, paint);
    }

    /// Adds what lies between the sides of a convex outline, and says in which rows.
    fn add_sides(&mut self, outline: &Outline) -> Range<usize> {
        let mut rows = NOWHERE;
        for (side, sign) in outline.sides.iter().zip([1.0, -1.0]) {
            for edge in side {
                rows = union(&rows, &self.add(edge, sign));
            }
        }
        rows
    }

    /// Adds the inside of an outline that may turn anywhere and cross itself. It is filled by
    /// the rule `nonzero`, once. All heights are quarters of a px, so that no edge ends within a quarter of a row.
    fn add_winding(&mut self, outline: &Outline) -> Range<usize> {
        let mut slices = Vec::new();
        for (side, turn) in outline.sides.iter().zip([1, -1]) {
            side.iter()
                .for_each(|edge| self.slice(edge, turn, &mut slices));
        }
        // From left to right in each quarter, the winding number tells where the inside begins and ends.
        slices.sort_by(Slice::order);
        let mut rows = NOWHERE;
        for quarter in slices.chunk_by(|a, b| a.quarter == b.quarter) {
            let y = quarter[0].quarter / 4;
            let mut winding = 0;
            let mut left = None;
            for slice in quarter {
                winding += slice.turn;
                if winding == 0 {
                    if let Some(left) = left.take() {
                        self.add_between(y, left, slice.x);
                    }
                } else if left.is_none() {
                    left = Some(slice.x);
                }
            }
            rows = union(&rows, &(y..y + 1));
        }
        rows
    }

    /// Adds what lies between two edges in a quarter of row `y`, each by its x at the top and at the bottom.
    fn add_between(&mut self, y: usize, [l, to_l]: [f32; 2], [r, to_r]: [f32; 2]) {
        // Edges that cross within the quarter both end in the middle of the stretch that they share.
        let meet = 0.5 * (l.min(to_l).max(r.min(to_r)) + l.max(to_l).min(r.max(to_r)));
        let ends = if to_l > to_r { [meet; 2] } else { [to_l, to_r] };
        for ((top, bottom), sign) in [(l, ends[0]), (r, ends[1])].into_iter().zip([1.0, -1.0]) {
            self.add_piece(y, Point::new(top, 0.0), Point::new(bottom, 0.25), sign);
        }
    }

    /// Appends the parts of an edge in each quarter of a row on the picture.
    fn slice(&self, edge: &Piece, turn: i32, slices: &mut Vec<Slice>) {
        let quarter = |y: f32| (4.0 * y).max(0.0) as usize;
        let (top, bottom) = (quarter(edge.top.y), quarter(edge.bottom.y));
        let x = |quarter: usize| edge.at(quarter as f32 / 4.0).x;
        slices.extend((top..bottom.min(4 * self.height)).map(|quarter| Slice {
            quarter,
            x: [x(quarter), x(quarter + 1)],
            turn,
        }));
    }

    /// Calls `paint` with what has changed in some rows.
    fn paint(&mut self, rows: Range<usize>, mut paint: impl FnMut(usize, usize, &[u8])) {
        let mut coverages = Vec::new();
        for y in rows {
            let span = std::mem::replace(&mut self.spans[y], NOWHERE);
            let Range { start, end } = span;
            if start >= end {
                continue;
            }
            let changes = &mut self.changes[y * (self.width + BEYOND)..][start..end];
            let mut covered = 0.0;
            coverages.clear();
            // Taking the changes leaves zeros for the next outline.
            coverages.extend(changes.iter_mut().map(|change| {
                covered += std::mem::take(change);
                (255.0 * covered.clamp(0.0, 1.0) + 0.5) as u8
            }));
            coverages.truncate(self.width.saturating_sub(start));
            paint(y, start, &coverages);
        }
    }

    /// Adds what lies to the right of `edge`, and says in which rows.
    fn add(&mut self, edge: &Piece, sign: f32) -> Range<usize> {
        let bottom = edge.bottom.y.min(self.height as f32);
        let mut upper = edge.at(edge.top.y.max(0.0));
        if upper.y >= bottom {
            return NOWHERE;
        }
        let rows = upper.y as usize..bottom.ceil() as usize;
        for y in rows.clone() {
            let lower = edge.at(bottom.min((y + 1) as f32));
            self.add_piece(y, upper, lower, sign);
            upper = lower;
        }
        rows
    }

    /// Adds what lies to the right of a piece of an edge in row `y`.
    fn add_piece(&mut self, y: usize, upper: Point, lower: Point, sign: f32) {
        let width = self.width as f32;
        let height = sign * (lower.y - upper.y);
        let (left, right) = (upper.x.min(lower.x), upper.x.max(lower.x));
        // An edge to the left of the picture covers its whole row.
        if right <= 0.0 {
            return self.change(y, 0, height, 0.0);
        }
        if right >= width {
            // The edge is off the picture: no coverage changes, but the row's span has to reach its end.
            self.change(y, self.width, 0.0, 0.0);
        }
        // A piece within one pixel: a trapezoid, by the place of its middle.
        if left.floor() == right.floor() && left < width {
            return self.change(y, left as usize, height, (0.5 * (left + right)).fract());
        }
        let per_px = height / (right - left);
        // A slanting one is cut at the sides of pixels; what is left of the picture counts for the whole row.
        if left < 0.0 {
            self.change(y, 0, -left * per_px, 0.0);
        }
        let (mut x, end) = (left.max(0.0), right.min(width));
        while x < end {
            let next = (x.floor() + 1.0).min(end);
            let middle = 0.5 * (x + next) - x.floor();
            self.change(y, x as usize, (next - x) * per_px, middle);
            x = next;
        }
    }

    /// Adds what lies to the right of a piece of some `height` with its `middle` at that place in pixel `x`.
    fn change(&mut self, y: usize, x: usize, height: f32, middle: f32) {
        let at = y * (self.width + BEYOND) + x;
        // Of the pixel itself what is right of the edge is covered, of all further ones everything.
        self.changes[at] += height * (1.0 - middle);
        self.changes[at + 1] += height * middle;
        self.spans[y] = union(&self.spans[y], &(x..x + 2));
    }
}

/// The part of an edge in a quarter of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slice {
    /// The quarter, counted from the top.
    quarter: usize,
    /// Where it begins and ends, px.
    x: [f32; 2],
    /// Its part in the winding number of all that is to its right.
    turn: i32,
}

impl Slice {
    /// From the top to the bottom, and from the left to the right where a quarter begins: edges may cross further down.
    fn order(&self, other: &Self) -> Ordering {
        let ([top, bottom], [other_top, other_bottom]) = (self.x, other.x);
        let by_quarter = self.quarter.cmp(&other.quarter);
        let by_top = by_quarter.then(top.total_cmp(&other_top));
        by_top.then(bottom.total_cmp(&other_bottom))
    }
}

fn union(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    a.start.min(b.start)..a.end.max(b.end)
}

#[cfg(test)]
mod tests {
    use super::super::contour::Contour;
    use super::super::window::Window;
    use super::*;
    use crate::scene::{Mark, Path, Stroke};

    /// Coverages of a stroke on 12×10 px.
    fn covered(a: [f32; 2], b: [f32; 2], radius: f32) -> Vec<Vec<u8>> {
        let contour = Contour::of(&Mark::from(Stroke {
            path: Path::line(a.into(), b.into()),
            radius,
            color: [0.0; 3],
            opacity: 1.0,
        }));
        let mut outline = Outline::default();
        outline.follow(&contour, Window::all(12, 10)[0]);
        let mut rows = vec![vec![0; 12]; 10];
        let mut accumulator = Accumulator::new(12, 10);
        for _ in 0..2 {
            // The second time nothing is left of the first.
            accumulator.fill(&outline, |y, x, coverages| {
                rows[y][x..x + coverages.len()].copy_from_slice(coverages);
            });
        }
        rows
    }

    #[test]
    fn an_upright_stroke_covers_its_share_of_each_pixel() {
        let rows = covered([5.25, -9.0], [5.25, 30.0], 1.5);
        for row in rows {
            assert_eq!(row, [0, 0, 0, 64, 255, 255, 191, 0, 0, 0, 0, 0]);
        }
    }

    #[test]
    fn a_level_stroke_covers_its_share_of_each_row() {
        let rows = covered([-30.0, 4.5], [50.0, 4.5], 1.25);
        let column: Vec<u8> = rows.iter().map(|row| row[7]).collect();
        assert_eq!(column, [0, 0, 0, 191, 255, 191, 0, 0, 0, 0]);
        assert!(rows.iter().all(|row| row.iter().all(|v| *v == row[0])));
    }

    #[test]
    fn a_slanting_stroke_covers_its_area() {
        // Its lines begin and end at quarters of a px.
        let rows = covered([3.0, 2.0], [6.0, 6.0], 1.25);
        let sum: f32 = rows.iter().flatten().map(|&v| f32::from(v)).sum();
        let area = 2.5 * 5.0 + std::f32::consts::PI * 1.25 * 1.25;
        assert!((sum / 255.0 / area - 1.0).abs() < 0.03, "{sum} {area}");
    }

    #[test]
    fn what_is_beyond_the_picture_leaves_the_rest_as_it_is() {
        let rows = covered([10.0, 5.0], [40.0, 5.0], 2.0);
        assert_eq!(rows[5][9..], [255, 255, 255]);
        assert_eq!(rows[5][..8], [0; 8]);
        for (a, b) in [
            ([-9.0, 5.0], [-5.0, 5.0]),
            ([20.0, 5.0], [25.0, 5.0]),
            ([5.0, 20.0], [5.0, 30.0]),
        ] {
            assert!(
                covered(a, b, 2.0).iter().flatten().all(|v| *v == 0),
                "{a:?}"
            );
        }
    }
}
