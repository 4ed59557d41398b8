//! When an engine draws a file as it was meant.

use crate::metrics::{Agreement, Quality};

/// How far below resvg's fidelity an engine's may be, dB.
pub const MAX_SHORTFALL_DB: f64 = 0.6;

/// Fidelity that is good enough whatever resvg's is, dB. Engines round colours and edges
/// differently and agree to 41 to 56 dB; a drawing that is more faithful than that in one
/// engine cannot be so in all. An error of 2 levels of 255 is 42 dB.
pub const CLEAR_DB: f64 = 42.0;

/// Least agreement with resvg's render, dB, where there is no picture to be faithful to.
pub const MIN_AGREEMENT_DB: f64 = 36.0;

/// Whether an engine that is as faithful as `engine` draws what resvg draws.
pub fn passes(engine: &Quality, resvg: &Quality) -> bool {
    engine.psnr_db >= resvg.psnr_db.min(CLEAR_DB + MAX_SHORTFALL_DB) - MAX_SHORTFALL_DB
}

/// Whether an engine draws what resvg draws, from the agreement of both alone.
pub fn passes_alone(agreement: &Agreement) -> bool {
    agreement.psnr_db >= MIN_AGREEMENT_DB
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quality(psnr_db: f64) -> Quality {
        Quality {
            psnr_db,
            ssim: 1.0,
            mse: 0.0,
            l1: 0.0,
        }
    }

    #[test]
    fn an_engine_may_fall_short_by_little_or_where_nobody_sees_it() {
        for (engine, resvg, verdict) in [
            (30.0, 30.5, true),
            (30.0, 30.7, false),
            (33.0, 30.0, true),
            (42.0, 55.0, true),
            (41.9, 55.0, false),
            (41.9, 42.4, true),
            (f64::INFINITY, f64::INFINITY, true),
        ] {
            assert_eq!(
                passes(&quality(engine), &quality(resvg)),
                verdict,
                "{engine} {resvg}"
            );
        }
    }
}
