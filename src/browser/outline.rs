//! The outline that a stroke is filled by.

use crate::math::{Point, Vector};

/// A straight piece of an outline, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    pub(super) top: Point,
    pub(super) bottom: Point,
    /// Whether its curve goes on below it.
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

/// An outline by its left and its right side, each from top to bottom.
#[derive(Debug, Default)]
pub(super) struct Outline {
    pub(super) sides: [Vec<Piece>; 2],
}

impl Outline {
    /// Replaces the outline by that of the stroke from `a` to `b`: two lines and four quarter circles.
    pub(super) fn trace(&mut self, a: Point, b: Point, radius: f32) {
        self.clear();
        let direction = (b - a).try_normalize(0.0);
        let along = direction.unwrap_or(Vector::new(1.0, 0.0)) * radius;
        let across = left_of(along);
        self.line(a + across, b + across);
        self.turn(b, across, along);
        self.turn(b, along, -across);
        self.line(b - across, a - across);
        self.turn(a, -across, -along);
        self.turn(a, -along, across);
        for side in &mut self.sides {
            side.sort_by(|e, f| e.top.y.total_cmp(&f.top.y));
        }
        self.run_on();
    }

    /// Takes everything away.
    pub(super) fn clear(&mut self) {
        self.sides.iter_mut().for_each(Vec::clear);
    }

    /// Adds the rectangle around the segment from `a` to `b`; `along` is the radius in its direction.
    pub(super) fn add_line(&mut self, a: Point, b: Point, along: Vector) {
        let across = left_of(along);
        self.line(a + across, b + across);
        self.line(b + across, b - across);
        self.line(b - across, a - across);
        self.line(a - across, a + across);
    }

    /// Adds the area that a line across a curve sweeps.
    pub(super) fn add_curve(&mut self, curve: Curve, radius: f32) {
        let ends = |curve: Curve| [0.0, 1.0].map(|t| curve.beside(t, radius).0);
        let [[start, end], [back, home]] = [curve, curve.reversed()].map(ends);
        self.beside(curve, radius, [0.0, 1.0], MAX_HALVINGS);
        self.line(end, back);
        self.beside(curve.reversed(), radius, [0.0, 1.0], MAX_HALVINGS);
        self.line(home, start);
    }

    /// Adds the half disc beyond the end `b` of a stroke that comes `along`.
    pub(super) fn add_cap(&mut self, b: Point, along: Vector) {
        let across = left_of(along);
        self.turn(b, across, along);
        self.turn(b, along, -across);
        self.line(b - across, b + across);
    }

    /// Adds the sector of a disc on the outside of a bend at `p`, from the direction `before` to `after`. If it is more
    /// than a quarter, its first arc is a quarter.
    pub(super) fn add_join(&mut self, p: Point, before: Vector, after: Vector) {
        let turns_left = before.perp(&after) < 0.0;
        let [from, to] = if turns_left {
            [left_of(-after), left_of(-before)]
        } else {
            [left_of(before), left_of(after)]
        };
        self.line(p, p + from);
        if before.dot(&after) > 0.0 {
            self.turn(p, from, to);
        } else {
            self.turn(p, from, before);
            self.turn(p, before, to);
        }
        self.line(p + to, p);
    }

    /// The left side of a part of a curve, as parabolas. One that turns by more than a quarter, or is not
    /// [`near`](is_near) the side in its middle, is halved.
    fn beside(&mut self, curve: Curve, radius: f32, [start, end]: [f32; 2], halvings: u32) {
        let half = 0.5 * (start + end);
        let [(from, d_from), middle, (to, d_to)] =
            [start, half, end].map(|t| curve.beside(t, radius));
        let (gap, turn) = (to - from, d_from.perp(&d_to));
        // How far it is along both tangents to where they cross.
        let (ahead, behind) = (gap.perp(&d_to) / turn, d_from.perp(&gap) / turn);
        let crosses = ahead * behind > 0.0;
        let knee = from + if crosses { d_from * ahead } else { gap * 0.5 };
        let is_plain = crosses || d_from.dot(&d_to) > 0.0;
        let is_wide = (knee - from).dot(&(knee - to)) <= 0.0;
        let parabola = [from, knee, to];
        if halvings == 0 || is_plain && is_wide && is_near(parabola, middle) {
            monotone(parabola).for_each(|part| self.chords(part));
            return;
        }
        self.beside(curve, radius, [start, half], halvings - 1);
        self.beside(curve, radius, [half, end], halvings - 1);
    }

