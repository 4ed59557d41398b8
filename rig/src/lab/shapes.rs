//! Signed distance fields of capsules, and their combinations, over a generic number.
//!
//! **Distances are positive inside** the shape, zero on its edge and negative outside, in px. Much of the
//! literature, including the source of this file, uses the opposite sign.
//!
//! ```text
//! capsule        d = r − √(|q|² + ε)
//!                q = (p−a) − h(b−a),   h = clamp((p−a)·(b−a) / (|b−a|² + ε), 0, 1)
//! union          d = max(d₁, d₂)
//! intersection   d = min(d₁, d₂)
//! subtraction    d = min(d₁, −d₂)
//! ```
//!
//! **Derivatives.** With `u = q / √(|q|² + ε)`: `∂d/∂r = 1`, and by the chain rule through `h`
//!
//! ```text
//! ∂d/∂a = (1−h)u + (u·(b−a)) ∂h/∂a      ∂h/∂a = (2h(b−a) − (b−a) − (p−a)) / (|b−a|² + ε)
//! ∂d/∂b =     hu + (u·(b−a)) ∂h/∂b      ∂h/∂b = ((p−a) − 2h(b−a)) / (|b−a|² + ε)
//! ```
//!
//! where `∂h = 0` if the clamp is active; at the limits themselves it is not, as in `PyTorch`'s `clamp`. At
//! ε = 0 the terms with `∂h` vanish, because `q` is then orthogonal to `b − a` wherever the clamp is
//! inactive.
//!
//! **Domain.** All finite parameters, ε ≥ 0, and a radius of either sign. ε rounds off the kink of the distance
//! on the centre line. It makes `d` smaller by at most `√ε` there, and by `ε / 2|q|` further away.
//!
//! **Degenerate cases.** A capsule of zero length is a circle: `h = 0`, and the gradient of both ends goes to
//! `a`. On the centre line `u = 0` if ε > 0; at ε = 0, where no derivative exists, 0 is used as well.
//!
//! An example, with `#` deep inside, `+` inside and `.` just outside:
//!
//! ```
//! use rig::lab::shapes::Capsule;
//!
//! let capsule = Capsule { a: [7.0, 7.0], b: [26.0, 3.0], radius: 3.0 };
//! let shade = |d: f64| match d {
//!     d if d > 1.5 => '#',
//!     d if d > 0.0 => '+',
//!     d if d > -1.5 => '.',
//!     _ => ' ',
//! };
//! let pixel = |x, y| shade(capsule.distance([x, y].map(|at: i32| f64::from(at) + 0.5), 0.0));
//! let row = |y: i32| (0..32).map(|x| pixel(x, y)).collect::<String>();
//! let picture = (0..11).map(|y| row(y).trim_end().to_owned()).collect::<Vec<_>>();
//! assert_eq!(picture, [
//!     "                .......+++++..",
//!     "           ........++++++++++.",
//!     "       .......+++++++######++.",
//!     "    .....+++++++###########++.",
//!     "   ..+++++++##############+++.",
//!     "   .+++##############+++++++..",
//!     "   .++###########+++++++.....",
//!     "   .++######+++++++.......",
//!     "   .++++++++++........",
//!     "   ..+++++.......",
//!     "    ........",
//! ]);
//! ```
//!
//! Source: Inigo Quilez, "2D distance functions" (the segment and the boolean operators), with the sign
//! reversed and ε added as in the golden data of this crate's tests.

use strokefit::math::Real;

/// A point or a displacement, px.
pub type Pair<T> = [T; 2];

/// A line segment swept by a disc: a segment with round caps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule<T: Real> {
    /// Where the centre line starts, px.
    pub a: Pair<T>,
    /// Where it ends, px.
    pub b: Pair<T>,
    /// Radius, px.
    pub radius: T,
}

/// A capsule's distance at a point, with its derivatives. The one by the radius is always 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapsuleJet<T: Real> {
    /// Signed distance, px, positive inside.
    pub d: T,
    /// `∂d/∂a`.
    pub by_a: Pair<T>,
    /// `∂d/∂b`.
    pub by_b: Pair<T>,
}

