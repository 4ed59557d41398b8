//! Lines of one width or of a varying one: their outlines as functions of the vertices of their middle and of the radii there.

use std::f64::consts::PI;

use super::segment::{
    Knot, NEARLY, Radius, Segment, Vertex, directions, own_unknowns, path_of, polyline, turned,
};
use crate::math::{self, Point, Vec2};
use crate::scene::{Cap, Path, Shape};

/// A line. Its width runs linearly with the parameter of each segment, from vertex to vertex.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::trace) struct Line {
    /// The vertices of its middle; behind the last one of an open line is nothing.
    pub(super) knots: Vec<Knot>,
    pub(super) is_closed: bool,
    /// True if all vertices have one radius, which is one number.
    pub(super) is_even: bool,
    /// Round ends and joins, or square ends and mitred corners.
    pub(super) cap: Cap,
}

/// Farthest that the polygon of a round end is from it, px.
const TOLERANCE: f64 = 0.02;
/// An arc of a smaller bulge is tried as a line: the farthest that it is from that is half of this times its chord. A guess.
pub(super) const FLAT: f64 = 0.05;
/// Farthest that two ends are apart which are tried as one, in radii. A guess: a sharp corner cuts its own middle short.
const REACH: f64 = 4.0;
/// One and the cosine of the sharpest turn that has a mitred corner: sharper ones are cut off, as SVG does by its limit of 4.
const SHARPEST: f64 = 0.125;
/// Largest slope of a radius: a disc that grows faster than the line hides what is before it.
const STEEPEST: f64 = 0.95;
/// Directions that differ by less, rad, need no join.
const STRAIGHT: f64 = 1e-3;
/// On the inner side of a line whose width varies, those that differ by less, rad, are joined there: what is covered twice is an
/// eighth of the cube of that, in squares of the radius, and it hardly turns with the line. Of 177 lines in ink, 65 are whole with 0.2,
/// and 63 with 0.5; 68 with 0.001, but hatching loses 1.1 dB.
const SHALLOW: f64 = 0.2;

impl Line {
    /// A line of one width.
    pub(super) fn even(knots: &[Knot], is_closed: bool, radius: f64, cap: Cap) -> Self {
        Self {
            knots: knots.iter().map(|knot| Knot { radius, ..*knot }).collect(),
            is_closed,
            is_even: true,
            cap,
        }
    }

    /// Its middle.
    pub(in crate::trace) fn path(&self) -> Path {
        self.circle()
            .map_or_else(|| path_of(&self.knots, self.is_closed), Shape::path)
    }

    /// The circle that its middle is, if it is two half circles.
    pub(super) fn circle(&self) -> Option<Shape> {
        let [a, b] = &self.knots[..] else { return None };
        let is_half = |knot: &Knot| matches!(knot.segment, Segment::Arc(bulge) if (bulge.abs() - 1.0).abs() < 0.01);
        let is_one = self.is_closed && is_half(a) && is_half(b);
        is_one.then(|| Shape::circle(a.at.midpoint(b.at), 0.5 * (b.at - a.at).hypot()))
    }

    /// The degrees of freedom of its middle, and of its width.
    pub(super) fn freedom(&self) -> usize {
        match self.circle().filter(|_| self.is_even) {
            Some(_) => 4,
            None => self.knots.iter().map(Knot::freedom).sum::<usize>() + self.radii(),
        }
    }

    /// The number of its radii.
    pub(super) fn radii(&self) -> usize {
        match self.is_even {
            true => 1,
            false => self.knots.len(),
        }
    }

    /// Half its width where it is widest, px.
    pub(in crate::trace) fn radius(&self) -> f64 {
        self.knots
            .iter()
            .fold(0.0, |most, knot| knot.radius.max(most))
    }

    /// Its length in units of its mean radius.
    pub(in crate::trace) fn slenderness(&self) -> f64 {
        let owns = own_unknowns(&self.knots).take(self.segments());
        let (mut length, mut covered) = (0.0, 0.0);
        for (i, own) in owns.enumerate() {
            let middle = self.middle(i, own);
            let ends = middle.vertices.windows(2).zip(middle.radii.windows(2));
            for (ends, radii) in ends {
                let step = (ends[1].at - ends[0].at).hypot();
                length += step;
                covered += 0.5 * step * (radii[0].value + radii[1].value);
            }
        }
        length * length / covered.max(f64::MIN_POSITIVE)
    }

