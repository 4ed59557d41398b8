//! Rings of lines, circular arcs and cubics, as functions of few numbers.
//!
//! A ring is a list of vertices with a segment behind each. The *unknowns* of a ring are its numbers in the order of
//! [`Ring::unknowns`]: the vertices, then the bulge of each arc and the control points of each cubic; a shape has those of its element.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::math::{self, Point, Vec2};
use crate::scene::{Path, PathPoint, Shape};

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

/// A vertex and the segment behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::trace) struct Knot {
    pub(super) at: Point,
    pub(super) segment: Segment,
    /// True if the segment before the vertex goes on in the direction of the one behind it.
    pub(super) is_smooth: bool,
}

impl Knot {
    /// The numbers that it adds to a ring.
    pub(super) fn freedom(&self) -> usize {
        let spared =
            usize::from(self.is_smooth) + usize::from(matches!(self.segment, Segment::Along(_)));
        2 + self.segment.unknowns() - spared
    }
}

/// A closed outline.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::trace) enum Ring {
    /// A circle, an ellipse or a rectangle.
    Shape {
        shape: Shape,
        /// 1 or −1, the sign of its area.
        turn: f64,
    },
    /// Vertices with segments.
    Knots(Vec<Knot>),
}

/// A vertex of the polyline that replaces a ring, with its derivatives by some unknowns of the ring: their index, and the change of
/// x and y.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) at: Point,
    slopes: [(u32, Vec2); 8],
    count: u8,
}

impl Vertex {
    fn new(at: Point, list: &[(usize, Vec2)]) -> Self {
        let mut slopes = [(0, Vec2::ZERO); 8];
        for (slot, &(unknown, slope)) in slopes.iter_mut().zip(list) {
            *slot = (unknown as u32, slope);
        }
        Self {
            at,
            slopes,
            count: list.len().min(8) as u8,
        }
    }

    /// Its derivatives by some unknowns of the ring: their index, and the change of x and y.
    pub(super) fn slopes(&self) -> &[(u32, Vec2)] {
        &self.slopes[..self.count.into()]
    }
}

/// Farthest that the polyline of a ring is from it, px.
const TOLERANCE: f64 = 0.004;