impl<T: Real> Capsule<T> {
    /// Signed distance from `p` to the edge in px, positive inside.
    #[inline]
    pub fn distance(&self, p: Pair<T>, eps: T) -> T {
        let (pa, ba) = (minus(p, self.a), minus(self.b, self.a));
        let h = foot(pa, ba, eps).clamp(T::zero(), T::one());
        self.radius - length(minus(pa, times(ba, h)), eps)
    }

    /// The distance at `p` with its derivatives.
    #[inline]
    pub fn jet(&self, p: Pair<T>, eps: T) -> CapsuleJet<T> {
        let (pa, ba) = (minus(p, self.a), minus(self.b, self.a));
        let foot = foot(pa, ba, eps);
        let h = foot.clamp(T::zero(), T::one());
        let q = minus(pa, times(ba, h));
        let length = length(q, eps);
        let u = direction(q, length);
        let (mut by_a, mut by_b) = (times(u, T::one() - h), times(u, h));
        let m = dot(ba, ba) + eps;
        if foot == h && m > T::zero() {
            let along = dot(u, ba) / m;
            let twice = times(ba, h + h);
            by_a = plus(by_a, times(minus(minus(twice, ba), pa), along));
            by_b = plus(by_b, times(minus(pa, twice), along));
        }
        CapsuleJet {
            d: self.radius - length,
            by_a,
            by_b,
        }
    }
}

/// Combination of two distance fields into one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Combination {
    /// Inside either: `max(d₁, d₂)`.
    Union,
    /// Inside both: `min(d₁, d₂)`. This is a bound of the true distance, not the distance itself.
    Intersection,
    /// Inside the first but not the second: `min(d₁, −d₂)`. This is a bound as well.
    Subtraction,
}

impl Combination {
    /// The combined distance, px, positive inside.
    #[inline]
    pub fn distance<T: Real>(self, d1: T, d2: T) -> T {
        match self {
            Self::Union => d1.max(d2),
            Self::Intersection => d1.min(d2),
            Self::Subtraction => d1.min(-d2),
        }
    }
}

