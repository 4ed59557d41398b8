//! Covers: what other marks hide of a border.

use crate::fit::drawing::Drawing;
use crate::math::{Point, nearest_on_segment};
use crate::scene::{Mark, Path, Rgb};

/// Farthest that chords are from a ring that others may lie in, px. A guess.
pub(super) const FLATNESS: f32 = 0.1;

/// The marks of a drawing as far as they hide others, and its page.
pub(super) struct Covers {
    marks: Vec<Cover>,
    page: Point,
}

/// A mark that hides others: all that it lies on if it is opaque, and the border of what has its colour.
struct Cover {
    /// The corners of the rings of an area, and the least and most x and y of each.
    rings: Vec<(Vec<Point>, [Point; 2])>,
    /// The middle of a stroke, and the least and most x and y.
    middle: Option<(Vec<Point>, [Point; 2])>,
    radius: f32,
    color: Rgb,
    is_opaque: bool,
}

impl Covers {
    pub(super) fn of(drawing: &Drawing) -> Self {
        let picture = drawing.surface().picture();
        let marks = drawing.free().iter().map(|mark| Cover::of(mark.to_mark()));
        Self {
            marks: marks.collect(),
            page: Point::new(picture.width() as f32, picture.height() as f32),
        }
    }

    /// True if a place of the border of mark `i` is on the page and no other mark hides it.
    pub(super) fn is_seen(&self, i: usize, p: Point) -> bool {
        let mut others = self.marks.iter().enumerate().filter(|&(k, _)| k != i);
        let hides = |(k, other): (usize, &Cover)| {
            (k > i && other.is_opaque && other.has(p, 0.0))
                || (other.middle.is_some() && other.is_like(&self.marks[i]) && other.has(p, MELTED))
        };
        is_within(p, [Point::origin(), self.page], 0.0) && !others.any(hides)
    }
}

/// Farthest beside a stroke that the border of what it runs into may be bent by it, px. A guess.
const MELTED: f32 = 1.0;

/// More opacity than this hides what lies below: the last descent has not made all of it full. A guess.
const OPAQUE: f32 = 0.99;

impl Cover {
    fn of(mark: Mark) -> Self {
        let corners = |path: &Path| {
            let mut corners = path.flattened(FLATNESS);
            if let [dot] = corners[..] {
                corners.push(dot);
            }
            bounded(corners)
        };
        match mark {
            Mark::Area(area) => Self {
                rings: area.rings.iter().map(corners).collect(),
                middle: None,
                radius: 0.0,
                color: area.color,
                is_opaque: area.opacity > OPAQUE,
            },
            Mark::Stroke(stroke) => Self {
                rings: Vec::new(),
                middle: Some(corners(&stroke.path)),
                radius: stroke.radius,
                color: stroke.color,
                is_opaque: stroke.opacity > OPAQUE,
            },
        }
    }

    /// True if a place lies on the mark, or at most `beside` px beside a stroke.
    fn has(&self, p: Point, beside: f32) -> bool {
        let winds = |(corners, bounds): &&(Vec<Point>, [Point; 2])| {
            is_within(p, *bounds, 0.0) && is_inside(p, corners)
        };
        let reach = self.radius + beside;
        let is_near = |(middle, bounds): &(Vec<Point>, [Point; 2])| {
            let ends = |pair: &[Point]| [pair[0], pair[1]].map(|p| [p.x, p.y]);
            let near =
                |pair: &[Point]| nearest_on_segment([p.x, p.y], ends(pair)).1 <= reach * reach;
            is_within(p, *bounds, reach) && middle.windows(2).any(near)
        };
        self.rings.iter().filter(winds).count() % 2 == 1
            || self.middle.as_ref().is_some_and(is_near)
    }

    /// True if two marks have colours that nobody tells apart.
    fn is_like(&self, other: &Self) -> bool {
        let pairs = self.color.iter().zip(other.color);
        pairs.fold(0.0, |most: f32, (a, b)| most.max((a - b).abs())) < 0.04
    }
}

/// True if a place is in a box, or at most `beside` px beside it.
fn is_within(p: Point, [low, high]: [Point; 2], beside: f32) -> bool {
    (low.x - beside..=high.x + beside).contains(&p.x)
        && (low.y - beside..=high.y + beside).contains(&p.y)
}

fn bounded(corners: Vec<Point>) -> (Vec<Point>, [Point; 2]) {
    let first = corners.first().copied().unwrap_or_default();
    let low = corners.iter().fold(first, |low, p| low.inf(p));
    let high = corners.iter().fold(first, |high, p| high.sup(p));
    (corners, [low, high])
}

/// True if a ray from `p` crosses the ring with these corners an odd number of times.
pub(super) fn is_inside(p: Point, corners: &[Point]) -> bool {
    let crosses = |pair: &&[Point]| {
        let (a, b) = (pair[0], pair[1]);
        let is_passed = (a.y > p.y) != (b.y > p.y);
        is_passed && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    corners.windows(2).filter(crosses).count() % 2 == 1
}
