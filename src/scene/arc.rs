//! Circular arcs.
//!
//! The **bulge** `k` of an arc is the tangent of a quarter of its sweep: positive where SVG's sweep flag is 1, ±1 for a half
//! circle, 0 for a line. With `d` half of the chord from start to end and `n = (d.y, −d.x)`, all else follows without any angle:
//!
//! ```text
//! halfway point  midpoint + k·n            radius  |d|·(1 + k²) / 2|k|
//! centre         midpoint + n·(k² − 1)/2k  bulge of each half  k / (1 + √(1 + k²))
//! ```
//!
//! A file has the ends, the radius and two flags of an arc. [`Arc::of_numbers`] is the only function from these numbers to the
//! point halfway, for those who round and for those who read, so that both have the same point to the bit.

use kurbo::{CubicBez, Line, PathSeg};

use super::grid::{Grid, MAX_COORDINATE, UNITS_PER_PX, px, units};
use crate::math::{self, Point, Vec2};

/// The bulge of an eighth of a circle: the cubic that stands for it is 4·10⁻⁶ of the radius off.
const EIGHTH: f64 = 0.198_912_367_379_658;

/// Bulges this near to 1 are those of half circles: recomputed from points, they are off by less.
const HALF: f64 = 1e-9;

/// The bulge of the flattest arc that is written as one, a sweep of 0.5°: the radius of a flatter one can't be found again from
/// its points.
const FLATTEST: f64 = 0.002;

/// Farthest that the written arc may be from the arc, px, or in steps of the grid if that is more.
const BESIDE: f64 = 0.05;
const STEPS: f64 = 2.0;

/// The arc of a circle from one point through another one to a third.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Its start, px.
    pub from: Point,
    /// A point that it goes through, px; in a written drawing the point halfway.
    pub through: Point,
    /// Its end, px.
    pub to: Point,
}

/// Numbers of an arc in SVG besides its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ArcNumbers {
    /// The radius in [`units`]. SVG enlarges one below half the chord to that: a half circle.
    pub(crate) radius: i64,
    /// True if the sweep is larger than a half circle.
    pub(crate) is_large: bool,
    /// True if the arc turns clockwise on the page.
    pub(crate) is_clockwise: bool,
}

impl Arc {
    /// The arc of these ends and this bulge, through the point halfway.
    pub fn of_bulge([from, to]: [Point; 2], bulge: f64) -> Self {
        let through = from.midpoint(to) + bulge * normal(from, to);
        Self { from, through, to }
    }

    /// The arc as SVG draws these numbers.
    pub(crate) fn of_numbers(ends: [Point; 2], numbers: ArcNumbers) -> Self {
        let half = 0.5 * length(ends[1] - ends[0]);
        let radius = px(numbers.radius);
        let bulge = if radius <= half {
            1.0
        } else {
            // The centre is √(r² − half²) from the chord.
            let far = radius + ((radius - half) * (radius + half)).sqrt();
            if numbers.is_large {
                far / half
            } else {
                half / far
            }
        };
        Self::of_bulge(ends, if numbers.is_clockwise { bulge } else { -bulge })
    }

    /// The numbers that SVG draws it by. Those of an arc that is not written as one may be far off.
    pub(crate) fn numbers(&self) -> ArcNumbers {
        let bulge = self.bulge();
        let half = 0.5 * length(self.to - self.from);
        let radius = if is_half(bulge) {
            // Any radius up to half the chord does: its decimal if that is exact, else a short one.
            let whole = units(half.floor());
            match units(half) {
                exact if px(exact) == half => exact,
                _ if whole > 0 => whole,
                _ => (half * UNITS_PER_PX as f64).floor() as i64,
            }
        } else {
            units(self.radius())
        };
        ArcNumbers {
            radius,
            is_large: bulge.abs() > 1.0 && !is_half(bulge),
            is_clockwise: bulge > 0.0,
        }
    }

    /// The tangent of a quarter of the sweep; 0 if the three points are in one line or two of them coincide.
    pub fn bulge(&self) -> f64 {
        let (first, second) = (self.through - self.from, self.to - self.through);
        // The angle between the chords of both parts is half the sweep, wherever on the arc the point between them is;
        // and tan(α/2) = sin α / (1 + cos α).
        let bulge = first.cross(second) / (length(first) * length(second) + first.dot(second));
        if bulge.is_finite() && self.from != self.to {
            bulge
        } else {
            0.0
        }
    }