    /// Half its width at each vertex, px, unless it has one width.
    pub(in crate::trace) fn varying(&self) -> Option<Vec<f64>> {
        (!self.is_even).then(|| self.knots.iter().map(|knot| knot.radius).collect())
    }

    /// The line so much wider on each side, px; at least a hair wide.
    pub(super) fn widened(&self, by: f64) -> Self {
        const HAIR: f64 = 0.01;
        let mut line = self.clone();
        for knot in &mut line.knots {
            knot.radius = (knot.radius + by).max(HAIR);
        }
        line
    }

    /// Its ends.
    pub(in crate::trace) fn cap(&self) -> Cap {
        self.cap
    }

    /// True if its middle has no curves, and no arcs but those of at most this bulge.
    pub(super) fn is_within(&self, most: f64) -> bool {
        let mut own = self.knots.iter().take(self.segments());
        own.all(|knot| match knot.segment {
            Segment::Line | Segment::Along(_) => true,
            Segment::Arc(bulge) => bulge.abs() < most,
            Segment::Cubic(_) => false,
        })
    }

    /// True if an open line with these vertices would end about where this one does; and of closed ones.
    pub(super) fn has_ends_of(&self, knots: &[Knot]) -> bool {
        let last = |knots: &[Knot]| knots[knots.len() - 1];
        let is_near = |a: Knot, b: Knot| (a.at - b.at).hypot() < NEARLY && !b.is_smooth;
        let are_near = is_near(self.knots[0], knots[0]) && is_near(last(&self.knots), last(knots));
        self.is_closed || (are_near && last(knots).segment == Segment::Line)
    }

    /// The lines that this one and another one are together, if ends of both are near each other: they meet in a corner there.
    pub(super) fn joined_with(&self, other: &Self) -> Vec<Self> {
        if self.is_closed || other.is_closed {
            return Vec::new();
        }
        let mut found = Vec::new();
        for first in [self.clone(), self.reversed()] {
            for second in [other.clone(), other.reversed()] {
                let (a, b) = (first.knots.len(), &second.knots);
                let most = REACH * self.radius().max(other.radius());
                let Some(meeting) = meeting(&first.knots, b, most) else {
                    continue;
                };
                let mut knots = first.knots[..a - 1].to_vec();
                let mut rest = b.to_vec();
                rest[0].at = meeting;
                rest[0].is_smooth = false;
                knots.extend(rest);
                found.push(Self {
                    knots,
                    is_even: first.is_even && second.is_even,
                    ..first.clone()
                });
            }
        }
        found
    }

    /// The closed line that this one is, if its ends are near each other.
    pub(super) fn closed(&self) -> Option<Self> {
        let count = self.knots.len();
        if self.is_closed || count < 4 {
            return None;
        }
        let mut knots = self.knots.clone();
        knots[0].at = meeting(&knots, &knots, REACH * self.radius())?;
        knots.truncate(count - 1);
        Some(Self {
            knots,
            is_closed: true,
            ..self.clone()
        })
    }

    /// The line in the other direction.
    fn reversed(&self) -> Self {
        let mut knots = turned(&self.knots);
        if !self.is_closed {
            let last = knots.len() - 1;
            knots[last].segment = Segment::Line;
        }
        Self {
            knots,
            ..self.clone()
        }
    }

    /// The number of segments of the middle.
    pub(super) fn segments(&self) -> usize {
        self.knots.len() - usize::from(!self.is_closed)
    }

    /// The index of the first radius among the unknowns, which come last.
    pub(super) fn radius_index(&self) -> usize {
        let own: usize = self
            .knots
            .iter()
            .take(self.segments())
            .map(|k| k.segment.unknowns())
            .sum();
        2 * self.knots.len() + own
    }

