//! Means of windows.

use std::collections::VecDeque;

use rayon::prelude::*;

/// Replaces each value by the mean of the window of 2`radius` + 1 rows and columns around it, as far as that is in the
/// picture.
pub(crate) fn average(values: &mut [f64], width: usize, radius: usize) {
    // A row is a picture 1 px wide, if it is turned.
    let rows = values.par_chunks_exact_mut(width);
    rows.for_each(|row| average_rows(row, 1, radius));
    average_rows(values, width, radius);
}

/// Replaces each row of `width` values by the mean of the rows at most `radius` away.
fn average_rows(values: &mut [f64], width: usize, radius: usize) {
    let height = values.len() / width;
    let row = |y: usize| y * width..(y + 1) * width;
    // Rows are needed once more after they are replaced.
    let mut before = VecDeque::new();
    // A running sum of the rows in reach: the next row enters, the first one leaves.
    let mut sums = vec![0.0; width];
    for y in 0..radius.min(height) {
        add(&mut sums, &values[row(y)]);
    }
    for y in 0..height {
        if y + radius < height {
            add(&mut sums, &values[row(y + radius)]);
        }
        let count = in_reach(y, height, radius) as f64;
        for (value, sum) in values[row(y)].iter_mut().zip(&sums) {
            before.push_back(*value);
            *value = sum / count;
        }
        if y >= radius {
            let gone = before.drain(..width);
            sums.iter_mut().zip(gone).for_each(|(sum, v)| *sum -= v);
        }
    }
}

fn add(sums: &mut [f64], values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v);
}

/// Number of the `length` places that are at most `radius` away from place `i`.
fn in_reach(i: usize, length: usize, radius: usize) -> usize {
    length.min(i + radius + 1) - i.saturating_sub(radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_the_window() {
        let (width, height) = (5, 4);
        let values: Vec<f64> = (0..width * height).map(|i| (i * i % 7) as f64).collect();
        let mut means = values.clone();
        average(&mut means, width, 1);
        for y in 0..height {
            for x in 0..width {
                let rows = y.saturating_sub(1)..height.min(y + 2);
                let window: Vec<f64> = rows
                    .flat_map(|row| {
                        let columns = x.saturating_sub(1)..width.min(x + 2);
                        columns.map(move |column| row * width + column)
                    })
                    .map(|i| values[i])
                    .collect();
                let mean = window.iter().sum::<f64>() / window.len() as f64;
                assert!((means[y * width + x] - mean).abs() < 1e-9, "{x} {y}");
            }
        }
    }
}
