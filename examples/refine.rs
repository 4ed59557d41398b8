//! Going on from an SVG, one's own or anyone's: its text stays, strokes are laid on it.
//!
//! ```sh
//! cargo run --release --example refine -- traced.svg photo.png finished.svg
//! ```
#![allow(clippy::print_stdout)]

use strokefit::fit::{Base, Budget, Config, Fitter, Preset};
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::verify;

/// The SVG `base` with up to `strokes` strokes more, towards `picture`, and how faithful it was and is.
pub(crate) fn refine(
    base: &str,
    picture: &Image,
    strokes: usize,
) -> strokefit::Result<(String, [Quality; 2])> {
    let before = verify::fidelity(base, picture)?;
    let base = Base::read(base.to_owned(), picture, false)?;
    let config = Config {
        budget: Budget {
            // Those of the base count too.
            strokes: Some(base.scene.len() + strokes),
            ..Budget::default()
        },
        preset: Preset::Draft,
        ..Config::default()
    };
    let text = Fitter::new(config).on(base).fit(picture)?.svg();
    let after = verify::fidelity(&text, picture)?;
    Ok((text, [before, after]))
}

#[allow(dead_code, reason = "the tests call `refine`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [base, picture, output] = args.as_slice() else {
        return Err(
            "say which SVG to go on from, which picture to draw, and which SVG to write".into(),
        );
    };
    let base = std::fs::read_to_string(base)?;
    let (text, [before, after]) = refine(&base, &Image::open(picture)?, 200)?;
    std::fs::write(output, text)?;
    println!("{:.2} dB, before {:.2} dB", after.psnr_db, before.psnr_db);
    Ok(())
}