    /// The vertices of its outline, as one ring. That of a closed line goes along one side, and back along the other one.
    ///
    /// A side is where the discs along the middle touch the border of their union. That changes to first order as the middle and the
    /// radius there do, and not by the direction in which it lies.
    pub(super) fn outline(&self) -> Vec<Vertex> {
        let owns = own_unknowns(&self.knots).take(self.segments());
        let segments = owns.enumerate().map(|(i, own)| self.middle(i, own));
        let segments: Vec<Middle> = segments.collect();
        let mut outline = Vec::new();
        // 1. The side to the left, seen with y pointing down; 2. the end; 3. the other side, backwards; 4. the start.
        for side in [-1.0, 1.0] {
            let mut places: Vec<Vertex> = Vec::new();
            for (i, middle) in segments.iter().enumerate() {
                let before = match i {
                    0 => segments.last().filter(|_| self.is_closed),
                    _ => Some(&segments[i - 1]),
                };
                if let Some(before) = before {
                    let touches = [(before, before.vertices.len() - 1), (middle, 0)];
                    let touches = touches.map(|(middle, k)| middle.touch(k, side));
                    let radius = &middle.radii[0];
                    places.extend(self.join(&middle.vertices[0], touches, side, radius));
                }
                let sides = middle.vertices.iter().zip(&middle.radii).enumerate();
                places
                    .extend(sides.map(|(k, (at, radius))| at.moved(middle.touch(k, side), radius)));
            }
            if self.is_closed {
                places.extend(places.first().copied());
            }
            if side > 0.0 {
                places.reverse();
            }
            outline.extend(places);
            if !self.is_closed {
                let k = if side < 0.0 { segments.len() - 1 } else { 0 };
                let middle = &segments[k];
                let at = if side < 0.0 {
                    middle.vertices.len() - 1
                } else {
                    0
                };
                outline.extend(self.end(middle, at, side));
            }
        }
        outline
    }

    /// The middle of a segment, whose unknowns besides the vertices begin at `own`.
    fn middle(&self, i: usize, own: usize) -> Middle {
        let vertices = polyline(&self.knots, i, own);
        let to = self.knots[(i + 1) % self.knots.len()].at;
        let [start, end] = directions(&self.knots[i], to).map(unit);
        let last = vertices.len() - 1;
        let way = |k: usize| match k {
            0 => start,
            k if k == last => end,
            k => unit(vertices[k + 1].at - vertices[k - 1].at),
        };
        let ways = (0..=last).map(way).collect();
        // Vertices are at even steps of the parameter.
        let next = (i + 1) % self.knots.len();
        let first = self.radius_index();
        let radius = |k: usize| {
            let share = k as f64 / last as f64;
            let [a, b] = [i, next].map(|i| self.knots[i].radius);
            Radius {
                value: a + share * (b - a),
                slopes: match self.is_even {
                    true => [(first, 1.0), (first, 0.0)],
                    false => [(first + i, 1.0 - share), (first + next, share)],
                },
            }
        };
        let radii: Vec<Radius> = (0..=last).map(radius).collect();
        let slope = |k: usize| {
            let [a, b] = [k.saturating_sub(1), (k + 1).min(last)];
            let length = (vertices[b].at - vertices[a].at).hypot();
            let slope = (radii[b].value - radii[a].value) / length.max(1e-9);
            slope.clamp(-STEEPEST, STEEPEST)
        };
        Middle {
            slopes: (0..=last).map(slope).collect(),
            radii,
            vertices,
            ways,
        }
    }

    /// What joins two segments on one side, between the directions in which their discs touch it there. These differ where the
    /// middle turns, and where the width changes more or less from there on.
    fn join(&self, at: &Vertex, [m, n]: [Vec2; 2], side: f64, radius: &Radius) -> Vec<Vertex> {
        let angle = 2.0 * math::atan(m.cross(n) / (1.0 + m.dot(n)).max(1e-9));
        let is_inner = angle * side > 0.0;
        let least = match is_inner && !self.is_even {
            true => SHALLOW,
            false => STRAIGHT,
        };
        if angle.abs() < least {
            return Vec::new();
        }
        // On the inner side both go to the middle, so that each is whole: where they overlap, they cover twice.
        if is_inner {
            return vec![*at];
        }
        match self.cap {
            Cap::Round => fan(at, m, angle, radius),
            Cap::Butt => vec![at.moved((m + n) / (1.0 + m.dot(n)).max(SHARPEST), radius)],
        }
    }

