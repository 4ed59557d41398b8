//! Floating-point types of generic formulas.

use std::f64::consts::PI;
use std::fmt::{Debug, Display};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::Elementary;

/// A floating-point type for generic formulas: `f32` in the renderer and the fit,
/// `f64` in the reference and the experiments.
pub trait Real:
    Elementary
    + Debug
    + Display
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Send
    + Sync
    + 'static
{
    /// `x`, rounded to this type.
    fn of(x: f64) -> Self;

    /// This number, exactly.
    fn to_f64(self) -> f64;

    /// The square root.
    fn sqrt(self) -> Self;

    /// Its distance from 0.
    fn abs(self) -> Self;

    /// The lesser of two.
    fn min(self, other: Self) -> Self;

    /// The greater of two.
    fn max(self, other: Self) -> Self;

    /// The nearest number from `low` to `high`.
    fn clamp(self, low: Self, high: Self) -> Self;

    /// 0.
    #[inline]
    fn zero() -> Self {
        Self::of(0.0)
    }

    /// 1.
    #[inline]
    fn one() -> Self {
        Self::of(1.0)
    }

    /// π.
    #[inline]
    fn pi() -> Self {
        Self::of(PI)
    }
}

macro_rules! real {
    ($($float:ident)*) => {$(
        impl Real for $float {
            #[inline]
            fn of(x: f64) -> Self {
                x as Self
            }

            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }

            #[inline]
            fn abs(self) -> Self {
                $float::abs(self)
            }

            #[inline]
            fn min(self, other: Self) -> Self {
                $float::min(self, other)
            }

            #[inline]
            fn max(self, other: Self) -> Self {
                $float::max(self, other)
            }

            #[inline]
            fn clamp(self, low: Self, high: Self) -> Self {
                $float::clamp(self, low, high)
            }
        }
    )*};
}

real! { f32 f64 }

/// x to a whole power, by squaring. The order of the products, and with it their rounding, is fixed here; the standard
/// library does not fix it.
#[inline]
pub fn powi<T: Real>(x: T, exponent: i32) -> T {
    let (mut power, mut square, mut left) = (T::one(), x, exponent.unsigned_abs());
    loop {
        if left & 1 == 1 {
            power *= square;
        }
        left >>= 1;
        if left == 0 {
            break;
        }
        square *= square;
    }
    if exponent < 0 {
        T::one() / power
    } else {
        power
    }
}
