//! The tiles that Chromium cuts a page into, and how Skia clips a contour that does not lie within one.
//!
//! Lines and curves are cut at the top and the bottom of the tile, and what is to its left or right becomes a line along its
//! side. So a curve that crosses a tile has other chords than one within it. If any part of a contour is cut, all of its
//! curves are cut where they turn back in x, too.

use std::ops::Range;

use super::curve::{monotone, on_parabola};
use super::part::Part;
use crate::math::{Point, Vector};

/// A tile, or the part of it that is on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// The top left corner, px of the picture.
    pub(super) corner: [usize; 2],
    /// Width and height, px.
    pub(super) size: [usize; 2],
}

/// Side of a tile, px.
const TILE: usize = 256;

/// Tiles begin this many px apart: they overlap by two px, and each shows one of the two.
const STEP: usize = TILE - 2;

impl Window {
    /// The windows on a picture of `width`×`height` px.
    pub(super) fn all(width: usize, height: usize) -> Vec<Self> {
        let rows = (0..height).step_by(STEP);
        let corners = rows.flat_map(|y| (0..width).step_by(STEP).map(move |x| [x, y]));
        let window = |corner: [usize; 2]| Self {
            corner,
            size: [TILE.min(width - corner[0]), TILE.min(height - corner[1])],
        };
        corners.map(window).collect()
    }

    /// The window's part of a picture that is `width` px wide, of three bytes per pixel.
    pub(super) fn cut_out(self, rgb: &[u8], width: usize) -> Vec<u8> {
        self.rows(width)
            .flat_map(|row| &rgb[row])
            .copied()
            .collect()
    }

    /// Puts what the window shows of a picture in its place: all but the first row and column, which the tile before it shows.
    /// Windows have to be put back in order, because each shows the last row and column of the one before.
    pub(super) fn put_back(self, seen: &[u8], rgb: &mut [u8], width: usize) {
        let [x, y] = self.corner.map(|at| usize::from(at > 0));
        let rows = self.rows(width).zip(seen.chunks_exact(3 * self.size[0]));
        for (row, seen) in rows.skip(y) {
            rgb[row][3 * x..].copy_from_slice(&seen[3 * x..]);
        }
    }

    /// The columns and rows of a picture of `size` that the window shows, px.
    pub(super) fn shown(self, size: [usize; 2]) -> [Range<usize>; 2] {
        [0, 1].map(|axis| {
            let corner = self.corner[axis];
            let start = corner + usize::from(corner > 0);
            // The window after this one, if there is one, shows what lies beyond.
            let end = if corner + STEP < size[axis] {
                corner + STEP + 1
            } else {
                size[axis]
            };
            start..end
        })
    }

    /// The bytes of each row of the window.
    fn rows(self, width: usize) -> impl Iterator<Item = Range<usize>> {
        let ([x, y], [columns, rows]) = (self.corner, self.size);
        let starts = (y..y + rows).map(move |y| 3 * (y * width + x));
        starts.map(move |start| start..start + 3 * columns)
    }

    /// The top left corner as a displacement.
    pub(super) fn origin(self) -> Vector {
        let [x, y] = self.corner;
        Vector::new(x as f32, y as f32)
    }

    /// Width and height as a point, the bottom right corner.
    fn end(self) -> Point {
        let [x, y] = self.size;
        Point::new(x as f32, y as f32)
    }

    /// True if a box is within the window.
    pub(super) fn contains(self, [low, high]: [Point; 2]) -> bool {
        let (from, to) = (Point::from(self.origin()), self.end() + self.origin());
        low.x >= from.x && low.y >= from.y && high.x <= to.x && high.y <= to.y
    }

    /// True if a box and the window have anything in common.
    pub(super) fn touches(self, [low, high]: [Point; 2]) -> bool {
        let (from, to) = (Point::from(self.origin()), self.end() + self.origin());
        low.x < to.x && low.y < to.y && high.x > from.x && high.y > from.y
    }

    /// Calls `keep` with the parts of `part` that show in the window. Like `part`, they go down, and they are in px of the
    /// window. A parabola must not turn back in y.
    pub(super) fn clip(self, part: Part, mut keep: impl FnMut(Part)) {
        let curve = match part {
            Part::Line([from, to]) => [from, from + (to - from) * 0.5, to],
            Part::Parabola(points) => points,
        };
        // Clipping may have turned a part over; whoever fills it expects it to go down.
        let mut keep = |[from, knee, to]: [Point; 3], is_side: bool| {
            let [from, to] = if from.y <= to.y {
                [from, to]
            } else {
                [to, from]
            };
            keep(match part {
                Part::Parabola(_) if !is_side => Part::Parabola([from, knee, to]),
                _ => Part::Line([from, to]),
            });
        };
        let end = self.end();
        // A part that does not turn back in x crosses each side of the window at most once.
        for curve in monotone(curve, 0) {
            // Above and below the window nothing is left.
            let Some(curve) = within(curve, 1, [0.0, end.y]) else {
                continue;
            };
            let side = |curve: [Point; 3], x: f32| curve.map(|p| Point::new(x, p.y));
            // To the left and right a line along the side is left, which keeps the winding number.
            let [left, rest] = cut(curve, 0, 0.0);
            if let Some(left) = left {
                keep(side(left, 0.0), true);
            }
            let Some(rest) = rest else {
                continue;
            };
            let [shown, right] = cut(rest, 0, end.x);
            if let Some(shown) = shown {
                keep(shown, false);
            }
            if let Some(right) = right {
                keep(side(right, end.x), true);
            }
        }
    }
}

