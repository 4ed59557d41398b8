//! The coverage functions, one of each kind and the two ends of `atan`.

use strokefit::coverage::Coverage;

pub(crate) const COVERAGES: [Coverage; 6] = [
    Coverage::Smoothstep,
    Coverage::Sigmoid,
    Coverage::Tanh,
    Coverage::Atan { k: 1.0 },
    Coverage::Atan { k: 4.0 },
    Coverage::Raw,
];