    /// True if it is the line between its ends.
    pub fn is_line(&self) -> bool {
        self.bulge() == 0.0
    }

    /// The point halfway, px.
    pub fn halfway(&self) -> Point {
        Self::of_bulge([self.from, self.to], self.bulge()).through
    }

    /// The radius, px; infinite for a line.
    pub fn radius(&self) -> f64 {
        let bulge = self.bulge().abs();
        0.25 * length(self.to - self.from) * (1.0 + bulge * bulge) / bulge
    }

    /// The centre of its circle, px; not finite for a line.
    pub fn center(&self) -> Point {
        let bulge = self.bulge();
        let away = 0.5 * (bulge * bulge - 1.0) / bulge;
        self.from.midpoint(self.to) + away * normal(self.from, self.to)
    }

    /// The angle that it sweeps, radians; positive if it turns clockwise on the page.
    pub fn sweep(&self) -> f64 {
        4.0 * math::atan(self.bulge())
    }

    /// Both halves.
    fn halves(&self) -> [Self; 2] {
        let (bulge, halfway) = (halved(self.bulge()), self.halfway());
        [[self.from, halfway], [halfway, self.to]].map(|ends| Self::of_bulge(ends, bulge))
    }

    /// Cubic curves in its place, each of at most an eighth of the circle and 4·10⁻⁶ of the radius off; or the line that it is.
    pub(crate) fn beziers(self) -> impl Iterator<Item = PathSeg> {
        let mut bulge = self.bulge();
        let mut chords = vec![[self.from, self.to]];
        while bulge.abs() > EIGHTH {
            let halves = chords.into_iter().flat_map(|[from, to]| {
                let halfway = Self::of_bulge([from, to], bulge).through;
                [[from, halfway], [halfway, to]]
            });
            chords = halves.collect();
            bulge = halved(bulge);
        }
        chords.into_iter().map(move |ends| bezier(ends, bulge))
    }

    /// The points between `ends`, the rounded ends of the arc, of what a file has in its place: another arc, two or more of
    /// them, a cubic curve, or nothing for a line.
    pub(super) fn rounded(&self, ends: [Point; 2], grid: &Grid) -> Vec<Rounded> {
        let aim = Self {
            from: ends[0],
            through: self.halfway(),
            to: ends[1],
        };
        if self.is_flat(grid) {
            return Vec::new();
        }
        if ends[0] != ends[1] && aim.bulge().abs() < FLATTEST {
            return match bezier(ends, aim.bulge()) {
                PathSeg::Cubic(curve) => {
                    vec![Rounded::Cubic([curve.p1, curve.p2].map(|p| grid.point(p)))]
                }
                _ => Vec::new(),
            };
        }
        match aim.nearest_written(grid) {
            // Rounded once more, it is the same.
            Some(arc) if arc.is_flat(grid) => Vec::new(),
            Some(arc) => vec![Rounded::Arc(arc.through)],
            None => {
                let middle = grid.point(aim.through);
                let [first, second] = self.halves();
                let mut points = first.rounded([ends[0], middle], grid);
                points.push(Rounded::On(middle));
                points.extend(second.rounded([middle, ends[1]], grid));
                points
            }
        }
    }

    /// True if a line is within half a step of the grid.
    fn is_flat(&self, grid: &Grid) -> bool {
        length(self.halfway() - self.from.midpoint(self.to)) < 0.5 * grid.step()
    }