impl Ring {
    /// The number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        match self {
            Self::Shape { shape, .. } => numbers(shape).len(),
            Self::Knots(knots) => {
                let own: usize = knots.iter().map(|knot| knot.segment.unknowns()).sum();
                2 * knots.len() + own
            }
        }
    }

    /// The values of the unknowns.
    pub(super) fn values(&self) -> Vec<f64> {
        match self {
            Self::Shape { shape, .. } => numbers(shape),
            Self::Knots(knots) => {
                let mut values: Vec<f64> = knots.iter().flat_map(|k| [k.at.x, k.at.y]).collect();
                for knot in knots {
                    match knot.segment {
                        Segment::Line | Segment::Along(_) => {}
                        Segment::Arc(bulge) => values.push(bulge),
                        Segment::Cubic([a, b]) => values.extend([a.x, a.y, b.x, b.y]),
                    }
                }
                values
            }
        }
    }

    /// The ring with these values of the unknowns.
    pub(super) fn with(&self, values: &[f64]) -> Self {
        let mut ring = self.clone();
        match &mut ring {
            Self::Shape { shape, .. } => *shape = with_numbers(shape, values),
            Self::Knots(knots) => {
                let (places, mut rest) = values.split_at(2 * knots.len());
                for (knot, at) in knots.iter_mut().zip(places.chunks(2)) {
                    knot.at = Point::new(at[0], at[1]);
                    let (own, others) = rest.split_at(knot.segment.unknowns());
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
        }
        ring
    }

    /// The ring as a path; one that is `alone` may be an element of its own. Arcs of up to 100° are cubics, which have fewer numbers
    /// and are as near as 0.0003 of the radius.
    pub(in crate::trace) fn path(&self, is_alone: bool) -> Path {
        const LONG: f64 = 0.467;
        let knots = match self {
            Self::Shape { shape, .. } if is_alone => return with_radius(shape).path(),
            Self::Shape { shape, turn } => &knots(shape, *turn),
            Self::Knots(knots) => knots,
        };
        let mut points = Vec::new();
        for (i, knot) in knots.iter().enumerate() {
            let to = knots[(i + 1) % knots.len()].at;
            points.push(PathPoint::on(knot.at));
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
        Path::of_points(points, true)
    }

    /// True if an element of its own takes fewer numbers than a part of a path.
    pub(in crate::trace) fn is_shorter_alone(&self) -> bool {
        match self {
            Self::Shape {
                shape: Shape::Rect { radius, .. },
                ..
            } => *radius > 0.0,
            Self::Shape { .. } => true,
            Self::Knots(_) => false,
        }
    }

    /// The change of each unknown that moves the ring by about a px.
    pub(super) fn units(&self) -> Vec<f64> {
        let mut units = vec![1.0; self.unknowns()];
        if let Self::Knots(knots) = self {
            for ((i, knot), own) in knots.iter().enumerate().zip(self.owns()) {
                if let Segment::Arc(_) = knot.segment {
                    // The middle of an arc is half the chord times the bulge beside it.
                    let chord = knots[(i + 1) % knots.len()].at - knot.at;
                    units[own] = 2.0 / chord.hypot().max(1.0);
                }
            }
        }
        units
    }

    /// The degrees of freedom: a smooth joint takes one, and so does an axis.
    pub(super) fn freedom(&self) -> f64 {
        let count = match self {
            Self::Shape { shape, .. } => numbers(shape).len(),
            Self::Knots(knots) => knots.iter().map(Knot::freedom).sum(),
        };
        count as f64
    }

    /// The number of segments: 1 of a shape.
    pub(super) fn segments(&self) -> usize {
        match self {
            Self::Shape { .. } => 1,
            Self::Knots(knots) => knots.len(),
        }
    }

    /// The index of the first unknown of each segment besides its vertices.
    fn own_unknowns(knots: &[Knot]) -> impl Iterator<Item = usize> + '_ {
        knots.iter().scan(2 * knots.len(), |next, knot| {
            let first = *next;
            *next += knot.segment.unknowns();
            Some(first)
        })
    }

    /// The polyline that replaces segment `i`, without its end, with the derivatives of its vertices.
    fn segment(&self, i: usize, own: usize) -> Vec<Vertex> {
        match self {
            Self::Shape { shape, turn } => around(shape, *turn),
            Self::Knots(knots) => {
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
                vertices
            }
        }
    }

    /// The polyline that replaces segment `i`, with its end.
    pub(super) fn polyline_of(&self, i: usize, owns: &[usize]) -> Vec<Vertex> {
        let mut vertices = self.segment(i, owns[i]);
        match self {
            // A shape ends where it starts.
            Self::Shape { .. } => vertices.push(vertices[0]),
            Self::Knots(knots) => {
                let k = (i + 1) % knots.len();
                let ends = Ends {
                    places: [knots[k].at; 2],
                    indices: [2 * k; 2],
                };
                vertices.push(ends.start());
            }
        }
        vertices
    }

    /// The index of the first unknown of each segment besides its vertices.
    pub(super) fn owns(&self) -> Vec<usize> {
        match self {
            Self::Shape { .. } => vec![0],
            Self::Knots(knots) => Self::own_unknowns(knots).collect(),
        }
    }

    /// The angle at vertex `i`, rad.
    pub(super) fn angle(&self, i: usize) -> f64 {
        let Self::Knots(knots) = self else {
            return 0.0;
        };
        let count = knots.len();
        turn(&[(i + count - 1) % count, i, (i + 1) % count].map(|k| knots[k]))
    }

    /// The angle at vertex `i`, rad, with its derivatives by the unknowns.
    pub(super) fn joint(&self, i: usize, owns: &[usize]) -> (f64, Vec<(usize, f64)>) {
        let Self::Knots(knots) = self else {
            return (0.0, Vec::new());
        };
        let count = knots.len();
        let [before, after] = [(i + count - 1) % count, (i + 1) % count];
        // Three vertices matter, and what belongs to two segments.
        let three = [before, i, after].map(|k| knots[k]);
        let angle = |three: &[Knot; 3]| turn(three);
        const STEP: f64 = 1e-6;
        let mut slopes: Vec<(usize, f64)> = Vec::new();
        let mut add = |index: usize, change: &dyn Fn(&mut [Knot; 3], f64)| {
            let moved = [-STEP, STEP].map(|step| {
                let mut three = three;
                change(&mut three, step);
                angle(&three)
            });
            slopes.push((index, (moved[1] - moved[0]) / (2.0 * STEP)));
        };
        for (k, index) in [before, i, after].into_iter().enumerate() {
            add(2 * index, &|three, step| three[k].at.x += step);
            add(2 * index + 1, &|three, step| three[k].at.y += step);
        }
        for (k, index) in [before, i].into_iter().enumerate() {
            for own in 0..knots[index].segment.unknowns() {
                add(
                    owns[index] + own,
                    &|three, step| match &mut three[k].segment {
                        Segment::Line | Segment::Along(_) => {}
                        Segment::Arc(bulge) => *bulge += step,
                        Segment::Cubic(controls) => {
                            let control = &mut controls[own / 2];
                            if own % 2 == 0 {
                                control.x += step
                            } else {
                                control.y += step
                            }
                        }
                    },
                );
            }
        }
        // A ring of two vertices has some twice.
        slopes.sort_by_key(|slope| slope.0);
        slopes.dedup_by(|b, a| {
            let is_same = a.0 == b.0;
            if is_same {
                a.1 += b.1;
            }
            is_same
        });
        (angle(&three), slopes)
    }
}

/// The angle by which a ring turns at the second of three vertices, rad.
fn turn(three: &[Knot; 3]) -> f64 {
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

/// The numbers of a shape. Round corners have a radius, but not sharp ones and those of an infinite radius, which are as round as the
/// shorter side allows.
fn numbers(shape: &Shape) -> Vec<f64> {
    match *shape {
        Shape::Circle { center, radius } => vec![center.x, center.y, radius],
        Shape::Ellipse {
            center,
            radii: [x, y],
        } => vec![center.x, center.y, x, y],
        Shape::Rect { low, high, radius } => {
            let sides = [low.x, low.y, high.x, high.y];
            sides
                .into_iter()
                .chain(Some(radius).filter(|radius| *radius > 0.0 && radius.is_finite()))
                .collect()
        }
    }
}

/// The shape of the same kind with these numbers.
fn with_numbers(shape: &Shape, values: &[f64]) -> Shape {
    let p = Point::new(values[0], values[1]);
    match *shape {
        Shape::Circle { .. } => Shape::Circle {
            center: p,
            radius: values[2],
        },
        Shape::Ellipse { .. } => Shape::Ellipse {
            center: p,
            radii: [values[2], values[3]],
        },
        Shape::Rect { radius, .. } => {
            let high = Point::new(values[2], values[3]);
            // Corners have room, and stay round.
            let most = 0.5 * (high - p).x.min((high - p).y);
            let own = |radius: &f64| radius.min(most).max(0.01);
            let radius = values.get(4).map_or(radius, own);
            Shape::Rect {
                low: p,
                high,
                radius,
            }
        }
    }
}

/// A shape as segments, clockwise for a `turn` of 1.
fn knots(shape: &Shape, turn: f64) -> Vec<Knot> {
    let knot = |x: f64, y: f64, segment: Segment| Knot {
        at: Point::new(x, y),
        segment,
        is_smooth: false,
    };
    let half = Segment::Arc(1.0);
    let quarter = Segment::Arc(math::tan(0.25 * FRAC_PI_2));
    let clockwise = match with_radius(shape) {
        Shape::Circle {
            center: Point { x, y },
            radius,
        } => {
            vec![knot(x - radius, y, half), knot(x + radius, y, half)]
        }
        Shape::Ellipse {
            center: Point { x, y },
            radii: [a, b],
        } => {
            // The handles of a quarter circle.
            const LENGTH: f64 = 0.552_284_749_830_793_4;
            let quarter = |(u, v): (f64, f64)| {
                let at = |u: f64, v: f64| Point::new(x + a * u, y + b * v);
                let controls = [
                    at(u - LENGTH * v, v + LENGTH * u),
                    at(LENGTH * u - v, LENGTH * v + u),
                ];
                Knot {
                    at: at(u, v),
                    segment: Segment::Cubic(controls),
                    is_smooth: true,
                }
            };
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
                .map(quarter)
                .to_vec()
        }
        Shape::Rect {
            low,
            high,
            radius: 0.0,
        } => vec![
            knot(low.x, low.y, Segment::Line),
            knot(high.x, low.y, Segment::Line),
            knot(high.x, high.y, Segment::Line),
            knot(low.x, high.y, Segment::Line),
        ],
        Shape::Rect { low, high, radius } => {
            let (left, top) = (low.x + radius, low.y + radius);
            let (right, bottom) = (high.x - radius, high.y - radius);
            // Two round corners with nothing between them are half a circle.
            let is_none = |side: f64| side < UNSEEN;
            let corners = |is_half: bool| if is_half { half } else { quarter };
            let (no_width, no_height) = (is_none(right - left), is_none(bottom - top));
            // The sides clockwise, and whether each is none, as its neighbours are or not.
            let sides = [
                ([(left, low.y), (right, low.y)], no_width, no_height),
                ([(high.x, top), (high.x, bottom)], no_height, no_width),
                ([(right, high.y), (left, high.y)], no_width, no_height),
                ([(low.x, bottom), (low.x, top)], no_height, no_width),
            ];
            let seen = sides.into_iter().filter(|(_, is_none, _)| !is_none);
            seen.flat_map(|([from, to], _, is_half)| {
                [
                    knot(from.0, from.1, Segment::Line),
                    knot(to.0, to.1, corners(is_half)),
                ]
            })
            .collect()
        }
    };
    if turn > 0.0 {
        clockwise
    } else {
        turned(&clockwise)
    }
}

/// A side of a round rectangle that is shorter is none, px: half of what a file's second decimal tells.
const UNSEEN: f64 = 0.005;

/// Segments in the other direction.
fn turned(knots: &[Knot]) -> Vec<Knot> {
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

/// The shape with a finite radius.
pub(super) fn with_radius(shape: &Shape) -> Shape {
    match *shape {
        Shape::Rect { low, high, radius } => {
            let side = high - low;
            Shape::rect([low, high], radius.min(0.5 * side.x.min(side.y)))
        }
        round => round,
    }
}

/// The vertices of a shape, clockwise for a `turn` of 1.
///
/// Each lies at a side, which is a centre or a border, and a multiple of the radii beside it. Round parts have as large an area as the
/// shape, so that the error of its coverage has no mean.
fn around(shape: &Shape, turn: f64) -> Vec<Vertex> {
    let [x, y] = [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)];
    let chords = |radius: f64| {
        // A chord of the angle a is about r·a²/8 from its arc.
        let count = TAU / (8.0 * TOLERANCE / radius.max(TOLERANCE)).sqrt();
        4.0 * (0.25 * count).ceil().max(3.0)
    };
    let round = |radius: f64| {
        let count = chords(radius);
        let step = TAU / count;
        let scale = (step / math::sin(step)).sqrt();
        (0..count as usize).map(move |i| {
            let (sin, cos) = math::sin_cos(step * i as f64);
            scale * Vec2::new(cos, sin)
        })
    };
    let mut vertices: Vec<Vertex> = match *shape {
        Shape::Circle { center, radius } => {
            let vertex =
                |out: Vec2| Vertex::new(center + radius * out, &[(0, x), (1, y), (2, out)]);
            round(radius).map(vertex).collect()
        }
        Shape::Ellipse {
            center,
            radii: [a, b],
        } => {
            let vertex = |out: Vec2| {
                let slopes = [(0, x), (1, y), (2, out.x * x), (3, out.y * y)];
                Vertex::new(center + Vec2::new(a * out.x, b * out.y), &slopes)
            };
            round(a.max(b)).map(vertex).collect()
        }
        Shape::Rect { low, high, radius } => {
            let side = high - low;
            let is_full = radius.is_infinite();
            let radius = radius.min(0.5 * side.x.min(side.y));
            // The unknowns of the sides that are the nearer ones.
            let nearer = if side.x < side.y { [0, 2] } else { [1, 3] };
            // The corners in the order of the quarter turns, which begin to the right.
            let corner = |quarter: usize| {
                let is_high = [quarter == 0 || quarter == 3, quarter < 2];
                let [at_x, at_y] = is_high.map(|is_high| if is_high { high } else { low });
                let signs = is_high.map(|is_high| if is_high { 1.0 } else { -1.0 });
                let steps = if radius > 0.0 {
                    chords(radius) as usize / 4
                } else {
                    0
                };
                (0..=steps).map(move |i| {
                    let factor = match steps {
                        0 => Vec2::ZERO,
                        _ => {
                            let turned = quarter as f64 + i as f64 / steps as f64;
                            let (sin, cos) = math::sin_cos(FRAC_PI_2 * turned);
                            Vec2::new(cos - signs[0], sin - signs[1])
                        }
                    };
                    let sides = [2 * usize::from(is_high[0]), 1 + 2 * usize::from(is_high[1])];
                    let mut slopes = vec![(sides[0], x), (sides[1], y)];
                    match (steps, is_full) {
                        (0, _) => {}
                        (_, false) => slopes.push((4, factor)),
                        (_, true) => {
                            let both = nearer.into_iter().zip([-0.5, 0.5]);
                            slopes.extend(both.map(|(side, half)| (side, half * factor)));
                        }
                    }
                    Vertex::new(Point::new(at_x.x, at_y.y) + radius * factor, &slopes)
                })
            };
            (0..4).flat_map(corner).collect()
        }
    };
    if turn < 0.0 {
        vertices.reverse();
    }
    vertices
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
