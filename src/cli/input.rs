//! Reads input files; `-` is standard input.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use anyhow::{Result, anyhow};
use strokefit::image::{Image, Limits, Remark};

use super::{hint, misuse};

const STDIN: &str = "-";

/// True if the argument means standard input.
pub(super) fn is_stdin(path: &Path) -> bool {
    path == Path::new(STDIN)
}

/// Refuses to read two of the files from standard input; `what` says what they are.
pub(super) fn expect_one_stdin(files: &[&Path], what: &str) -> Result<()> {
    if files.iter().filter(|path| is_stdin(path)).count() > 1 {
        return Err(misuse(format!(
            "standard input cannot be both {what}: name one of them"
        )));
    }
    Ok(())
}

/// An error of the library about the file at `path`, with its name.
pub(super) fn blame(error: anyhow::Error, path: &Path) -> anyhow::Error {
    match error.downcast::<strokefit::Error>() {
        Ok(error) => error.within(name(path)).into(),
        Err(error) => error,
    }
}

/// The name of the file in messages.
pub fn name(path: &Path) -> String {
    if is_stdin(path) {
        "standard input".into()
    } else {
        path.display().to_string()
    }
}

/// Reads a picture, within the usual limits.
pub fn picture(path: &Path) -> Result<Image> {
    Ok(picture_within(path, Limits::default())?.0)
}

/// Reads a picture, within the limits, and says what was changed or left out.
pub(super) fn picture_within(path: &Path, limits: Limits) -> Result<(Image, Vec<Remark>)> {
    if !is_stdin(path) {
        return Image::read_within(path, limits).map_err(|e| hint::or_neighbour(e.into(), path));
    }
    let bytes = read(path, limits.max_bytes)?;
    Ok(Image::decode_remarking(&bytes, &name(path), limits)?)
}

/// Reads an SVG file.
pub fn svg(path: &Path) -> Result<String> {
    text(path, "an SVG file")
}

/// Reads a text file; `kind` says what it should be.
pub(super) fn text(path: &Path, kind: &str) -> Result<String> {
    let limit = Limits::default().max_bytes;
    let bytes = read(path, limit)?;
    let name = name(path);
    if bytes.is_empty() {
        return Err(anyhow!("{name}: the file is empty: give {kind}"));
    }
    if bytes.len() as u64 > limit {
        let most = limit >> 20;
        return Err(anyhow!(
            "{name}: the file is longer than {most} MiB: give {kind} of less"
        ));
    }
    String::from_utf8(bytes).map_err(|_| anyhow!("{name}: not UTF-8 text: give {kind}"))
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
        Err(error) => Err(hint::or_neighbour(unreadable(path, &error), path)),
    }
}

fn unreadable(path: &Path, error: &io::Error) -> anyhow::Error {
    let name = name(path);
    match error.kind() {
        io::ErrorKind::NotFound => anyhow!("{name}: no such file: check the name"),
        io::ErrorKind::PermissionDenied => {
            anyhow!("{name}: permission denied: make the file readable")
        }
        io::ErrorKind::IsADirectory => anyhow!("{name}: is a directory: name a file in it"),
        _ => anyhow!("{name}: cannot be read ({error}): check the file"),
    }
}
