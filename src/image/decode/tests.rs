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

/// True if the build reads the format.
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
    use ImageFormat::{Bmp, Gif, Jpeg, Png, Pnm, Qoi, Tiff, WebP};
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
        (Qoi, 0.0),
        (Pnm, 0.0),
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
    #[cfg(not(feature = "formats"))]
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

#[test]
#[cfg(feature = "formats")]
fn an_icon_is_read() {
    let icon = encode(DynamicImage::from(ramp()).to_rgba8(), ImageFormat::Ico);
    let expected = decoded(&encode(ramp(), ImageFormat::Png)).unwrap();
    assert_eq!(decoded(&icon).unwrap(), expected);
}

#[test]
#[cfg(feature = "formats")]
fn a_tga_is_told_by_its_end() {
    let mut bytes = encode(ramp(), ImageFormat::Tga);
    if !bytes.ends_with(b"TRUEVISION-XFILE.\0") {
        bytes.extend([0; 8]);
        bytes.extend(b"TRUEVISION-XFILE.\0");
    }
    let expected = decoded(&encode(ramp(), ImageFormat::Png)).unwrap();
    assert_eq!(decoded(&bytes).unwrap(), expected);
}

#[test]
#[cfg(feature = "formats")]
fn light_is_encoded_and_what_is_beyond_the_range_is_counted() {
    let light: ImageBuffer<Rgb<f32>, _> =
        ImageBuffer::from_raw(2, 1, vec![0.0, 0.25, 1.0, 4.0, 0.5, 9.0]).unwrap();
    let (image, remarks) = read(&encode(light, ImageFormat::Hdr));
    let [red, green, blue] = image.planes();
    let is_near = |level: f32, expected: f32| (level - expected).abs() < 0.003;
    assert!(
        is_near(green[0], 0.537) && is_near(green[1], 0.735),
        "{green:?}"
    );
    assert_eq!(red[0], 0.0);
    assert!(is_near(red[1], 1.0) && is_near(blue[1], 1.0));
    assert_eq!(remarks, [Remark::Clipped(2)]);
}

#[cfg(feature = "formats")]
fn read(bytes: &[u8]) -> (Image, Vec<Remark>) {
    Image::decode_remarking(bytes, "in.file", Limits::default()).unwrap()
}

#[test]
#[cfg(feature = "formats")]
fn frames_after_the_first_are_spoken_of() {
    use ::image::codecs::gif::GifEncoder;
    let gif = |frames: usize| {
        let mut bytes = Vec::new();
        let mut encoder = GifEncoder::new(&mut bytes);
        for _ in 0..frames {
            let frame = DynamicImage::from(ramp()).to_rgba8();
            encoder.encode_frame(::image::Frame::new(frame)).unwrap();
        }
        drop(encoder);
        bytes
    };
    assert_eq!(read(&gif(1)).1, []);
    assert_eq!(read(&gif(3)).1, [Remark::FirstOfSeveral]);
    assert_eq!(read(&encode(ramp(), ImageFormat::Tiff)).1, []);
}

#[cfg(feature = "formats")]
fn with_profile(
    profile: &moxcms::ColorProfile,
    pixels: &[u8],
    color: ExtendedColorType,
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_icc_profile(profile.encode().unwrap()).unwrap();
    let channels = u32::from(color.channel_count());
    encoder
        .write_image(pixels, pixels.len() as u32 / channels, 1, color)
        .unwrap();
    bytes
}

#[test]
#[cfg(feature = "formats")]
fn colours_of_other_profiles_become_those_of_srgb() {
    use moxcms::ColorProfile;
    // A grey stays what it is, and the same red is more of one in Display P3: 0.8 is 0.867 in sRGB.
    let pixels = [128, 128, 128, 204, 77, 51, 0, 255, 0];
    let (image, remarks) = read(&with_profile(
        &ColorProfile::new_display_p3(),
        &pixels,
        ExtendedColorType::Rgb8,
    ));
    let pixel = |i: usize| [0, 1, 2].map(|c| image.planes()[c][i]);
    let is_near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
    assert!(is_near(pixel(0), [128.0 / 255.0; 3]), "{:?}", pixel(0));
    assert!(is_near(pixel(1), [0.867, 0.253, 0.146]), "{:?}", pixel(1));
    assert!(is_near(pixel(2), [0.0, 1.0, 0.0]), "{:?}", pixel(2));
    assert_eq!(remarks, [Remark::Converted]);

    let grey = with_profile(
        &ColorProfile::new_gray_with_gamma(1.0),
        &[0, 55, 255],
        ExtendedColorType::L8,
    );
    let (image, remarks) = read(&grey);
    assert!(
        (image.planes()[1][1] - 0.5015).abs() < 0.01,
        "{:?}",
        image.planes()[1]
    );
    assert_eq!(remarks, [Remark::Converted]);
}

