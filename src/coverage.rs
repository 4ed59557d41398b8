//! Soft coverage functions. They map the signed distance from a pixel's centre to a stroke's edge to the
//! covered part of the pixel, 0..1.
//!
//! `d` is the distance in px, positive inside. `s > 0` is the softness in px, the width
//! over which the edge rises from 0 to 1. `x = d/s`.
//!
//! | function | value | derivative by `d` | where it ends |
//! | --- | --- | --- | --- |
//! | smoothstep | `3t² − 2t³`, `t = clamp((d + s/2)/(s + 1e-4), 0, 1)` | `6t(1−t)/(s + 1e-4)` | `s/2` |
//! | sigmoid | `1/(1 + exp(−x))` | `σ(1−σ)/s` | never |
//! | tanh | `tanh(x)/2 + ½` | `(1 − tanh²x)/2s` | never |
//! | atan | `atan(kx)/π + ½` | `k/(πs(1 + k²x²))` | never |
//! | raw | `clamp(x, −1, 1)/2 + ½` | `1/2s` for `−1 ≤ x ≤ 1`, else 0 | `s` |
//!
//! All are monotone, and `σ(d) + σ(−d) = 1`. For smoothstep this holds only to 1.5e-4/(s + 1e-4), because the
//! 1e-4 in its denominator keeps it defined at s = 0; the golden data contain it too. Smoothstep at
//! s = 1 is close to what an antialiasing rasteriser draws. The article draws its targets with `raw`.
//!
//! Coverage in ninths, from 3 px outside to 3 px inside, at a softness of 1 px:
//!
//! ```
//! use strokefit::coverage::Coverage;
//!
//! let profile = |coverage: Coverage| -> String {
//!     let ninths = |d: i32| (9.0 * coverage.value(f64::from(d) / 4.0, 1.0)).round() as u8;
//!     (-12..=12).map(|d| char::from(b'0' + ninths(d))).collect()
//! };
//! assert_eq!(profile(Coverage::Smoothstep),    "0000000000014899999999999");
//! assert_eq!(profile(Coverage::Tanh),          "0000000112235677889999999");
//! assert_eq!(profile(Coverage::Sigmoid),       "0111112223345566777888889");
//! assert_eq!(profile(Coverage::Atan { k: 1.0 }), "1111112223345566777888888");
//! ```
//!
//! At infinite `d` the values are 0 and 1 and the derivatives 0.
//!
//! Source: the article that this project started from compares these functions (`strokefit-rig lab`).
//! Smoothstep is Hermite's cubic, as in the OpenGL Shading Language.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use crate::error::{Error, ErrorKind, Result};
use crate::math::{self, Real};
use crate::words::from_text;

/// Coverage below which [`Coverage::support`] drops a tail: half of one of 256 levels, so that even a stroke
/// of the highest contrast changes no 8-bit pixel there. With a higher value the cut shows as a ring
/// around soft strokes. With a lower one, every stroke with a tail spends time on pixels that it does not
/// change.
pub const TAIL: f64 = 1.0 / 512.0;

/// Added to smoothstep's width, px, as in the golden data.
const SMOOTHSTEP_EPS: f64 = 1e-4;

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
        /// Steepness, finite and > 0.
        k: f32,
    },
    /// `clamp(d/s, −1, 1)/2 + ½`.
    Raw,
}

impl Coverage {
    /// One of each kind, and `atan` at both ends of its usual steepness, for tests of what holds for all.
    pub const EACH: [Self; 6] = [
        Self::Smoothstep,
        Self::Sigmoid,
        Self::Tanh,
        Self::Atan { k: 1.0 },
        Self::Atan { k: 4.0 },
        Self::Raw,
    ];

    /// Coverage 0..1 at signed distance `d` px, with an edge `softness` px wide.
    #[inline]
    pub fn value<T: Real>(self, d: T, softness: T) -> T {
        let (half, one) = (T::of(0.5), T::one());
        match self {
            Self::Smoothstep => {
                let t = smoothstep_parameter(d, softness);
                t * t * (T::of(3.0) - (t + t))
            }
            Self::Sigmoid => one / (one + math::exp(-d / softness)),
            Self::Tanh => math::tanh(d / softness) * half + half,
            Self::Atan { k } => math::atan(steepness::<T>(k) * d / softness) / T::pi() + half,
            Self::Raw => (d / softness).clamp(-one, one) * half + half,
        }
    }

    /// The derivative of [`value`](Self::value) by `d`, per px.
    #[inline]
    pub fn derivative<T: Real>(self, d: T, softness: T) -> T {
        let (half, one) = (T::of(0.5), T::one());
        match self {
            Self::Smoothstep => {
                let t = smoothstep_parameter(d, softness);
                T::of(6.0) * t * (one - t) / (softness + T::of(SMOOTHSTEP_EPS))
            }
            Self::Sigmoid => {
                let value = self.value(d, softness);
                value * (one - value) / softness
            }
            Self::Tanh => {
                let tanh = math::tanh(d / softness);
                (one - tanh * tanh) * half / softness
            }
            Self::Atan { k } => {
                let k = steepness::<T>(k);
                let x = k * d / softness;
                k / (T::pi() * softness * (one + x * x))
            }
            // At the kinks the slope of the inside, as autograd gives for `clamp`.
            Self::Raw if d.abs() <= softness => half / softness,
            Self::Raw => T::zero(),
        }
    }

