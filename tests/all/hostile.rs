//! Files made to do harm, some hundred of them, all from seeds: each is read or refused in one line, with no
//! panic, no hang, and no more memory than the limits say.

use std::fmt::Write as _;
use std::io::Cursor;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::support::{Place, assert_says};
use image::{DynamicImage, ImageFormat, RgbImage, RgbaImage};
use strokefit::image::{Image, Limits};
use strokefit::report::Usage;
use strokefit::verify::{self, Size};
use strokefit::{Result, rng, svg};

/// Most time for a file, on a busy machine; without others it is a second at most.
const PATIENCE: Duration = Duration::from_secs(60);
/// Most memory that the process may have held at the end of a test.
const MAX_BYTES: u64 = 1_500 << 20;

const LIMITS: Limits = Limits {
    max_pixels: 1 << 22,
    max_bytes: 64 << 20,
};

/// Hands `file` to `reader` in a thread with an ordinary stack, as a server would. A refusal has one line.
fn survive<T: Send + 'static>(
    name: &str,
    file: impl AsRef<[u8]> + Send + 'static,
    reader: fn(&[u8]) -> Result<T>,
) -> Result<T> {
    let (sender, receiver) = mpsc::channel();
    let worker = thread::spawn(move || sender.send(reader(file.as_ref())));
    let outcome = match receiver.recv_timeout(PATIENCE) {
        Ok(outcome) => outcome,
        Err(mpsc::RecvTimeoutError::Timeout) => panic!("{name} hangs"),
        Err(mpsc::RecvTimeoutError::Disconnected) => panic!("{name} panics: {:?}", worker.join()),
    };
    if let Err(error) = &outcome {
        assert!(!error.to_string().contains('\n'), "{name}: {error}");
    }
    outcome
}

/// The memory of this process never exceeded the bound.
fn assert_frugal() {
    if let Some(bytes) = Usage::now().peak_rss_bytes {
        assert!(bytes < MAX_BYTES, "{} MiB were held", bytes >> 20);
    }
}

/// `bytes` with some of them changed, cut, doubled or moved.
fn mutated(bytes: &[u8], seed: u64) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for step in 0..1 + rng::bits(seed, 0, 0, 0) % 6 {
        let draw = |k: u64, n: usize| (rng::bits(seed, step, k, 1) % n.max(1) as u64) as usize;
        let at = draw(0, bytes.len());
        let end = (at + draw(1, 40)).min(bytes.len());
        match draw(2, 6) {
            0 => bytes[at] ^= 1 << draw(3, 8),
            1 => bytes[at] = [0, 0xff, 0x7f, 0x80, b'<', b'9'][draw(3, 6)],
            2 => bytes.truncate(at.max(1)),
            3 => bytes[at..end].fill(0xff),
            4 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => drop(bytes.drain(at..end.min(at + bytes.len() / 2))),
        }
        if bytes.is_empty() {
            bytes.push(0);
        }
    }
    bytes
}

fn encoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Intact pictures of all formats.
fn pictures() -> Vec<(String, Vec<u8>)> {
    use ImageFormat::{Bmp, Gif, Jpeg, Png, Tiff, WebP};
    let rgb = RgbImage::from_fn(33, 17, |x, y| image::Rgb([x as u8 * 7, y as u8 * 15, 90]));
    let rgba = RgbaImage::from_fn(9, 21, |x, y| {
        image::Rgba([x as u8 * 25, 40, 90, y as u8 * 12])
    });
    let mut files = Vec::new();
    for format in [Bmp, Gif, Jpeg, Png, Tiff, WebP] {
        files.push((format!("{format:?}"), encoded(rgb.clone(), format)));
        if format != Jpeg {
            files.push((
                format!("{format:?} with alpha"),
                encoded(rgba.clone(), format),
            ));
        }
    }
    files
}

fn decode(bytes: &[u8]) -> Result<Image> {
    Image::decode(bytes, "hostile", LIMITS)
}

#[test]
fn damaged_pictures() {
    let mut refused = 0;
    let files = pictures();
    for (name, file) in &files {
        for seed in 0..24 {
            let bytes = mutated(file, seed);
            let name = format!("{name}, mutation {seed}");
            if let Ok(image) = survive(&name, bytes, decode) {
                let pixels = image.width() as u64 * image.height() as u64;
                assert!(pixels <= LIMITS.max_pixels, "{name}");
            } else {
                refused += 1;
            }
        }
    }
    assert!(refused > 24 * files.len() / 3, "{refused} were refused");
    assert_frugal();
}

/// The header of a PNG of `width × height`, then `filling` bytes.
fn png_bomb(width: u32, height: u32, filling: usize) -> Vec<u8> {
    let mut file = encoded(RgbImage::new(1, 1), ImageFormat::Png);
    file[16..20].copy_from_slice(&width.to_be_bytes());
    file[20..24].copy_from_slice(&height.to_be_bytes());
    file.resize(file.len() + filling, 0);
    file
}

