//! Lines whose width varies: strokes with a radius at each vertex.
//!
//! The vertices are the points with [`is_on`](super::PathPoint::is_on), in their order: neither the on-points that control points of
//! quadratic curves imply, nor the middle points of arcs. Between two vertices the radius runs linearly with the parameter
//! of the curves between them: `(j + t)/k` on the `j`-th of `k` pieces, where `t` is the share of the angle on an arc.
//!
//! Such a line covers the union of the discs along it. A disc of radius `r` at `p` touches the border of the union in the directions
//!
//! ```text
//! m = −k·u ± √(1 − k²)·n        k = dr/ds
//! ```
//!
//! where `u` is the direction of the line, `n` its normal and `s` its length: these are the places where `|x − p(s)| − r(s)` is
//! stationary. With a constant radius they are along the normal. Where `|k| ≥ 1`, the disc lies in its neighbour.
//!
//! A side of the outline is `p + min(r, f)·m`, where `f` is the distance at which neighbouring radii cross: the line turns more sharply
//! there than its disc. So each radius moves forward over its whole length and the outline, as a sum of all these narrow sectors,
//! winds around nothing the other way: no hole appears under SVG's nonzero rule, however sharp the turn. At corners an arc joins the
//! outer sides and the inner ones meet in the vertex, for the same reason.

mod side;
mod union;

use std::f64::consts::{FRAC_PI_2, PI};

use super::piece::PathPiece;
use super::{Cap, Path, PathPoint, PointKind, Rgb, Shape, Stroke};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{self, Point, Vec2};
use kurbo::{ParamCurve, ParamCurveDeriv};
use side::Side;

/// An end of a smaller radius is a sharp tip, px.
const TIP: f64 = 0.1;
/// Farthest that an arc is from its chord which is left out where a side turns, px: less than outlines are off anyway.
const SMOOTH: f64 = 0.02;
/// Cosine of the largest turn between two samples of a line, and the difference of their `k` for the same turn of `m`: 0.12 rad.
const TURN: f64 = 0.9928;
const LEAN: f64 = 0.12;
/// Most halvings of the parameter between samples. At a cusp the direction jumps however near they are.
const HALVINGS: u32 = 8;
/// Cosine of a turn between neighbouring samples that is a cusp.
const CUSP: f64 = 0.9;

impl Stroke {
    /// A stroke with half a width at each vertex of its path, px, and with round ends and corners.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when there is not one radius for each vertex, when one is negative or not finite, or when none is
    /// above 0.
    pub fn varying(path: Path, radii: Vec<f64>, color: Rgb, opacity: f32) -> Result<Self> {
        let refused = |message: String| Err(Error::new(ErrorKind::Config, message));
        let vertices = path.points().iter().filter(|p| p.is_on()).count();
        if vertices != radii.len() || vertices == 0 {
            return refused(format!(
                "a line of {vertices} points on its path has {} radii: give one for each, of a path with such points",
                radii.len()
            ));
        }
        if let Some(radius) = radii.iter().find(|r| !r.is_finite() || **r < 0.0) {
            return refused(format!("a radius is {radius} px: make it 0 or more"));
        }
        let radius = radii.iter().copied().fold(0.0, f64::max);
        if radius == 0.0 {
            return refused("a line has no radius above 0: give it one, or leave it out".into());
        }
        Ok(Self {
            path,
            radius,
            radii,
            cap: Cap::Round,
            color,
            opacity,
        })
    }

    /// True if it has a radius at each vertex.
    pub fn is_varying(&self) -> bool {
        !self.radii.is_empty()
    }

    /// Half the width at each point of the path, px: at the control points of curves and the middles of arcs that of the place on the
    /// line that is nearest in the parameter.
    pub fn radii_of_points(&self) -> Vec<f64> {
        let points = self.path.points();
        if !self.is_varying() {
            return vec![self.radius; points.len()];
        }
        let (first, kinds) = from_vertex(points);
        let mut radii = Vec::with_capacity(points.len());
        for (i, run) in between(&kinds).enumerate() {
            let [from, to] = [i, i + 1].map(|k| self.radii[k % self.radii.len()]);
            // A control point of a quadratic curve is at the middle of its own curve.
            let share = |(j, kind): (usize, &PointKind)| match kind {
                PointKind::Quad => (j as f64 + 0.5) / run.len() as f64,
                _ => (j + 1) as f64 / (run.len() + 1) as f64,
            };
            let shares = run.iter().enumerate().map(share);
            radii.push(from);
            radii.extend(shares.map(|share| (1.0 - share) * from + share * to));
        }
        radii.rotate_right(first);
        radii
    }

