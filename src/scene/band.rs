//! Bands: lines of even width with square ends and mitred corners, as strokes with [`Cap::Butt`] have them.
//!
//! A band covers an area too: each point of the line has one to either side of it. The rings of an open band go along one
//! side and back along the other one; a closed band has a ring for each side. Control points lie where the sides of the line's
//! control polygon meet. So the points of the rings depend on those of the line, and on the width.

use super::grid::MIN_WIDTH;
use super::path::Path;
use super::piece::{PathPoint, PointKind};
use super::polyline::{CLEAR, Turn, directions, polyline, turns};
use super::shape::EXACT;
use super::{Area, Cap, Mark, Stroke};
use crate::math::{self, Point, Vec2};

/// A line of even width with square ends and mitred corners, as SVG's `stroke-linecap="butt"` and
/// `stroke-linejoin="miter"` draw it.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// The middle, px.
    pub line: Path,
    /// The width, px.
    pub width: f64,
}

/// SVG cuts corners off that reach farther than 4 half widths. This is the sum of 1 and the cosine of their turn, with
/// a little to spare.
const SHARPEST: f64 = 0.13;

/// Cosine of the sharpest turn at a control point: the sides of sharper curves are no parabolas.
const SHARPEST_CURVE: f64 = 0.5;

/// Farthest that quadratic curves are from the cubic curves and arcs of a line that they stand for, px.
const BESIDE_LINE: f64 = 0.02;

/// A rectangle is a line, px: at most so wide, and at least so many times as long.
const THIN_PX: f64 = 6.0;
const SLENDER: f64 = 2.0;

impl Band {
    /// The rings of an area that looks like the band: one, or two of a closed one.
    pub fn rings(&self) -> Vec<Path> {
        let points = self.line.points();
        let is_closed = self.line.is_closed();
        let sides = sides(points, is_closed).unwrap_or_else(|| any_sides(points, is_closed));
        let beside = |sign: f64| {
            let moved = points.iter().zip(&sides).map(move |(p, side)| PathPoint {
                at: p.at + 0.5 * sign * self.width * *side,
                kind: p.kind,
            });
            moved.collect::<Vec<_>>()
        };
        // Back along the other side: an open band is one ring, and of a closed one the inner ring becomes a hole.
        let (left, mut right) = (beside(1.0), beside(-1.0));
        right.reverse();
        match self.line.is_closed() {
            true => vec![Path::of_points(left, true), Path::of_points(right, true)],
            false => vec![Path::of_points([left, right].concat(), true)],
        }
    }

    /// The band whose rings are within a `tolerance` in px of these rings of a polygon or a frame; the longest of several.
    pub(crate) fn like(rings: &[Path], tolerance: f64) -> Option<Self> {
        let straight = |ring: &Path| polyline(ring, tolerance, 0.0).unwrap_or_else(|| ring.clone());
        let rings: &[Path] = &rings.iter().map(straight).collect::<Vec<_>>();
        let points: Vec<PathPoint> = rings.iter().flat_map(Path::points).copied().collect();
        if points.len() > MOST_POINTS || !points.len().is_multiple_of(2) {
            return None;
        }
        let mut reversed = points.clone();
        reversed.reverse();
        let half = points.len() / 2;
        let turned = |points: &[PathPoint], by: usize| {
            let mut points = points.to_vec();
            match rings.len() {
                1 => points.rotate_left(by),
                // Of a frame, the inner corners are turned against the outer ones.
                _ => points[half..].rotate_left(by % half),
            }
            points
        };
        // Rings may begin anywhere and go either way: every start in both senses is a candidate, and the slenderest band wins.
        let senses = [points, reversed];
        let turns = senses
            .iter()
            .flat_map(|points| (0..points.len()).map(move |by| turned(points, by)));
        let bands = turns.filter_map(|points| {
            let band = Self::between(&points, rings)?;
            let is_like =
                band.is_sound() && band.deviation(&points)? <= tolerance && !band.is_box(tolerance);
            (is_like && band.slenderness() >= LONG).then_some(band)
        });
        bands.max_by(|a, b| a.slenderness().total_cmp(&b.slenderness()))
    }

