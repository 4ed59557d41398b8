//! The verdict: an engine draws a file as it is meant, or not.

use crate::metrics::Agreement;

/// Largest shortfall of an engine's fidelity from resvg's, dB.
pub const MAX_SHORTFALL_DB: f64 = 0.6;

/// PSNR of an engine's render against resvg's, dB, that is good enough whatever the fidelity. Engines round
/// colours and edges differently: on drawings that all of them draw right they are 39 to 56 dB apart, and no
/// file can be more faithful than that in all of them. Below this bound, a difference of 4 levels in every
/// pixel, something is missing or in another place.
pub const MIN_DB_AGAINST_RESVG: f64 = 36.0;

/// True if an engine draws what resvg draws: it leaves no gap, and its render is close to resvg's, or its fidelity, where that
/// is known, falls short of resvg's by no more than [`MAX_SHORTFALL_DB`].
pub fn passes(against_resvg: &Agreement, shortfall_db: Option<f64>) -> bool {
    let is_close = against_resvg.psnr_db >= MIN_DB_AGAINST_RESVG;
    let is_as_faithful = shortfall_db.is_some_and(|db| db <= MAX_SHORTFALL_DB);
    !against_resvg.has_gap() && (is_close || is_as_faithful)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_engine_that_leaves_a_gap_fails() {
        let gap = Agreement {
            psnr_db: 50.0,
            max_abs: 255,
            patch_abs: 200,
        };
        assert!(!passes(&gap, Some(0.0)));
    }

    #[test]
    fn an_engine_must_be_as_faithful_or_agree() {
        for (against_resvg_db, shortfall_db, verdict) in [
            (f64::INFINITY, None, true),
            (36.0, None, true),
            (35.9, None, false),
            (35.9, Some(0.6), true),
            (35.9, Some(-3.0), true),
            (35.9, Some(0.7), false),
            (41.0, Some(5.0), true),
            (f64::NAN, Some(f64::NAN), false),
        ] {
            let against_resvg = Agreement {
                psnr_db: against_resvg_db,
                max_abs: 90,
                patch_abs: 9,
            };
            assert_eq!(
                passes(&against_resvg, shortfall_db),
                verdict,
                "{against_resvg_db} {shortfall_db:?}"
            );
        }
    }
}