    /// The border of what a stroke whose width varies covers: its outline without edges that have the stroke on both sides, as a line
    /// that crosses itself or turns sharply has them.
    pub(crate) fn border(&self) -> Vec<Path> {
        union::united(self.swept())
    }

    /// The outline of a stroke whose width varies: the border of the union of the discs along it, to about 0.05 px. One ring, or one for
    /// each side of a closed path.
    pub(crate) fn swept(&self) -> Vec<Path> {
        let legs = legs(&self.path, &self.radii);
        let (Some(first), Some(last)) = (
            legs.first().and_then(|leg| leg.first()),
            legs.last().and_then(|leg| leg.last()),
        ) else {
            return vec![Shape::circle(self.path.ends().0, self.radius).path()];
        };
        let [left, right] = [1.0, -1.0].map(|sign| side(&legs, sign, self.path.is_closed()));
        if self.path.is_closed() {
            let mut back = right.points;
            back.reverse();
            return [left.points, back].into_iter().filter_map(ring).collect();
        }
        // Along the left side, around the end, back along the right side, and around the start.
        let mut outline = left;
        outline.arc(last, last.way(1.0), -PI - 2.0 * last.lean());
        let mut back = right.points;
        back.reverse();
        back.into_iter().for_each(|point| outline.push(point));
        outline.arc(first, first.way(-1.0), -PI + 2.0 * first.lean());
        ring(outline.points).into_iter().collect()
    }
}

/// A disc of the line, and where it touches the border of the union.
#[derive(Debug, Clone, Copy)]
struct Disc {
    at: Point,
    radius: f64,
    /// The direction of the line.
    along: Vec2,
    /// dr/ds, −1 to 1.
    k: f64,
    /// On the left and on the right: the lengths of the radii to where neighbouring ones cross, at most the radius.
    reach: [f64; 2],
}

impl Disc {
    /// The disc of a line with this velocity and acceleration, whose radius grows by `slope`.
    fn of(at: Point, [velocity, bend]: [Vec2; 2], [radius, slope]: [f64; 2]) -> Self {
        let speed = length(velocity);
        let k = slope / speed;
        if k.abs() >= 1.0 || k.is_nan() {
            return Self {
                at,
                radius,
                along: unit(velocity),
                k: slope.signum(),
                reach: [radius; 2],
            };
        }
        // With θ' the turn of u, m' × m = −(θ' ± k'/c), and the velocity moves the radius across itself by c·|p'|.
        let c = (1.0 - k * k).sqrt();
        let turn = velocity.cross(bend) / (speed * speed);
        let k_change = -k * velocity.dot(bend) / (speed * speed);
        let reach = [1.0, -1.0].map(|sign| {
            let closing = sign * turn + k_change / c;
            match closing > 0.0 {
                true => radius.min(c * speed / closing),
                false => radius,
            }
        });
        Self {
            at,
            radius,
            along: velocity / speed,
            k,
            reach,
        }
    }

    /// The direction in which it touches the border, on the left with a `sign` of 1 and on the right with −1.
    fn way(&self, sign: f64) -> Vec2 {
        let c = (1.0 - self.k * self.k).max(0.0).sqrt();
        -self.k * self.along + sign * c * self.along.turn_90()
    }

    /// The angle by which that is turned against the normal: the arcsine of k.
    fn lean(&self) -> f64 {
        let c = (1.0 - self.k * self.k).max(0.0).sqrt();
        2.0 * math::atan(self.k / (1.0 + c))
    }

    /// Length of its radius on a side.
    fn reach(&self, sign: f64) -> f64 {
        self.reach[usize::from(sign < 0.0)]
    }