    /// The band along a path, or the [`polyline`] that it is within a `tolerance` of, that goes on `beyond` its ends, px.
    pub(crate) fn along(
        path: &Path,
        width: f64,
        beyond: [f64; 2],
        [tolerance, radius]: [f64; 2],
    ) -> Option<Self> {
        let polyline = polyline(path, tolerance, radius);
        let mut points = polyline.as_ref().unwrap_or(path).points().to_vec();
        let last = points.len().checked_sub(1).filter(|&last| last > 0)?;
        if !path.is_closed() {
            for ([end, inner], px) in [[0, 1], [last, last - 1]].into_iter().zip(beyond) {
                let (end_at, inner_at) = (points[end].at, points[inner].at);
                let away = (end_at - inner_at).normalize();
                let away = Some(away).filter(|away| away.is_finite())?;
                points[end].at = end_at + away * px;
            }
        }
        let line = Path::new(points, path.is_closed()).ok()?;
        Some(Self { line, width }).filter(Self::is_sound)
    }

    /// True if its ends or some of its corners show that it is no stroke.
    pub(crate) fn is_told(&self) -> bool {
        let points = self.line.points();
        let is_clear = |(p, turn): (&PathPoint, &Turn)| p.is_on() && turn.cosine < CLEAR;
        let has_corner = || {
            points
                .iter()
                .zip(turns(points, true)?)
                .any(|(p, turn)| is_clear((p, &turn)))
                .then_some(())
        };
        !self.line.is_closed() || has_corner().is_some()
    }

    /// True if it is a rectangle rather than a line: level or upright, and wide.
    fn is_box(&self, tolerance: f64) -> bool {
        let [a, b] = self.line.points() else {
            return false;
        };
        let way = b.at - a.at;
        let is_along = way.x.abs().min(way.y.abs()) <= tolerance;
        let is_line = self.width <= THIN_PX && way.hypot() >= SLENDER * self.width;
        is_along && !is_line
    }

    /// The stroke with square ends in the colour and opacity of another one.
    pub(crate) fn stroke(self, like: &Stroke) -> Stroke {
        Stroke {
            path: self.line,
            radius: 0.5 * self.width,
            radii: Vec::new(),
            cap: Cap::Butt,
            ..like.clone()
        }
    }

    /// Length of the line in widths.
    pub(crate) fn slenderness(&self) -> f64 {
        let line = self.line.flattened(0.1);
        let lengths = line.windows(2).map(|ends| (ends[1] - ends[0]).hypot());
        lengths.sum::<f64>() / self.width
    }

    /// True if SVG draws the band as its rings.
    pub(crate) fn is_sound(&self) -> bool {
        let (points, is_closed) = (self.line.points(), self.line.is_closed());
        let Some(turns) = turns(points, is_closed) else {
            return false;
        };
        let half = 0.5 * self.width;
        let count = points.len();
        let is_turn = |(p, turn): (&PathPoint, &Turn)| match p.is_on() {
            true => 1.0 + turn.cosine >= SHARPEST,
            false => turn.cosine >= SHARPEST_CURVE,
        };
        // A turn of θ shortens the inner side of a leg by half the width × tan(θ/2). Both corners of a leg have room for that.
        let has_room = |i: usize| {
            let (a, b) = (i, (i + 1) % count);
            let length = (points[b].at - points[a].at).hypot();
            half * (turns[a].tangent + turns[b].tangent) <= length
        };
        let legs = if is_closed { count } else { count - 1 };
        let length = |i: usize| (points[(i + 1) % count].at - points[i].at).hypot();
        self.width >= MIN_WIDTH
            && (0..legs).map(length).sum::<f64>() >= self.width
            && self.width.is_finite()
            && points.iter().zip(&turns).all(is_turn)
            && (0..legs).all(has_room)
    }

    /// The band whose rings have points near to these, of these kinds.
    pub(crate) fn near(places: &[[f32; 2]], kinds: &[PointKind], is_closed: bool) -> Option<Self> {
        let points = places.iter().zip(kinds).map(|(&at, &kind)| PathPoint {
            at: math::point(at),
            kind,
        });
        between(&points.collect::<Vec<_>>(), is_closed)
    }

    /// Moves points to the points of the rings.
    pub(crate) fn put(&self, places: &mut [[f32; 2]]) {
        let rings = self.rings();
        let points = rings.iter().flat_map(Path::points);
        let pairs = places.iter_mut().zip(points);
        pairs.for_each(|(place, point)| *place = math::xy(point.at));
    }

    /// Projects a change of these points onto the changes that keep the band: of its line and of its width.
    pub(crate) fn project(&self, change: &mut [[f32; 2]]) {
        let Some(sides) = sides(self.line.points(), self.line.is_closed()) else {
            return;
        };
        let half = sides.len();
        let pair =
            |change: &[[f32; 2]], i: usize| [i, 2 * half - 1 - i].map(|k| math::point(change[k]));
        // To first order the sides keep their directions: the line moves by the mean of a pair, the width by its difference.
        let width = width(&sides, |i| pair(change, i));
        for (i, &side) in sides.iter().enumerate() {
            let [a, b] = pair(change, i);
            let (middle, away) = (a.midpoint(b), 0.5 * width * side);
            change[i] = math::xy(middle + away);
            change[2 * half - 1 - i] = math::xy(middle - away);
        }
    }