    /// An arc of a quarter or less.
    fn turn(&mut self, center: Point, from: Vector, to: Vector) {
        self.arc(center, from, to, QUARTER_BULGE * from.norm());
    }

    fn line(&mut self, from: Point, to: Point) {
        let is_down = from.y < to.y;
        let (top, bottom) = if is_down { (from, to) } else { (to, from) };
        self.push(is_down, snapped(top), snapped(bottom), false);
    }

    /// The arc around `center` from `from` to `to`, as parabolas that touch it at their ends. One parabola would
    /// reach `bulge` px outside of the arc; beyond [`MAX_BULGE`] the arc is halved.
    fn arc(&mut self, center: Point, from: Vector, to: Vector, bulge: f32) {
        let sum = from + to;
        let cosine = from.dot(&to) / from.norm_squared();
        if bulge > MAX_BULGE {
            let middle = sum / (2.0 + 2.0 * cosine).sqrt();
            self.arc(center, from, middle, bulge / 4.0);
            self.arc(center, middle, to, bulge / 4.0);
            return;
        }
        let knee = sum / (1.0 + cosine);
        for part in monotone([from, knee, to].map(|v| center + v)) {
            self.chords(part);
        }
    }

    /// The chords of a parabola that does not turn back in y. Snapping its upper end shifts the whole parabola. The
    /// end of a tall chord moves along it to a whole px, that of another only in y, but never below the snapped
    /// lower end.
    fn chords(&mut self, [from, knee, to]: [Point; 3]) {
        let is_down = from.y <= to.y;
        let (start, end) = if is_down { (from, to) } else { (to, from) };
        let (mut top, last) = (snapped(start), snapped(end));
        let shift = Vector::new(0.0, top.y - start.y);
        let count = chord_count(start, knee, end);
        let mut before = top;
        for i in 1..=count {
            let place = on_parabola(start, knee, end, i as f32 / count as f32) + shift;
            let mut bottom = if i == count { last } else { snapped(place) };
            if i < count && place.y - before.y >= TALL {
                let y = place.y.round().min(last.y);
                let slope = (place.x - top.x) / (place.y - top.y);
                bottom = Point::new(place.x - slope * (place.y - y), y);
            }
            bottom.y = bottom.y.min(last.y);
            if bottom.y > top.y {
                self.push(is_down, top, bottom, i < count);
                top = bottom;
            }
            before = place;
        }
    }

    /// Adds an edge to its side. The outline is traced with its inside on the right, so an edge that goes down
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

/// Enough for the sharpest bend of a parabola.
const MAX_HALVINGS: u32 = 10;

/// A parabola whose control point is at neither end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve(pub(super) [Point; 3]);

impl Curve {
    fn reversed(self) -> Self {
        let Self([a, c, b]) = self;
        Self([b, c, a])
    }

    /// The direction at `t`; that of the end where the curve comes to a halt.
    pub(super) fn direction(self, t: f32) -> Vector {
        let Self([a, c, b]) = self;
        let speed = (c - a) * (1.0 - t) + (b - c) * t;
        let direction = speed.try_normalize(0.0).or((b - c).try_normalize(0.0));
        direction.unwrap_or(Vector::new(1.0, 0.0))
    }

    /// The point `radius` to the left of that at `t`, and the direction there.
    fn beside(self, t: f32, radius: f32) -> (Point, Vector) {
        let Self([a, c, b]) = self;
        let direction = self.direction(t);
        (
            on_parabola(a, c, b, t) + left_of(direction) * radius,
            direction,
        )
    }

