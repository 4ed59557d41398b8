//! Bytes in, text and bytes out: no file is touched, as in a server.
//!
//! ```sh
//! cargo run --release --example memory < samples/noto-gem.png > gem.png
//! ```

use std::io::{self, Read, Write};

use strokefit::fit::{Budget, Config, Fitter, Preset};
use strokefit::image::{Image, Limits};
use strokefit::verify::{self, Size};

/// Pictures that may come from anyone: at most a million pixels, from at most 4 MiB.
const LIMITS: Limits = Limits {
    max_pixels: 1 << 20,
    max_bytes: 4 << 20,
};

/// The SVG text of a picture file, and that SVG as a PNG file of twice the size.
pub(crate) fn convert(file: &[u8]) -> strokefit::Result<(String, Vec<u8>)> {
    // The name is for messages alone.
    let picture = Image::decode(file, "the picture", LIMITS)?;
    let config = Config {
        budget: Budget {
            strokes: Some(150),
            ..Budget::default()
        },
        preset: Preset::Draft,
        ..Config::default()
    };
    let drawing = Fitter::new(config).fit(&picture)?;
    let text = drawing.svg();
    let png = verify::render(&text, Size::Scale(2.0), None)?.encode_png()?;
    Ok((text, png))
}

#[allow(dead_code, reason = "the tests call `convert`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut file = Vec::new();
    io::stdin().read_to_end(&mut file)?;
    let (_, png) = convert(&file)?;
    io::stdout().write_all(&png)?;
    Ok(())
}
