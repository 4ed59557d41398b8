//! Files to read, `-` being standard input.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use anyhow::{Result, anyhow};
use strokefit::image::{Image, Limits};

const STDIN: &str = "-";

/// Whether the argument means standard input.
pub(super) fn is_stdin(path: &Path) -> bool {
    path == Path::new(STDIN)
}

/// What messages call the file.
pub(super) fn name(path: &Path) -> String {
    if is_stdin(path) {
        "standard input".into()
    } else {
        path.display().to_string()
    }
}

/// Reads a picture.
pub(super) fn picture(path: &Path) -> Result<Image> {
    if !is_stdin(path) {
        return Ok(Image::open(path)?);
    }
    let limits = Limits::default();
    let bytes = read(path, limits.max_bytes)?;
    Ok(Image::decode(&bytes, &name(path), limits)?)
}

/// Reads an SVG file.
pub(super) fn svg(path: &Path) -> Result<String> {
    let limit = Limits::default().max_bytes;
    let bytes = read(path, limit)?;
    let name = name(path);
    if bytes.is_empty() {
        return Err(anyhow!("{name}: the file is empty: give an SVG file"));
    }
    if bytes.len() as u64 > limit {
        return Err(anyhow!(
            "{name}: the file is longer than {} MiB: give a smaller SVG",
            limit >> 20
        ));
    }
    String::from_utf8(bytes).map_err(|_| {
        anyhow!("{name}: not UTF-8 text, so no SVG that can be read: give a plain .svg file")
    })
}

/// All bytes, but no more than one beyond `limit`.
fn read(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let limit = limit.saturating_add(1);
    let outcome = if is_stdin(path) {
        io::stdin().lock().take(limit).read_to_end(&mut bytes)
    } else {
        File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes))
    };
    match outcome {
        Ok(_) => Ok(bytes),
        Err(e) => Err(anyhow!(
            "{}: cannot be read ({e}): check the name and its permissions",
            name(path)
        )),
    }
}
