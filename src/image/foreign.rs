//! Formats that are not read: their names, and a way to make a PNG of such a file.

/// A picture format: its name, the bytes that a file has from a place on, and a remedy.
type Foreign = (&'static str, usize, &'static [u8], &'static str);

const AVIF: &str = "avifdec IN OUT.png";
const HEIC: &str = "heif-convert IN OUT.png";
const JXL: &str = "djxl IN OUT.png";
const MAGICK: &str = "magick IN OUT.png";
const PDF: &str = "pdftoppm -png -r 150 IN OUT";
const RAW: &str = "darktable-cli IN OUT.png";

const FOREIGN: [Foreign; 20] = [
    ("AVIF", 4, b"ftypavif", AVIF),
    ("AVIF", 4, b"ftypavis", AVIF),
    ("HEIC", 4, b"ftypheic", HEIC),
    ("HEIC", 4, b"ftypheix", HEIC),
    ("HEIC", 4, b"ftyphevc", HEIC),
    ("HEIC", 4, b"ftypmif1", HEIC),
    ("HEIC", 4, b"ftypmsf1", HEIC),
    ("JPEG XL", 0, b"\xff\x0a", JXL),
    ("JPEG XL", 0, b"\0\0\0\x0cJXL \r\n\x87\n", JXL),
    ("JPEG 2000", 0, b"\0\0\0\x0cjP  \r\n\x87\n", MAGICK),
    ("JPEG 2000", 0, b"\xff\x4f\xff\x51", MAGICK),
    ("OpenEXR", 0, b"\x76\x2f\x31\x01", MAGICK),
    ("Photoshop", 0, b"8BPS", MAGICK),
    ("GIMP", 0, b"gimp xcf", MAGICK),
    ("PDF", 0, b"%PDF-", PDF),
    ("PostScript", 0, b"%!PS", MAGICK),
    ("Canon raw", 4, b"ftypcrx ", RAW),
    ("Fuji raw", 0, b"FUJIFILMCCD-RAW", RAW),
    ("Krita", 30, b"mimetypeapplication/x-krita", MAGICK),
    CGBI,
];

/// The start of a PNG that Apple's tools have packed for devices: rows of BGRA, without the frame of zlib.
const CGBI: Foreign = (
    "Apple's optimised PNG (CgBI)",
    0,
    b"\x89PNG\r\n\x1a\n\0\0\0\x04CgBI",
    "xcrun pngcrush -revert-iphone-optimizations IN OUT.png",
);

/// Bytes of a text that may come before the root element of an SVG.
const PROLOG: usize = 4096;

/// True if the file begins as a PNG and is none.
pub(super) fn is_cgbi(bytes: &[u8]) -> bool {
    bytes.starts_with(CGBI.2)
}

/// Name of the file's format and a way to convert it, if the format is known.
pub(super) fn advice(bytes: &[u8]) -> Option<String> {
    let is = |(_, at, magic, _): &&Foreign| {
        let rest = bytes.get(*at..);
        rest.is_some_and(|rest| rest.starts_with(magic))
    };
    let (name, remedy) = match FOREIGN.iter().find(is) {
        Some((name, .., remedy)) => (*name, *remedy),
        None if is_svg(bytes) => ("SVG", "strokefit render IN -o OUT.png"),
        None => return None,
    };
    Some(format!(
        "the file is {name}, which strokefit does not read: convert it first, for example with {remedy}"
    ))
}

fn is_svg(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(PROLOG)];
    let head = String::from_utf8_lossy(head);
    let head = head.trim_start_matches('\u{feff}').trim_start();
    head.starts_with('<') && head.contains("<svg")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_their_first_bytes() {
        for (bytes, word) in [
            (&b"\0\0\0\x20ftypavif\0\0"[..], "AVIF"),
            (b"\0\0\0\x18ftypheic", "heif-convert"),
            (b"\xff\x0a\xfa\x1f", "djxl"),
            (
                b"\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- a -->\n<svg xmlns=\"\">",
                "strokefit render",
            ),
            (b"%PDF-1.7", "PDF"),
        ] {
            let advice = advice(bytes).unwrap();
            assert!(advice.contains(word), "{advice}");
        }
        assert_eq!(advice(b"hello <svg>"), None);
        assert_eq!(advice(b""), None);
    }
}
