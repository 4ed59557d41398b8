//! Segments between vertices: lines, circular arcs and cubics, as functions of few numbers.

use crate::math::{self, Point, Vec2};
use crate::scene::{Path, PathPoint};

/// A segment between two vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::trace) enum Segment {
    Line,
    /// A line along an axis, 0 if it is level and 1 if it is upright: its ends have one place across.
    Along(usize),
    /// An arc with this bulge, tan(angle/4), positive if it turns to the right, seen with y pointing down.
    ///
    /// The bulge is regular where the arc becomes a line, where radius and centre are not.
    Arc(f64),
    Cubic([Point; 2]),
}

impl Segment {
    /// Number of unknowns besides the vertices.
    pub(super) fn unknowns(&self) -> usize {
        match self {
            Self::Line | Self::Along(_) => 0,
            Self::Arc(_) => 1,
            Self::Cubic(_) => 4,
        }
    }
}

/// The squared distance of a place from a polyline.
pub(super) fn distance2(places: &[Point], p: Point) -> f64 {
    let pieces = places.windows(2);
    let pieces = pieces.map(|ends| kurbo::Line::new(ends[0], ends[1]));
    let squares = pieces.map(|piece| kurbo::ParamCurveNearest::nearest(&piece, p, 0.0).distance_sq);
    squares.fold(f64::INFINITY, f64::min)
}

/// A vertex and the segment behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::trace) struct Knot {
    pub(super) at: Point,
    pub(super) segment: Segment,
    /// True if the segment before the vertex goes on in the direction of the one behind it.
    pub(super) is_smooth: bool,
    /// Half the width of a line there, px; 0 of an outline.
    pub(super) radius: f64,
}

impl Knot {
    /// The numbers that it adds to a ring.
    pub(super) fn freedom(&self) -> usize {
        let spared =
            usize::from(self.is_smooth) + usize::from(matches!(self.segment, Segment::Along(_)));
        2 + self.segment.unknowns() - spared
    }
}

/// Most unknowns that move a vertex: those of a cubic, and the radii at both ends of a segment of a line.
const MOST_SLOPES: usize = 10;

/// Half the width of a line at a vertex of its polyline, px, with its derivatives by the radii among the unknowns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Radius {
    pub(super) value: f64,
    pub(super) slopes: [(usize, f64); 2],
}

/// A vertex of the polyline that replaces a ring, with its derivatives by some unknowns of the ring: their index, and the change of
/// x and y.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) at: Point,
    slopes: [(u32, Vec2); MOST_SLOPES],
    count: u8,
}

impl Vertex {
    pub(super) fn new(at: Point, list: &[(usize, Vec2)]) -> Self {
        let mut slopes = [(0, Vec2::ZERO); MOST_SLOPES];
        for (slot, &(unknown, slope)) in slopes.iter_mut().zip(list) {
            *slot = (unknown as u32, slope);
        }
        Self {
            at,
            slopes,
            count: list.len().min(MOST_SLOPES) as u8,
        }
    }

    /// The vertex moved by a radius in a direction.
    pub(super) fn moved(&self, way: Vec2, radius: &Radius) -> Self {
        let mut moved = *self;
        moved.at += radius.value * way;
        for (index, slope) in radius.slopes.into_iter().filter(|(_, slope)| *slope != 0.0) {
            if let Some(slot) = moved.slopes.get_mut(usize::from(moved.count)) {
                *slot = (index as u32, slope * way);
                moved.count += 1;
            }
        }
        moved
    }

    /// Its derivatives by some unknowns of the ring: their index, and the change of x and y.
    pub(super) fn slopes(&self) -> &[(u32, Vec2)] {
        &self.slopes[..self.count.into()]
    }
}

/// Farthest that the polyline of a ring is from it, px.
pub(super) const TOLERANCE: f64 = 0.004;

/// The angle by which a ring turns at the second of three vertices, rad.
pub(super) fn turn(three: &[Knot; 3]) -> f64 {
    let [[_, before], [after, _]] = [
        directions(&three[0], three[1].at),
        directions(&three[1], three[2].at),
    ];
    angle_between(before, after)
}

/// The angle from one direction to another, rad, −π to π.
pub(super) fn angle_between(u: Vec2, v: Vec2) -> f64 {
    // The tangent of half the angle is sin/(1 + cos).
    2.0 * math::atan(u.cross(v) / (u.hypot() * v.hypot() + u.dot(v)).max(1e-12))
}

/// The weights of a cubic's points at share `t`.
pub(super) fn weights(t: f64) -> [f64; 4] {
    let u = 1.0 - t;
    [u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t]
}

/// The middle of an arc from one place to another: the sagitta is half its bulge times the chord.
pub(super) fn arc_middle(from: Point, to: Point, bulge: f64) -> Point {
    let chord = to - from;
    from.midpoint(to) + 0.5 * bulge * Vec2::new(chord.y, -chord.x)
}

