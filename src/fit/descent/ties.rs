//! Ties: numbers of strokes, such as widths, that are equal and stay so while the strokes are fitted, or stay as they are.

use serde::{Deserialize, Serialize};

/// Groups of equal numbers and single ones that stay, by their places among all numbers of the free strokes.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(in crate::fit) struct Ties {
    groups: Vec<Vec<usize>>,
    fixed: Vec<usize>,
}

impl Ties {
    /// Ties the numbers at these places. A single one stays as it is.
    pub(in crate::fit) fn tie(&mut self, places: Vec<usize>) {
        match places[..] {
            [place] => self.fix(place),
            _ => self.groups.push(places),
        }
    }

    /// Fixes the number at this place.
    pub(in crate::fit) fn fix(&mut self, place: usize) {
        self.fixed.push(place);
    }

    /// Adds the ties of `others`.
    pub(in crate::fit) fn extend(&mut self, others: Self) {
        self.groups.extend(others.groups);
        self.fixed.extend(others.fixed);
    }

    /// Gives each tied number the derivative of the loss with respect to its whole group, and each fixed one none. An
    /// optimiser that treats equal numbers alike then keeps them equal.
    pub(in crate::fit) fn gather(&self, slopes: &mut [f32]) {
        self.fixed.iter().for_each(|&i| slopes[i] = 0.0);
        for group in &self.groups {
            let sum: f32 = group.iter().map(|&i| slopes[i]).sum();
            group.iter().for_each(|&i| slopes[i] = sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tied_numbers_have_the_derivative_of_their_group() {
        let mut ties = Ties::default();
        ties.tie(vec![0, 3]);
        ties.tie(vec![2]);
        let mut slopes = [1.0, 2.0, 4.0, 8.0];
        ties.gather(&mut slopes);
        assert_eq!(slopes, [9.0, 2.0, 0.0, 9.0]);
    }
}