    /// Distance outside the edge, px, beyond which coverage is dropped because it is 0 or, for functions with
    /// tails, below [`TAIL`].
    pub fn support(self, softness: f64) -> f64 {
        match self {
            Self::Smoothstep => softness / 2.0,
            // The d for which σ(−d) = TAIL. 1/(1 + e^x) = TAIL gives x = ln(1/TAIL − 1); tanh is the sigmoid of 2x; atan(−kx)/π +
            // ½ = TAIL gives kx = 1/tan(π·TAIL).
            Self::Sigmoid => softness * math::ln(1.0 / TAIL - 1.0),
            Self::Tanh => softness * math::ln(1.0 / TAIL - 1.0) / 2.0,
            Self::Atan { k } => softness / (f64::from(k) * math::tan(PI * TAIL)),
            Self::Raw => softness,
        }
    }
}

fn smoothstep_parameter<T: Real>(d: T, softness: T) -> T {
    // The guard is in the denominator alone, so t = ½ is reached a hair inside of the edge.
    let t = (d + softness * T::of(0.5)) / (softness + T::of(SMOOTHSTEP_EPS));
    t.clamp(T::zero(), T::one())
}

fn steepness<T: Real>(k: f32) -> T {
    T::of(f64::from(k))
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Smoothstep => f.write_str("smoothstep"),
            Self::Sigmoid => f.write_str("sigmoid"),
            Self::Tanh => f.write_str("tanh"),
            Self::Atan { k: 1.0 } => f.write_str("atan"),
            Self::Atan { k } => write!(f, "atan:{k}"),
            Self::Raw => f.write_str("raw"),
        }
    }
}

/// Reads the words that [`Display`](fmt::Display) writes: `smoothstep`, `sigmoid`, `tanh`, `atan`, `atan:K`
/// or `raw`.
///
/// # Errors
/// [`ErrorKind::Config`] for any other word, or a `K` that is not a finite number above 0.
impl FromStr for Coverage {
    type Err = Error;

    fn from_str(word: &str) -> Result<Self> {
        match word {
            "smoothstep" => Ok(Self::Smoothstep),
            "sigmoid" => Ok(Self::Sigmoid),
            "tanh" => Ok(Self::Tanh),
            "atan" => Ok(Self::Atan { k: 1.0 }),
            "raw" => Ok(Self::Raw),
            _ => match word.strip_prefix("atan:") {
                Some(k) => parse_steepness(k),
                None => Err(unknown(word)),
            },
        }
    }
}

fn parse_steepness(word: &str) -> Result<Coverage> {
    match word.parse::<f32>() {
        Ok(k) if k.is_finite() && k > 0.0 => Ok(Coverage::Atan { k }),
        _ => Err(Error::new(
            ErrorKind::Config,
            format!(
                "coverage `atan:{word}`: the steepness must be a finite number above 0, as in `atan:4`"
            ),
        )),
    }
}

fn unknown(word: &str) -> Error {
    Error::new(
        ErrorKind::Config,
        format!(
            "no coverage function is called `{word}`: use smoothstep, sigmoid, tanh, atan, atan:K or raw"
        ),
    )
}

/// A coverage function that may change from one to another during a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverageSchedule {
    /// Used while the softness anneals.
    pub early: Coverage,
    /// Used at the final softness, and to judge strokes.
    pub late: Coverage,
}

impl Default for CoverageSchedule {
    fn default() -> Self {
        Coverage::Smoothstep.into()
    }
}

/// One function throughout.
impl From<Coverage> for CoverageSchedule {
    fn from(coverage: Coverage) -> Self {
        Self {
            early: coverage,
            late: coverage,
        }
    }
}

impl fmt::Display for CoverageSchedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.early == self.late {
            write!(f, "{}", self.late)
        } else {
            write!(f, "{}>{}", self.early, self.late)
        }
    }
}

/// Reads `A` (one function throughout) or `A>B`.
///
/// # Errors
/// [`ErrorKind::Config`] if `A` or `B` is not a coverage function.
impl FromStr for CoverageSchedule {
    type Err = Error;

    fn from_str(words: &str) -> Result<Self> {
        match words.split_once('>') {
            None => Ok(words.parse::<Coverage>()?.into()),
            Some((early, late)) => Ok(Self {
                early: early.parse()?,
                late: late.parse()?,
            }),
        }
    }
}