/// The directions in which the segment behind a vertex begins and ends, at `to`.
pub(super) fn directions(knot: &Knot, to: Point) -> [Vec2; 2] {
    let chord = to - knot.at;
    match knot.segment {
        Segment::Line | Segment::Along(_) => [chord; 2],
        Segment::Arc(bulge) => {
            // Both are half of the arc's angle from the chord.
            let (sin, cos) = math::sin_cos(2.0 * math::atan(bulge));
            let turned =
                |sin: f64| Vec2::new(cos * chord.x - sin * chord.y, sin * chord.x + cos * chord.y);
            [turned(-sin), turned(sin)]
        }
        Segment::Cubic([a, b]) => [a - knot.at, to - b],
    }
}

/// The ends of a segment, and the indices of their x.
struct Ends {
    places: [Point; 2],
    indices: [usize; 2],
}

impl Ends {
    fn start(&self) -> Vertex {
        let [x, y] = [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)];
        Vertex::new(
            self.places[0],
            &[(self.indices[0], x), (self.indices[0] + 1, y)],
        )
    }
}

/// The index of the first unknown of the segment behind each vertex, besides those of the vertices.
pub(super) fn own_unknowns(knots: &[Knot]) -> impl Iterator<Item = usize> + '_ {
    knots.iter().scan(2 * knots.len(), |next, knot| {
        let first = *next;
        *next += knot.segment.unknowns();
        Some(first)
    })
}

/// The values of the unknowns of vertices, so many of which have segments behind them.
pub(super) fn values_of(knots: &[Knot], segments: usize) -> Vec<f64> {
    let mut values: Vec<f64> = knots.iter().flat_map(|k| [k.at.x, k.at.y]).collect();
    for knot in &knots[..segments] {
        match knot.segment {
            Segment::Line | Segment::Along(_) => {}
            Segment::Arc(bulge) => values.push(bulge),
            Segment::Cubic([a, b]) => values.extend([a.x, a.y, b.x, b.y]),
        }
    }
    values
}

/// Gives vertices these values of their unknowns.
pub(super) fn set_values(knots: &mut [Knot], values: &[f64]) {
    let (places, mut rest) = values.split_at(2 * knots.len());
    for (knot, at) in knots.iter_mut().zip(places.chunks(2)) {
        knot.at = Point::new(at[0], at[1]);
        let (own, others) = rest.split_at(knot.segment.unknowns().min(rest.len()));
        match &mut knot.segment {
            Segment::Line | Segment::Along(_) => {}
            Segment::Arc(bulge) => *bulge = own[0],
            Segment::Cubic(controls) => {
                *controls = [Point::new(own[0], own[1]), Point::new(own[2], own[3])];
            }
        }
        rest = others;
    }
}

/// The polyline that replaces the segment behind vertex `i`, with its end, and the derivatives of its vertices. Its unknowns besides
/// the vertices begin at `own`.
pub(super) fn polyline(knots: &[Knot], i: usize, own: usize) -> Vec<Vertex> {
    let k = (i + 1) % knots.len();
    let ends = Ends {
        places: [knots[i].at, knots[k].at],
        indices: [2 * i, 2 * k],
    };
    let mut vertices = Vec::new();
    match knots[i].segment {
        Segment::Line | Segment::Along(_) => vertices.push(ends.start()),
        Segment::Arc(bulge) => arc(&ends, bulge, own, &mut vertices),
        Segment::Cubic(controls) => cubic(&ends, controls, own, &mut vertices),
    }
    let end = Ends {
        places: [knots[k].at; 2],
        indices: [2 * k; 2],
    };
    vertices.push(end.start());
    vertices
}

/// The path of vertices and segments. Arcs of up to 100° are cubics, which have fewer numbers and are as near as 0.0003 of the radius.
pub(super) fn path_of(knots: &[Knot], is_closed: bool) -> Path {
    const LONG: f64 = 0.467;
    let mut points = Vec::new();
    for (i, knot) in knots.iter().enumerate() {
        let to = knots[(i + 1) % knots.len()].at;
        points.push(PathPoint::on(knot.at));
        if !is_closed && i + 1 == knots.len() {
            break;
        }
        match knot.segment {
            Segment::Line | Segment::Along(_) => {}
            Segment::Arc(bulge) if bulge.abs() < LONG => {
                let angle = 4.0 * math::atan(bulge.abs());
                // 4/3·tan(a/4)·r, with the chord 2r·sin(a/2); a third of the chord for none.
                let sine = math::sin(0.5 * angle);
                let length = if sine > 1e-9 {
                    2.0 / 3.0 * bulge.abs() / sine
                } else {
                    1.0 / 3.0
                };
                let [u, v] = directions(knot, to);
                points.extend([knot.at + length * u, to - length * v].map(PathPoint::cubic));
            }
            Segment::Arc(bulge) => {
                points.push(PathPoint::arc(arc_middle(knot.at, to, bulge)));
            }
            Segment::Cubic(controls) => points.extend(controls.map(PathPoint::cubic)),
        }
    }
    Path::of_points(points, is_closed)
}

