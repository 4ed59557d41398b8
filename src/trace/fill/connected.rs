//! The connected pixels of a picture that have one label, and where they touch.

/// The region of each pixel, and the pixels of each region, row by row, 4-connected: two passes, after Rosenfeld and Pfaltz,
/// "Sequential operations in digital picture processing".
pub(super) fn connected<K: PartialEq>(
    count: usize,
    width: usize,
    key: impl Fn(usize) -> K,
) -> (Vec<u32>, Vec<Vec<u32>>) {
    // An earlier pixel of the same region, for each pixel but the first one.
    let mut earlier: Vec<u32> = Vec::with_capacity(count);
    for i in 0..count {
        let own = key(i);
        let is_alike = |k: &usize| key(*k) == own;
        let left = i.checked_sub(1).filter(|_| !i.is_multiple_of(width));
        let left = left.filter(is_alike).map(|k| earlier[k]);
        let above = i.checked_sub(width).filter(is_alike).map(|k| earlier[k]);
        let first = match (left, above) {
            (Some(left), Some(above)) if left != above => join(&mut earlier, left, above),
            (Some(first), _) | (None, Some(first)) => first,
            (None, None) => i as u32,
        };
        earlier.push(first);
    }
    let mut of = earlier;
    let mut members: Vec<Vec<u32>> = Vec::new();
    for i in 0..of.len() {
        // What is earlier has its region by now.
        let region = match of[i] as usize {
            first if first == i => members.len() as u32,
            before => of[before],
        };
        of[i] = region;
        if region as usize == members.len() {
            members.push(Vec::new());
        }
        members[region as usize].push(i as u32);
    }
    (of, members)
}

/// Joins the regions of two pixels, and returns the first pixel of both.
fn join(earlier: &mut [u32], a: u32, b: u32) -> u32 {
    let [a, b] = [a, b].map(|pixel| {
        let mut first = pixel as usize;
        while earlier[first] as usize != first {
            // Half of the way will do next time.
            earlier[first] = earlier[earlier[first] as usize];
            first = earlier[first] as usize;
        }
        first as u32
    });
    earlier[a.max(b) as usize] = a.min(b);
    a.min(b)
}

/// The pairs of pixels, beside or below each other, that are of different regions.
pub(super) fn borders(of: &[u32], width: usize) -> impl Iterator<Item = [usize; 2]> + '_ {
    (0..of.len()).flat_map(move |i| {
        let is_last = (i + 1).is_multiple_of(width);
        let next = [Some(i + 1).filter(|_| !is_last), Some(i + width)];
        let next = next.into_iter().flatten();
        let others = next.filter(move |&k| of.get(k).is_some_and(|other| *other != of[i]));
        others.map(move |k| [i, k])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The regions of a picture in letters, each as a letter of its own.
    fn regions(rows: &[&str]) -> Vec<String> {
        let labels = rows.concat().into_bytes();
        let (of, members) = connected(labels.len(), rows[0].len(), |i| labels[i]);
        for (region, pixels) in members.iter().enumerate() {
            assert!(pixels.is_sorted() && pixels.iter().all(|&i| of[i as usize] == region as u32));
        }
        let letters: String = of
            .iter()
            .map(|&region| char::from(b'a' + region as u8))
            .collect();
        let rows = letters.as_bytes().chunks(rows[0].len());
        rows.map(|row| String::from_utf8_lossy(row).into_owned())
            .collect()
    }

    #[test]
    fn what_meets_below_is_one_region() {
        let comb = ["x.x.x.x", "x.x.xxx", "x.xxx..", "xxx..xx"];
        assert_eq!(regions(&comb), ["abacada", "abacaaa", "abaaaee", "aaaffgg"]);
    }

    #[test]
    fn corners_do_not_connect_and_rows_do_not_run_on() {
        assert_eq!(regions(&["x.", ".x"]), ["ab", "cd"]);
        assert_eq!(regions(&["..x", "x.."]), ["aab", "caa"]);
    }
}
