//! SIMD levels by name, and those that this machine has.

use fearless_simd::Level;

use crate::error::{Error, Result};
use crate::words::words;

/// The instruction set of the renderer. All of them give the same bits. A machine that has none of them has `Auto` alone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Simd {
    /// The widest that this machine has.
    #[default]
    Auto,
    /// AVX-512 as of Ice Lake.
    Avx512,
    /// AVX2 (x86-64-v3).
    Avx2,
    /// SSE4.2 (x86-64-v2).
    Sse42,
    /// SSE2, which every x86-64 has.
    Sse2,
    /// NEON, which every aarch64 has.
    Neon,
    /// The 128-bit vectors of WebAssembly, in a build with that feature.
    Simd128,
}

impl Simd {
    /// Those that this machine has, widest first.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        let named = Self::ALL.into_iter().filter(|simd| *simd != Self::Auto);
        named.filter(|simd| simd.level().is_some())
    }

    /// The level, if this machine has it.
    pub fn level(self) -> Option<Level> {
        let best = Level::new();
        match self {
            Self::Auto => Some(best),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512 => best.as_avx512().map(Level::Avx512),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2 => best.as_avx2().map(Level::Avx2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse42 => best.as_sse4_2().map(Level::Sse4_2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse2 => best.as_sse2().map(Level::Sse2),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => best.as_neon().map(Level::Neon),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Self::Simd128 => best.as_wasm_simd128().map(Level::WasmSimd128),
            #[allow(unreachable_patterns, reason = "levels of other machines")]
            _ => None,
        }
    }

    /// The level.
    ///
    /// # Errors
    /// [`ErrorKind::Config`](crate::ErrorKind::Config) when this machine does not have it.
    #[doc(hidden)]
    pub fn require(self) -> Result<Level> {
        self.level().ok_or_else(|| {
            let here: Vec<String> = Self::available().map(|s| s.to_string()).collect();
            let message = format!(
                "this machine has no {self}: use auto or one of {}",
                here.join(", ")
            );
            Error::config(message)
        })
    }
}

words!(
    Simd,
    "an instruction set": Auto = "auto",
    Avx512 = "avx512",
    Avx2 = "avx2",
    Sse42 = "sse4.2",
    Sse2 = "sse2",
    Neon = "neon",
    Simd128 = "simd128"
);
