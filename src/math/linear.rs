//! Linear least squares: the one door of `nalgebra`.

use nalgebra::{Const, DMatrix, Dyn, OMatrix};

/// The normal equations AᵀWA·x = AᵀWb of a linear least-squares problem, for `R` right sides b at once.
///
/// Sums and Cholesky's decomposition run in a fixed order, so the solution has the same bits on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Normal<const R: usize> {
    left: DMatrix<f64>,
    right: OMatrix<f64, Dyn, Const<R>>,
}

impl<const R: usize> Normal<R> {
    /// No equation yet, of so many unknowns.
    pub(crate) fn of(unknowns: usize) -> Self {
        Self {
            left: DMatrix::zeros(unknowns, unknowns),
            right: OMatrix::zeros_generic(Dyn(unknowns), Const),
        }
    }

    /// Adds the equation Σ factor · x[unknown] = value, with a weight.
    pub(crate) fn add(&mut self, terms: &[(usize, f64)], values: [f64; R], weight: f64) {
        for &(row, factor) in terms {
            let factor = weight * factor;
            // Cholesky's decomposition reads the lower half alone.
            for &(column, other) in terms.iter().filter(|(column, _)| *column <= row) {
                self.left[(row, column)] += factor * other;
            }
            for (k, value) in values.iter().enumerate() {
                self.right[(row, k)] += factor * value;
            }
        }
    }

    /// Σ right side · x, summed over all right sides: by how much the solution lessens the squared error. One that was damped lessens it
    /// by more than that.
    pub(crate) fn gain(&self, solution: &[[f64; R]]) -> f64 {
        let rows = self.right.row_iter().zip(solution);
        rows.map(|(row, x)| row.iter().zip(x).map(|(b, x)| b * x).sum::<f64>())
            .sum()
    }

    /// The solution for each unknown; `None` unless the equations determine all of them.
    pub(crate) fn solve(self) -> Option<Vec<[f64; R]>> {
        let solution = self.left.cholesky()?.solve(&self.right);
        let rows = solution.row_iter();
        Some(rows.map(|row| std::array::from_fn(|k| row[k])).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_are_nearest_to_their_equations() {
        // Of (0, 0), (1, 3) and (2, 4) the line ⅓ + 2x is the nearest; the other one goes through its points.
        let mut equations = Normal::of(2);
        for (x, values) in [(0.0, [0.0, -1.0]), (1.0, [3.0, -2.0]), (2.0, [4.0, -3.0])] {
            equations.add(&[(0, 1.0), (1, x)], values, 1.0);
        }
        let solution = equations.solve().unwrap();
        for (found, expected) in solution.iter().zip([[1.0 / 3.0, -1.0], [2.0, -1.0]]) {
            assert!(
                found
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() < 1e-12),
                "{solution:?}"
            );
        }
    }

    #[test]
    fn a_solution_lessens_the_squared_error_by_its_gain() {
        let (mut equations, mut damped) = (Normal::of(1), Normal::of(1));
        for value in [1.0, 4.0, 4.0] {
            equations.add(&[(0, 2.0)], [value], 1.0);
            damped.add(&[(0, 2.0)], [value], 1.0);
        }
        damped.add(&[(0, 1.0)], [0.0], 3.0);
        let error = |x: f64| {
            let squares = [1.0, 4.0, 4.0].map(|v| (v - 2.0 * x) * (v - 2.0 * x));
            squares.iter().sum::<f64>()
        };
        let lessens = |x: f64| error(0.0) - error(x);
        let [best, near] = [equations.clone(), damped].map(|e| e.solve().unwrap());
        assert!((equations.gain(&best) - lessens(best[0][0])).abs() < 1e-12);
        assert!(equations.gain(&near) < lessens(near[0][0]));
    }

    #[test]
    fn weights_are_numbers_of_equations() {
        let [mut once, mut thrice] = [Normal::of(1), Normal::of(1)];
        for value in [1.0, 4.0, 4.0, 4.0] {
            once.add(&[(0, 2.0)], [value], 1.0);
        }
        thrice.add(&[(0, 2.0)], [1.0], 1.0);
        thrice.add(&[(0, 2.0)], [4.0], 3.0);
        assert_eq!(once.solve(), thrice.solve());
    }

    #[test]
    fn what_is_not_determined_has_no_solution() {
        for factor in [0.0, f64::NAN] {
            let mut equations = Normal::of(2);
            equations.add(&[(0, 1.0), (1, factor)], [1.0], 1.0);
            assert_eq!(equations.solve(), None);
        }
    }
}
