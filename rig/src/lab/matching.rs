//! A problem for descent: match the coverage of a union of capsules to a black-and-white target.
//!
//! **Distances are positive inside** a capsule, zero on its edge and negative outside, in px:
//!
//! ```text
//! capsule        d = r − √(|q|² + ε)
//!                q = (p−a) − h(b−a),   h = clamp((p−a)·(b−a) / (|b−a|² + ε), 0, 1)
//! union          d = max(d₁, d₂)
//! ```
//!
//! **Derivatives.** With `u = q / √(|q|² + ε)`: `∂d/∂r = 1`, and by the chain rule through `h`
//!
//! ```text
//! ∂d/∂a = (1−h)u + (u·(b−a)) ∂h/∂a      ∂h/∂a = (2h(b−a) − (b−a) − (p−a)) / (|b−a|² + ε)
//! ∂d/∂b =     hu + (u·(b−a)) ∂h/∂b      ∂h/∂b = ((p−a) − 2h(b−a)) / (|b−a|² + ε)
//! ```
//!
//! where `∂h = 0` if the clamp is active; at the limits themselves it is not, as in `PyTorch`'s `clamp`. A capsule of zero
//! length is a circle: `h = 0`, and the gradient of both ends goes to `a`. On the centre line `u = 0`.
//!
//! Source: Inigo Quilez, "2D distance functions", with the sign reversed and ε added as in the golden data of this crate's tests.

use super::descent::Problem;
use strokefit::coverage::Coverage;
use strokefit::loss::Loss;
use strokefit::math::Real;

/// A line segment swept by a disc: a segment with round caps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule<T: Real> {
    /// Where the centre line starts, px.
    pub a: [T; 2],
    /// Where it ends, px.
    pub b: [T; 2],
    /// Radius, px.
    pub radius: T,
}

/// The way from the centre line of a capsule to a point.
struct Offset<T> {
    from_start: [T; 2],
    along: [T; 2],
    /// Place of the nearest point, 0 at `a` and 1 at `b`, before it is clamped and after.
    foot: T,
    h: T,
    /// From the nearest point.
    way: [T; 2],
    length: T,
}

impl<T: Real> Capsule<T> {
    /// Signed distance from `p` to the edge in px, positive inside.
    pub fn distance(&self, p: [T; 2], eps: T) -> T {
        self.radius - self.offset(p, eps).length
    }

    /// The derivatives of the distance at `p` by `a` and by `b`. That by the radius is always 1.
    fn derivatives(&self, p: [T; 2], eps: T) -> [[T; 2]; 2] {
        let Offset {
            from_start,
            along,
            foot,
            h,
            way,
            length,
        } = self.offset(p, eps);
        let u = if length > T::zero() {
            way.map(|x| x / length)
        } else {
            [T::zero(); 2]
        };
        let (mut by_a, mut by_b) = (times(u, T::one() - h), times(u, h));
        let m = dot(along, along) + eps;
        if foot == h && m > T::zero() {
            let slope = dot(u, along) / m;
            let twice = times(along, h + h);
            let by_h = times(minus(minus(twice, along), from_start), slope);
            by_a = [by_a[0] + by_h[0], by_a[1] + by_h[1]];
            let by_h = times(minus(from_start, twice), slope);
            by_b = [by_b[0] + by_h[0], by_b[1] + by_h[1]];
        }
        [by_a, by_b]
    }

    fn offset(&self, p: [T; 2], eps: T) -> Offset<T> {
        let (from_start, along) = (minus(p, self.a), minus(self.b, self.a));
        let m = dot(along, along) + eps;
        let foot = if m > T::zero() {
            dot(from_start, along) / m
        } else {
            T::zero()
        };
        let h = foot.clamp(T::zero(), T::one());
        let way = minus(from_start, times(along, h));
        let length = (dot(way, way) + eps).sqrt();
        Offset {
            from_start,
            along,
            foot,
            h,
            way,
            length,
        }
    }
}

fn minus<T: Real>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn times<T: Real>(a: [T; 2], factor: T) -> [T; 2] {
    a.map(|x| x * factor)
}

fn dot<T: Real>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// What the numbers of a shape are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// `[x, y, radius]`: a capsule of no length.
    Circle,
    /// `[a.x, a.y, b.x, b.y, radius]`.
    Capsule,
}

impl Form {
    /// Numbers of each shape.
    fn params(self) -> usize {
        match self {
            Self::Circle => 3,
            Self::Capsule => 5,
        }
    }

    /// The shapes of these numbers.
    fn capsules<T: Real>(self, params: &[T]) -> Vec<Capsule<T>> {
        let of = |a, b, radius| Capsule { a, b, radius };
        match self {
            Self::Circle => {
                let circles = params.as_chunks().0.iter();
                circles.map(|&[x, y, r]| of([x, y], [x, y], r)).collect()
            }
            Self::Capsule => {
                let capsules = params.as_chunks().0.iter();
                let capsule = |&[ax, ay, bx, by, r]: &[T; 5]| of([ax, ay], [bx, by], r);
                capsules.map(capsule).collect()
            }
        }
    }
}

/// A square of sample points one px apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Samples<T> {
    /// Rows, and columns.
    pub size: usize,
    /// x and y of the first point, px.
    pub origin: T,
    /// ε of the signed distance, px².
    pub eps: T,
}

