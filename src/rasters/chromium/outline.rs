//! The outline that a contour is filled by, within a window.

use super::contour::Contour;
use super::curve::{monotone, on_parabola};
use super::part::Part;
use super::window::Window;
use crate::math::{Point, Vector};

/// A straight piece of an outline, px of its window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    pub(super) top: Point,
    pub(super) bottom: Point,
    /// True if its curve goes on below it.
    goes_on: bool,
}

impl Piece {
    fn height(&self) -> f32 {
        self.bottom.y - self.top.y
    }

    /// px to the right per px down.
    fn slope(&self) -> f32 {
        (self.bottom.x - self.top.x) / self.height()
    }

    /// The point of its line at `y`.
    pub(super) fn at(&self, y: f32) -> Point {
        Point::new(self.top.x + self.slope() * (y - self.top.y), y)
    }
}

/// An outline by its left and its right side.
#[derive(Debug, Default)]
pub(super) struct Outline {
    pub(super) sides: [Vec<Piece>; 2],
    /// True for a capsule. Any other may turn anywhere and cross itself.
    pub(super) is_convex: bool,
}

impl Outline {
    /// Replaces the outline by that of `contour`, as `window` shows it. Each side of a convex one goes from top to bottom.
    pub(super) fn follow(&mut self, contour: &Contour, window: Window) {
        self.sides.iter_mut().for_each(Vec::clear);
        self.is_convex = contour.is_convex;
        let is_cut = !window.contains(contour.bounds);
        let mut add = |is_down: bool, part: Part| {
            if is_cut {
                window.clip(part, |part| self.add(is_down, part));
            } else {
                self.add(is_down, part);
            }
        };
        for part in &contour.parts {
            // Parts go down from here on, and remember on which side they are.
            match part.seen_from(window.origin()) {
                Part::Line([a, b]) => {
                    let is_down = a.y < b.y;
                    add(is_down, Part::Line(if is_down { [a, b] } else { [b, a] }));
                }
                Part::Parabola(points) => monotone(points, 1).for_each(|[a, c, b]| {
                    let is_down = a.y <= b.y;
                    add(
                        is_down,
                        Part::Parabola(if is_down { [a, c, b] } else { [b, c, a] }),
                    );
                }),
            }
        }
        // Skia fills convex outlines by another routine, which walks down both sides at once.
        if contour.is_convex {
            for side in &mut self.sides {
                side.sort_by(|e, f| e.top.y.total_cmp(&f.top.y));
            }
            self.run_on();
        }
    }

    /// Adds a part that goes down, or stands for one that `is_down`.
    fn add(&mut self, is_down: bool, part: Part) {
        match part {
            Part::Line([top, bottom]) => self.push(is_down, snapped(top), snapped(bottom), false),
            Part::Parabola(points) => self.chords(is_down, points),
        }
    }

    /// The chords of a parabola that does not turn back in y. Snapping its upper end shifts the whole parabola. The
    /// end of a tall chord moves along it to a whole px, that of another only in y, but never below the snapped
    /// lower end.
    fn chords(&mut self, is_down: bool, [start, knee, end]: [Point; 3]) {
        let (mut top, last) = (snapped(start), snapped(end));
        let shift = Vector::new(0.0, top.y - start.y);
        let count = chord_count(start, knee, end);
        let mut before = top;
        for i in 1..=count {
            // The last chord ends where the curve does, whatever rounding made of the others.
            let place = on_parabola(start, knee, end, i as f32 / count as f32) + shift;
            let mut bottom = if i == count { last } else { snapped(place) };
            if i < count && place.y - before.y >= TALL {
                let y = place.y.round().min(last.y);
                let slope = (place.x - top.x) / (place.y - top.y);
                bottom = Point::new(place.x - slope * (place.y - y), y);
            }
            // A chord that rounding leaves without a height is not drawn: the next one begins at its top.
            bottom.y = bottom.y.min(last.y);
            if bottom.y > top.y {
                self.push(is_down, top, bottom, i < count);
                top = bottom;
            }
            before = place;
        }
    }

    /// Adds an edge to its side. A contour is traced with its inside on the right, so an edge that goes down
    /// belongs to the right side.
    fn push(&mut self, is_down: bool, top: Point, bottom: Point, goes_on: bool) {
        if top.y < bottom.y {
            let edge = Piece {
                top,
                bottom,
                goes_on,
            };
            self.sides[usize::from(is_down)].push(edge);
        }
    }

