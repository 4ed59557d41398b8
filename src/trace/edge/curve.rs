//! Rings of segments, shapes and lines, as functions of few numbers.
//!
//! A ring is a list of vertices with a segment behind each. The *unknowns* of a ring are its numbers in the order of
//! [`Ring::unknowns`]: the vertices, then the bulge of each arc and the control points of each cubic; a shape has those of its element.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::line::Line;
use super::segment::{
    Knot, Segment, TOLERANCE, Vertex, own_unknowns, path_of, polyline, set_values, turn, turned,
    values_of,
};
use crate::math::{self, Point, Vec2};
use crate::scene::{Path, Shape};

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
    /// What a line covers.
    Line(Line),
}

impl Ring {
    /// The number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        match self {
            Self::Shape { shape, .. } => numbers(shape).len(),
            Self::Knots(knots) => {
                let own: usize = knots.iter().map(|knot| knot.segment.unknowns()).sum();
                2 * knots.len() + own
            }
            Self::Line(line) => line.radius_index() + line.radii(),
        }
    }

    /// The values of the unknowns.
    pub(super) fn values(&self) -> Vec<f64> {
        match self {
            Self::Shape { shape, .. } => numbers(shape),
            Self::Knots(knots) => values_of(knots, knots.len()),
            Self::Line(line) => {
                let mut values = values_of(&line.knots, line.segments());
                let radii = line.knots.iter().take(line.radii());
                values.extend(radii.map(|knot| knot.radius));
                values
            }
        }
    }

    /// The ring with these values of the unknowns.
    pub(super) fn with(&self, values: &[f64]) -> Self {
        let mut ring = self.clone();
        match &mut ring {
            Self::Shape { shape, .. } => *shape = with_numbers(shape, values),
            Self::Knots(knots) => set_values(knots, values),
            Self::Line(line) => {
                set_values(&mut line.knots, values);
                let radii = &values[line.radius_index()..];
                for (i, knot) in line.knots.iter_mut().enumerate() {
                    // One of all, or one of each.
                    knot.radius = radii[i.min(radii.len() - 1)].max(LEAST_RADIUS);
                }
            }
        }
        ring
    }

    /// The ring as a path; one that is `alone` may be an element of its own. Arcs of up to 100° are cubics, which have fewer numbers
    /// and are as near as 0.0003 of the radius.
    pub(in crate::trace) fn path(&self, is_alone: bool) -> Path {
        let knots = match self {
            Self::Shape { shape, .. } if is_alone => return with_radius(shape).path(),
            Self::Shape { shape, turn } => &knots(shape, *turn),
            Self::Knots(knots) => knots,
            Self::Line(line) => return path_of(&line.knots, line.is_closed),
        };
        path_of(knots, true)
    }

    /// Its segments, which go on smoothly but for the corners of a sharp rectangle.
    pub(super) fn segmented(&self) -> Vec<Knot> {
        match self {
            Self::Shape { shape, turn } => {
                let is_sharp = matches!(shape, Shape::Rect { radius: 0.0, .. });
                let mut knots = knots(shape, *turn);
                knots.iter_mut().for_each(|knot| knot.is_smooth = !is_sharp);
                knots
            }
            ring => ring.knots().to_vec(),
        }
    }

    /// True if an element of its own takes fewer numbers than a part of a path.
    pub(in crate::trace) fn is_shorter_alone(&self) -> bool {
        match self {
            Self::Shape {
                shape: Shape::Rect { radius, .. },
                ..
            } => *radius > 0.0,
            Self::Shape { .. } => true,
            Self::Knots(_) | Self::Line(_) => false,
        }
    }

    /// The change of each unknown that moves the ring by about a px.
    pub(super) fn units(&self) -> Vec<f64> {
        let mut units = vec![1.0; self.unknowns()];
        let knots = self.knots();
        if !knots.is_empty() {
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
            Self::Line(line) => line.freedom(),
        };
        count as f64
    }

    /// The number of segments: 1 of a shape.
    pub(super) fn segments(&self) -> usize {
        match self {
            Self::Shape { .. } | Self::Line(_) => 1,
            Self::Knots(knots) => knots.len(),
        }
    }

    /// The polyline that replaces segment `i`, with the derivatives of its vertices; without its end, if that is its start.
    fn segment(&self, i: usize, own: usize) -> Vec<Vertex> {
        match self {
            Self::Shape { shape, turn } => around(shape, *turn),
            Self::Knots(knots) => polyline(knots, i, own),
            Self::Line(line) => line.outline(),
        }
    }

    /// The polyline that replaces segment `i`, with its end.
    pub(super) fn polyline_of(&self, i: usize, owns: &[usize]) -> Vec<Vertex> {
        let mut vertices = self.segment(i, owns[i]);
        match self {
            // What is a ring by itself ends where it starts.
            Self::Shape { .. } | Self::Line(_) => vertices.push(vertices[0]),
            Self::Knots(_) => {}
        }
        vertices
    }

    /// The vertices of the ring, or of its middle.
    pub(super) fn knots(&self) -> &[Knot] {
        match self {
            Self::Shape { .. } => &[],
            Self::Knots(knots) => knots,
            Self::Line(line) => &line.knots,
        }
    }

    /// The vertices at which a segment goes on in the direction of the one before.
    pub(super) fn smooth(&self) -> impl Iterator<Item = usize> + '_ {
        let knots = self.knots().iter().enumerate();
        knots.filter(|(_, knot)| knot.is_smooth).map(|(i, _)| i)
    }

    /// The index of the first unknown of each segment besides its vertices.
    pub(super) fn owns(&self) -> Vec<usize> {
        match self {
            Self::Shape { .. } => vec![0],
            Self::Knots(knots) => own_unknowns(knots).collect(),
            Self::Line(line) => own_unknowns(&line.knots).collect(),
        }
    }

    /// The angle at vertex `i`, rad.
    pub(super) fn angle(&self, i: usize) -> f64 {
        let knots = self.knots();
        let count = knots.len();
        turn(&[(i + count - 1) % count, i, (i + 1) % count].map(|k| knots[k]))
    }

    /// The angle at vertex `i`, rad, with its derivatives by the unknowns.
    pub(super) fn joint(&self, i: usize, owns: &[usize]) -> (f64, Vec<(usize, f64)>) {
        let knots = self.knots();
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

/// Least radius of a line, px: what it covers of a pixel is proportional to it, so that it goes on down to there.
const LEAST_RADIUS: f64 = 0.1;

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
        radius: 0.0,
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
                    radius: 0.0,
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
