//! Values of options: numbers.

use strokefit::fit::{MAX_STROKES, MAX_THREADS};

/// Longest side of a picture of a known drawing, px; it is rendered at four times that.
const MAX_SIDE: usize = 2048;

/// A number of strokes, iterations or frames.
pub(super) fn count(text: &str) -> Result<usize, String> {
    whole(text, MAX_STROKES)
}

/// A number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    whole(text, MAX_THREADS)
}

/// The longer side of a picture, px.
pub(super) fn side(text: &str) -> Result<u16, String> {
    whole(text, MAX_SIDE).and_then(|px| u16::try_from(px).map_err(|e| e.to_string()))
}

fn whole(text: &str, most: usize) -> Result<usize, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (1..=most).contains(number));
    number.ok_or_else(|| format!("give a whole number from 1 to {most}"))
}
