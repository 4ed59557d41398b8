//! The formats that are read: their marks, and the kinds of each that are read.

use ::image::ImageFormat;

use super::header;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Format {
    /// Its usual name.
    pub name: &'static str,
    /// The extensions of its files, without a dot.
    pub extensions: &'static [&'static str],
    /// Kinds that are read.
    pub read: &'static str,
    /// Kinds that are refused; empty if there are none.
    pub refused: &'static str,
}

/// The formats of a build with the feature `formats`; one without it reads the first alone. The table in
/// `docs/command-line.md` is this one.
pub const FORMATS: [Format; 13] = [
    Format {
        name: "PNG",
        extensions: &["png", "apng"],
        read: "all; colours by `cICP` (SDR, PQ and HLG), `iCCP`, `sRGB`, or `gAMA` and `cHRM`, the first that there is",
        refused: "Apple's optimised PNG (CgBI)",
    },
    Format {
        name: "JPEG",
        extensions: &["jpg", "jpeg", "jfif"],
        read: "baseline and progressive; grey, RGB, YCbCr, CMYK and YCCK",
        refused: "12 bits, lossless, arithmetic coding",
    },
    Format {
        name: "WebP",
        extensions: &["webp"],
        read: "lossy and lossless, the first frame",
        refused: "",
    },
    Format {
        name: "GIF",
        extensions: &["gif"],
        read: "the first frame",
        refused: "",
    },
    Format {
        name: "BMP",
        extensions: &["bmp", "dib"],
        read: "1 to 32 bits",
        refused: "JPEG or PNG inside",
    },
    Format {
        name: "TIFF",
        extensions: &["tif", "tiff"],
        read: "the first page, BigTIFF too; grey, palette, RGB, YCbCr and CMYK; integers up to 64 bits, floats; alpha of either kind; \
               uncompressed, LZW, Deflate, PackBits, JPEG, fax 4",
        refused: "CIELAB, signed integers, alpha beside CMYK, YCbCr with subsampling unless in JPEG",
    },
    Format {
        name: "ICO",
        extensions: &["ico"],
        read: "the largest picture, PNG or 1 to 32 bits with its mask",
        refused: "",
    },
    Format {
        name: "QOI",
        extensions: &["qoi"],
        read: "all",
        refused: "",
    },
    Format {
        name: "TGA",
        extensions: &["tga", "icb", "vda", "vst"],
        read: "palette, grey and colour; without a footer if it is not compressed, or by its name",
        refused: "",
    },
    Format {
        name: "DDS",
        extensions: &["dds"],
        read: "DXT1, DXT3, DXT5 (BC1 to BC3); uncompressed; the first picture",
        refused: "DXT2, DXT4, BC4 to BC7, floats",
    },
    Format {
        name: "HDR",
        extensions: &["hdr"],
        read: "Radiance; light beyond white is clipped",
        refused: "",
    },
    Format {
        name: "farbfeld",
        extensions: &["ff"],
        read: "all",
        refused: "",
    },
    Format {
        name: "PNM",
        extensions: &["pbm", "pgm", "ppm", "pam", "pnm"],
        read: "PBM, PGM, PPM and PAM, text or binary",
        refused: "PFM",
    },
];

/// Files to give instead of one that is not read: "a PNG, …, or PNM file".
pub(super) fn readable() -> String {
    if !cfg!(feature = "formats") {
        return "a PNG file, or use a build with the feature `formats`".into();
    }
    let names = FORMATS.map(|format| format.name);
    match names.split_last() {
        Some((last, others)) => format!("a {} or {last} file", others.join(", ")),
        None => String::new(),
    }
}

/// The format of a file, by its first bytes; TGA by its end, its whole, or the file's name.
pub(super) fn detect(bytes: &[u8], name: &str) -> Option<ImageFormat> {
    let guessed = ::image::guess_format(bytes).ok();
    let found = guessed.or_else(|| {
        if header::is_big_tiff(bytes) {
            Some(ImageFormat::Tiff)
        } else {
            header::is_tga(bytes, is_named_tga(name)).then_some(ImageFormat::Tga)
        }
    });
    // The library reads DDS, but not by the general way that this asks about.
    let is_dds = |format| cfg!(feature = "formats") && format == ImageFormat::Dds;
    found.filter(|&format| format.reading_enabled() || is_dds(format))
}

fn is_named_tga(name: &str) -> bool {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    let mut tga = FORMATS.iter().filter(|format| format.name == "TGA");
    tga.any(|format| {
        let mut names = format.extensions.iter();
        names.any(|name| name.eq_ignore_ascii_case(extension))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_in_the_docs_is_that_of_the_code() {
        let mut table =
            String::from("| format | names | read | not read |\n| --- | --- | --- | --- |\n");
        for format in FORMATS {
            let names = format.extensions.iter().map(|name| format!("`.{name}`"));
            let names = names.collect::<Vec<_>>().join(" ");
            let Format {
                name,
                read,
                refused,
                ..
            } = format;
            table += &format!("| {name} | {names} | {read} | {refused} |\n");
        }
        let docs = include_str!("../../docs/command-line.md");
        assert!(
            docs.contains(&table),
            "docs/command-line.md should have:\n{table}"
        );
    }

    #[test]
    #[cfg(feature = "formats")]
    fn every_promised_format_is_read() {
        for format in FORMATS {
            let known = ImageFormat::from_extension(format.extensions[0]).unwrap();
            assert!(
                known.reading_enabled() || known == ImageFormat::Dds,
                "{}",
                format.name
            );
        }
    }

    #[test]
    fn a_name_tells_tga_alone() {
        assert!(is_named_tga("a/b.TGA") && is_named_tga("x.vst"));
        assert!(!is_named_tga("tga") && !is_named_tga("a.tga/b.png"));
    }
}
