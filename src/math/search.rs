//! Search for the least value of a function of a few numbers.

/// A point near `start` where `cost` is least, by steps along each number in turn that are halved where none is an
/// improvement.
pub(crate) fn search<const N: usize>(
    start: [f64; N],
    mut step: f64,
    finest: f64,
    cost: impl Fn([f64; N]) -> f64,
) -> [f64; N] {
    let (mut best, mut least) = (start, cost(start));
    while step >= finest {
        let mut improved = false;
        // Each step starts from the best so far, so one round may move along several numbers.
        for (i, sign) in (0..N).flat_map(|i| [(i, 1.0), (i, -1.0)]) {
            let mut moved = best;
            moved[i] += sign * step;
            let found = cost(moved);
            if found < least {
                (best, least, improved) = (moved, found, true);
            }
        }
        if !improved {
            step /= 2.0;
        }
    }
    best
}
