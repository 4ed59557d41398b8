//! The program that cargo has built for these tests.

/// Its path.
pub(crate) const STROKEFIT: &str = env!("CARGO_BIN_EXE_strokefit");
