//! The value of `--palette`: a list of colours, or a file of them.

use std::fs;
use std::io;
use std::path::Path;

use strokefit::fit::Colors;

/// Longest file that counts as a palette, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// The list, or the content of the file.
pub(super) fn read(text: &str) -> Result<String, String> {
    let is_file = Path::new(text).exists();
    let is_list = text.contains(',') || Colors::palette(text).is_ok();
    if text.starts_with('#') || !is_file && is_list {
        return Ok(text.to_owned());
    }
    let remedy =
        "give #rrggbb,#rrggbb,..., a file with one such colour per line, or a GIMP palette";
    let unreadable = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => format!("no such file: {remedy}"),
        _ => format!("cannot be read ({e}): {remedy}"),
    };
    let length = fs::metadata(text).map_err(unreadable)?.len();
    if length > MAX_BYTES {
        return Err(format!("the file is longer than 1 MiB: {remedy}"));
    }
    let bytes = fs::read(text).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|_| format!("not a text file: {remedy}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_told_from_a_file() {
        for list in ["#ff0000", "red,blue", "rot,blau"] {
            assert_eq!(read(list).as_deref(), Ok(list));
        }
        let message = read("no-such-file").unwrap_err();
        assert!(message.contains("no such file"), "{message}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.txt");
        fs::write(&path, "red\nblue\n").unwrap();
        assert_eq!(read(&path.to_string_lossy()), Ok("red\nblue\n".into()));
    }
}
