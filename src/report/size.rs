//! The length of a file, and compression. The one door of `flate2`.

use std::io::Write;

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};

/// Bytes of `text` after gzip at its highest level, as a web server may send it.
pub fn gzip_bytes(text: &str) -> usize {
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to memory cannot fail.
    let _ = gzip.write_all(text.as_bytes());
    gzip.finish().map_or(0, |bytes| bytes.len())
}

/// The bytes compressed as zlib does at its highest level.
pub(crate) fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing to memory cannot fail.
    let _ = zlib.write_all(bytes);
    zlib.finish().unwrap_or_default()
}

/// Bytes of a file, head and layers included, per stroke; `None` without strokes.
pub fn per_stroke(bytes: usize, strokes: usize) -> Option<f64> {
    (strokes > 0).then(|| bytes as f64 / strokes as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_repeats_is_compressed() {
        let text = "<path/>".repeat(1000);
        assert!((18..200).contains(&gzip_bytes(&text)));
    }

    #[test]
    fn nothing_is_not_divided_by() {
        assert_eq!([per_stroke(300, 4), per_stroke(300, 0)], [Some(75.0), None]);
    }
}
