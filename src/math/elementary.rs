//! Elementary functions, all from one place.
//!
//! IEEE 754 fixes `+ − × ÷` and the square root to the last bit. It fixes no other function: each C library rounds
//! `exp` in its own way, and a compiler that knows the argument may round it in yet another. A fit turns one bit
//! into another drawing, so all of the library takes these functions from here, and `clippy.toml` refuses the
//! methods of `f32` and `f64`. Square roots, `floor`, `round` and `mul_add` are exact, and are used as they are.

use super::Real;

/// Writes a trait with a method for each function, its implementations for `f32` and `f64`, and the functions.
macro_rules! elementary {
    ($($(#[$doc:meta])* $name:ident($x:ident $(, $y:ident)?): $single:path, $double:path;)*) => {
        /// What the functions of [`math`](super) can be taken of: `f32` and `f64`.
        pub trait Elementary: Copy {
            $($(#[$doc])* fn $name(self $(, $y: Self)?) -> Self;)*
        }

        #[allow(clippy::disallowed_methods)]
        impl Elementary for f32 {
            $(#[inline] fn $name(self $(, $y: Self)?) -> Self { $single(self $(, $y)?) })*
        }

        #[allow(clippy::disallowed_methods)]
        impl Elementary for f64 {
            $(#[inline] fn $name(self $(, $y: Self)?) -> Self { $double(self $(, $y)?) })*
        }

        $($(#[$doc])* #[inline] pub fn $name<T: Elementary>($x: T $(, $y: T)?) -> T {
            Elementary::$name($x $(, $y)?)
        })*
    };
}

elementary! {
    /// e to the power of x.
    exp(x): f32::exp, f64::exp;
    /// 2 to the power of x.
    exp2(x): f32::exp2, f64::exp2;
    /// Logarithm of base e.
    ln(x): f32::ln, f64::ln;
    /// Logarithm of base 2.
    log2(x): f32::log2, f64::log2;
    /// Logarithm of base 10.
    log10(x): f32::log10, f64::log10;
    /// Sine of an angle in radians.
    sin(x): f32::sin, f64::sin;
    /// Cosine of an angle in radians.
    cos(x): f32::cos, f64::cos;
    /// Tangent of an angle in radians.
    tan(x): f32::tan, f64::tan;
    /// Hyperbolic tangent.
    tanh(x): f32::tanh, f64::tanh;
    /// Angle in radians, −π/2 to π/2, whose tangent is x.
    atan(x): f32::atan, f64::atan;
    /// Cube root.
    cbrt(x): f32::cbrt, f64::cbrt;
    /// x to the power of y.
    powf(x, y): f32::powf, f64::powf;
    /// Length of the vector (x, y).
    hypot(x, y): f32::hypot, f64::hypot;
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos<T: Elementary>(x: T) -> (T, T) {
    (sin(x), cos(x))
}

/// x to a whole power, by squaring. The order of the products, and with it their rounding, is fixed here, which
/// that of the standard library's function is not.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_powers_are_products() {
        for (exponent, expected) in [(0, 1.0), (1, 3.0), (2, 9.0), (5, 243.0), (-2, 1.0 / 9.0)] {
            assert_eq!(powi(3.0_f64, exponent), expected, "{exponent}");
            assert_eq!(powi(3.0_f32, exponent), expected as f32, "{exponent}");
        }
        assert_eq!(powi(0.5_f64, i32::MIN), f64::INFINITY);
    }
}