/// The part of a parabola between two values along an axis, in which it does not turn back.
fn within(curve: [Point; 3], axis: usize, [low, high]: [f32; 2]) -> Option<[Point; 3]> {
    let [_, above] = cut(curve, axis, low);
    let [below, _] = cut(above?, axis, high);
    below
}

/// The parts of a parabola, which does not turn back along an axis, below and above a `value` there. A part that is at the value
/// throughout is below it.
fn cut(curve: [Point; 3], axis: usize, value: f32) -> [Option<[Point; 3]>; 2] {
    let [a, c, b] = curve;
    let [from, knee, to] = curve.map(|p| p[axis]);
    if from.max(to) <= value {
        return [Some(curve), None];
    }
    if from.min(to) >= value {
        return [None, Some(curve)];
    }
    let half = knee - from;
    // The root of a·t² + 2·half·t = value − from that lies between 0 and 1, in the form that loses no digits.
    let root = (half * half + (from - 2.0 * knee + to) * (value - from))
        .max(0.0)
        .sqrt();
    let t = (value - from) / (half + root.copysign(to - from));
    let t = t.clamp(0.0, 1.0);
    let knees = [a + (c - a) * t, c + (b - c) * t];
    let mut middle = on_parabola(a, c, b, t);
    middle[axis] = value;
    let parts = [[a, knees[0], middle], [middle, knees[1], b]].map(Some);
    if from < to {
        parts
    } else {
        let [before, after] = parts;
        [after, before]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window {
        corner: [0, 0],
        size: [10, 10],
    };

    fn clipped(part: Part) -> Vec<Part> {
        let mut parts = Vec::new();
        WINDOW.clip(part, |part| parts.push(part));
        parts
    }

    #[test]
    fn each_pixel_is_shown_by_one_window_and_those_at_sides_by_the_next() {
        let (width, height) = (600, 257);
        let windows = Window::all(width, height);
        let mut rgb = vec![u8::MAX; 3 * width * height];
        for (i, window) in (0..).zip(&windows) {
            let seen = vec![i; 3 * window.size[0] * window.size[1]];
            window.put_back(&seen, &mut rgb, width);
        }
        let shown_by = |x: usize, y: usize| rgb[3 * (y * width + x)];
        assert_eq!([254, 255, 508, 509].map(|x| shown_by(x, 0)), [0, 1, 1, 2]);
        assert_eq!([254, 255].map(|y| shown_by(0, y)), [0, 3]);
        assert!(rgb.iter().all(|&i| i < 6));
    }

    #[test]
    fn what_is_put_back_is_what_was_cut_out() {
        let (width, height) = (300, 3);
        let rgb: Vec<u8> = (0..3 * width * height)
            .map(|i| (i * 7 % 251) as u8)
            .collect();
        let mut copy = vec![0; rgb.len()];
        for window in Window::all(width, height) {
            window.put_back(&window.cut_out(&rgb, width), &mut copy, width);
        }
        assert_eq!(copy, rgb);
    }

    #[test]
    fn a_line_across_becomes_its_middle_and_two_sides() {
        let line = |points: [[f32; 2]; 2]| Part::Line(points.map(Point::from));
        assert_eq!(
            clipped(line([[-5.0, 0.0], [15.0, 4.0]])),
            [
                line([[0.0, 0.0], [0.0, 1.0]]),
                line([[0.0, 1.0], [10.0, 3.0]]),
                line([[10.0, 3.0], [10.0, 4.0]]),
            ]
        );
        assert_eq!(clipped(line([[3.0, -9.0], [4.0, 0.0]])), []);
    }

    #[test]
    fn a_curve_keeps_its_way_and_stays_within() {
        let points = [[-4.0, -3.0], [25.0, 2.0], [2.0, 14.0]].map(Point::from);
        let parts = clipped(Part::Parabola(points));
        let [start, knee, end] = points;
        let way: Vec<Point> = (0..=1000)
            .map(|i| on_parabola(start, knee, end, i as f32 / 1000.0))
            .collect();
        let mut height = 0.0;
        for part in parts {
            match part {
                Part::Line([a, b]) => {
                    assert!(a.x == b.x && (a.x == 0.0 || a.x == 10.0));
                    height += b.y - a.y;
                }
                Part::Parabola([a, c, b]) => {
                    height += b.y - a.y;
                    for t in [0.0, 0.3, 0.5, 0.8, 1.0] {
                        let p = on_parabola(a, c, b, t);
                        let off = way
                            .iter()
                            .map(|q| (p - *q).norm())
                            .fold(f32::INFINITY, f32::min);
                        assert!(off < 0.03, "{p:?} is {off} off");
                        assert!(
                            [p.x, p.y].iter().all(|v| (-1e-4..10.0001).contains(v)),
                            "{p:?}"
                        );
                    }
                }
            }
        }
        assert!((height - 10.0).abs() < 1e-4, "{height}");
    }
}