    /// The nearest arc of these ends that is read as it is written, if one is near.
    fn nearest_written(&self, grid: &Grid) -> Option<Self> {
        // Near a half circle a step of the radius moves the arc by many: the radius is rounded down and up, with either flag.
        let steps = [grid.below(self.radius()), grid.above(self.radius())];
        let candidates = steps.into_iter().flat_map(|radius| {
            [false, true].map(|is_large| ArcNumbers {
                radius: units(radius),
                is_large,
                is_clockwise: self.bulge() > 0.0,
            })
        });
        let ends = [self.from, self.to];
        let arcs = candidates.map(|numbers| Self::of_numbers(ends, numbers));
        let away = |arc: &Self| length(arc.through - self.through);
        let near = arcs.filter(|arc| {
            away(arc) <= BESIDE.max(STEPS * grid.step())
                && arc.bulge().abs() >= FLATTEST
                && arc.radius() <= MAX_COORDINATE
                && Self::of_numbers(ends, arc.numbers()) == *arc
        });
        near.min_by(|a, b| away(a).total_cmp(&away(b)))
    }
}

/// What a file has between the ends of an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rounded {
    /// A point on the path.
    On(Point),
    /// The point halfway along an arc.
    Arc(Point),
    /// The control points of a cubic curve.
    Cubic([Point; 2]),
}

/// The cubic curve of an arc that sweeps little, or the line that it is.
fn bezier([from, to]: [Point; 2], bulge: f64) -> PathSeg {
    if bulge == 0.0 {
        return PathSeg::Line(Line::new(from, to));
    }
    // The handles are 4/3·r·tan(θ/4) = |chord|·(1 + k²)/3 long, at half the sweep θ from the chord: cos(θ/2) = (1 − k²)/(1 + k²).
    let along = (1.0 - bulge * bulge) / 3.0 * (to - from);
    let beside = 4.0 * bulge / 3.0 * normal(from, to);
    PathSeg::Cubic(CubicBez::new(
        from,
        from + along + beside,
        to - along + beside,
        to,
    ))
}

/// Half of the chord, turned to the side of a positive bulge.
fn normal(from: Point, to: Point) -> Vec2 {
    let half = 0.5 * (to - from);
    Vec2::new(half.y, -half.x)
}

/// The bulge of half an arc.
fn halved(bulge: f64) -> f64 {
    bulge / (1.0 + (1.0 + bulge * bulge).sqrt())
}

fn is_half(bulge: f64) -> bool {
    (bulge.abs() - 1.0).abs() < HALF
}

