//! Covers: the parts of a border that other marks hide.

use kurbo::{Line, ParamCurveNearest, Rect};

use crate::fit::drawing::Drawing;
use crate::math::Point;
use crate::scene::{Mark, Rgb, is_inside};

/// Farthest that chords are from a ring that others may lie in, px. A guess.
const FLATNESS: f64 = 0.1;

/// The marks of a drawing as far as they hide others, and its page.
pub(super) struct Occlusion {
    marks: Vec<Cover>,
    page: Rect,
}

/// A mark that hides others: if it is opaque, all below it, and the border of marks of its colour.
struct Cover {
    /// The box around all that it covers.
    extent: Rect,
    is_area: bool,
    /// The rings of an area, or the middle of a stroke.
    lines: Vec<Line>,
    radius: f64,
    color: Rgb,
    is_opaque: bool,
}

impl Occlusion {
    pub(super) fn of(drawing: &Drawing) -> Self {
        let picture = drawing.surface().picture();
        let marks = drawing.free().iter().map(|mark| Cover::of(mark.to_mark()));
        let [width, height] = [picture.width(), picture.height()].map(|side| side as f64);
        Self {
            marks: marks.collect(),
            page: Rect::new(0.0, 0.0, width, height),
        }
    }

    /// True if a place of the border of mark `i` is on the page and no other mark hides it.
    pub(super) fn is_seen(&self, i: usize, p: Point) -> bool {
        let mut others = self.marks.iter().enumerate().filter(|&(k, _)| k != i);
        let hides = |(k, other): (usize, &Cover)| {
            let is_stroke = !other.is_area;
            // An opaque mark on top hides the border. So does a stroke of the same colour, above or below: the two run together.
            (k > i && other.is_opaque && other.has(p, 0.0))
                || (is_stroke && other.is_like(&self.marks[i]) && other.has(p, MELTED))
        };
        self.page.contains(p) && !others.any(hides)
    }
}

/// Farthest beside a stroke that the border of what it runs into may be bent by it, px. A guess.
const MELTED: f64 = 1.0;

/// Marks of more opacity than this hide those below: the last descent leaves some a little short of 1. A guess.
const OPAQUE: f32 = 0.99;

impl Cover {
    fn of(mark: Mark) -> Self {
        // A stroke with square ends covers its rings.
        let mark = mark.filled();
        Self {
            extent: mark.extent(),
            is_area: mark.is_area(),
            lines: mark.lines(FLATNESS),
            radius: mark.radius(),
            color: mark.color(),
            is_opaque: mark.opacity() > OPAQUE,
        }
    }

    /// True if a place lies on the mark, or at most `beside` px beside a stroke.
    fn has(&self, p: Point, beside: f64) -> bool {
        let reach = self.radius + beside;
        let is_near = |line: &Line| line.nearest(p, 0.0).distance_sq <= reach * reach;
        self.extent.inflate(beside, beside).contains(p)
            && match self.is_area {
                true => is_inside(&self.lines, p),
                false => self.lines.iter().any(is_near),
            }
    }

    /// True if two marks have colours that nobody can distinguish.
    fn is_like(&self, other: &Self) -> bool {
        let pairs = self.color.iter().zip(other.color);
        pairs.fold(0.0, |most: f32, (a, b)| most.max((a - b).abs())) < 0.04
    }
}
