//! One side of a stroke, or its whole contour, as it is being traced.

use super::curve::{Curve, left_of, on_parabola};
use super::part::Part;
use crate::math::{Point, Vector};

/// A line of parts that join.
pub(super) struct Side {
    pub(super) start: Point,
    pub(super) end: Point,
    pub(super) parts: Vec<Part>,
}

impl Side {
    pub(super) fn from(start: Point) -> Self {
        Self {
            start,
            end: start,
            parts: Vec::new(),
        }
    }

    pub(super) fn line_to(&mut self, to: Point) {
        self.parts.push(Part::Line([self.end, to]));
        self.end = to;
    }

    fn parabola_to(&mut self, knee: Point, to: Point) {
        self.parts.push(Part::Parabola([self.end, knee, to]));
        self.end = to;
    }

    /// Half a disc beyond the end `b` of a stroke that comes `along`, from its left side to its right one.
    pub(super) fn cap(&mut self, b: Point, along: Vector) {
        let across = left_of(along);
        self.turn(b, across, along);
        self.turn(b, along, -across);
        self.end = b - across;
    }

    /// The side of a curve that is `radius` to the left of it.
    pub(super) fn beside(&mut self, curve: Curve, radius: f32) {
        self.beside_part(curve, radius, [0.0, 1.0], MAX_HALVINGS);
    }

    /// That of a part of the curve, as parabolas. One that turns by more than a quarter, or is not
    /// [`near`](is_near) the side in its middle, is halved.
    fn beside_part(&mut self, curve: Curve, radius: f32, [start, end]: [f32; 2], halvings: u32) {
        let half = 0.5 * (start + end);
        // The parabola has the side's tangents at both ends, so that its control point is where these cross.
        let [(from, d_from), middle, (to, d_to)] =
            [start, half, end].map(|t| curve.beside(t, radius));
        let (gap, turn) = (to - from, d_from.perp(&d_to));
        // Distances along both tangents to where they cross.
        let (ahead, behind) = (gap.perp(&d_to) / turn, d_from.perp(&gap) / turn);
        let crosses = ahead * behind > 0.0;
        let knee = from + if crosses { d_from * ahead } else { gap * 0.5 };
        let is_plain = crosses || d_from.dot(&d_to) > 0.0;
        let is_wide = (knee - from).dot(&(knee - to)) <= 0.0;
        // Skia's conditions: the tangents cross ahead, or the part is all but straight; it turns by less than a quarter; its
        // middle is near.
        if halvings == 0 || is_plain && is_wide && is_near([from, knee, to], middle) {
            self.parabola_to(knee, to);
            return;
        }
        self.beside_part(curve, radius, [start, half], halvings - 1);
        self.beside_part(curve, radius, [half, end], halvings - 1);
    }

    /// An arc of a quarter or less around `center`, as parabolas that touch it at their ends. One that would reach more than
    /// [`MAX_BULGE`] out of the arc is halved.
    pub(super) fn turn(&mut self, center: Point, from: Vector, to: Vector) {
        let cosine = (from.dot(&to) / from.norm_squared()).clamp(0.0, 1.0);
        let sum = from + to;
        // Of the conic with the weight w, k·|a − 2c + b| is outside, where k = (1 − w) / (4 + 4w).
        let weight = (0.5 * (1.0 + cosine)).sqrt();
        let away = sum.norm() * (1.0 - cosine) / (1.0 + cosine);
        let bulge = away * (1.0 - weight) / (4.0 * (1.0 + weight));
        self.arc(center, from, to, bulge);
    }

    fn arc(&mut self, center: Point, from: Vector, to: Vector, bulge: f32) {
        let sum = from + to;
        let cosine = from.dot(&to) / from.norm_squared();
        if bulge > MAX_BULGE {
            let middle = sum / (2.0 + 2.0 * cosine).sqrt();
            self.arc(center, from, middle, bulge / 4.0);
            self.arc(center, middle, to, bulge / 4.0);
            return;
        }
        self.parabola_to(center + sum / (1.0 + cosine), center + to);
    }
}

/// Enough for the sharpest bend of a parabola.
const MAX_HALVINGS: u32 = 10;

/// Largest distance of a parabola outside its arc, px.
const MAX_BULGE: f32 = 0.25;

/// True if a parabola is at most [`MAX_BULGE`] away from a point that it should go through in this direction. If it
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