/// The length of a vector, the same on every platform.
fn length(v: Vec2) -> f64 {
    v.hypot2().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;

    fn random(i: u64) -> [f64; 6] {
        [0, 1, 2, 3, 4, 5].map(|k| 100.0 * f64::from(rng::draw(k, i, 0, 0)))
    }

    fn arc(i: u64) -> Arc {
        let [a, b, c, d, e, f] = random(i);
        Arc {
            from: Point::new(a, b),
            through: Point::new(c, d),
            to: Point::new(e, f),
        }
    }

    #[test]
    fn an_arc_is_the_circle_through_its_points() {
        for arc in (0..500).map(arc) {
            let (center, radius) = (arc.center(), arc.radius());
            for p in [arc.from, arc.through, arc.halfway(), arc.to] {
                let away = (p - center).hypot() - radius;
                assert!(away.abs() < 1e-9 * radius.max(100.0), "{arc:?}: {away}");
            }
            let half = (arc.halfway() - arc.from).hypot() - (arc.to - arc.halfway()).hypot();
            assert!(half.abs() < 1e-9 * radius.max(100.0));
            // The chord is that of the sweep.
            let chord = (2.0 * radius * math::sin(0.5 * arc.sweep())).abs();
            assert!((chord - (arc.to - arc.from).hypot()).abs() < 1e-6 * radius);
            let turned = Arc {
                from: arc.to,
                to: arc.from,
                ..arc
            };
            assert_eq!(turned.sweep(), -arc.sweep());
            assert_eq!(turned.halfway(), arc.halfway());
        }
    }

    #[test]
    fn cubic_curves_keep_within_a_hundred_thousandth_of_the_radius() {
        use kurbo::ParamCurve;
        for arc in (0..500).map(arc) {
            let (center, radius) = (arc.center(), arc.radius());
            let curves: Vec<PathSeg> = arc.beziers().collect();
            assert_eq!(curves[0].start(), arc.from);
            assert_eq!(curves[curves.len() - 1].end(), arc.to);
            for p in curves
                .iter()
                .flat_map(|curve| [0.1, 0.3, 0.5, 0.8].map(|t| curve.eval(t)))
            {
                let away = (p - center).hypot() - radius;
                assert!(away.abs() < 1e-5 * radius, "{arc:?}: {away}");
            }
        }
    }

    #[test]
    fn the_flags_are_those_of_svg() {
        // SVG 2, path data: from (0, 0) to (2, 0), clockwise goes up, as y points down.
        let ends = [Point::ZERO, Point::new(2.0, 0.0)];
        let numbers = |radius: f64, is_large, is_clockwise| ArcNumbers {
            radius: units(radius),
            is_large,
            is_clockwise,
        };
        let up = Arc::of_numbers(ends, numbers(1.25, false, true));
        assert_eq!(
            (up.through, up.center()),
            ((1.0, -0.5).into(), (1.0, 0.75).into())
        );
        let down = Arc::of_numbers(ends, numbers(1.25, true, false));
        assert_eq!(down.through, (1.0, 2.0).into());
        assert!((down.center() - Point::new(1.0, 0.75)).hypot() < 1e-12);
        for small in [0.25, 1.0] {
            let half = Arc::of_numbers(ends, numbers(small, true, true));
            assert_eq!(half.through, (1.0, -1.0).into());
            assert_eq!(half.numbers(), numbers(1.0, false, true));
        }
    }

    #[test]
    fn degenerate_arcs_are_lines() {
        let at = |x: f64| Point::new(x, 3.0);
        for [from, through, to] in [
            [0.0, 1.0, 2.0],
            [0.0, 3.0, 2.0],
            [0.0, -1.0, 2.0],
            [0.0, 0.0, 2.0],
            [0.0, 2.0, 2.0],
            [1.0, 1.0, 1.0],
            [1.0, 2.0, 1.0],
        ] {
            let arc = Arc {
                from: at(from),
                through: at(through),
                to: at(to),
            };
            assert!(arc.is_line(), "{arc:?}");
            assert_eq!(arc.beziers().count(), 1);
            assert_eq!(arc.halfway(), arc.from.midpoint(arc.to));
        }
    }

    #[test]
    fn a_rounded_arc_is_read_as_it_was_written_and_is_near() {
        for precision in 0..=6 {
            let grid = Grid::new(precision);
            for i in 0..2000 {
                let mut arc = arc(i);
                if i % 4 == 1 {
                    // Nearly half circles.
                    let bulge = 1.0 + 0.02 * (random(i)[2] / 100.0 - 0.5);
                    arc = Arc::of_bulge([arc.from, arc.to], bulge);
                }
                if i % 4 == 2 {
                    // Flat ones.
                    arc = Arc::of_bulge([arc.from, arc.to], 0.01 * random(i)[2] / 100.0);
                }
                if i % 4 == 3 {
                    // Nearly circles.
                    let to = arc.from + 0.01 * (arc.to - arc.from);
                    arc = Arc::of_bulge([arc.from, to], 1000.0);
                }
                let ends = [grid.point(arc.from), grid.point(arc.to)];
                let mut from = ends[0];
                let rounded = arc.rounded(ends, &grid);
                let next = |k: usize| match rounded.get(k + 1) {
                    Some(Rounded::On(p)) => *p,
                    _ => ends[1],
                };
                let tolerance = BESIDE.max(STEPS * grid.step()) + grid.step();
                let beside = |p: Point| ((p - arc.center()).hypot() - arc.radius()).abs();
                for (k, point) in rounded.iter().enumerate() {
                    match *point {
                        Rounded::On(p) => {
                            from = p;
                            assert!(beside(p) <= tolerance);
                        }
                        Rounded::Arc(through) => {
                            let ends = [from, next(k)];
                            let [from, to] = ends;
                            let written = Arc { from, through, to };
                            let again = Arc::of_numbers(ends, written.numbers());
                            assert_eq!(written, again, "{precision}");
                            if !is_half(written.bulge()) {
                                let radius = px(written.numbers().radius);
                                assert_eq!(grid.round(radius), radius);
                            }
                            assert!(
                                beside(through) <= tolerance,
                                "{arc:?} {precision}: {through}"
                            );
                        }
                        Rounded::Cubic(_) => assert!(arc.bulge().abs() < 2.0 * FLATTEST),
                    }
                }
            }
        }
    }
}