    fn touch(&self, sign: f64) -> Point {
        self.at + self.reach(sign) * self.way(sign)
    }

    /// True if it touches the border there.
    fn is_free(&self, sign: f64) -> bool {
        self.k.abs() < 1.0 && self.reach(sign) == self.radius
    }
}

/// The discs along the pieces of a path, without those of no length; none for a dot.
fn legs(path: &Path, radii: &[f64]) -> Vec<Vec<Disc>> {
    let mut spans = spans(path, radii);
    if let ([first, ..], false) = (&mut spans[..], path.is_closed()) {
        first.1[0] = tip(first.1[0]);
    }
    if let ([.., last], false) = (&mut spans[..], path.is_closed()) {
        last.1[1] = tip(last.1[1]);
    }
    // Of two vertices in one place, the larger disc covers the other: the radius jumps, along the line before or behind.
    let has_length = |piece: &PathPiece| piece.start() != piece.end() || is_curve(piece);
    let Some(mut along) = spans
        .iter()
        .find_map(|(piece, _)| has_length(piece).then(|| unit(velocities(piece, 0.0)[0])))
    else {
        return Vec::new();
    };
    let mut legs: Vec<Vec<Disc>> = Vec::new();
    for (piece, ends) in &spans {
        if has_length(piece) {
            for leg in discs(piece, *ends) {
                along = leg.last().map_or(along, |disc| disc.along);
                legs.push(leg);
            }
        } else if ends[0] != ends[1] {
            let disc = |radius: f64| Disc {
                at: piece.start(),
                radius,
                along,
                k: (ends[1] - ends[0]).signum(),
                reach: [radius; 2],
            };
            legs.push(ends.map(disc).to_vec());
        }
    }
    legs
}

fn tip(radius: f64) -> f64 {
    if radius < TIP { 0.0 } else { radius }
}

fn is_curve(piece: &PathPiece) -> bool {
    match piece {
        PathPiece::Line(_) => false,
        PathPiece::Quad(curve) => curve.p1 != curve.p0,
        PathPiece::Cubic(curve) => curve.p1 != curve.p0 || curve.p2 != curve.p0,
        PathPiece::Arc(arc) => !arc.is_line(),
    }
}

/// The index of the first vertex, and the kinds of all points from there on.
fn from_vertex(points: &[PathPoint]) -> (usize, Vec<PointKind>) {
    let first = points.iter().position(PathPoint::is_on).unwrap_or(0);
    let mut kinds: Vec<PointKind> = points.iter().map(|p| p.kind).collect();
    kinds.rotate_left(first);
    (first, kinds)
}

/// The kinds of the points between each two vertices, the first of which is the first point.
fn between(kinds: &[PointKind]) -> impl Iterator<Item = &[PointKind]> {
    kinds.split(|kind| *kind == PointKind::On).skip(1)
}

/// The pieces of a path with the radii at their ends.
fn spans(path: &Path, radii: &[f64]) -> Vec<(PathPiece, [f64; 2])> {
    let (_, mut kinds) = from_vertex(path.points());
    // A closed path goes on from its first vertex to itself.
    if path.is_closed() {
        kinds.push(PointKind::On);
    }
    // Each control point of a quadratic curve has one of its own; other pieces lie between vertices.
    let counts = between(&kinds).map(|run| match run.first() {
        Some(PointKind::Quad) => run.len(),
        _ => 1,
    });
    let ends = counts.enumerate().flat_map(|(i, count)| {
        let radius = |i: usize| radii.get(i % radii.len().max(1)).copied().unwrap_or(0.0);
        let at = move |j: usize| {
            let share = j as f64 / count as f64;
            (1.0 - share) * radius(i) + share * radius(i + 1)
        };
        (0..count).map(move |j| [at(j), at(j + 1)])
    });
    path.pieces().zip(ends).collect()
}

