//! Parabolas: the curves of a path, and what contours are made of.

use crate::math::{Point, Vector};

/// A parabola whose control point is at neither end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve(pub(super) [Point; 3]);

impl Curve {
    /// The direction at `t`; that of the end where the curve comes to a halt.
    pub(super) fn direction(self, t: f32) -> Vector {
        let Self([a, c, b]) = self;
        let speed = (c - a) * (1.0 - t) + (b - c) * t;
        let direction = speed.try_normalize(0.0).or((b - c).try_normalize(0.0));
        direction.unwrap_or(Vector::new(1.0, 0.0))
    }

    /// The point `radius` to the left of that at `t`, and the direction there.
    pub(super) fn beside(self, t: f32, radius: f32) -> (Point, Vector) {
        let Self([a, c, b]) = self;
        let direction = self.direction(t);
        (
            on_parabola(a, c, b, t) + left_of(direction) * radius,
            direction,
        )
    }

    /// The ends of the lines that stand for a curve which is nearly straight: they meet where it bends most.
    pub(super) fn as_lines(self) -> Option<Vec<Point>> {
        let Self([a, c, b]) = self;
        let (toward, bend) = (c - a, (b - c) - (c - a));
        let t = -toward.dot(&bend) / bend.norm_squared();
        let sharpest = (t > 0.0 && t < 1.0).then(|| on_parabola(a, c, b, t));
        let corners = [Some(a), sharpest, Some(b)];
        self.is_straight()
            .then(|| corners.into_iter().flatten().collect())
    }

    /// True if none of the three points is farther from the line between the other two, which are the farthest apart, than
    /// [`STRAIGHT`].
    fn is_straight(self) -> bool {
        let Self([a, c, b]) = self;
        let length = |[from, to, _]: &[Point; 3]| (*to - *from).amax();
        let pairs = [[a, c, b], [a, b, c], [c, b, a]].into_iter();
        let Some([from, to, between]) = pairs.reduce(|longest, pair| {
            if length(&pair) > length(&longest) {
                pair
            } else {
                longest
            }
        }) else {
            return false;
        };
        let (along, away) = (to - from, between - from);
        let t = along.dot(&away) / along.norm_squared();
        let nearest = if (0.0..=1.0).contains(&t) {
            along * t
        } else {
            Vector::zeros()
        };
        (away - nearest).norm_squared() <= STRAIGHT * along.amax() * along.amax()
    }
}

/// The squared distance from a line at which a curve counts as straight, in units of its squared length along an axis.
const STRAIGHT: f32 = 5e-6;

/// The vector to the left of another, of its length, as seen with y down.
pub(super) fn left_of(along: Vector) -> Vector {
    Vector::new(along.y, -along.x)
}

/// The point at `t` of a parabola.
pub(super) fn on_parabola(start: Point, knee: Point, end: Point, t: f32) -> Point {
    let u = 1.0 - t;
    Point::from(start.coords() * (u * u) + knee.coords() * (2.0 * t * u) + end.coords() * (t * t))
}

/// The parabola, in two where it turns back along an axis.
pub(super) fn monotone(
    [from, knee, to]: [Point; 3],
    axis: usize,
) -> impl Iterator<Item = [Point; 3]> {
    let (before, after) = (knee[axis] - from[axis], to[axis] - knee[axis]);
    if before * after >= 0.0 {
        return [Some([from, knee, to]), None].into_iter().flatten();
    }
    let t = before / (before - after);
    let turn = on_parabola(from, knee, to, t);
    let flat = |mut p: Point| {
        p[axis] = turn[axis];
        p
    };
    let knees = [from + (knee - from) * t, knee + (to - knee) * t].map(flat);
    let parts = [[from, knees[0], turn], [turn, knees[1], to]];
    parts.map(Some).into_iter().flatten()
}
