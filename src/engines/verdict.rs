//! When an engine draws a file as it was meant.

/// How far below resvg's fidelity an engine's may be, dB.
pub const MAX_SHORTFALL_DB: f64 = 0.6;

/// Agreement with resvg's render, dB, that is good enough whatever the fidelity. Engines round
/// colours and edges differently, and agree to 39 to 56 dB on drawings that all of them draw right;
/// what is more faithful than that in one of them cannot be so in all. Below this, a difference of
/// 4 levels in every pixel, something is missing or in another place.
pub const MIN_AGREEMENT_DB: f64 = 36.0;

/// Whether an engine draws what resvg draws: it agrees with resvg to `agreement_db`, or its
/// fidelity, where that is known, falls short of resvg's by no more than it may.
pub fn passes(agreement_db: f64, shortfall_db: Option<f64>) -> bool {
    agreement_db >= MIN_AGREEMENT_DB || shortfall_db.is_some_and(|db| db <= MAX_SHORTFALL_DB)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_engine_must_be_as_faithful_or_agree() {
        for (agreement_db, shortfall_db, verdict) in [
            (f64::INFINITY, None, true),
            (36.0, None, true),
            (35.9, None, false),
            (35.9, Some(0.6), true),
            (35.9, Some(-3.0), true),
            (35.9, Some(0.7), false),
            (41.0, Some(5.0), true),
            (f64::NAN, Some(f64::NAN), false),
        ] {
            assert_eq!(
                passes(agreement_db, shortfall_db),
                verdict,
                "{agreement_db} {shortfall_db:?}"
            );
        }
    }
}
