//! Geometry words of the crate and its elementary functions: the one door of `nalgebra`.

mod elementary;

pub use elementary::{
    Elementary, atan, cbrt, cos, exp, exp2, hypot, ln, log2, log10, powf, powi, sin, sin_cos, tan,
    tanh,
};
pub use nalgebra::{DMatrix, DVector, Point2, Vector2};

/// A point of the picture plane in px; x to the right, y down, pixel centres at +0.5.
pub type Point = Point2<f32>;

/// A displacement in the picture plane in px.
pub type Vector = Vector2<f32>;

/// A floating-point type for generic formulas: `f32` in the renderer and the fit,
/// `f64` in the reference and the experiments.
pub trait Real: nalgebra::RealField + Elementary + Copy {
    /// `x`, rounded to this type.
    fn of(x: f64) -> Self;

    /// This number, exactly.
    fn to_f64(self) -> f64;
}

impl Real for f32 {
    #[inline]
    fn of(x: f64) -> Self {
        x as Self
    }

    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    #[inline]
    fn of(x: f64) -> Self {
        x
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
}