/// The velocity and the acceleration of a piece.
fn velocities(piece: &PathPiece, t: f64) -> [Vec2; 2] {
    let own = match piece {
        PathPiece::Line(line) => [line.p1 - line.p0, Vec2::ZERO],
        PathPiece::Quad(curve) => {
            let deriv = curve.deriv();
            [deriv.eval(t).to_vec2(), deriv.p1 - deriv.p0]
        }
        PathPiece::Cubic(curve) => {
            let deriv = curve.deriv();
            [deriv.eval(t), deriv.deriv().eval(t)].map(Point::to_vec2)
        }
        PathPiece::Arc(arc) if arc.is_line() => [arc.to - arc.from, Vec2::ZERO],
        PathPiece::Arc(arc) => {
            let (sweep, away) = (arc.sweep(), place(piece, t) - arc.center());
            [sweep * away.turn_90(), -sweep * sweep * away]
        }
    };
    // A control point may lie on its end: the line leaves it for the next one.
    let is_still = length(own[0]) < 1e-9;
    match is_still {
        true => {
            let inner = if t < 0.5 { t + 1e-4 } else { t - 1e-4 };
            let way = place(piece, t) - place(piece, inner);
            [if t < 0.5 { -way } else { way } * 1e4, Vec2::ZERO]
        }
        false => own,
    }
}

fn place(piece: &PathPiece, t: f64) -> Point {
    match piece {
        PathPiece::Line(line) => line.eval(t),
        PathPiece::Quad(curve) => curve.eval(t),
        PathPiece::Cubic(curve) => curve.eval(t),
        PathPiece::Arc(arc) if arc.is_line() => arc.from.lerp(arc.to, t),
        PathPiece::Arc(arc) => {
            let (sin, cos) = math::sin_cos(arc.sweep() * t);
            let from = arc.from - arc.center();
            arc.center() + cos * from + sin * from.turn_90()
        }
    }
}

/// The discs along a piece whose radius runs from one end to the other; apart where the piece has a cusp.
fn discs(piece: &PathPiece, [from, to]: [f64; 2]) -> Vec<Vec<Disc>> {
    let disc = |t: f64| {
        let radius = (1.0 - t) * from + t * to;
        Disc::of(place(piece, t), velocities(piece, t), [radius, to - from])
    };
    let steps = match piece {
        PathPiece::Line(_) => 1,
        _ => 4,
    };
    let mut all = vec![disc(0.0)];
    for i in 0..steps {
        let [start, end] = [i, i + 1].map(|i| f64::from(i) / f64::from(steps));
        let end = (end, disc(end));
        halved(&disc, (start, all[all.len() - 1]), end, HALVINGS, &mut all);
    }
    // Of discs that lie in their neighbours, the first and the last ones tell.
    let is_inner = |i: usize| {
        let around = [i.wrapping_sub(1), i, i + 1];
        let mut around = around.into_iter().map(|i| all.get(i));
        around.all(|disc| disc.is_some_and(|disc| disc.k.abs() == 1.0))
    };
    let told: Vec<Disc> = (0..all.len())
        .filter(|&i| !is_inner(i))
        .map(|i| all[i])
        .collect();
    let is_smooth = |a: &Disc, b: &Disc| a.along.dot(b.along) > CUSP;
    told.chunk_by(is_smooth).map(<[Disc]>::to_vec).collect()
}

/// Adds the discs behind one of them up to another one, so near that the border turns little in between.
fn halved(
    disc: &impl Fn(f64) -> Disc,
    (start, first): (f64, Disc),
    (end, last): (f64, Disc),
    halvings: u32,
    all: &mut Vec<Disc>,
) {
    let is_near = first.along.dot(last.along) > TURN && (first.k - last.k).abs() < LEAN;
    if is_near || halvings == 0 {
        all.push(last);
        return;
    }
    let middle = 0.5 * (start + end);
    let halfway = (middle, disc(middle));
    halved(disc, (start, first), halfway, halvings - 1, all);
    halved(disc, halfway, (end, last), halvings - 1, all);
}

