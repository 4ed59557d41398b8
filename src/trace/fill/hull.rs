//! The area of the convex hull of some pixels.

/// The area of the convex hull of pixels, px². They are given row by row.
pub(super) fn hull_area(members: &[u32], width: usize) -> f64 {
    // The corners of the first and the last pixel of each row are enough.
    let mut corners: Vec<[i64; 2]> = Vec::new();
    for row in members.chunk_by(|a, b| *a as usize / width == *b as usize / width) {
        let (first, last) = (row[0] as usize, row[row.len() - 1] as usize);
        let y = (first / width) as i64;
        let (left, right) = ((first % width) as i64, (last % width) as i64 + 1);
        corners.extend([[left, y], [left, y + 1], [right, y], [right, y + 1]]);
    }
    corners.sort_unstable();
    let mut twice = 0;
    let lower = half_hull(corners.iter().copied());
    let upper = half_hull(corners.iter().rev().copied());
    for side in [lower, upper] {
        for pair in side.windows(2) {
            twice += pair[0][0] * pair[1][1] - pair[0][1] * pair[1][0];
        }
    }
    twice.abs() as f64 / 2.0
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
    fn hulls_have_their_areas() {
        // A square of 3×3 px with a notch; an L, whose hull cuts its corner off.
        let square = [0, 1, 2, 10, 12, 20, 21, 22];
        assert_eq!(hull_area(&square, 10), 9.0);
        let ell = [0, 10, 20, 21, 22];
        assert_eq!(hull_area(&ell, 10), 7.0);
    }
}
