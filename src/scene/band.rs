//! Bands: areas that are lines of even width, with square ends and mitred corners.
//!
//! A stroke is swept by a disc, so its ends and corners are round. What a pen with square ends draws is an area here, and a
//! `<path>` with a stroke in the file, so that editors show its line and its width.
//!
//! Rings *are* a band if their points are those of [`Band::rings`]: each point of the line has one to either side of it. The
//! points of an open band go along one side and back along the other one; a closed band has a ring for each side. Control
//! points lie where the sides of the line's control polygon meet.

use super::grid::MIN_WIDTH;
use super::path::{Path, PathPoint};
use super::polyline::{CLEAR, Turn, directions, polyline, turns};
use super::shape::Shape;
use super::written_path::spacing;
use super::{Area, Mark, Stroke};
use crate::math::Point;

/// A line of even width with square ends and mitred corners, as SVG's `stroke-linecap="butt"` and
/// `stroke-linejoin="miter"` draw it.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// The middle, px.
    pub line: Path,
    /// The width, px.
    pub width: f32,
}

/// SVG cuts corners off that reach farther than 4 half widths. This is the sum of 1 and the cosine of their turn, with
/// a little to spare.
const SHARPEST: f64 = 0.13;

/// Cosine of the sharpest turn at a control point: the sides of sharper curves are no parabolas.
const SHARPEST_CURVE: f64 = 0.5;

/// A rectangle is a line, px: at most so wide, and at least so many times as long.
const THIN_PX: f32 = 6.0;
const SLENDER: f32 = 2.0;

impl Band {
    /// The rings of an area that looks like the band: one, or two of a closed one.
    pub fn rings(&self) -> Vec<Path> {
        let points = self.line.points();
        let sides = sides(points, self.line.is_closed()).unwrap_or_default();
        let beside = |sign: f64| {
            let moved = points.iter().zip(&sides).map(move |(p, side)| PathPoint {
                at: moved(p.at, side, 0.5 * sign * f64::from(self.width)),
                is_on: p.is_on,
            });
            moved.collect::<Vec<_>>()
        };
        let (left, mut right) = (beside(1.0), beside(-1.0));
        right.reverse();
        match self.line.is_closed() {
            true => vec![Path::of_points(left, true), Path::of_points(right, true)],
            false => vec![Path::of_points([left, right].concat(), true)],
        }
    }

    /// The band that these rings are the rings of.
    pub fn of(rings: &[Path]) -> Option<Self> {
        if let [ring] = rings
            && let Some(Shape::Rect { low, high, .. }) = Shape::of(ring)
        {
            let sides = high - low;
            let is_line = sides.min() <= THIN_PX && sides.max() >= SLENDER * sides.min();
            if !is_line {
                return None;
            }
        }
        let points: Vec<PathPoint> = rings.iter().flat_map(Path::points).copied().collect();
        let band = Self::between(&points, rings)?;
        let near = 4.0 * rings.iter().map(spacing).fold(0.0, f32::max);
        (band.is_sound() && band.deviation(&points)? <= near).then_some(band)
    }