#[test]
#[cfg(feature = "formats")]
fn the_profile_of_srgb_changes_nothing_and_a_damaged_one_is_ignored() {
    use moxcms::ColorProfile;
    let pixels: Vec<u8> = (0..=255).flat_map(|v| [v, 255 - v, v / 2]).collect();
    let plain = Image::from_rows(Rows::packed(256, 1, 3, &pixels)).unwrap();
    let srgb = with_profile(&ColorProfile::new_srgb(), &pixels, ExtendedColorType::Rgb8);
    assert_eq!(read(&srgb), (plain.clone(), vec![]));

    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder
        .set_icc_profile(b"no profile at all".to_vec())
        .unwrap();
    encoder
        .write_image(&pixels, 256, 1, ExtendedColorType::Rgb8)
        .unwrap();
    assert_eq!(
        read(&bytes),
        (plain, vec![Remark::ProfileIgnored("damaged")])
    );
}

#[test]
fn formats_that_are_not_read_are_named_with_a_way_to_convert_them() {
    let avif = message(b"\0\0\0\x20ftypavif\0\0\0\0avifmif1");
    assert!(avif.contains("AVIF") && avif.contains("avifdec"), "{avif}");
    let svg = message(b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    assert!(svg.contains("strokefit render"), "{svg}");
}

/// A file of `tests/data/pictures`: a chart of four patches, in forms that are easily read wrong.
fn chart(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pictures/");
    std::fs::read(format!("{folder}{name}")).unwrap()
}

/// Red, green, blue and yellow of the chart, as 8-bit levels, found in the middle of each patch at this scale.
#[cfg(feature = "formats")]
fn patches(image: &Image, scale: f64) -> [[f32; 3]; 4] {
    [(34, 20), (72, 16), (24, 48), (72, 48)].map(|(x, y)| {
        let at = |v: i32| (f64::from(v) * scale) as usize;
        let i = at(y) * image.width() + at(x);
        image.planes().each_ref().map(|plane| plane[i] * 255.0)
    })
}

#[cfg(feature = "formats")]
const CHART: [[f32; 3]; 4] = [
    [200.0, 40.0, 40.0],
    [40.0, 160.0, 60.0],
    [40.0, 70.0, 200.0],
    [240.0, 210.0, 60.0],
];

/// By how many levels the farthest channel of a patch is off.
#[cfg(feature = "formats")]
fn worst(found: [[f32; 3]; 4], expected: [[f32; 3]; 4]) -> f32 {
    let pairs = found.iter().flatten().zip(expected.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
#[cfg(feature = "formats")]
fn charts_have_their_colours_in_every_form() {
    for (name, tolerance) in [
        ("chart_expected.png", 0.0),
        ("uint32.tiff", 4.0),
        ("palette.tiff", 4.0),
        ("ycbcr.tiff", 4.0),
        ("big.tiff", 0.0),
        ("cicp_p3.png", 4.0),
        ("gama10_16.png", 4.0),
        ("plain.dds", 0.0),
    ] {
        let image = decoded(&chart(name)).unwrap();
        assert_eq!((image.width(), image.height()), (96, 64), "{name}");
        let found = patches(&image, 1.0);
        assert!(worst(found, CHART) <= tolerance, "{name}: {found:?}");
    }
}

#[test]
#[cfg(feature = "formats")]
fn icons_of_rgb_show_their_largest_picture() {
    for name in ["multi.ico", "bmp24.ico"] {
        let image = decoded(&chart(name)).unwrap();
        assert_eq!((image.width(), image.height()), (48, 32), "{name}");
        let found = patches(&image, 0.5);
        assert!(worst(found, CHART) <= 1.0, "{name}: {found:?}");
    }
}

#[test]
#[cfg(feature = "formats")]
fn inks_are_seen_by_the_profile_of_the_file() {
    let expected = decoded(&chart("cmyk_expected.png")).unwrap();
    for name in ["cmyk_icc.jpg", "cmyk_icc.tiff"] {
        let (image, remarks) = read(&chart(name));
        let found = patches(&image, 1.0);
        assert!(
            worst(found, patches(&expected, 1.0)) <= 12.0,
            "{name}: {found:?}"
        );
        assert_eq!(remarks, [Remark::Converted], "{name}");
    }
}

#[test]
#[cfg(feature = "formats")]
fn premultiplied_colours_become_straight() {
    let image = decoded(&chart("assocalpha.tiff")).unwrap();
    let found = patches(&image, 1.0);
    assert!(worst(found, CHART) <= 12.0, "{found:?}");
    let alpha = image.alpha().unwrap()[20 * 96 + 34];
    assert!((alpha * 255.0 - 128.0).abs() < 0.5, "{alpha}");
}

#[test]
#[cfg(feature = "formats")]
fn light_of_pq_keeps_its_colours() {
    let image = decoded(&chart("cicp_pq.png")).unwrap();
    let found = patches(&image, 1.0);
    assert!(found[0][0] - found[0][1] >= 90.0, "{found:?}");
}

#[test]
#[cfg(feature = "formats")]
fn grey_floats_are_a_picture() {
    let image = decoded(&chart("float32_grey.tiff")).unwrap();
    assert_eq!((image.width(), image.height()), (96, 64));
    let found = patches(&image, 1.0);
    for ([red, green, blue], [r, g, b]) in found.into_iter().zip(CHART) {
        let luma = 0.299 * r + 0.587 * g + 0.114 * b;
        assert!(
            red == green && green == blue && (red - luma).abs() < 12.0,
            "{found:?}"
        );
    }
}

#[test]
#[cfg(feature = "formats")]
fn kinds_that_are_not_read_are_named() {
    for (name, words) in [
        ("twelvebit.jpg", "12 bits per sample"),
        ("lossless.jpg", "lossless JPEG"),
        ("cgbi.png", "Apple's optimised PNG"),
    ] {
        let message = message(&chart(name));
        assert!(
            message.contains(words) && message.contains("OUT.png"),
            "{message}"
        );
    }
}

#[test]
fn a_picture_of_nothing_says_so() {
    let outcome = Image::decode_remarking(&chart("alltransparent.png"), "a", Limits::default());
    assert_eq!(outcome.unwrap().1, [Remark::Transparent]);
}

#[test]
#[cfg(feature = "formats")]
fn a_tga_without_a_footer_is_read_from_below() {
    // Its descriptor says that the first row is the lowest, and its rows begin with the uppermost.
    let image = decoded(&chart("footerless.tga")).unwrap();
    let [red, green, blue, yellow] = CHART;
    assert_eq!(worst(patches(&image, 1.0), [blue, yellow, red, green]), 0.0);
}

#[test]
#[cfg(feature = "formats")]
fn compressed_tga_without_a_footer_is_told_by_its_name() {
    // 2×1 px: a run of two.
    let mut bytes = vec![0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0];
    bytes.extend([0x81, 3, 2, 1]);
    assert!(decoded(&bytes).is_err());
    let image = Image::decode(&bytes, "a/B.TGA", Limits::default()).unwrap();
    assert_eq!(image.to_rgb8(), [1, 2, 3, 1, 2, 3]);
}

#[test]
#[cfg(feature = "formats")]
fn every_cut_of_every_chart_is_an_error_or_a_picture() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pictures");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        let name = path.to_string_lossy();
        for cut in (0..bytes.len().min(400)).chain((400..bytes.len()).step_by(977)) {
            let _ = Image::decode(&bytes[..cut], &name, Limits::default());
        }
        for at in 0..bytes.len().min(400) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x81;
            let _ = Image::decode(&damaged, &name, Limits::default());
        }
    }
}
