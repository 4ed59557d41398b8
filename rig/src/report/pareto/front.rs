//! The Pareto front of a set of drawings.

use super::ParetoEntry;

/// The entries that no other of `entries` beats in both `cost` (less is better) and `gain` (more is
/// better), by rising cost. Entries without either are left out.
pub fn front<'a>(
    entries: impl IntoIterator<Item = &'a ParetoEntry>,
    cost: impl Fn(&ParetoEntry) -> Option<f64>,
    gain: impl Fn(&ParetoEntry) -> Option<f64>,
) -> Vec<&'a ParetoEntry> {
    let known = entries.into_iter();
    let mut known: Vec<_> = known
        .filter_map(|e| Some((cost(e)?, gain(e)?, e)))
        .collect();
    known.sort_by(|(a, x, _), (b, y, _)| a.total_cmp(b).then(y.total_cmp(x)));
    let mut best = f64::NEG_INFINITY;
    known.retain(|&(_, gain, _)| {
        let better = gain > best;
        best = best.max(gain);
        better
    });
    known.into_iter().map(|(.., entry)| entry).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{OWN, drawing};
    use super::*;

    #[test]
    fn a_front_has_what_nothing_beats() {
        let own = |label, cpu_s, psnr_db| drawing(OWN, label, cpu_s, 900, psnr_db);
        let entries = [
            own("a", 3.0, 31.0),
            own("b", 1.0, 30.0),
            own("c", 2.0, 29.0),
            own("d", 1.0, 28.0),
        ];
        let front = front(&entries, |e| e.cpu_s, ParetoEntry::psnr_db);
        let labels: Vec<_> = front.iter().map(|e| e.label.as_str()).collect();
        assert_eq!(labels, ["b", "a"]);
    }
}
