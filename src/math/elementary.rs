//! Elementary functions, all from one place.
//!
//! IEEE 754 fixes `+ − × ÷` and the square root to the last bit. It fixes no other function: each C library rounds
//! `exp` in its own way, and a compiler that knows the argument may round it in yet another. A fit turns one bit
//! into another drawing, so all of the library takes these functions from here, and `clippy.toml` refuses the
//! methods of `f32` and `f64`. Square roots, `floor`, `round` and `mul_add` are exact, and are used as they are.
//!
//! They come from `libm`, a translation of musl's C library to Rust: sums, products and square roots in a fixed
//! order. All that it takes from a processor is exact as well (`sqrt`, `fma`, `rint`, `floor` and `ceil`).

/// Writes a trait with a method for each function, its implementations for `f32` and `f64`, and the functions.
macro_rules! elementary {
    ($($(#[$doc:meta])* $name:ident($x:ident $(, $y:ident)?): $single:path, $double:path;)*) => {
        /// Numbers that the functions of [`math`](super) take: `f32` and `f64`.
        pub trait Elementary: Copy {
            $($(#[$doc])* fn $name(self $(, $y: Self)?) -> Self;)*
        }

        impl Elementary for f32 {
            $(#[inline] fn $name(self $(, $y: Self)?) -> Self { $single(self $(, $y)?) })*
        }

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
    exp(x): libm::expf, libm::exp;
    /// 2 to the power of x.
    exp2(x): libm::exp2f, libm::exp2;
    /// Logarithm of base e.
    ln(x): libm::logf, libm::log;
    /// Logarithm of base 2.
    log2(x): libm::log2f, libm::log2;
    /// Logarithm of base 10.
    log10(x): libm::log10f, libm::log10;
    /// Sine of an angle in radians.
    sin(x): libm::sinf, libm::sin;
    /// Cosine of an angle in radians.
    cos(x): libm::cosf, libm::cos;
    /// Tangent of an angle in radians.
    tan(x): libm::tanf, libm::tan;
    /// Hyperbolic tangent.
    tanh(x): libm::tanhf, libm::tanh;
    /// Angle in radians, −π/2 to π/2, whose tangent is x.
    atan(x): libm::atanf, libm::atan;
    /// Cube root.
    cbrt(x): libm::cbrtf, libm::cbrt;
    /// x to the power of y.
    powf(x, y): libm::powf, libm::pow;
    /// Length of the vector (x, y).
    hypot(x, y): libm::hypotf, libm::hypot;
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos<T: Elementary>(x: T) -> (T, T) {
    (sin(x), cos(x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::powi;

    const EXPECTED: [(&str, u64); 14] = [
        ("exp", 0x8517_d15e_b6a9_a67a),
        ("exp2", 0xe437_e004_dbde_aeb4),
        ("ln", 0x3ff9_d1a4_2675_1c1c),
        ("log2", 0x5b90_dc3e_2e96_63e9),
        ("log10", 0xbad0_eb86_63cb_794e),
        ("sin", 0xb016_11d5_8962_8537),
        ("cos", 0x475f_876b_b863_3c31),
        ("tan", 0x91e2_b2cc_bcda_be3d),
        ("tanh", 0x17a4_e9f3_accb_31ac),
        ("atan", 0x2952_3a8e_8705_5467),
        ("cbrt", 0xb508_8f3a_03d4_00cd),
        ("powf", 0x8b1f_060d_1870_32f2),
        ("powi", 0x18ff_626b_7334_1184),
        ("hypot", 0x2dfa_d7a3_39f8_83d8),
    ];

    /// The bits of a function's values in single and double precision at 2,000 places from 0.001 to 200.
    fn bits(single: fn(f32) -> f32, double: fn(f64) -> f64) -> u64 {
        let places = (1..=2000).map(|i| f64::from(i) * f64::from(i) / 20_000.0);
        let values = places.map(|x| [u64::from(single(x as f32).to_bits()), double(x).to_bits()]);
        let words = values.flatten();
        words.fold(0, |hash, word| {
            (hash.rotate_left(5) ^ word).wrapping_mul(0x517c_c1b7_2722_0a95)
        })
    }

    #[test]
    fn values_have_the_same_bits_on_every_platform() {
        let found = [
            ("exp", bits(|x| exp(-x), |x| exp(-x))),
            ("exp2", bits(exp2, exp2)),
            ("ln", bits(ln, ln)),
            ("log2", bits(log2, log2)),
            ("log10", bits(log10, log10)),
            ("sin", bits(sin, sin)),
            ("cos", bits(cos, cos)),
            ("tan", bits(tan, tan)),
            ("tanh", bits(tanh, tanh)),
            ("atan", bits(atan, atan)),
            ("cbrt", bits(cbrt, cbrt)),
            ("powf", bits(|x| powf(x, 1.7), |x| powf(x, 1.7))),
            ("powi", bits(|x| powi(x, -3), |x| powi(x, -3))),
            ("hypot", bits(|x| hypot(x, 3.1), |x| hypot(x, 3.1))),
        ];
        assert_eq!(found, EXPECTED);
    }

    #[test]
    fn powers_of_two_have_whole_logarithms() {
        for power in -40..=40 {
            assert_eq!(log2(powi(2.0_f32, power)), power as f32);
            assert_eq!(log2(powi(2.0_f64, power)), f64::from(power));
        }
    }

    #[test]
    fn whole_powers_are_products() {
        for (exponent, expected) in [(0, 1.0), (1, 3.0), (2, 9.0), (5, 243.0), (-2, 1.0 / 9.0)] {
            assert_eq!(powi(3.0_f64, exponent), expected, "{exponent}");
            assert_eq!(powi(3.0_f32, exponent), expected as f32, "{exponent}");
        }
        assert_eq!(powi(0.5_f64, i32::MIN), f64::INFINITY);
    }
}