#[test]
fn pictures_that_unpack_to_gigabytes() {
    let jpeg = encoded(RgbImage::new(8, 8), ImageFormat::Jpeg);
    let frame = jpeg.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    let mut wide = jpeg;
    wide[frame + 5..frame + 9].fill(0xff);
    let mut gif = encoded(RgbImage::new(8, 8), ImageFormat::Gif);
    gif[6..10].fill(0xff);
    let mut bmp = encoded(RgbImage::new(8, 8), ImageFormat::Bmp);
    bmp[18..26].copy_from_slice(&[0x60, 0xea, 0, 0, 0x60, 0xea, 0, 0]);
    for (name, file) in [
        ("PNG of 60000×60000", png_bomb(60_000, 60_000, 1 << 20)),
        ("PNG of 2³¹×2³¹", png_bomb(1 << 31, 1 << 31, 0)),
        ("PNG of 1×10⁹", png_bomb(1, 1_000_000_000, 0)),
        ("JPEG of 65535×65535", wide),
        ("GIF of 65535×65535", gif),
        ("BMP of 60000×60000", bmp),
    ] {
        let error = survive(name, file, decode).unwrap_err().to_string();
        assert!(
            error.contains("too large") || error.contains("damaged"),
            "{name}: {error}"
        );
    }
    assert_frugal();
}

const HEAD: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="600" height="400" viewBox="0 0 600 400">"##;

fn page(body: &str) -> String {
    format!("{HEAD}{body}</svg>")
}