fn plus<T: Real>(a: Pair<T>, b: Pair<T>) -> Pair<T> {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus<T: Real>(a: Pair<T>, b: Pair<T>) -> Pair<T> {
    [a[0] - b[0], a[1] - b[1]]
}

fn times<T: Real>(a: Pair<T>, factor: T) -> Pair<T> {
    a.map(|x| x * factor)
}

fn dot<T: Real>(a: Pair<T>, b: Pair<T>) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// The foot of the perpendicular from `p` on the line, 0 at `a` and 1 at `b`.
#[inline]
fn foot<T: Real>(pa: Pair<T>, ba: Pair<T>, eps: T) -> T {
    let m = dot(ba, ba) + eps;
    if m > T::zero() {
        dot(pa, ba) / m
    } else {
        T::zero()
    }
}

#[inline]
fn length<T: Real>(q: Pair<T>, eps: T) -> T {
    (dot(q, q) + eps).sqrt()
}

/// `q / length`, or zero if there is no direction.
#[inline]
fn direction<T: Real>(q: Pair<T>, length: T) -> Pair<T> {
    if length > T::zero() {
        q.map(|q| q / length)
    } else {
        [T::zero(); 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use strokefit::rng;

    const EPS: f64 = 1e-3;

    /// A number in −4..12, so that points lie within and around shapes of the same range.
    fn coordinate(i: u64, k: u64) -> f64 {
        f64::from(rng::draw(1, 0, i, k)) * 16.0 - 4.0
    }

    fn point(i: u64, k: u64) -> Pair<f64> {
        [coordinate(i, k), coordinate(i, k + 1)]
    }

    fn capsule([ax, ay, bx, by, radius]: [f64; 5]) -> Capsule<f64> {
        Capsule {
            a: [ax, ay],
            b: [bx, by],
            radius,
        }
    }

    /// Central differences of `f` in each of its parameters.
    fn differences<const N: usize>(x: [f64; N], f: impl Fn([f64; N]) -> f64) -> [f64; N] {
        let step = 1e-6;
        std::array::from_fn(|k| {
            let (mut low, mut high) = (x, x);
            low[k] -= step;
            high[k] += step;
            (f(high) - f(low)) / (2.0 * step)
        })
    }

    fn check(name: &str, analytic: &[f64], numeric: &[f64], failures: &mut Vec<String>) {
        for (k, (a, n)) in analytic.iter().zip(numeric).enumerate() {
            if (a - n).abs() > 1e-7 * (1.0 + n.abs()) {
                failures.push(format!("{name}, parameter {k}: {a} against {n}"));
            }
        }
    }

    #[test]
    fn distances_are_positive_inside() {
        let capsule = capsule([0.0, 0.0, 10.0, 0.0, 1.0]);
        assert_eq!(capsule.distance([5.0, 0.0], 0.0), 1.0);
        assert_eq!(capsule.distance([5.0, 3.0], 0.0), -2.0);
        assert_eq!(capsule.distance([-3.0, 4.0], 0.0), -4.0);
        assert_eq!(capsule.distance([14.0, -3.0], 0.0), -4.0);
    }

    #[test]
    fn a_capsule_of_zero_length_is_a_circle() {
        let dot = capsule([2.0, 3.0, 2.0, 3.0, 1.5]);
        for i in 0..20 {
            let p = point(i, 0);
            let away = minus(p, [2.0, 3.0]);
            let jet = dot.jet(p, 0.0);
            assert!((jet.d - (1.5 - length(away, 0.0))).abs() < 1e-12);
            let towards = direction(away, length(away, 0.0));
            assert!(length(minus(plus(jet.by_a, jet.by_b), towards), 0.0) < 1e-12);
        }
    }

    #[test]
    fn nothing_is_infinite_on_the_centre_line() {
        let thin = capsule([1.0, 1.0, 5.0, 1.0, 0.0]);
        for x in [1.0, 3.0, 5.0] {
            let jet = thin.jet([x, 1.0], 0.0);
            assert_eq!((jet.d, jet.by_a, jet.by_b), (0.0, [0.0; 2], [0.0; 2]));
        }
        let dot = capsule([1.0, 1.0, 1.0, 1.0, 2.0]).jet([1.0, 1.0], 0.0);
        assert_eq!((dot.d, dot.by_a, dot.by_b), (2.0, [0.0; 2], [0.0; 2]));
    }

    #[test]
    fn a_jet_has_the_value_of_the_distance() {
        for i in 0..50 {
            let (a, b, p) = (point(i, 0), point(i, 2), point(i, 4));
            let capsule = Capsule { a, b, radius: 1.0 };
            assert_eq!(capsule.jet(p, EPS).d, capsule.distance(p, EPS));
        }
    }

    #[test]
    fn derivatives_are_central_differences() {
        let mut failures = Vec::new();
        for i in 0..200 {
            let (a, b, p) = (point(i, 0), point(i, 2), point(i, 4));
            let jet = capsule([a[0], a[1], b[0], b[1], 1.0]).jet(p, EPS);
            let numeric = differences([a[0], a[1], b[0], b[1], 1.0], |x| {
                capsule(x).distance(p, EPS)
            });
            let analytic = [jet.by_a[0], jet.by_a[1], jet.by_b[0], jet.by_b[1], 1.0];
            check(&format!("capsule {i}"), &analytic, &numeric, &mut failures);
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    #[test]
    fn combinations_are_of_sets() {
        use Combination::{Intersection, Subtraction, Union};
        for (d1, d2) in [(1.0, 2.0), (1.0, -2.0), (-1.0, 2.0), (-1.0, -2.0)] {
            let inside = |c: Combination| c.distance(d1, d2) > 0.0;
            assert_eq!(inside(Union), d1 > 0.0 || d2 > 0.0);
            assert_eq!(inside(Intersection), d1 > 0.0 && d2 > 0.0);
            assert_eq!(inside(Subtraction), d1 > 0.0 && d2 < 0.0);
        }
    }
}