/// One side of the outline, in the direction of the line.
fn side(legs: &[Vec<Disc>], sign: f64, is_closed: bool) -> Side {
    let mut side = Side::default();
    let joints = legs.iter().zip(legs.iter().skip(1));
    let closing = legs.last().zip(legs.first()).filter(|_| is_closed);
    // What joins the end of a leg to the next one's start.
    let joints: Vec<Option<Joint>> = joints
        .chain(closing)
        .map(|(a, b)| a.last().zip(b.first()))
        .map(|pair| pair.map(|(a, b)| Joint::of(a, b, sign)))
        .collect();
    for (i, leg) in legs.iter().enumerate() {
        let before = i.checked_sub(1).and_then(|i| joints[i]);
        let is_on = before.is_some_and(|joint| joint == Joint::Smooth);
        // The border is at a right angle to the radius.
        let way = |disc: &Disc| -sign * disc.way(sign).turn_90();
        if let (true, Some(first)) = (is_on, leg.first()) {
            side.turn(way(first));
        }
        for disc in leg.iter().skip(usize::from(is_on)) {
            let at = disc.touch(sign);
            match disc.is_free(sign) {
                true => side.sample(at, way(disc)),
                false => side.corner(at),
            }
        }
        if let (Some(Some(joint)), Some(last)) = (joints.get(i), leg.last()) {
            match *joint {
                Joint::Smooth => {}
                Joint::Inner => side.corner(last.at),
                Joint::Outer(angle) => side.arc(last, last.way(sign), -sign * angle),
            }
        }
    }
    side.end();
    side
}

/// What joins two legs on a side.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Joint {
    /// Nothing: the side hardly turns.
    Smooth,
    /// The vertex.
    Inner,
    /// An arc of this angle.
    Outer(f64),
}

impl Joint {
    fn of(a: &Disc, b: &Disc, sign: f64) -> Self {
        let turn = angle(a.along, b.along);
        // The directions to the border are u turned by ±(π/2 + the arcsine of k).
        let outer = -sign * turn - (b.lean() - a.lean());
        let height = a.radius * (1.0 - math::cos(0.5 * outer.abs().min(PI)));
        let is_open = a.is_free(sign) && b.is_free(sign);
        if height < SMOOTH && is_open && outer.abs() < FRAC_PI_2 {
            Self::Smooth
        } else if outer > 0.0 {
            Self::Outer(outer)
        } else {
            Self::Inner
        }
    }
}

impl Side {
    /// Adds an arc around a disc, from a direction on, by an angle.
    fn arc(&mut self, disc: &Disc, from: Vec2, angle: f64) {
        let at = |share: f64| {
            let (sin, cos) = math::sin_cos(share * angle);
            disc.at + disc.radius * (cos * from + sin * from.turn_90())
        };
        self.corner(at(0.0));
        if disc.radius * angle.abs() < 1e-9 {
            return;
        }
        // Beyond three quarters of a circle both ends are too near to each other to tell its middle.
        let parts = if angle.abs() > 1.5 * PI { 2 } else { 1 };
        let share = 1.0 / f64::from(parts);
        for part in 0..parts {
            let start = share * f64::from(part);
            self.push(PathPoint::arc(at(start + 0.5 * share)));
            self.push(PathPoint::on(at(start + share)));
        }
    }
}

/// The ring of points; `None` if they are none.
fn ring(mut points: Vec<PathPoint>) -> Option<Path> {
    // The ring may end on its start, and there turn back on itself.
    loop {
        let count = points.len();
        let is_on = |i: usize| points[i % count].is_on();
        if count > 1 && is_on(0) && is_on(count - 1) && points[0].at == points[count - 1].at {
            points.pop();
        } else if count > 2
            && [0, 1, count - 1].into_iter().all(is_on)
            && points[1].at == points[count - 1].at
        {
            points.pop();
            points.remove(0);
        } else {
            break;
        }
    }
    (!points.is_empty()).then(|| Path::of_points(points, true))
}

/// The angle from one direction to another, −π to π.
fn angle(a: Vec2, b: Vec2) -> f64 {
    let whole = 1.0 + a.dot(b);
    match whole > 1e-12 {
        true => 2.0 * math::atan(a.cross(b) / whole),
        false => PI,
    }
}

fn length(v: Vec2) -> f64 {
    v.hypot2().sqrt()
}

fn unit(v: Vec2) -> Vec2 {
    v / length(v).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests;
