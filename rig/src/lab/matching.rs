//! A problem for descent: match the coverage of a union of shapes to a black-and-white target.

use std::marker::PhantomData;

use super::descent::Problem;
use super::shapes::{Capsule, Combination};
use strokefit::coverage::Coverage;
use strokefit::loss::Loss;
use strokefit::math::Real;

/// A shape given by a few numbers, the last of which is its radius.
pub trait Parametric<T: Real>: Sized {
    /// Number of parameters.
    const PARAMS: usize;

    /// The shape with these numbers.
    fn from_params(params: &[T]) -> Self;

    /// Signed distance at `p`, px, positive inside.
    fn distance(&self, p: [T; 2], eps: T) -> T;

    /// Adds `weight` times the derivatives of the distance at `p` to `sum`.
    fn accumulate(&self, p: [T; 2], eps: T, weight: T, sum: &mut [T]);
}

/// A capsule of no length.
pub struct Circle<T: Real>(Capsule<T>);

/// `[x, y, radius]`.
impl<T: Real> Parametric<T> for Circle<T> {
    const PARAMS: usize = 3;

    fn from_params(params: &[T]) -> Self {
        let center = [params[0], params[1]];
        Self(Capsule {
            a: center,
            b: center,
            radius: params[2],
        })
    }

    fn distance(&self, p: [T; 2], eps: T) -> T {
        self.0.distance(p, eps)
    }

    fn accumulate(&self, p: [T; 2], eps: T, weight: T, sum: &mut [T]) {
        // All of the derivative goes to the first end.
        let by = self.0.jet(p, eps).by_a;
        add(sum, weight, [by[0], by[1], T::one()]);
    }
}

/// `[a.x, a.y, b.x, b.y, radius]`.
impl<T: Real> Parametric<T> for Capsule<T> {
    const PARAMS: usize = 5;

    fn from_params(params: &[T]) -> Self {
        Self {
            a: [params[0], params[1]],
            b: [params[2], params[3]],
            radius: params[4],
        }
    }

    fn distance(&self, p: [T; 2], eps: T) -> T {
        Capsule::distance(self, p, eps)
    }

    fn accumulate(&self, p: [T; 2], eps: T, weight: T, sum: &mut [T]) {
        let jet = self.jet(p, eps);
        let by = [jet.by_a[0], jet.by_a[1], jet.by_b[0], jet.by_b[1], T::one()];
        add(sum, weight, by);
    }
}

/// `sum += weight·by`.
fn add<T: Real, const N: usize>(sum: &mut [T], weight: T, by: [T; N]) {
    for (sum, by) in sum.iter_mut().zip(by) {
        *sum += weight * by;
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
    pub fn points(self) -> impl Iterator<Item = [T; 2]> {
        let at = move |i: usize| T::of(i as f64) + self.origin;
        (0..self.size).flat_map(move |y| (0..self.size).map(move |x| [at(x), at(y)]))
    }

    /// Coverage of the union of the shapes of `params` at all points, with an edge of 1 px.
    pub fn draw<S: Parametric<T>>(self, params: &[T], coverage: Coverage) -> Vec<T> {
        let shapes = shapes::<T, S>(params);
        let value = |p| coverage.value(union(&shapes, p, self.eps).1, T::one());
        self.points().map(value).collect()
    }
}

fn shapes<T: Real, S: Parametric<T>>(params: &[T]) -> Vec<S> {
    params.chunks_exact(S::PARAMS).map(S::from_params).collect()
}

/// The distance to the union of `shapes` at `p`, with the index of the one that it is; where
/// several tie, of the first.
fn union<T: Real, S: Parametric<T>>(shapes: &[S], p: [T; 2], eps: T) -> (usize, T) {
    let mut nearest = (0, T::of(f64::NEG_INFINITY));
    for (i, shape) in shapes.iter().enumerate() {
        let d = shape.distance(p, eps);
        let union = Combination::Union.distance(nearest.1, d);
        if union > nearest.1 {
            nearest = (i, union);
        }
    }
    nearest
}

/// The mean squared error between the coverage of a union of shapes `S` and a target.
#[derive(Debug, Clone)]
pub struct Matching<T, S> {
    grid: Samples<T>,
    coverage: Coverage,
    target: Vec<T>,
    /// Bounds of every radius, px.
    radii: [f64; 2],
    shapes: PhantomData<S>,
}

impl<T: Real, S: Parametric<T>> Matching<T, S> {
    /// Shapes covering by `coverage`, against `target`: one value per point of `grid`. Radii are
    /// kept within `radii`.
    pub fn new(grid: Samples<T>, coverage: Coverage, target: Vec<T>, radii: [f64; 2]) -> Self {
        Self {
            grid,
            coverage,
            target,
            radii,
            shapes: PhantomData,
        }
    }
}

impl<T: Real, S: Parametric<T>> Problem<T> for Matching<T, S> {
    fn evaluate(&self, params: &[T], gradient: &mut [T]) -> f64 {
        let shapes = shapes::<T, S>(params);
        let (eps, one) = (self.grid.eps, T::one());
        let unions: Vec<_> = self.grid.points().map(|p| union(&shapes, p, eps)).collect();
        let covered = |&(_, d): &(usize, T)| self.coverage.value(d, one);
        let canvas: Vec<T> = unions.iter().map(covered).collect();
        let d_canvas = Loss::L2.gradient(&canvas, &self.target);
        gradient.fill(T::zero());
        for ((p, &(i, d)), &g) in self.grid.points().zip(&unions).zip(&d_canvas) {
            let d_distance = g * self.coverage.derivative(d, one);
            let own = &mut gradient[i * S::PARAMS..][..S::PARAMS];
            shapes[i].accumulate(p, eps, d_distance, own);
        }
        Loss::L2.mean(&canvas, &self.target)
    }

    fn clamp(&self, params: &mut [T]) {
        let [low, high] = self.radii.map(T::of);
        for shape in params.chunks_exact_mut(S::PARAMS) {
            if let Some(radius) = shape.last_mut() {
                *radius = radius.clamp(low, high);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<S: Parametric<f64>>(params: &[f64], target: &[f64]) {
        let grid = Samples {
            size: 12,
            origin: 0.0,
            eps: 1e-4,
        };
        let target = grid.draw::<S>(target, Coverage::Raw);
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let problem = Matching::<f64, S>::new(grid, Coverage::Tanh, target, all);
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
        check::<Circle<f64>>(&[3.1, 4.2, 2.5], &[6.0, 6.0, 3.0]);
        let two = [1.2, 2.3, 8.4, 3.5, 1.1, 9.3, 1.2, 4.4, 9.1, 0.7];
        check::<Capsule<f64>>(&two, &[2.0, 2.0, 9.0, 9.0, 1.0]);
    }
}