    /// The point where a curve turns back that lies on a line, or nearly so.
    pub(super) fn turning_point(self) -> Option<Point> {
        let Self([a, c, b]) = self;
        let (there, back) = (c - a, b - c);
        let longer = if there.norm() > back.norm() {
            there
        } else {
            back
        };
        let is_straight = there.perp(&back).abs() <= FLAT * longer.norm();
        let t = there.dot(&longer) / (there - back).dot(&longer);
        (is_straight && there.dot(&back) < 0.0).then(|| on_parabola(a, c, b, t))
    }
}

/// Width in px within which a curve is a line.
const FLAT: f32 = 0.01;

/// The vector to the left of another, of its length, as seen with y down.
fn left_of(along: Vector) -> Vector {
    Vector::new(along.y, -along.x)
}

/// How far the parabola of a quarter is outside of a circle of radius 1. That of half an arc is a quarter as far.
const QUARTER_BULGE: f32 = 0.0607;

/// How far outside a parabola may be, px.
const MAX_BULGE: f32 = 0.25;

/// Whether a parabola is at most [`MAX_BULGE`] away from a point that it should go through in this direction. If it
/// comes by before or after its middle, it has to be nearer.
fn is_near([from, knee, to]: [Point; 3], (point, direction): (Point, Vector)) -> bool {
    let away = |t: f32| on_parabola(from, knee, to, t) - point;
    if away(0.5).norm() <= MAX_BULGE {
        return true;
    }
    // It comes by where at² + bt + c = 0.
    let along = |v: Vector| v.dot(&direction);
    let (a, b, c) = (
        along((from - knee) + (to - knee)),
        2.0 * along(knee - from),
        along(from - point),
    );
    let root = (b * b - 4.0 * a * c).sqrt();
    let q = -0.5 * (b + root.copysign(b));
    let mut passes = [q / a, c / q]
        .into_iter()
        .filter(|t| (0.0..=1.0).contains(t));
    let (Some(t), None) = (passes.next(), passes.next()) else {
        return false;
    };
    away(t).norm() <= MAX_BULGE * (1.0 - 2.0 * (t - 0.5).abs())
}

/// The parabola, in two where it turns back in y.
fn monotone([from, knee, to]: [Point; 3]) -> impl Iterator<Item = [Point; 3]> {
    let (before, after) = (knee.y - from.y, to.y - knee.y);
    if before * after >= 0.0 {
        return [Some([from, knee, to]), None].into_iter().flatten();
    }
    let t = before / (before - after);
    let turn = on_parabola(from, knee, to, t);
    let knees = [from + (knee - from) * t, knee + (to - knee) * t].map(|p| Point::new(p.x, turn.y));
    let parts = [[from, knees[0], turn], [turn, knees[1], to]];
    parts.map(Some).into_iter().flatten()
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

fn on_parabola(start: Point, knee: Point, end: Point, t: f32) -> Point {
    let u = 1.0 - t;
    Point::from(start.coords * (u * u) + knee.coords * (2.0 * t * u) + end.coords * (t * t))
}

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

/// Whether `side` hardly bends where its edge `i` begins, between two curves or lines.
fn is_slight(side: &[Piece], i: usize) -> bool {
    let (upper, Some(lower)) = (&side[i - 1], side.get(i)) else {
        return false;
    };
    !upper.goes_on && lower.height() >= 1.0 && (upper.slope() - lower.slope()).abs() <= 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(a: [f32; 2], b: [f32; 2], radius: f32) -> Outline {
        let mut outline = Outline::default();
        outline.trace(a.into(), b.into(), radius);
        outline
    }

    #[test]
    fn sides_go_down_from_the_top_to_the_bottom_without_a_gap_in_height() {
        for (a, b, radius) in [
            ([5.3, 6.1], [9.8, 11.9], 2.2),
            ([9.8, 3.1], [2.6, 3.9], 0.6),
            ([40.0, 40.3], [40.0, 40.3], 31.7),
        ] {
            let Outline { sides } = outline(a, b, radius);
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
        let Outline { sides } = outline([5.3, 6.13], [9.8, 11.91], 2.2);
        for edge in sides.iter().flatten() {
            assert_eq!((4.0 * edge.top.y).fract(), 0.0, "{edge:?}");
        }
    }

    #[test]
    fn a_dot_is_as_wide_as_its_stroke_and_bulges_between() {
        let Outline { sides } = outline([20.0, 20.0], [20.0, 20.0], 3.0);
        let reach = |edge: &Piece| (edge.top - Point::new(20.0, 20.0)).norm();
        let reaches = sides.iter().flatten().map(reach);
        let most = reaches.fold(0.0_f32, f32::max);
        assert!((3.1..3.2).contains(&most), "{most}");
    }
}