    /// The band of points in the order of [`Band::rings`].
    fn between(points: &[PathPoint], rings: &[Path]) -> Option<Self> {
        let half = points.len() / 2;
        let is_closed = match rings {
            [_] => false,
            [a, b] => {
                if a.points().len() != b.points().len() {
                    return None;
                }
                true
            }
            _ => return None,
        };
        let is_paired = (0..half).all(|i| points[i].kind == points[points.len() - 1 - i].kind);
        let has_ends =
            is_closed || points.first()?.is_on() && points.get(half.checked_sub(1)?)?.is_on();
        let is_even = points.len().is_multiple_of(2) && half >= if is_closed { 3 } else { 2 };
        (is_even && is_paired && has_ends).then(|| between(points, is_closed))?
    }

    /// Farthest that one of these points is from its place, px.
    fn deviation(&self, points: &[PathPoint]) -> Option<f64> {
        let rings = self.rings();
        let own = rings.iter().flat_map(Path::points);
        let away = own.zip(points).map(|(a, b)| a.at - b.at);
        let away = away.map(|by| by.x.abs().max(by.y.abs()));
        away.max_by(f64::total_cmp)
    }
}

impl Stroke {
    /// The line with square ends that it is, if it is one.
    pub(crate) fn band(&self) -> Option<Band> {
        // The sides of other curves are found from quadratic ones.
        let band = || Band {
            line: self.path.quadratic(BESIDE_LINE),
            width: 2.0 * self.radius,
        };
        (self.cap == Cap::Butt).then(band)
    }
}

impl Mark {
    /// This mark, as the area that looks like it if it is a stroke with square ends or one whose width varies.
    #[must_use]
    pub fn filled(self) -> Self {
        let rings = self
            .as_stroke()
            .and_then(|stroke| match stroke.is_varying() {
                true => Some(stroke.border()),
                false => Some(stroke.band()?.rings()),
            });
        match rings {
            Some(rings) => Area::plain(rings, self.color(), self.opacity()).into(),
            None => self,
        }
    }

    /// This mark as the shapes, or as the stroke with square ends, that its coordinates are exactly those of: arrays of coordinates
    /// have no more of it. The inverse of [`filled`](Self::filled).
    #[must_use]
    pub fn recognised(self) -> Self {
        let band = |area: &Area| {
            let points: Vec<PathPoint> =
                area.rings.iter().flat_map(Path::points).copied().collect();
            let band = Band::between(&points, &area.rings)?;
            let is_line = band.is_sound() && !band.is_box(EXACT) && band.slenderness() >= LONG;
            (is_line && band.deviation(&points)? < EXACT).then_some(band)
        };
        match self {
            Self::Area(area) => match band(&area) {
                Some(band) => Self::Stroke(Stroke {
                    path: band.line,
                    radius: 0.5 * band.width,
                    radii: Vec::new(),
                    cap: Cap::Butt,
                    color: area.color,
                    opacity: area.opacity,
                }),
                None => Self::Area(Area {
                    rings: area.rings.into_iter().map(Path::recognised).collect(),
                    ..area
                }),
            },
            Self::Stroke(stroke) => Self::Stroke(Stroke {
                path: stroke.path.recognised(),
                ..stroke
            }),
        }
    }
}

/// Most points of rings that are compared with bands.
const MOST_POINTS: usize = 64;

/// An area is a band if it is at least so many times as long as wide.
const LONG: f64 = 2.5;

/// For each point of a line the way to its left side, in units of half the width; `None` if there is none, as points
/// coincide or the line turns back.
fn sides(points: &[PathPoint], is_closed: bool) -> Option<Vec<Vec2>> {
    directions(points, is_closed)?
        .into_iter()
        .map(mitre)
        .collect()
}

/// The way to the left side between two directions; `None` if the line turns back.
fn mitre([before, after]: [Vec2; 2]) -> Option<Vec2> {
    let whole = 1.0 + before.dot(after);
    // The bisector of both normals, 1 / cos(θ/2) long at a turn of θ, as |before + after| = 2 cos(θ/2).
    (whole > 0.01).then(|| (before + after).turn_90() / whole)
}