/// Segments in the other direction.
pub(super) fn turned(knots: &[Knot]) -> Vec<Knot> {
    let count = knots.len();
    let knot = |i: usize| Knot {
        segment: match knots[(i + count - 1) % count].segment {
            Segment::Arc(bulge) => Segment::Arc(-bulge),
            Segment::Cubic([a, b]) => Segment::Cubic([b, a]),
            line => line,
        },
        ..knots[i]
    };
    (0..count).rev().map(knot).collect()
}

/// A point of an arc in units of its chord, from start to end along x, with its derivative by the bulge.
///
/// With the plane as complex numbers, t/(t + c·(1 − t)) is an arc from 0 to 1, as Möbius' maps take lines to circles. Its middle is
/// (1 − ib)/2, as that of the arc with the bulge b, for c = (1 + ib)/(1 − ib).
fn on_arc(bulge: f64, t: f64) -> [Vec2; 2] {
    let square = 1.0 + bulge * bulge;
    let times = |a: Vec2, b: Vec2| Vec2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
    let c = Vec2::new(1.0 - bulge * bulge, 2.0 * bulge) / square;
    let below = Vec2::new(t, 0.0) + (1.0 - t) * c;
    // One over it.
    let inverse = Vec2::new(below.x, -below.y) / below.hypot2();
    let slope = 2.0 * Vec2::new(-c.y, c.x) / square;
    [
        t * inverse,
        -t * (1.0 - t) * times(slope, times(inverse, inverse)),
    ]
}

/// Appends the vertices of an arc, without its end.
fn arc(ends: &Ends, bulge: f64, own: usize, vertices: &mut Vec<Vertex>) {
    let [from, to] = ends.places;
    let chord = to - from;
    let length = chord.hypot();
    let angle = 4.0 * math::atan(bulge.abs());
    let radius = length * (1.0 + bulge * bulge) / (4.0 * bulge.abs()).max(1e-9);
    let step = (8.0 * TOLERANCE / radius.max(TOLERANCE)).sqrt();
    // The longest step is the middle one, which is b/atan(b) times the mean.
    let longest = if angle > 1e-6 {
        4.0 * bulge.abs() / angle
    } else {
        1.0
    };
    let count = (longest * angle / step).ceil().clamp(2.0, 400.0);
    let across = Vec2::new(-chord.y, chord.x);
    let place = |p: Vec2| p.x * chord + p.y * across;
    for i in 0..count as usize {
        let [p, by_bulge] = on_arc(bulge, i as f64 / count);
        // The chord turns and stretches with its ends: x·chord + y·across is complex multiplication.
        let [along, beside] = [Vec2::new(p.x, p.y), Vec2::new(-p.y, p.x)];
        let [x, y] = [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)];
        let [a, b] = ends.indices;
        let slopes = [
            (a, x - along),
            (a + 1, y - beside),
            (b, along),
            (b + 1, beside),
            (own, place(by_bulge)),
        ];
        vertices.push(Vertex::new(from + place(p), &slopes));
    }
}

/// Appends the vertices of a cubic, without its end.
fn cubic(ends: &Ends, [c, d]: [Point; 2], own: usize, vertices: &mut Vec<Vertex>) {
    let [from, to] = ends.places;
    let bend =
        |a: Point, b: Point, c: Point| (a.to_vec2() - 2.0 * b.to_vec2() + c.to_vec2()).hypot();
    // The second derivative is at most 6 times the larger of these.
    let bend = 6.0 * bend(from, c, d).max(bend(c, d, to));
    let count = (bend / (8.0 * TOLERANCE)).sqrt().ceil().clamp(2.0, 200.0);
    let [a, b] = ends.indices;
    for i in 0..count as usize {
        let weights = weights(i as f64 / count);
        let points = [from, c, d, to].map(Point::to_vec2);
        let at = weights
            .iter()
            .zip(points)
            .map(|(w, p)| *w * p)
            .sum::<Vec2>();
        let slopes = [a, own, own + 2, b].into_iter().zip(weights);
        let slopes = slopes.flat_map(|(k, w)| [(k, Vec2::new(w, 0.0)), (k + 1, Vec2::new(0.0, w))]);
        let slopes: Vec<(usize, Vec2)> = slopes.collect();
        vertices.push(Vertex::new(at.to_point(), &slopes));
    }
}

/// Farthest that the ends of a line are from one along an axis, px, at which that is tried. Pixels judge it.
pub(super) const NEARLY: f64 = 0.5;
