//! Soft coverage functions: signed distance in, 0..1 out.

/// A soft coverage function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coverage {
    /// `3t² − 2t³` with `t = clamp((d + s/2)/(s + 1e-4), 0, 1)`.
    Smoothstep,
    /// `1/(1 + exp(−d/s))`.
    Sigmoid,
    /// `tanh(d/s)/2 + ½`.
    Tanh,
    /// `atan(k·d/s)/π + ½`.
    Atan {
        /// Steepness.
        k: f32,
    },
}

/// A coverage function that passes from one to another during a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverageSchedule {
    /// Used while the softness anneals.
    pub early: Coverage,
    /// Used at the final softness, and to judge.
    pub late: Coverage,
}

impl Default for CoverageSchedule {
    fn default() -> Self {
        Self { early: Coverage::Smoothstep, late: Coverage::Smoothstep }
    }
}