impl<T: Real> Samples<T> {
    /// All points, row by row.
    fn points(self) -> impl Iterator<Item = [T; 2]> {
        let at = move |i: usize| T::of(i as f64) + self.origin;
        (0..self.size).flat_map(move |y| (0..self.size).map(move |x| [at(x), at(y)]))
    }

    /// Coverage of the union of the shapes of `params` at all points, with an edge of 1 px.
    pub fn draw(self, form: Form, params: &[T], coverage: Coverage) -> Vec<T> {
        let shapes = form.capsules(params);
        let value = |p| coverage.value(union(&shapes, p, self.eps).1, T::one());
        self.points().map(value).collect()
    }
}

/// The distance to the union of `shapes` at `p`, with the index of the one that it is; where
/// several tie, of the first.
fn union<T: Real>(shapes: &[Capsule<T>], p: [T; 2], eps: T) -> (usize, T) {
    let mut nearest = (0, T::of(f64::NEG_INFINITY));
    for (i, shape) in shapes.iter().enumerate() {
        let d = shape.distance(p, eps);
        if d > nearest.1 {
            nearest = (i, d);
        }
    }
    nearest
}

/// The mean squared error between the coverage of a union of shapes and a target.
#[derive(Debug, Clone)]
pub struct Matching<T> {
    /// Where the target is sampled.
    pub samples: Samples<T>,
    /// What the numbers are.
    pub form: Form,
    /// Coverage function of the shapes.
    pub coverage: Coverage,
    /// One value per point.
    pub target: Vec<T>,
    /// Bounds of every radius, px.
    pub radii: [f64; 2],
}

impl<T: Real> Problem<T> for Matching<T> {
    fn evaluate(&self, params: &[T], gradient: &mut [T]) -> f64 {
        let shapes = self.form.capsules(params);
        let (samples, one) = (self.samples, T::one());
        let nearest = samples.points().map(|p| union(&shapes, p, samples.eps));
        let nearest: Vec<_> = nearest.collect();
        let covered = |&(_, d): &(usize, T)| self.coverage.value(d, one);
        let canvas: Vec<T> = nearest.iter().map(covered).collect();
        let d_canvas = Loss::L2.gradient(&canvas, &self.target);
        gradient.fill(T::zero());
        for ((p, &(i, d)), &g) in samples.points().zip(&nearest).zip(&d_canvas) {
            let weight = g * self.coverage.derivative(d, one);
            let [[ax, ay], [bx, by]] = shapes[i].derivatives(p, samples.eps);
            // All of a circle's derivative goes to the first end.
            let derivatives = match self.form {
                Form::Circle => [ax, ay, one, T::zero(), T::zero()],
                Form::Capsule => [ax, ay, bx, by, one],
            };
            let own = &mut gradient[i * self.form.params()..][..self.form.params()];
            for (sum, by) in own.iter_mut().zip(derivatives) {
                *sum += weight * by;
            }
        }
        Loss::L2.mean(&canvas, &self.target)
    }

    fn clamp(&self, params: &mut [T]) {
        let [low, high] = self.radii.map(T::of);
        for shape in params.chunks_exact_mut(self.form.params()) {
            if let Some(radius) = shape.last_mut() {
                *radius = radius.clamp(low, high);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn check(form: Form, params: &[f64], target: &[f64]) {
        let samples = Samples {
            size: 12,
            origin: 0.0,
            eps: 1e-4,
        };
        let problem = Matching {
            samples,
            form,
            coverage: Coverage::Tanh,
            target: samples.draw(form, target, Coverage::Raw),
            radii: ANY,
        };
        let mut gradient = vec![0.0; params.len()];
        problem.evaluate(params, &mut gradient);
        let loss = |params: &[f64]| problem.evaluate(params, &mut vec![0.0; params.len()]);
        for (k, analytic) in gradient.iter().enumerate() {
            let (mut low, mut high) = (params.to_vec(), params.to_vec());
            low[k] -= 1e-6;
            high[k] += 1e-6;
            let numeric = (loss(&high) - loss(&low)) / 2e-6;
            assert!(
                (numeric - analytic).abs() < 1e-8,
                "{k}: {analytic} {numeric}"
            );
        }
    }

    #[test]
    fn gradients_are_central_differences() {
        check(Form::Circle, &[3.1, 4.2, 2.5], &[6.0, 6.0, 3.0]);
        let two = [1.2, 2.3, 8.4, 3.5, 1.1, 9.3, 1.2, 4.4, 9.1, 0.7];
        check(Form::Capsule, &two, &[2.0, 2.0, 9.0, 9.0, 1.0]);
    }

    fn capsule([ax, ay, bx, by, radius]: [f64; 5]) -> Capsule<f64> {
        Capsule {
            a: [ax, ay],
            b: [bx, by],
            radius,
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
    fn nothing_is_infinite_on_the_centre_line() {
        let thin = capsule([1.0, 1.0, 5.0, 1.0, 0.0]);
        for x in [1.0, 3.0, 5.0] {
            assert_eq!(thin.distance([x, 1.0], 0.0), 0.0);
            assert_eq!(thin.derivatives([x, 1.0], 0.0), [[0.0; 2]; 2]);
        }
        let dot = capsule([1.0, 1.0, 1.0, 1.0, 2.0]);
        assert_eq!(dot.distance([1.0, 1.0], 0.0), 2.0);
        assert_eq!(dot.derivatives([1.0, 1.0], 0.0), [[0.0; 2]; 2]);
    }
}