/// The sides of a line of any points, for each of them. Points that coincide share the directions of the legs around them. Where
/// the line turns back or has no direction, both sides meet on it.
fn any_sides(points: &[PathPoint], is_closed: bool) -> Vec<Vec2> {
    let count = points.len();
    let leg = |i: usize| {
        let way = (points[(i + 1) % count].at - points[i].at).normalize();
        Some(way).filter(|way| way.is_finite())
    };
    // The leg behind each point; there is none behind the last one of an open line.
    let legs: Vec<Option<Vec2>> = (0..count)
        .map(|i| (is_closed || i + 1 < count).then(|| leg(i))?)
        .collect();
    // A closed line goes around, so what is carried on from its end is where its start begins.
    let around = |way: Option<&Vec2>| way.copied().filter(|_| is_closed);
    let mut before = around(legs.iter().flatten().next_back());
    let mut after = around(legs.iter().flatten().next());
    let befores = legs.iter().map(|leg| {
        let own = before;
        before = leg.or(before);
        own
    });
    let befores: Vec<_> = befores.collect();
    let afters = legs.iter().rev().map(|leg| {
        after = leg.or(after);
        after
    });
    let mut afters: Vec<_> = afters.collect();
    afters.reverse();
    let pairs = befores.into_iter().zip(afters);
    let sides = pairs.map(|(before, after)| mitre([before.or(after)?, after.or(before)?]));
    sides.map(Option::unwrap_or_default).collect()
}

/// The line amid pairs of points, the first with the last one, and the width that suits them best.
fn between(points: &[PathPoint], is_closed: bool) -> Option<Band> {
    let half = points.len() / 2;
    let pair = |i: usize| [points[i].at, points[points.len() - 1 - i].at];
    let middle = |i: usize| PathPoint {
        at: pair(i)[0].midpoint(pair(i)[1]),
        kind: points[i].kind,
    };
    let line: Vec<PathPoint> = (0..half).map(middle).collect();
    let width = width(&sides(&line, is_closed)?, pair);
    (width > 0.0).then(|| Band {
        line: Path::of_points(line, is_closed),
        width,
    })
}

