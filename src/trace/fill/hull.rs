//! The convex hull of some pixels.

/// A convex polygon, whose corners are those of pixels.
#[derive(Debug, Clone, Default)]
pub(super) struct Hull {
    /// From the left to the right along one side of it, and along the other one.
    sides: [Vec<[i64; 2]>; 2],
}

impl Hull {
    /// The hull of pixels, which are given row by row.
    pub(super) fn of(members: &[u32], width: usize) -> Self {
        // The corners of the first and the last pixel of each row are enough.
        let mut corners: Vec<[i64; 2]> = Vec::new();
        for row in members.chunk_by(|a, b| *a as usize / width == *b as usize / width) {
            let (first, last) = (row[0] as usize, row[row.len() - 1] as usize);
            let y = (first / width) as i64;
            let (left, right) = ((first % width) as i64, (last % width) as i64 + 1);
            corners.extend([[left, y], [left, y + 1], [right, y], [right, y + 1]]);
        }
        corners.sort_unstable();
        let lower = half_hull(corners.iter().copied());
        let upper = half_hull(corners.iter().rev().copied());
        Self {
            sides: [lower, upper],
        }
    }

    /// Its area, px².
    pub(super) fn area(&self) -> f64 {
        let twice: i64 = self.edges().map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum();
        twice.abs() as f64 / 2.0
    }

    /// The pixels whose middles are inside, as column and row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = [i64; 2]> {
        let rows = self.edges().flatten().map(|corner| corner[1]);
        let (top, bottom) = rows.fold((i64::MAX, i64::MIN), |(top, bottom), y| {
            (top.min(y), bottom.max(y))
        });
        (top..bottom).flat_map(move |y| {
            // In units of half a px, where the edges meet the middle of the row.
            let middle = 2 * y + 1;
            let across = self.edges().filter_map(move |[a, b]| {
                let [low, high] = [2 * a[1], 2 * b[1]];
                let is_across = (low < middle) != (high < middle);
                let share = || (middle - low) as f64 / (high - low) as f64;
                is_across.then(|| a[0] as f64 + share() * (b[0] - a[0]) as f64)
            });
            let (left, right) = across
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(left, right), x| {
                    (left.min(x), right.max(x))
                });
            let columns = (left - 0.5).ceil() as i64..(right - 0.5).ceil() as i64;
            columns.map(move |x| [x, y])
        })
    }

    fn edges(&self) -> impl Iterator<Item = [[i64; 2]; 2]> {
        let edges = self.sides.iter().flat_map(|side| side.windows(2));
        edges.map(|edge| [edge[0], edge[1]])
    }
}

/// One half of the hull of sorted places, after Andrew's monotone chain.
fn half_hull(places: impl Iterator<Item = [i64; 2]>) -> Vec<[i64; 2]> {
    let mut hull: Vec<[i64; 2]> = Vec::new();
    for p in places {
        while let [.., a, b] = hull[..] {
            let turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            if turn > 0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_have_their_areas_and_pixels() {
        // A square of 3×3 px with a notch; an L, whose hull cuts its corner off.
        let square = [0, 1, 2, 10, 12, 20, 21, 22];
        assert_eq!(Hull::of(&square, 10).area(), 9.0);
        let ell = [0, 10, 20, 21, 22];
        assert_eq!(Hull::of(&ell, 10).area(), 7.0);
        let inside: Vec<_> = Hull::of(&ell, 10).pixels().collect();
        let expected = [[0, 0], [0, 1], [1, 1], [0, 2], [1, 2], [2, 2]];
        assert_eq!(inside, expected);
    }
}
