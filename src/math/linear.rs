//! Linear equations.

/// Solutions of linear equations, one for each of the right sides. The matrix of their `columns` is symmetric; `None`
/// unless it is positive definite as well.
///
/// By Cholesky's decomposition, with sums in a fixed order.
pub(crate) fn solve_symmetric<const N: usize>(
    mut columns: Vec<Vec<f64>>,
    rights: [Vec<f64>; N],
) -> Option<[Vec<f64>; N]> {
    decompose(&mut columns)?;
    Some(rights.map(|right| solved(&columns, right)))
}

/// Turns the lower half of a matrix into the lower half of its factor.
fn decompose(columns: &mut [Vec<f64>]) -> Option<()> {
    for j in 0..columns.len() {
        // Column j of A = LLᵀ, from its diagonal down, is Σ L_k·L_jk over the columns k ≤ j. Take away those before j.
        let (before, rest) = columns.split_at_mut(j);
        let column = &mut rest[0][j..];
        for earlier in before {
            add(column, -earlier[j], &earlier[j..]);
        }
        // The rest of the diagonal is L_jj². It is above 0 exactly for a positive definite matrix; NaN fails, too.
        let root = Some(column[0]).filter(|square| *square > 0.0)?.sqrt();
        column[0] = root;
        column[1..].iter_mut().for_each(|number| *number /= root);
    }
    Some(())
}

/// The solution for a right side, by the factor: forwards, then backwards.
fn solved(factor: &[Vec<f64>], mut right: Vec<f64>) -> Vec<f64> {
    // L·y = right, column by column.
    for (i, column) in factor.iter().enumerate() {
        right[i] /= column[i];
        let (known, rest) = right.split_at_mut(i + 1);
        add(rest, -known[i], &column[i + 1..]);
    }
    // Lᵀ·x = y, from the last unknown to the first.
    for (i, column) in factor.iter().enumerate().rev() {
        let rest = dot(&column[i + 1..], &right[i + 1..]);
        right[i] = (right[i] - rest) / column[i];
    }
    right
}

fn add(sums: &mut [f64], factor: f64, terms: &[f64]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += factor * term;
    }
}

/// The scalar product: eight sums side by side, as vector units add, and then the remainder.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, last_a), (b, last_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += a[k] * b[k];
        }
    }
    let whole = (0..4).fold(0.0, |sum, k| sum + (sums[k] + sums[k + 4]));
    let last = last_a.iter().zip(last_b);
    last.fold(whole, |sum, (a, b)| sum + a * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_solve_their_equations() {
        let size = 19;
        let entry = |i: usize, k: usize| 1.0 / (1 + i + k) as f64 + if i == k { 1.0 } else { 0.0 };
        let columns: Vec<Vec<f64>> = (0..size)
            .map(|i| (0..size).map(|k| entry(i, k)).collect())
            .collect();
        let right: Vec<f64> = (0..size).map(|i| i as f64 - 4.5).collect();
        let [solution] = solve_symmetric(columns.clone(), [right.clone()]).unwrap();
        for (i, right) in right.iter().enumerate() {
            assert!((dot(&columns[i], &solution) - right).abs() < 1e-12, "{i}");
        }
    }

    #[test]
    fn matrices_that_are_not_positive_definite_have_no_solution() {
        for columns in [
            [[0.0, 0.0], [0.0, 1.0]],
            [[1.0, 2.0], [2.0, 1.0]],
            [[f64::NAN, 0.0], [0.0, 1.0]],
        ] {
            let columns = columns.map(Vec::from).to_vec();
            assert_eq!(solve_symmetric(columns, [vec![1.0, 1.0]]), None);
        }
    }
}
