//! The nearest of many things in the plane, by a grid of square cells.

use super::{Spot, dist};

/// Things at places of a region.
#[derive(Debug, Clone)]
pub(super) struct Nearby<T> {
    /// The corner of the region with the least coordinates.
    corner: Spot,
    /// Side of a cell, px.
    side: f64,
    columns: usize,
    rows: usize,
    /// Things in each cell, row by row.
    cells: Vec<Vec<(Spot, T)>>,
}

impl<T: Copy> Nearby<T> {
    /// An empty grid for things at these places, with about as many cells.
    pub(super) fn over(spots: &[Spot]) -> Self {
        let least = |axis: usize| spots.iter().map(|s| s[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| {
            spots
                .iter()
                .map(|s| s[axis])
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let corner = [least(0), least(1)];
        let [width, height] = [0, 1].map(|axis| (most(axis) - least(axis)).max(1.0));
        let side = (width * height / spots.len().max(1) as f64).sqrt();
        // A region of a line has cells along it only.
        let side = side.max(width.max(height) / spots.len().max(1) as f64);
        let [columns, rows] = [width, height].map(|length| (length / side) as usize + 1);
        Self {
            corner,
            side,
            columns,
            rows,
            cells: vec![Vec::new(); columns * rows],
        }
    }

    pub(super) fn put(&mut self, spot: Spot, thing: T) {
        let cell = self.cell(spot);
        self.cells[cell].push((spot, thing));
    }

    /// Takes away the things in the cell of `spot` that `goes` says.
    pub(super) fn take(&mut self, spot: Spot, goes: impl Fn(&T) -> bool) {
        let cell = self.cell(spot);
        self.cells[cell].retain(|(_, thing)| !goes(thing));
    }

    /// The `count` nearest things that `counts`, each with its distance, the nearest first. Among equally near ones, that
    /// of the first cell comes first, and then that which was put first.
    pub(super) fn nearest(
        &self,
        from: Spot,
        count: usize,
        counts: impl Fn(&T) -> bool,
    ) -> Vec<(f64, T)> {
        let [column, row] = self.place(from);
        let mut found: Vec<(f64, T)> = Vec::new();
        for ring in 0..self.columns.max(self.rows) {
            for cell in self.ring([column, row], ring) {
                let inside = self.cells[cell].iter().filter(|(_, thing)| counts(thing));
                found.extend(inside.map(|&(spot, thing)| (dist(from, spot), thing)));
            }
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            found.truncate(count);
            // All that is not yet seen is farther away than this.
            let seen = ring as f64 * self.side;
            if found.len() == count && found.last().is_some_and(|(far, _)| *far <= seen) {
                break;
            }
        }
        found
    }

    /// The cells that are `ring` steps away, row by row.
    fn ring(&self, [column, row]: [usize; 2], ring: usize) -> impl Iterator<Item = usize> {
        let (columns, rows) = (self.columns, self.rows);
        let (top, left) = (row.checked_sub(ring), column.checked_sub(ring));
        let (bottom, right) = (row + ring, column + ring);
        let lines = top.unwrap_or(0)..=bottom.min(rows - 1);
        let first = left.unwrap_or(0);
        let last = right.min(columns - 1);
        lines.flat_map(move |line| {
            let is_whole = Some(line) == top || line == bottom;
            let step = if is_whole { 1 } else { (2 * ring).max(1) };
            // Between top and bottom, only the two ends of a line are in the ring.
            let ends = [left, Some(right)].into_iter().flatten();
            let ends = ends.filter(move |&end| end < columns && !is_whole);
            let whole = (first..=last).step_by(step).filter(move |_| is_whole);
            whole.chain(ends).map(move |column| line * columns + column)
        })
    }

    fn cell(&self, spot: Spot) -> usize {
        let [column, row] = self.place(spot);
        row * self.columns + column
    }

    /// Column and row of the cell that is nearest to `spot`.
    fn place(&self, spot: Spot) -> [usize; 2] {
        let step = |axis: usize| ((spot[axis] - self.corner[axis]) / self.side).max(0.0) as usize;
        [step(0).min(self.columns - 1), step(1).min(self.rows - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;

    #[test]
    fn the_nearest_are_those_of_a_search_through_all() {
        let spots: Vec<Spot> = (0..300)
            .map(|i| [0, 1].map(|axis| 50.0 * f64::from(rng::draw(7, 0, i, axis))))
            .collect();
        let mut nearby = Nearby::over(&spots);
        spots
            .iter()
            .enumerate()
            .for_each(|(i, &s)| nearby.put(s, i));
        for from in [[0.0, 0.0], [25.0, 30.0], [-40.0, 90.0], [49.0, 1.0]] {
            let mut all: Vec<_> = spots.iter().map(|&spot| dist(from, spot)).collect();
            all.sort_by(f64::total_cmp);
            let found: Vec<f64> = nearby
                .nearest(from, 9, |_| true)
                .iter()
                .map(|f| f.0)
                .collect();
            assert_eq!(found, all[..9]);
        }
        nearby.take(spots[0], |&i| i == 0);
        assert_ne!(nearby.nearest(spots[0], 1, |_| true)[0].1, 0);
    }
}
