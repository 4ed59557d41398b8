//! Formats that are not read: their names, and a way to make a PNG of such a file.

/// A picture format by its first bytes.
struct Foreign {
    name: &'static str,
    /// Bytes that a file has from `at` on.
    magic: &'static [u8],
    at: usize,
    remedy: &'static str,
}

const fn foreign(
    name: &'static str,
    at: usize,
    magic: &'static [u8],
    remedy: &'static str,
) -> Foreign {
    Foreign {
        name,
        magic,
        at,
        remedy,
    }
}

const AVIF: &str = "avifdec IN OUT.png";
const HEIC: &str = "heif-convert IN OUT.png";
const JXL: &str = "djxl IN OUT.png";
const MAGICK: &str = "magick IN OUT.png";
const PDF: &str = "pdftoppm -png -r 150 IN OUT";
const RAW: &str = "darktable-cli IN OUT.png";

const FOREIGN: [Foreign; 20] = [
    foreign("AVIF", 4, b"ftypavif", AVIF),
    foreign("AVIF", 4, b"ftypavis", AVIF),
    foreign("HEIC", 4, b"ftypheic", HEIC),
    foreign("HEIC", 4, b"ftypheix", HEIC),
    foreign("HEIC", 4, b"ftyphevc", HEIC),
    foreign("HEIC", 4, b"ftypmif1", HEIC),
    foreign("HEIC", 4, b"ftypmsf1", HEIC),
    foreign("JPEG XL", 0, b"\xff\x0a", JXL),
    foreign("JPEG XL", 0, b"\0\0\0\x0cJXL \r\n\x87\n", JXL),
    foreign("JPEG 2000", 0, b"\0\0\0\x0cjP  \r\n\x87\n", MAGICK),
    foreign("JPEG 2000", 0, b"\xff\x4f\xff\x51", MAGICK),
    foreign("OpenEXR", 0, b"\x76\x2f\x31\x01", MAGICK),
    foreign("Photoshop", 0, b"8BPS", MAGICK),
    foreign("GIMP", 0, b"gimp xcf", MAGICK),
    foreign("PDF", 0, b"%PDF-", PDF),
    foreign("PostScript", 0, b"%!PS", MAGICK),
    foreign("Canon raw", 4, b"ftypcrx ", RAW),
    foreign("Fuji raw", 0, b"FUJIFILMCCD-RAW", RAW),
    foreign("Krita", 30, b"mimetypeapplication/x-krita", MAGICK),
    CGBI,
];

/// The start of a PNG that Apple's tools have packed for devices: rows of BGRA, without the frame of zlib.
const CGBI: Foreign = foreign(
    "Apple's optimised PNG (CgBI)",
    0,
    b"\x89PNG\r\n\x1a\n\0\0\0\x04CgBI",
    "xcrun pngcrush -revert-iphone-optimizations IN OUT.png",
);

/// Bytes of a text that may come before the root element of an SVG.
const PROLOG: usize = 4096;

/// True if the file begins as a PNG and is none.
pub(super) fn is_cgbi(bytes: &[u8]) -> bool {
    bytes.starts_with(CGBI.magic)
}

/// Name of the file's format and a way to convert it, if the format is known.
pub(super) fn advice(bytes: &[u8]) -> Option<String> {
    let is = |f: &&Foreign| {
        bytes
            .get(f.at..)
            .is_some_and(|rest| rest.starts_with(f.magic))
    };
    let (name, remedy) = match FOREIGN.iter().find(is) {
        Some(found) => (found.name, found.remedy),
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
