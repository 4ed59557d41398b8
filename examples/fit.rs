//! A picture file in, an SVG file out, and how faithful it is.
//!
//! ```sh
//! cargo run --release --example fit -- samples/coffee-300.png coffee.svg
//! ```
#![allow(clippy::print_stdout)]

use std::path::Path;

use strokefit::fit::{Budget, Config, Fitter, Preset};
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::verify;

/// Draws `input` with at most `strokes` strokes and writes `output`; how faithful the file is.
pub(crate) fn draw(
    input: &Path,
    output: &Path,
    strokes: usize,
) -> Result<Quality, Box<dyn std::error::Error>> {
    let picture = Image::open(input)?;
    let config = Config {
        budget: Budget {
            strokes: Some(strokes),
            ..Budget::default()
        },
        preset: Preset::Draft,
        ..Config::default()
    };
    let drawing = Fitter::new(config).fit(&picture)?;
    let text = drawing.svg();
    std::fs::write(output, &text)?;
    // The judge is a renderer that knows nothing of the fit.
    Ok(verify::fidelity(&text, &drawing.target)?)
}

#[allow(dead_code, reason = "the tests call `draw`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let (Some(input), Some(output)) = (args.next(), args.next()) else {
        return Err("say which picture to draw, and which SVG to write".into());
    };
    let quality = draw(input.as_ref(), output.as_ref(), 500)?;
    println!("{output}: {:.2} dB", quality.psnr_db);
    Ok(())
}