    /// Where a side bends only slightly within a row of pixels, extends the upper edge to the end of that row.
    fn run_on(&mut self) {
        let [left, right] = &self.sides;
        let bends = [unseen_bends(left, right), unseen_bends(right, left)];
        for (side, bends) in self.sides.iter_mut().zip(bends) {
            for i in bends {
                let (upper, lower) = (side[i - 1], side[i]);
                let end = lower.top.y.ceil();
                side[i - 1].bottom = upper.at(end);
                side[i].top = lower.at(end);
            }
        }
    }
}

/// Two chords for a parabola that bends by less than 4 px, and twice as many for each four times of that.
fn chord_count(start: Point, knee: Point, end: Point) -> u32 {
    let bend = ((knee - start) - (end - knee)).abs();
    let bend = bend.max() + 0.5 * bend.min();
    let (mut count, mut limit) = (2, 4.0);
    while bend + 0.25 >= limit && count < MAX_CHORDS {
        (count, limit) = (2 * count, 4.0 * limit);
    }
    count
}

const MAX_CHORDS: u32 = 64;

/// Height of a tall chord, px.
const TALL: f32 = 2.0;

/// The point with its y rounded to a quarter of a px; x stays.
fn snapped(p: Point) -> Point {
    Point::new(p.x, (4.0 * p.y + 0.5).floor() / 4.0)
}

/// Indices of the edges of `side` whose bend at the top is ignored: it lies within a row, it is slight, and a
/// bend of the `other` side within a px of it is slight, too.
fn unseen_bends(side: &[Piece], other: &[Piece]) -> Vec<usize> {
    let is_unseen = |&i: &usize| {
        let (upper, y) = (&side[i - 1], side[i].top.y);
        if y.fract() == 0.0 || !is_slight(side, i) {
            return false;
        }
        let is_near =
            |edge: &Piece| edge.bottom.y > upper.top.y && (edge.bottom.y - y).abs() <= 1.0;
        let opposite = other.iter().position(is_near);
        opposite.is_none_or(|k| is_slight(other, k + 1))
    };
    (1..side.len()).filter(is_unseen).collect()
}

/// True if `side` hardly bends where its edge `i` begins, between two curves or lines.
fn is_slight(side: &[Piece], i: usize) -> bool {
    let (upper, Some(lower)) = (&side[i - 1], side.get(i)) else {
        return false;
    };
    !upper.goes_on && lower.height() >= 1.0 && (upper.slope() - lower.slope()).abs() <= 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::scene::{Mark, Path, Stroke};

    fn outline(a: [f32; 2], b: [f32; 2], radius: f32) -> Outline {
        let mut outline = Outline::default();
        let contour = Contour::of(&Mark::from(Stroke {
            path: Path::line(a.into(), b.into()),
            radius,
            color: [0.0; 3],
            opacity: 1.0,
        }));
        outline.follow(&contour, Window::all(200, 200)[0]);
        outline
    }

    #[test]
    fn sides_go_down_from_the_top_to_the_bottom_without_a_gap_in_height() {
        for (a, b, radius) in [
            ([5.3, 6.1], [9.8, 11.9], 2.2),
            ([9.8, 3.1], [2.6, 3.9], 0.6),
            ([40.0, 40.3], [40.0, 40.3], 31.7),
        ] {
            let Outline { sides, .. } = outline(a, b, radius);
            let [left, right] = sides
                .each_ref()
                .map(|side| (side[0].top.y, side[side.len() - 1].bottom.y));
            assert_eq!(left, right);
            for pair in sides.iter().flat_map(|side| side.windows(2)) {
                assert_eq!(pair[0].bottom.y, pair[1].top.y);
            }
        }
    }

    #[test]
    fn heights_are_quarters_of_a_px() {
        let Outline { sides, .. } = outline([5.3, 6.13], [9.8, 11.91], 2.2);
        for edge in sides.iter().flatten() {
            assert_eq!((4.0 * edge.top.y).fract(), 0.0, "{edge:?}");
        }
    }

    #[test]
    fn a_dot_is_as_wide_as_its_stroke_and_bulges_between() {
        let Outline { sides, .. } = outline([20.0, 20.0], [20.0, 20.0], 3.0);
        let reach = |edge: &Piece| (edge.top - Point::new(20.0, 20.0)).norm();
        let reaches = sides.iter().flatten().map(reach);
        let most = reaches.fold(0.0_f32, f32::max);
        assert!((3.1..3.2).contains(&most), "{most}");
    }
}
