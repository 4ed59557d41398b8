use ::image::codecs::png::PngEncoder;
use ::image::{DynamicImage, ExtendedColorType, ImageBuffer, ImageEncoder, Rgb};

use super::*;

fn decoded(bytes: &[u8]) -> Result<Image> {
    Image::decode(bytes, "in.file", Limits::default())
}

fn message(bytes: &[u8]) -> String {
    let error = decoded(bytes).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Picture);
    let message = error.to_string();
    assert!(
        message.starts_with("in.file: ") && !message.contains('\n'),
        "{message}"
    );
    message
}

fn encode(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Whether the build reads the format.
fn is_read(format: ImageFormat) -> bool {
    cfg!(feature = "formats") || format == ImageFormat::Png
}

/// A smooth picture, so that JPEG keeps it, of few colours, so that GIF does.
fn ramp() -> ::image::RgbImage {
    ImageBuffer::from_fn(24, 10, |x, y| Rgb([x as u8 * 8, y as u8 * 8, 128]))
}

fn png_with_orientation(orientation: u8) -> Vec<u8> {
    let tag = [
        b"MM\0\x2a\0\0\0\x08\0\x01".as_slice(),
        b"\x01\x12\0\x03\0\0\0\x01\0",
        &[orientation],
        &[0; 6],
    ];
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_exif_metadata(tag.concat()).unwrap();
    encoder
        .write_image(&[10, 20, 30, 40, 50, 60], 3, 2, ExtendedColorType::L8)
        .unwrap();
    bytes
}

#[test]
fn every_format_gives_the_same_picture() {
    use ImageFormat::{Bmp, Gif, Jpeg, Png, Tiff, WebP};
    let expected = decoded(&encode(ramp(), Png)).unwrap();
    assert_eq!(
        (expected.width(), expected.height(), expected.alpha()),
        (24, 10, None)
    );
    assert_eq!(expected.planes()[0][5], 40.0 / 255.0);
    assert_eq!(expected.planes()[1][24 * 3], 24.0 / 255.0);
    for (format, tolerance) in [
        (Bmp, 0.0),
        (Tiff, 0.0),
        (WebP, 0.0),
        (Jpeg, 0.05),
        (Gif, 0.05),
    ]
    .into_iter()
    .filter(|(format, _)| is_read(*format))
    {
        let image = decoded(&encode(ramp(), format)).unwrap();
        let pairs = image
            .planes()
            .iter()
            .flatten()
            .zip(expected.planes().iter().flatten());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst <= tolerance, "{format:?} is off by {worst}");
    }
}

#[test]
fn grey_and_16_bit_and_alpha_are_kept() {
    let grey: ::image::GrayImage = ImageBuffer::from_raw(2, 1, vec![0, 51]).unwrap();
    let image = decoded(&encode(grey, ImageFormat::Png)).unwrap();
    assert_eq!(
        image.planes(),
        &[vec![0.0, 0.2], vec![0.0, 0.2], vec![0.0, 0.2]]
    );

    let grey_alpha: ::image::GrayAlphaImage = ImageBuffer::from_raw(1, 1, vec![255, 51]).unwrap();
    let image = decoded(&encode(grey_alpha, ImageFormat::Png)).unwrap();
    assert_eq!(
        (image.planes()[2][0], image.alpha()),
        (1.0, Some(&[0.2][..]))
    );

    let deep: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_raw(1, 1, vec![1, 2, 65535]).unwrap();
    for format in [ImageFormat::Png, ImageFormat::Tiff]
        .into_iter()
        .filter(|format| is_read(*format))
    {
        let image = decoded(&encode(deep.clone(), format)).unwrap();
        assert_eq!(
            image.planes(),
            &[vec![1.0 / 65535.0], vec![2.0 / 65535.0], vec![1.0]]
        );
    }
}

#[test]
#[cfg(feature = "formats")]
fn floats_are_kept_within_their_range() {
    let float: ImageBuffer<Rgb<f32>, _> =
        ImageBuffer::from_raw(1, 1, vec![0.25, f32::NAN, 7.0]).unwrap();
    let image = decoded(&encode(float, ImageFormat::Tiff)).unwrap();
    assert_eq!(image.planes(), &[vec![0.25], vec![0.0], vec![1.0]]);
}