    /// The end of the line at a vertex of a segment's middle, from one side to the other.
    fn end(&self, middle: &Middle, at: usize, side: f64) -> Vec<Vertex> {
        match self.cap {
            Cap::Round => {
                // Half a turn, and what the line widens to there.
                let slope = -side * middle.slopes[at];
                let lean = math::atan(slope / (1.0 - slope * slope).sqrt());
                let from = middle.touch(at, side);
                fan(
                    &middle.vertices[at],
                    from,
                    PI + 2.0 * lean,
                    &middle.radii[at],
                )
            }
            Cap::Butt => Vec::new(),
        }
    }
}

/// The middle of a segment as a polyline: its vertices, the directions there, and half the widths with their slopes.
struct Middle {
    vertices: Vec<Vertex>,
    ways: Vec<Vec2>,
    radii: Vec<Radius>,
    /// The changes of half the width with the length.
    slopes: Vec<f64>,
}

impl Middle {
    /// The direction in which the disc around vertex `k` touches the border of what the line covers, on one side.
    fn touch(&self, k: usize, side: f64) -> Vec2 {
        let slope = self.slopes[k];
        let across = (1.0 - slope * slope).sqrt();
        side * across * normal(self.ways[k]) - slope * self.ways[k]
    }
}

/// Where a line that ends and one that starts meet, if the end and the start are near each other.
fn meeting(first: &[Knot], second: &[Knot], most: f64) -> Option<Point> {
    let a = first.len();
    let [end, start] = [first[a - 1].at, second[0].at];
    if (start - end).hypot() > most {
        return None;
    }
    let way = |knots: &[Knot], i: usize| directions(&knots[i], knots[i + 1].at);
    let [u, v] = [way(first, a - 2)[1], way(second, 0)[0]].map(unit);
    let along = (start - end).cross(v) / u.cross(v);
    let meeting = end + along * u;
    let is_near =
        u.cross(v).abs() > 0.1 && (meeting - end).hypot().max((meeting - start).hypot()) < most;
    Some(match is_near {
        true => meeting,
        false => end.midpoint(start),
    })
}

/// Vertices of the circle around a place, from one direction on, without both ends.
fn fan(at: &Vertex, from: Vec2, angle: f64, radius: &Radius) -> Vec<Vertex> {
    let step = (8.0 * TOLERANCE / radius.value.max(TOLERANCE)).sqrt();
    let count = (angle.abs() / step).ceil().max(2.0) as usize;
    let place = |k: usize| {
        let (sin, cos) = math::sin_cos(angle * k as f64 / count as f64);
        let out = Vec2::new(cos * from.x - sin * from.y, sin * from.x + cos * from.y);
        at.moved(out, radius)
    };
    (1..count).map(place).collect()
}

/// The normal to the right of a direction, seen with y pointing down.
fn normal(way: Vec2) -> Vec2 {
    Vec2::new(-way.y, way.x)
}

fn unit(way: Vec2) -> Vec2 {
    way / way.hypot().max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::super::coverage::{Band, Coverage, Page};
    use super::super::curve::Ring;
    use super::super::describe;
    use super::super::segment::distance2;
    use super::*;

    #[test]
    fn a_line_with_round_corners_covers_what_is_near_its_middle() {
        let page = Page {
            origin: [0; 2],
            width: 60,
            height: 60,
        };
        // A sharp corner to each side.
        for corner in [[50.0, 20.3], [12.1, 14.2]] {
            let places = [[10.2, 40.7], corner, [15.4, 12.9]].map(|[x, y]| Point::new(x, y));
            let line = Line::even(&places.map(describe::corner), false, 4.2, Cap::Round);
            let ring = Ring::Line(line);
            let band = Band::around(&ring, page);
            let shares = Coverage::of(&ring, &band).shares();
            for ([x, y], share) in band.places().zip(shares) {
                const STEPS: i32 = 16;
                let at = |k: i32, i: i32| f64::from(k) + (f64::from(i) + 0.5) / f64::from(STEPS);
                let inside = (0..STEPS * STEPS).filter(|k| {
                    let p = Point::new(at(x, k % STEPS), at(y, k / STEPS));
                    distance2(&places, p).sqrt() < 4.2
                });
                let expected = inside.count() as f64 / f64::from(STEPS * STEPS);
                assert!(
                    (share - expected).abs() < 0.08,
                    "{x},{y}: {share} {expected}"
                );
            }
        }
    }
}
