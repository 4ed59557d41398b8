//! The quickest fits.

use strokefit::fit::{Budget, Config, Preset};

/// The draft of a drawing of at most `strokes` strokes.
pub(crate) fn draft(strokes: usize) -> Config {
    Config {
        budget: Budget {
            strokes: Some(strokes),
            ..Budget::default()
        },
        preset: Preset::Draft,
        ..Config::default()
    }
}