/// The width for which points beside a line are nearest to pairs, by least squares.
fn width(sides: &[Vec2], pair: impl Fn(usize) -> [Point; 2]) -> f64 {
    let (mut along, mut square) = (0.0, f64::MIN_POSITIVE);
    for (i, side) in sides.iter().enumerate() {
        let [a, b] = pair(i);
        // A pair is the middle ± ½·width·side, so a − b = width·side, and width = Σ side·(a − b) / Σ |side|².
        along += side.dot(a - b);
        square += side.hypot2();
    }
    along / square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    fn line(points: &[([f64; 2], bool)], closed: bool) -> Path {
        let point = |&([x, y], is_on): &([f64; 2], bool)| PathPoint {
            at: Point::new(x, y),
            kind: PointKind::on_if(is_on),
        };
        Path::new(points.iter().map(point).collect(), closed).unwrap()
    }

    fn bands() -> [Band; 4] {
        let corner = [
            ([10.0, 40.5], true),
            ([10.0, 12.0], true),
            ([53.25, 20.0], true),
        ];
        let bend = [
            ([10.0, 40.0], true),
            ([16.0, 18.0], false),
            ([45.0, 10.0], true),
        ];
        let frame = [
            ([10.0, 10.0], true),
            ([90.0, 10.0], true),
            ([60.5, 70.0], true),
        ];
        let single = [([10.0, 10.0], true), ([70.0, 33.0], true)];
        [
            (line(&corner, false), 5.0),
            (line(&bend, false), 4.0),
            (line(&frame, true), 6.5),
            (line(&single, false), 12.0),
        ]
        .map(|(line, width)| Band { line, width })
    }

    #[test]
    fn rings_that_begin_anywhere_and_are_a_little_off_are_like_their_band() {
        for band in bands().into_iter().filter(|band| band.width != 4.0) {
            for by in 0..3 {
                let rings = band.rings().into_iter().map(|ring| {
                    let mut points = ring.points().to_vec();
                    points.rotate_left(by);
                    points[0].at.x += 0.1;
                    Path::new(points, true).unwrap()
                });
                let rings: Vec<Path> = rings.collect();
                let found = Band::like(&rings, 0.3).unwrap();
                assert!((found.width - band.width).abs() < 0.2, "{found:?}");
                assert_eq!(found.line.points().len(), band.line.points().len());
                assert!((found.slenderness() - band.slenderness()).abs() < 0.5);
            }
        }
    }

    /// The points of a band's rings as a descent has them.
    fn points(band: &Band) -> (Vec<[f32; 2]>, Vec<PointKind>) {
        let rings = band.rings();
        let points = rings.iter().flat_map(Path::points);
        points.map(|p| (math::xy(p.at), p.kind)).unzip()
    }

    #[test]
    fn moved_points_are_those_of_a_band_near_to_it() {
        for band in bands() {
            let (mut places, kinds) = points(&band);
            for (i, place) in places.iter_mut().enumerate() {
                let (sin, cos) = math::sin_cos(2.0 * i as f32);
                *place = [place[0] + 0.1 * sin, place[1] + 0.1 * cos];
            }
            let near = Band::near(&places, &kinds, band.line.is_closed()).unwrap();
            assert!((near.width - band.width).abs() < 0.2, "{near:?}");
            near.put(&mut places);
            let again = Band::near(&places, &kinds, band.line.is_closed()).unwrap();
            let pairs = again.line.points().iter().zip(near.line.points());
            assert!(pairs.into_iter().all(|(a, b)| (a.at - b.at).hypot() < 1e-4));
            assert!((again.width - near.width).abs() < 1e-4);
        }
    }

    #[test]
    fn what_keeps_a_band_is_left_of_a_change() {
        for band in bands() {
            let count = band.rings().iter().map(|ring| ring.points().len()).sum();
            let change = |i: usize| <[f32; 2]>::from(math::sin_cos(5.0 * i as f32));
            let mut left: Vec<[f32; 2]> = (0..count).map(change).collect();
            band.project(&mut left);
            // Once more changes nothing, and the rest is at a right angle to it.
            let mut again = left.clone();
            band.project(&mut again);
            let mut pairs = left.iter().flatten().zip(again.iter().flatten());
            assert!(pairs.all(|(a, b)| (a - b).abs() < 1e-5));
            let rest = (0..count).flat_map(change).zip(left.iter().flatten());
            let dot: f32 = rest.map(|(all, left)| (all - left) * left).sum();
            assert!(dot.abs() < 1e-4, "{dot}");
        }
    }

    #[test]
    fn what_svg_would_draw_otherwise_is_no_band() {
        let sharp = [
            ([10.0, 10.0], true),
            ([80.0, 14.0], true),
            ([10.0, 18.0], true),
        ];
        let short = [
            ([10.0, 10.0], true),
            ([40.0, 10.0], true),
            ([40.0, 11.0], true),
        ];
        let sound = |points, width| {
            let line = line(points, false);
            Band { line, width }.is_sound()
        };
        assert!(!sound(&sharp, 3.0));
        assert!(!sound(&short, 3.0));
        assert!(sound(&short, 2.0));
        assert!(!sound(&short, 1.0));
    }

    #[test]
    fn every_point_of_a_line_has_one_on_either_side() {
        let on = |x, y| ([x, y], true);
        let twice = [on(1.0, 5.0), on(4.0, 5.0), on(4.0, 5.0), on(9.0, 5.0)];
        let back = [on(1.0, 5.0), on(9.0, 5.0), on(1.0, 5.0)];
        let places = |points: &[([f64; 2], bool)], closed: bool| {
            let (line, width) = (line(points, closed), 2.0);
            let rings = Band { line, width }.rings();
            let points = rings.iter().flat_map(Path::points).map(|p| p.at);
            points.map(<(f64, f64)>::from).collect::<Vec<_>>()
        };
        let left = [(1.0, 6.0), (4.0, 6.0), (4.0, 6.0), (9.0, 6.0)];
        let right = [(9.0, 4.0), (4.0, 4.0), (4.0, 4.0), (1.0, 4.0)];
        assert_eq!(places(&twice, false), [left, right].concat());
        let forth = [(1.0, 6.0), (9.0, 5.0), (1.0, 4.0)];
        let reversed = [(1.0, 6.0), (9.0, 5.0), (1.0, 4.0)];
        assert_eq!(places(&back, false), [forth, reversed].concat());
        for closed in [false, true] {
            assert_eq!(places(&[on(3.0, 4.0)], closed), [(3.0, 4.0); 2]);
        }
        assert_eq!(places(&[on(f64::NAN, 4.0), on(2.0, 1.0)], true).len(), 4);
    }

    #[test]
    fn a_rectangle_is_a_line_if_it_is_thin() {
        let level = |width| Band {
            line: line(&[([10.0, 10.0], true), ([70.0, 10.0], true)], false),
            width,
        };
        assert!(Band::like(&level(3.0).rings(), 0.3).is_some());
        assert!(Band::like(&level(9.0).rings(), 0.3).is_none());
    }
}