    /// The band that these rings, those of a polygon or of a frame, are within a `tolerance` in px; a long one of several.
    pub(crate) fn like(rings: &[Path], tolerance: f32) -> Option<Self> {
        let straight = |ring: &Path| polyline(ring, tolerance, 0.0).unwrap_or_else(|| ring.clone());
        let rings: &[Path] = &rings.iter().map(straight).collect::<Vec<_>>();
        let points: Vec<PathPoint> = rings.iter().flat_map(Path::points).copied().collect();
        if points.len() > MOST_POINTS || points.len() % 2 > 0 {
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
        let senses = [points, reversed];
        let turns = senses
            .iter()
            .flat_map(|points| (0..points.len()).map(move |by| turned(points, by)));
        let bands = turns.filter_map(|points| {
            let band = Self::between(&points, rings)?;
            let is_like = band.is_sound() && band.deviation(&points)? <= tolerance;
            (is_like && band.slenderness() >= LONG).then_some(band)
        });
        bands.max_by(|a, b| a.slenderness().total_cmp(&b.slenderness()))
    }

    /// The band along a path, or the [`polyline`] that it is within a `tolerance` of, that goes on `beyond` its ends, px.
    pub(crate) fn along(
        path: &Path,
        width: f32,
        beyond: [f32; 2],
        [tolerance, radius]: [f32; 2],
    ) -> Option<Self> {
        let polyline = polyline(path, tolerance, radius);
        let mut points = polyline.as_ref().unwrap_or(path).points().to_vec();
        let last = points.len().checked_sub(1).filter(|&last| last > 0)?;
        if !path.is_closed() {
            for ([end, inner], px) in [[0, 1], [last, last - 1]].into_iter().zip(beyond) {
                let (end_at, inner_at) = (points[end].at, points[inner].at);
                let away = (end_at - inner_at).try_normalize(0.0)?;
                points[end].at = end_at + away * px;
            }
        }
        let line = Path::new(points, path.is_closed()).ok()?;
        Some(Self { line, width }).filter(Self::is_sound)
    }

    /// True if its ends or some of its corners show that it is no stroke.
    pub(crate) fn is_told(&self) -> bool {
        let points = self.line.points();
        let is_clear = |(p, turn): (&PathPoint, &Turn)| p.is_on && turn.cosine < CLEAR;
        let has_corner = || {
            points
                .iter()
                .zip(turns(points, true)?)
                .any(|(p, turn)| is_clear((p, &turn)))
                .then_some(())
        };
        !self.line.is_closed() || has_corner().is_some()
    }

    /// The band as an area in the colour and opacity of a stroke.
    pub(crate) fn area(&self, stroke: &Stroke) -> Area {
        Area {
            rings: self.rings(),
            color: stroke.color,
            opacity: stroke.opacity,
            shade: None,
        }
    }

    /// Length of the line in widths.
    pub(crate) fn slenderness(&self) -> f32 {
        let line = self.line.flattened(0.1);
        let lengths = line.windows(2).map(|ends| (ends[1] - ends[0]).norm());
        lengths.sum::<f32>() / self.width
    }

    /// True if SVG draws the band as its rings.
    pub(crate) fn is_sound(&self) -> bool {
        let (points, is_closed) = (self.line.points(), self.line.is_closed());
        let Some(turns) = turns(points, is_closed) else {
            return false;
        };
        let half = 0.5 * f64::from(self.width);
        let count = points.len();
        let is_turn = |(p, turn): (&PathPoint, &Turn)| match p.is_on {
            true => 1.0 + turn.cosine >= SHARPEST,
            false => turn.cosine >= SHARPEST_CURVE,
        };
        // Both corners of a leg have room for their inner sides.
        let has_room = |i: usize| {
            let (a, b) = (i, (i + 1) % count);
            let length = f64::from((points[b].at - points[a].at).norm());
            half * (turns[a].tangent + turns[b].tangent) <= length
        };
        let legs = if is_closed { count } else { count - 1 };
        let length = |i: usize| (points[(i + 1) % count].at - points[i].at).norm();
        f64::from(self.width) >= MIN_WIDTH
            && (0..legs).map(length).sum::<f32>() >= self.width
            && self.width.is_finite()
            && points.iter().zip(&turns).all(is_turn)
            && (0..legs).all(has_room)
    }

    /// The band near to the points of this band's rings, each a little beside its place.
    pub(crate) fn near(&self, places: &[[f32; 2]]) -> Option<Self> {
        let flags = self.line.points().iter().map(|p| p.is_on);
        let flags = flags.clone().chain(flags.rev());
        let points = places.iter().zip(flags).map(|(&at, is_on)| PathPoint {
            at: at.into(),
            is_on,
        });
        between(&points.collect::<Vec<_>>(), self.line.is_closed())
    }

    /// Moves points to those of the rings.
    pub(crate) fn put(&self, places: &mut [[f32; 2]]) {
        let rings = self.rings();
        let points = rings.iter().flat_map(Path::points);
        places
            .iter_mut()
            .zip(points)
            .for_each(|(place, point)| *place = point.at.into());
    }

    /// Leaves of a change of these points the part that keeps the band: the change of its line and of its width.
    pub(crate) fn project(&self, change: &mut [[f32; 2]]) {
        let Some(sides) = sides(self.line.points(), self.line.is_closed()) else {
            return;
        };
        let half = sides.len();
        let pair = |change: &[[f32; 2]], i: usize| [change[i], change[2 * half - 1 - i]];
        let width = width(&sides, |i| pair(change, i));
        for (i, side) in sides.iter().enumerate() {
            let [a, b] = pair(change, i);
            for axis in 0..2 {
                let middle = 0.5 * (a[axis] + b[axis]);
                let away = (0.5 * width * side[axis]) as f32;
                change[i][axis] = middle + away;
                change[2 * half - 1 - i][axis] = middle - away;
            }
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
        let is_paired = (0..half).all(|i| points[i].is_on == points[points.len() - 1 - i].is_on);
        let has_ends =
            is_closed || points.first()?.is_on && points.get(half.checked_sub(1)?)?.is_on;
        let is_even = points.len() % 2 == 0 && half >= if is_closed { 3 } else { 2 };
        (is_even && is_paired && has_ends).then(|| between(points, is_closed))?
    }

    /// Farthest that one of these points is from its place, px.
    fn deviation(&self, points: &[PathPoint]) -> Option<f32> {
        let rings = self.rings();
        let own = rings.iter().flat_map(Path::points);
        let away = own.zip(points).map(|(a, b)| (a.at - b.at).amax());
        away.max_by(f32::total_cmp)
    }
}

impl Mark {
    /// The band that it is, if it is an area that is one.
    pub fn band(&self) -> Option<Band> {
        self.as_area()?.band()
    }
}

impl Area {
    /// The band that it is, so that its file draws it as a stroke.
    pub fn band(&self) -> Option<Band> {
        self.shade.is_none().then(|| Band::of(&self.rings))?
    }

    /// The area with its rings turned if it is a band, so that it looks the same and is none.
    #[must_use]
    pub(crate) fn filled(mut self) -> Self {
        if self.band().is_none() {
            return self;
        }
        let reversed = |ring: &Path| {
            let points = ring.points().iter().rev().copied();
            Path::of_points(points.collect(), true)
        };
        self.rings = self.rings.iter().map(reversed).collect();
        self
    }
}

/// Most points of rings that are compared with bands.
const MOST_POINTS: usize = 64;

/// An area is a band if it is at least so many times as long as wide.
const LONG: f32 = 2.5;

/// For each point of a line the way to its left side, in units of half the width; `None` if there is none, as points
/// coincide or the line turns back.
fn sides(points: &[PathPoint], is_closed: bool) -> Option<Vec<[f64; 2]>> {
    let side = |[[ux, uy], [vx, vy]]: [[f64; 2]; 2]| {
        let whole = 1.0 + ux * vx + uy * vy;
        (whole > 0.01).then(|| [-(uy + vy) / whole, (ux + vx) / whole])
    };
    directions(points, is_closed)?
        .into_iter()
        .map(side)
        .collect()
}

fn moved(p: Point, side: &[f64; 2], by: f64) -> Point {
    let at = |px: f32, axis: usize| (f64::from(px) + by * side[axis]) as f32;
    Point::new(at(p.x, 0), at(p.y, 1))
}

/// The line amid pairs of points, the first with the last one, and the width that suits them best.
fn between(points: &[PathPoint], is_closed: bool) -> Option<Band> {
    let half = points.len() / 2;
    let pair = |i: usize| [points[i].at, points[points.len() - 1 - i].at];
    let middle = |i: usize| {
        let [a, b] = pair(i);
        let at = |a: f32, b: f32| (0.5 * (f64::from(a) + f64::from(b))) as f32;
        PathPoint {
            at: Point::new(at(a.x, b.x), at(a.y, b.y)),
            is_on: points[i].is_on,
        }
    };
    let line: Vec<PathPoint> = (0..half).map(middle).collect();
    let sides = sides(&line, is_closed)?;
    let width = width(&sides, |i| pair(i).map(<[f32; 2]>::from)) as f32;
    (width > 0.0).then(|| Band {
        line: Path::of_points(line, is_closed),
        width,
    })
}

/// The width for which points beside a line are nearest to pairs, by least squares.
fn width(sides: &[[f64; 2]], pair: impl Fn(usize) -> [[f32; 2]; 2]) -> f64 {
    let (mut along, mut square) = (0.0, f64::MIN_POSITIVE);
    for (i, side) in sides.iter().enumerate() {
        let [a, b] = pair(i);
        for axis in 0..2 {
            along += side[axis] * (f64::from(a[axis]) - f64::from(b[axis]));
            square += side[axis] * side[axis];
        }
    }
    along / square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    fn line(points: &[([f32; 2], bool)], closed: bool) -> Path {
        let point = |&(at, is_on): &([f32; 2], bool)| PathPoint {
            at: at.into(),
            is_on,
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
    fn rings_are_their_band_and_moved_ones_are_none() {
        for band in bands() {
            let rings = band.rings();
            let found = Band::of(&rings).unwrap();
            let pairs = found.line.points().iter().zip(band.line.points());
            assert!(pairs.into_iter().all(|(a, b)| (a.at - b.at).amax() < 1e-4));
            assert!((found.width - band.width).abs() < 1e-4);
            let mut points = rings[0].points().to_vec();
            points[1].at.x += 0.01;
            let moved = [vec![Path::new(points, true).unwrap()], rings[1..].to_vec()].concat();
            assert_eq!(Band::of(&moved), None);
        }
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

    #[test]
    fn rings_of_moved_points_are_restored_to_a_band() {
        for band in bands() {
            let rings = band.rings();
            let points = rings.iter().flat_map(Path::points);
            let mut places: Vec<[f32; 2]> = points.map(|p| p.at.into()).collect();
            for (i, place) in places.iter_mut().enumerate() {
                let (sin, cos) = math::sin_cos(2.0 * i as f32);
                *place = [place[0] + 0.1 * sin, place[1] + 0.1 * cos];
            }
            band.near(&places).unwrap().put(&mut places);
            let mut rest = places.iter();
            let restored = rings.iter().map(|ring| {
                let points = ring.points().iter().zip(rest.by_ref());
                let points = points.map(|(p, &at)| PathPoint {
                    at: at.into(),
                    ..*p
                });
                Path::new(points.collect(), true).unwrap()
            });
            let restored: Vec<Path> = restored.collect();
            assert!(Band::of(&restored).is_some());
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
    fn a_rectangle_is_a_line_if_it_is_thin() {
        let level = |width| Band {
            line: line(&[([10.0, 10.0], true), ([70.0, 10.0], true)], false),
            width,
        };
        assert!(Band::of(&level(3.0).rings()).is_some());
        assert!(Band::of(&level(9.0).rings()).is_none());
        let rect = Shape::rect([[10.0, 8.5].into(), [70.0, 11.5].into()], 0.0);
        assert_eq!(Band::of(&[rect.ring()]), None);
    }
}