from_text!(CoverageSchedule);

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Coverage; 7] = [
        Coverage::Smoothstep,
        Coverage::Sigmoid,
        Coverage::Tanh,
        Coverage::Atan { k: 1.0 },
        Coverage::Atan { k: 1.5 },
        Coverage::Atan { k: 4.0 },
        Coverage::Raw,
    ];
    const SOFTNESSES: [f64; 4] = [0.25, 1.0, 1.7, 4.0];

    /// Distances that avoid the kinks of `raw` and smoothstep at every softness above.
    fn distances() -> impl Iterator<Item = f64> {
        (-60..=60).map(|i| f64::from(i) * 0.173 + 0.0071)
    }

    #[test]
    fn derivatives_are_central_differences() {
        let mut failures = Vec::new();
        for coverage in ALL {
            for s in SOFTNESSES {
                for d in distances() {
                    let step = 1e-6;
                    let rise = coverage.value(d + step, s) - coverage.value(d - step, s);
                    let (numeric, analytic) = (rise / (2.0 * step), coverage.derivative(d, s));
                    if (numeric - analytic).abs() > 1e-8 {
                        failures.push(format!(
                            "{coverage} s {s} d {d}: {analytic} against {numeric}"
                        ));
                    }
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    #[test]
    fn what_is_outside_of_an_edge_is_inside_of_its_complement() {
        for coverage in ALL {
            for s in SOFTNESSES {
                let slack = match coverage {
                    Coverage::Smoothstep => 1.5 * SMOOTHSTEP_EPS / s,
                    _ => 1e-15,
                };
                for d in distances() {
                    let sum = coverage.value(d, s) + coverage.value(-d, s);
                    assert!((sum - 1.0).abs() <= slack, "{coverage} s {s} d {d}: {sum}");
                }
            }
        }
    }

    #[test]
    fn coverage_rises_from_0_to_1() {
        for coverage in ALL {
            for s in SOFTNESSES {
                let values: Vec<f64> = distances().map(|d| coverage.value(d, s)).collect();
                assert!(values.is_sorted(), "{coverage} s {s}");
                assert!(
                    values.iter().all(|v| (0.0..=1.0).contains(v)),
                    "{coverage} s {s}"
                );
                assert_eq!(coverage.value(f64::NEG_INFINITY, s), 0.0, "{coverage}");
                assert_eq!(coverage.value(f64::INFINITY, s), 1.0, "{coverage}");
                assert_eq!(coverage.derivative(f64::NEG_INFINITY, s), 0.0, "{coverage}");
                assert_eq!(coverage.derivative(f64::INFINITY, s), 0.0, "{coverage}");
            }
        }
    }

    #[test]
    fn nothing_to_speak_of_lies_beyond_the_support() {
        for coverage in ALL {
            for s in SOFTNESSES {
                let (support, step) = (coverage.support(s), 1e-9);
                let (beyond, within) = (-support - step, -support * 0.99);
                match coverage {
                    Coverage::Smoothstep | Coverage::Raw => {
                        assert_eq!(coverage.value(beyond, s), 0.0);
                        assert!(coverage.value(within, s) > 0.0);
                    }
                    _ => {
                        assert!(coverage.value(beyond, s) < TAIL, "{coverage} s {s}");
                        assert!(coverage.value(within, s) > TAIL, "{coverage} s {s}");
                    }
                }
            }
        }
    }

    #[test]
    fn single_precision_follows_double() {
        for coverage in ALL {
            for d in distances() {
                let (single, double) = (coverage.value(d as f32, 1.5), coverage.value(d, 1.5));
                assert!(
                    (f64::from(single) - double).abs() < 1e-6,
                    "{coverage} d {d}"
                );
            }
        }
    }

    #[test]
    fn words_are_read_as_they_are_written() {
        for coverage in ALL {
            assert_eq!(coverage.to_string().parse::<Coverage>().unwrap(), coverage);
            let mix = CoverageSchedule {
                early: Coverage::Sigmoid,
                late: coverage,
            };
            assert_eq!(mix.to_string().parse::<CoverageSchedule>().unwrap(), mix);
        }
        let mix: CoverageSchedule = "atan:2.5>smoothstep".parse().unwrap();
        assert_eq!(mix.early, Coverage::Atan { k: 2.5 });
        assert_eq!(mix.late, Coverage::Smoothstep);
        assert_eq!(
            "tanh".parse::<CoverageSchedule>().unwrap(),
            Coverage::Tanh.into()
        );
    }

    #[test]
    fn nonsense_is_named() {
        for word in [
            "", "gauss", "atan:", "atan:0", "atan:-1", "atan:inf", "atan:NaN", "Tanh", "tanh ",
        ] {
            let error = word.parse::<Coverage>().unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Config);
            assert!(error.to_string().contains(&format!("`{word}`")), "{error}");
        }
        for words in ["tanh>", ">tanh", "tanh>tanh>tanh"] {
            assert!(words.parse::<CoverageSchedule>().is_err(), "{words}");
        }
    }
}