#[test]
fn exif_orientation_turns_the_picture() {
    let levels = |orientation| {
        let image = decoded(&png_with_orientation(orientation)).unwrap();
        let plane = image.planes()[0]
            .iter()
            .map(|v| (v * 255.0).round() as u8)
            .collect::<Vec<_>>();
        (image.width(), image.height(), plane)
    };
    assert_eq!(levels(1), (3, 2, vec![10, 20, 30, 40, 50, 60]));
    assert_eq!(levels(3), (3, 2, vec![60, 50, 40, 30, 20, 10]));
    assert_eq!(levels(6), (2, 3, vec![40, 10, 50, 20, 60, 30]));
    assert_eq!(levels(8), (2, 3, vec![30, 60, 20, 50, 10, 40]));
}

#[test]
fn empty_and_foreign_files_are_told_apart() {
    assert!(message(b"").contains("empty"));
    assert!(message(b"#!/bin/sh\nexit 0\n").contains("not a picture"));
    // A format that is known but not built in.
    assert!(message(b"qoif\0\0\0\x01\0\0\0\x01\x03\0").contains("not a picture"));
}

#[test]
fn a_file_cut_anywhere_is_an_error_that_says_so() {
    use ImageFormat::{Bmp, Gif, Jpeg, Png, Tiff, WebP};
    let formats = [Png, Jpeg, WebP, Gif, Bmp, Tiff];
    for format in formats.into_iter().filter(|format| is_read(*format)) {
        let bytes = encode(ramp(), format);
        for cut in [20, 30, bytes.len() / 2, bytes.len() * 9 / 10] {
            let message = message(&bytes[..cut]);
            assert!(
                message.contains("cut short"),
                "{format:?} cut at {cut}: {message}"
            );
        }
    }
}

#[test]
fn damaged_bytes_are_an_error_or_a_picture_but_no_panic() {
    use ImageFormat::{Bmp, Gif, Jpeg, Png, Tiff, WebP};
    let formats = [Png, Jpeg, WebP, Gif, Bmp, Tiff];
    for format in formats.into_iter().filter(|format| is_read(*format)) {
        let bytes = encode(ramp(), format);
        for at in 4..bytes.len().min(200) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0xff;
            if let Err(error) = decoded(&damaged) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
}

#[test]
fn a_picture_of_no_pixels_says_so() {
    let cases = [
        (ImageFormat::Png, 16),
        (ImageFormat::Gif, 6),
        (ImageFormat::Bmp, 18),
    ];
    for (format, at) in cases.into_iter().filter(|case| is_read(case.0)) {
        let mut bytes = encode(ramp(), format);
        bytes[at..at + 4].fill(0);
        let message = message(&bytes);
        assert!(message.contains("no pixels (0×"), "{format:?}: {message}");
    }
}

#[test]
fn size_limits_are_checked_from_the_header() {
    let mut bytes = encode(ramp(), ImageFormat::Png);
    // 65536×65536, which no memory here could hold.
    bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let message = message(&bytes);
    assert!(message.contains("too large (65536×65536"), "{message}");
}

#[test]
#[cfg(feature = "formats")]
fn size_limits_are_checked_from_what_the_decoder_says() {
    let bytes = encode(ramp(), ImageFormat::Tiff);
    let limits = Limits {
        max_pixels: 100,
        ..Limits::default()
    };
    let error = Image::decode(&bytes, "a.tif", limits).unwrap_err();
    assert!(
        error.to_string().contains("24×10 px, at most 100 pixels"),
        "{error}"
    );
}

#[test]
#[cfg(not(feature = "formats"))]
fn what_another_build_reads_is_said() {
    let message = message(b"GIF89a\x01\0\x01\0\0\0\0");
    assert!(message.contains("the feature `formats`"), "{message}");
}

#[test]
fn long_files_are_refused() {
    let limits = Limits {
        max_bytes: 1 << 20,
        ..Limits::default()
    };
    let error = Image::decode(&vec![0x89; (1 << 20) + 1], "a", limits).unwrap_err();
    assert!(error.to_string().contains("longer than 1 MiB"), "{error}");
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none.png");
    let error = Image::open(&missing).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(
        error.to_string().contains("none.png: no such file"),
        "{error}"
    );
    let error = Image::open(folder.path()).unwrap_err();
    assert!(error.to_string().contains("is a directory"), "{error}");
}
