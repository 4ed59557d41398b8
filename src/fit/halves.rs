//! Search by halves: which of many changes may be made, where to try all of them costs as much as to try one.

/// Offers all of these to `accepts` at once and, of what it refuses, each half, down to single ones.
pub(super) fn by_halves(all: Vec<usize>, mut accepts: impl FnMut(&[usize]) -> bool) {
    let mut groups = vec![all];
    while let Some(group) = groups.pop() {
        if group.is_empty() || accepts(&group) || group.len() == 1 {
            continue;
        }
        let (some, others) = group.split_at(group.len() / 2);
        groups.extend([some.to_vec(), others.to_vec()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_refused_is_found_among_many() {
        let (mut taken, mut trials) = (Vec::new(), 0);
        by_halves((0..64).collect(), |group| {
            trials += 1;
            let is_good = !group.contains(&17) && !group.contains(&40);
            if is_good {
                taken.extend_from_slice(group);
            }
            is_good
        });
        taken.sort_unstable();
        let good: Vec<usize> = (0..64).filter(|i| ![17, 40].contains(i)).collect();
        assert_eq!(taken, good);
        assert!(trials < 26, "{trials}");
    }

    #[test]
    fn nothing_is_offered_of_nothing() {
        by_halves(Vec::new(), |_| unreachable!());
    }
}
