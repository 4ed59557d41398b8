//! The fuzz targets for a moment: the corpus, and inputs made of it.
//!
//! `STROKEFIT_FUZZ=50` makes it as many times longer; what it finds is written to `fuzz/findings`.

use std::path::Path;

#[path = "../../fuzz/src/lib.rs"]
#[allow(clippy::expect_used, clippy::print_stderr, unreachable_pub)]
mod targets;

/// Another seed than the long runs began with.
const SEED: u64 = 11;

/// Tries the corpus of a target and `runs` inputs in all.
fn fuzz(name: &str, runs: u64) {
    let times = std::env::var("STROKEFIT_FUZZ").map_or(1, |times| times.parse().unwrap());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let outcome = targets::drive(&folder, name, runs * times, SEED);
    outcome.unwrap_or_else(|finding| panic!("{finding}"));
}

#[test]
fn pictures_of_any_bytes_are_read_or_refused() {
    fuzz("picture", 20_000);
}

#[test]
fn drawings_of_any_bytes_are_read_or_refused() {
    fuzz("svg", 10_000);
}

#[test]
fn options_of_any_bytes_are_understood_or_refused() {
    fuzz("words", 20_000);
}

#[test]
fn scenes_of_any_numbers_are_written_and_drawn() {
    fuzz("scene", 4000);
}