/// The body of a file of `levels` definitions, each of which draws the one before `times` times.
fn tower(
    levels: usize,
    times: usize,
    define: impl Fn(usize, &str) -> String,
    draw: impl Fn(usize) -> String,
) -> String {
    let mut body = String::from(r#"<defs><path id="l0" d="M0 0h9v9z"/>"#);
    for level in 1..=levels {
        body += &define(level, &draw(level - 1).repeat(times));
    }
    body + "</defs>" + &draw(levels)
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bytes
        .chunks(3)
        .flat_map(|c| {
            let word = c.iter().fold(0_u32, |w, &b| w << 8 | u32::from(b)) << (8 * (3 - c.len()));
            (0..4).map(move |i| match i <= c.len() {
                true => DIGITS[(word >> (18 - 6 * i)) as usize & 63] as char,
                false => '=',
            })
        })
        .collect()
}

fn embedded(mime: &str, bytes: &[u8]) -> String {
    let data = base64(bytes);
    format!(r#"<image width="600" height="400" href="data:{mime};base64,{data}"/>"#)
}

/// SVG files that ask for more than is reasonable, each of which has to be refused.
fn svg_bombs() -> Vec<(&'static str, String)> {
    let used = |level: usize| format!(r##"<use xlink:href="#l{level}"/>"##);
    let grouped = |level: usize, inside: &str| format!(r#"<g id="l{level}">{inside}</g>"#);
    let filled = |fill: &str| format!(r#"<rect width="600" height="400" {fill}/>"#);
    let patterned = |level: usize| filled(&format!(r##"fill="url(#l{level})""##));
    let pattern = |level: usize, inside: &str| {
        format!(
            r#"<pattern id="l{level}" width="600" height="400" patternUnits="userSpaceOnUse">{inside}</pattern>"#
        )
    };
    let filter = |step: &str| {
        let steps = step.repeat(20);
        format!(r#"<filter id="f">{steps}</filter>"#) + &filled(r#"filter="url(#f)""#)
    };
    let png = |width, height, filling| embedded("image/png", &png_bomb(width, height, filling));
    let nested = |open: &str, times: usize, inside: &str| {
        open.repeat(times) + inside + &"</g>".repeat(times)
    };
    let bodies = [
        ("a use of uses", tower(12, 10, grouped, used)),
        ("a pattern of patterns", tower(10, 10, pattern, patterned)),
        ("nested groups", nested("<g>", 200_000, "")),
        ("nested layers", nested(r#"<g opacity="0.9">"#, 1020, &filled(""))),
        (
            "a wide morphology",
            filter(r#"<feMorphology operator="dilate" radius="500"/>"#),
        ),
        (
            "endless turbulence",
            filter(r#"<feTurbulence baseFrequency="0.05" numOctaves="100000000"/>"#),
        ),
        (
            "a picture as high as the sky",
            png(1, 1, 0).replace("\"400\"", "\"9999999999920\""),
        ),
        (
            "a path to infinity",
            r#"<path d="M0 0C9 3 3 9 2e38 20A5 5 0 0 1 9 2Q1 2 3 4z"/>"#.into(),
        ),
        (
            "a mask of a distant path",
            r#"<mask id="m"><rect width="9" height="9"/></mask><path mask="url(#m)" d="M0 0H2e14V9z"/>"#.into(),
        ),
        (
            "a large pattern",
            r#"<pattern id="p" width="40000" height="40000" patternUnits="userSpaceOnUse"><rect width="9" height="9"/></pattern>"#
                .to_owned()
                + &filled(r#"fill="url(#p)""#),
        ),
        ("a large embedded PNG", png(60_000, 60_000, 1 << 10)),
        ("many embedded PNGs", png(6_000, 6_000, 0).repeat(3)),
        ("an embedded SVG", embedded("image/svg+xml", page("").as_bytes())),
        (
            "an embedded archive",
            embedded("image/svg+xml", &[0x1f, 0x8b, 8, 0, 0, 0, 0, 0]),
        ),
        (
            "a million and more elements",
            r#"<path d="M0 0h1"/>"#.repeat(1_000_001),
        ),
        ("five million texts", "<a/>x".repeat(2_500_000)),
    ];
    let mut entities = String::from(r#"<!DOCTYPE svg [<!ENTITY e0 "<g/><g/><g/><g/><g/><g/>">"#);
    for level in 1..9 {
        let last = format!("&e{};", level - 1).repeat(10);
        write!(entities, "<!ENTITY e{level} \"{last}\">").unwrap();
    }
    let vast = page("").replace("\"600\"", "\"1e9\"");
    let mut bombs = Vec::from(bodies.map(|(name, body)| (name, page(&body))));
    bombs.push(("entities of entities", entities + "]>" + &page("&e8;")));
    bombs.push(("a page of 10⁹ × 10⁹", vast.replace("\"400\"", "\"1e9\"")));
    bombs
}

fn draw(bytes: &[u8]) -> Result<Image> {
    let text = String::from_utf8_lossy(bytes);
    let _ = svg::read(&text);
    verify::render(&text, Size::Scale(1.0), Some([1.0; 3]))
}

#[test]
fn svg_files_that_ask_for_too_much() {
    for (name, text) in svg_bombs() {
        let outcome = survive(name, text, draw);
        assert!(outcome.is_err(), "{name} was drawn");
    }
    assert_frugal();
}

/// Odd, but no reason to fail.
#[test]
fn svg_files_that_are_merely_odd() {
    let chain = (1..900).map(|i| format!(r##"<mask id="m{i}" mask="url(#m{})"/>"##, i - 1));
    let stops = r#"<stop offset="0.5"/>"#.repeat(50_000);
    let rules = "g g g g g g g g g g{fill:red}".repeat(2_000);
    let oddities = [
        r##"<rect width="NaN" height="1e999"/><path d="M0 0L1e5 1e5 -1e5 1e5z" stroke="#000" stroke-width="1e4"/>"##.into(),
        r##"<path d="M0 0H1000000" stroke="#000" stroke-dasharray="0.001"/>"##.into(),
        r#"<g transform="matrix(0 0 0 0 0 0)"><rect width="9" height="9"/></g>"#.into(),
        r##"<g id="a"><use href="#a"/></g><clipPath id="c" clip-path="url(#c)"/><rect width="9" height="9" clip-path="url(#c)"/>"##.into(),
        chain.collect::<String>(),
        format!(r##"<linearGradient id="g">{stops}</linearGradient><rect width="9" height="9" fill="url(#g)"/>"##),
        format!("<style>{rules}</style>"),
        format!(r#"<path d="M0 0{}"/>"#, "l1 1 2-1".repeat(200_000)),
        r#"<image width="9" height="9" href="http://127.0.0.1:9/a.png"/><image width="9" height="9" href="/etc/passwd"/>"#.into(),
        r#"<text font-family="x" font-size="1e20">ab</text>"#.into(),
    ];
    for (i, text) in oddities.into_iter().enumerate() {
        let outcome = survive(&format!("oddity {i}"), page(&text), draw);
        assert!(outcome.is_ok(), "oddity {i}: {}", outcome.unwrap_err());
    }
    assert_frugal();
}

#[test]
fn damaged_svg_files() {
    let own = page(
        r##"<rect width="600" height="400" fill="#336699"/>
<g id="stage-1" fill="none" stroke-linecap="round"><title>x</title><path d="M1 2L3 4" stroke="#ff0000" stroke-width="1.5" stroke-opacity="0.5"/></g>"##,
    );
    let foreign = page(
        r##"<defs><linearGradient id="g"><stop offset="0" stop-color="red"/></linearGradient><clipPath id="c"><circle r="50"/></clipPath><filter id="f"><feGaussianBlur stdDeviation="3"/></filter></defs><g clip-path="url(#c)" filter="url(#f)" opacity=".5"><use href="#r"/><rect id="r" width="70" height="90" rx="4" fill="url(#g)" transform="rotate(30)"/></g>"##,
    );
    for (kind, text) in [("ours", own), ("foreign", foreign)] {
        assert!(survive(kind, text.clone(), draw).is_ok());
        for seed in 0..80 {
            let name = format!("{kind}, mutation {seed}");
            let _ = survive(&name, mutated(text.as_bytes(), seed), draw);
        }
    }
    assert_frugal();
}

/// Words of resvg when it panics are nothing for the user: the program says what is wrong in its own words.
#[test]
fn a_panic_of_resvg_is_an_error_like_any_other() {
    let words = Place::new().said("render @fuzz/corpus/svg/high.svg -o out.png", 1);
    assert!(words.starts_with("error: "), "{words}");
    assert_says(&words, &["resvg cannot"]);
    assert!(!words.contains("panicked"), "{words}");
}
