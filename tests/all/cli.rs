//! The program as its users meet it: exit statuses, lines on standard error, files left behind.

use std::fs;

use serde_json::Value;

use crate::support::{Place, assert_refused, assert_says, stderr};

const RED_SVG: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><rect width="2" height="2" fill="#ff0000"/></svg>"##;

/// A folder with a file `red.svg`, half of which is red.
fn with_red() -> Place {
    let place = Place::new();
    place.file("red.svg", RED_SVG);
    place
}

#[test]
fn pictures_that_cannot_be_read_are_refused() {
    let place = Place::of_picture(30, 20);
    let good = place.bytes("in.png");
    place.file("empty.png", "");
    place.file("cut.png", &good[..good.len() / 2]);
    place.file("text.png", "this is no picture");
    let mut hollow = good.clone();
    hollow[16..24].fill(0);
    place.file("hollow.png", hollow);
    let mut huge = good;
    huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    place.file("huge.png", huge);
    fs::create_dir(place.path("folder")).unwrap();
    for (name, words) in [
        ("missing.png", "no such file"),
        ("folder", "is a directory"),
        ("empty.png", "empty"),
        ("cut.png", "cut short"),
        ("text.png", "not a picture"),
        ("hollow.png", "0×0"),
        ("huge.png", "too large"),
    ] {
        assert_refused(&place, &["fit", name, "-o", "out.svg"], 1, &[name, words]);
    }
    let words = ["standard input: the file is empty"];
    assert_refused(&place, "fit - -o out.svg", 1, &words);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let place = Place::of_picture(30, 20);
    place.file("file", "");
    fs::create_dir(place.path("folder")).unwrap();
    for name in ["folder", "file/out.svg", "file/none/out.svg"] {
        for options in ["-o", "-o out.svg --report"] {
            let fit = format!("fit in.png {options} {name}");
            assert_refused(&place, &fit, 1, &[name, "cannot be written"]);
        }
    }
}

#[test]
fn folders_of_outputs_are_made() {
    let place = Place::of_picture(30, 20);
    let outputs = "-o a/{stem}.svg -o b/c/in.gif -o d/{n}.png --report e/r.json --events f/e.jsonl";
    place.done(&format!("fit in.png {outputs} --strokes 5"));
    for name in ["a/in.svg", "b/c/in.gif", "d/1.png", "e/r.json", "f/e.jsonl"] {
        assert!(!place.bytes(name).is_empty(), "{name}");
    }
    place.done("render a/in.svg -o g/h.png");
    assert!(place.path("g/h.png").is_file());
    // A command that is refused makes none.
    assert_refused(&place, "fit no.png -o none/out.svg", 1, &["no.png"]);
    assert!(!place.path("none").exists());
}

#[test]
#[cfg(unix)]
fn a_write_protected_file_is_not_replaced() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::of_picture(30, 20);
    place.file("out.svg", "precious");
    fs::set_permissions(place.path("out.svg"), fs::Permissions::from_mode(0o444)).unwrap();
    let words = ["out.svg", "permission denied"];
    assert_refused(&place, "fit in.png -o out.svg", 1, &words);
    assert_eq!(place.text("out.svg"), "precious");
}

#[test]
fn nonsense_options_are_refused() {
    let place = Place::of_picture(30, 20);
    for (option, values) in [
        ("--strokes", &["0", "many", "1000000000"][..]),
        ("--psnr", &["NaN", "inf", "-3"]),
        ("--bytes", &["0"]),
        ("--time", &["-1", "0", "1e300"]),
        ("--stages", &["0"]),
        ("--precision", &["9"]),
        ("--threads", &["0"]),
        ("--preset", &["ludicrous"]),
        ("--coverage", &["mystery", "atan:-1"]),
        ("--background", &["#12345"]),
        ("--seed", &["x"]),
    ] {
        for value in values {
            let args = ["fit", "in.png", "-o", "out.svg", option, value];
            assert_refused(&place, &args, 2, &[option, value]);
        }
    }
    let words = ["--scale", "0"];
    assert_refused(&place, "render in.svg -o a.png --scale 0", 2, &words);
}

#[test]
fn files_that_are_no_svg_are_refused() {
    let place = with_red();
    place.picture("in.png", 4, 2);
    place.picture("tall.png", 2, 4);
    place.file("text.svg", "hello");
    place.file("cut.svg", &RED_SVG[..60]);
    place.file("empty.svg", "");
    place.file("foreign.svg", RED_SVG.replace("http:", "https:"));
    for name in [
        "missing.svg",
        "text.svg",
        "cut.svg",
        "empty.svg",
        "foreign.svg",
        "in.png",
    ] {
        assert_refused(&place, &["check", name, "in.png"], 1, &[name]);
        assert_refused(&place, &["render", name, "-o", "out.png"], 1, &[name]);
    }
    for (args, status, words) in [
        (
            "check red.svg tall.png",
            1,
            &["red.svg", "aspect ratio"][..],
        ),
        ("render red.svg -o a.png --scale 1e9", 1, &["red.svg", "px"]),
        ("render red.svg -o red.svg", 2, &["red.svg", "overwritten"]),
        ("check - -", 2, &["standard input"]),
    ] {
        assert_refused(&place, args, status, words);
    }
}

#[test]
fn render_draws_at_the_scale_asked_for() {
    let place = with_red();
    place.done("render red.svg -o a.png --scale 2");
    let picture = image::open(place.path("a.png")).unwrap().to_rgba8();
    assert_eq!(picture.dimensions(), (8, 4));
    assert_eq!(picture.get_pixel(0, 0).0, [255, 0, 0, 255]);
    assert_eq!(picture.get_pixel(7, 3).0[3], 0);
    let piped = place.pipe("render - -o - --scale 2", RED_SVG.as_bytes());
    assert_eq!(piped.stdout, place.bytes("a.png"));
}

#[test]
fn check_prints_a_table_or_json_or_nothing() {
    let place = with_red();
    place.done("render red.svg -o red.png");
    let check = "check red.svg red.png --renderer resvg";
    let table = place.printed(&format!("{check} --report r.json"));
    assert_says(&table, &["resvg", "inf"]);
    let record = place.report("r.json");
    assert_eq!(record["schema"], 1);
    assert_eq!(record["renderers"][0]["renderer"], "resvg");
    assert!(
        record["renderers"][0]["fidelity"]["psnr_db"].is_null(),
        "{record}"
    );
    let quiet = place.done(&format!("{check} -q"));
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    for options in ["--report -", "--report - -q"] {
        let piped = place.printed(&format!("{check} {options}"));
        let mut piped: Value = serde_json::from_str(&piped).unwrap();
        let mut expected = record.clone();
        // All but how long it took.
        for record in [&mut expected, &mut piped] {
            assert!(record["renderers"][0]["wall_s"].take().is_f64());
        }
        assert_eq!(piped, expected);
    }
}

#[test]
fn fit_writes_a_file_that_check_and_render_understand() {
    let place = Place::new();
    let few = "--strokes 150 --preset draft";
    let fit = format!("fit @samples/noto-gem.png -o gem.svg --report gem.json {few}");
    let output = place.done(&fit);
    let summary = stderr(&output);
    assert_eq!(summary.lines().count(), 1, "{summary}");
    assert_says(
        &summary,
        &["gem.svg", "strokes", "bytes", "fidelity", "agreement", "dB"],
    );
    assert!(output.stdout.is_empty());
    assert_eq!(place.names(), ["gem.json", "gem.svg"]);

    let record = place.report("gem.json");
    assert_eq!(record["svg_bytes"], place.bytes("gem.svg").len());
    assert!(record["strokes"].as_u64().unwrap() <= 150);
    let stages = record["stages"].as_array().unwrap().iter();
    let staged: u64 = stages.map(|s| s["strokes"].as_u64().unwrap()).sum();
    assert_eq!(staged, record["strokes"]);
    let agreement = record["agreement"]["psnr_db"].as_f64().unwrap();
    assert!(agreement > 36.0, "{record}");

    // The report says what anyone can measure; the gem's transparent parts are laid on white.
    let check = "check gem.svg @samples/noto-gem.png --report - --renderer resvg";
    let check: Value = serde_json::from_slice(&place.run(check).stdout).unwrap();
    assert_eq!(check["renderers"][0]["fidelity"], record["fidelity"]);
    place.done("render gem.svg -o gem.png");
}

#[test]
fn fit_works_in_a_pipe_and_quietly() {
    let place = Place::of_picture(30, 20);
    let piped = place.pipe("fit - -o - -q --strokes 20", &place.bytes("in.png"));
    assert_eq!(piped.status.code(), Some(0));
    assert_eq!(stderr(&piped), "");
    place.done("fit in.png -o out.svg --strokes 20");
    assert_eq!(piped.stdout, place.bytes("out.svg"));
}

#[test]
fn threads_change_no_byte() {
    let place = Place::of_picture(60, 40);
    let fit = |threads: usize| {
        place.done(&format!(
            "fit in.png -o out.svg --preset draft --strokes 60 --threads {threads}"
        ));
        place.bytes("out.svg")
    };
    assert!(fit(1) == fit(3));
}

#[test]
fn the_smallest_and_thinnest_pictures_work() {
    let place = Place::new();
    for (width, height) in [(1, 1), (1, 4096), (4096, 1), (3, 2)] {
        place.picture("in.png", width, height);
        for strokes in [1, 40] {
            place.done(&format!(
                "fit in.png -o out.svg --preset draft --strokes {strokes}"
            ));
        }
        let page = format!("viewBox=\"0 0 {width} {height}\"");
        assert_says(&place.text("out.svg"), &[&page]);
    }
}

#[test]
fn a_target_out_of_reach_is_exit_3_and_the_file_is_kept() {
    let place = Place::new();
    let fit = "fit @samples/coffee-300.png -o out.svg --strokes 5 --psnr 60";
    assert_says(&place.said(fit, 3), &["target not reached"]);
    assert_eq!(place.names(), ["out.svg"]);
}

/// dB of a fit that asks for 60, and what it says.
fn asked_for_60(place: &Place, input: &str, options: &str) -> (f64, String) {
    let fit = format!("fit {input} -o out.svg --psnr 60 --report r.json {options}");
    let said = place.said(&fit, 3);
    let reached = &place.report("r.json")["fidelity"]["psnr_db"];
    (reached.as_f64().unwrap(), said)
}

/// Each remedy of a target that was missed is tried.
#[test]
fn what_is_said_to_help_helps() {
    let place = Place::new();
    let noise = |x: u32, y: u32| (((x * 7919 + y * 104_729) * 2_654_435) >> 8) as u8;
    let picture = image::GrayImage::from_fn(40, 30, |x, y| image::Luma([noise(x, y)]));
    picture.save(place.path("in.png")).unwrap();
    let twice = image::imageops::resize(&picture, 80, 60, image::imageops::FilterType::Triangle);
    twice.save(place.path("twice.png")).unwrap();

    for (options, remedy, input, with_remedy) in [
        (
            "--strokes 5",
            "allow more strokes",
            "in.png",
            "--strokes 20",
        ),
        ("--bytes 700", "allow more bytes", "in.png", "--bytes 2800"),
        (
            "--opaque --preset draft",
            "leave out --opaque, --preset draft",
            "in.png",
            "",
        ),
        ("", "allow more strokes", "in.png", "--strokes 400"),
        ("", "", "twice.png", ""),
    ] {
        let (before, said) = asked_for_60(&place, "in.png", options);
        assert_says(&said, &[remedy]);
        let (after, _) = asked_for_60(&place, input, with_remedy);
        assert!(after > before, "{options}: {before} {after}");
    }
}

#[test]
fn what_is_said_to_help_a_picture_of_few_pixels_helps() {
    let place = Place::new();
    let chequer = |x, y| image::Rgb([255 * ((x + y) % 2) as u8; 3]);
    let mut picture = image::RgbImage::from_fn(4, 4, chequer);
    picture.put_pixel(3, 3, image::Rgb([128; 3]));
    picture.save(place.path("in.png")).unwrap();
    let said = place.said("fit in.png -o out.svg --preset draft", 0);
    assert_says(&said, &["16 times its size"]);
    let large = image::imageops::resize(&picture, 64, 64, image::imageops::FilterType::Nearest);
    large.save(place.path("in.png")).unwrap();
    place.done("fit in.png -o out.svg");
    place.done("render out.svg -o out.png");
    let drawn = image::open(place.path("out.png")).unwrap().to_rgb8();
    for (x, y, pixel) in picture.enumerate_pixels() {
        let middle = drawn.get_pixel(16 * x + 8, 16 * y + 8);
        let levels = pixel.0.iter().zip(middle.0);
        let worst = levels.map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(worst < 32, "{pixel:?} {middle:?}");
    }
}

#[test]
fn pictures_of_more_formats_are_read_and_others_named() {
    let place = Place::new();
    let picture = image::RgbImage::from_fn(20, 16, |x, _| image::Rgb([x as u8 * 12, 90, 200]));
    picture.save(place.path("a.ppm")).unwrap();
    picture.save(place.path("b.qoi")).unwrap();
    let picture = image::DynamicImage::from(picture).to_rgba8();
    picture.save(place.path("c.ico")).unwrap();
    for name in ["a.ppm", "b.qoi", "c.ico"] {
        place.done(&format!("fit {name} -o out.svg --strokes 5 --preset draft"));
    }
    place.file("d.avif", b"\0\0\0\x20ftypavif\0\0\0\0avifmif1");
    place.file("e.svg", RED_SVG);
    for (name, words) in [("d.avif", "avifdec"), ("e.svg", "strokefit render")] {
        assert_refused(&place, &["fit", name, "-o", "out.svg"], 1, &[name, words]);
    }
    let pixel = image::Rgba([9, 90, 200, 255]);
    let frame = || image::Frame::new(image::RgbaImage::from_pixel(9, 9, pixel));
    let mut gif = Vec::new();
    let mut encoder = image::codecs::gif::GifEncoder::new(&mut gif);
    encoder.encode_frames([frame(), frame()]).unwrap();
    drop(encoder);
    place.file("f.gif", gif);
    let said = place.said("-v fit f.gif -o out.svg --report r.json", 0);
    assert_eq!(said.matches("first frame").count(), 1);
    assert_remark(&place, "first frame");
}

/// The first remark of the report says this of the input.
#[track_caller]
fn assert_remark(place: &Place, words: &str) {
    let remark = &place.report("r.json")["input"]["remarks"][0];
    assert_says(remark.as_str().unwrap(), &[words]);
}

#[test]
fn what_matters_of_colours_is_said_unasked() {
    let place = Place::new();
    let fit = "fit @tests/data/pictures/alltransparent.png -o a.svg";
    assert_says(
        &place.said(fit, 0),
        &["every pixel of the picture is transparent"],
    );
    let fit = "fit @tests/data/pictures/cmyk_icc.jpg -o a.svg --report r.json";
    assert!(!place.said(fit, 0).contains("sRGB"));
    assert_remark(&place, "sRGB");
}

#[test]
fn a_large_picture_is_drawn_of_fewer_pixels() {
    let place = Place::new();
    let picture = image::GrayImage::from_fn(1536, 1280, |x, y| {
        image::Luma([(((x * x + y * y) as f32 / 3e5).sin() * 50.0 + 120.0) as u8])
    });
    picture.save(place.path("in.png")).unwrap();
    let head = r#"width="1536" height="1280" viewBox="0 0 768 640""#;
    let said = place.said(
        "fit in.png -o out.svg --preset draft --marks strokes --strokes 40",
        0,
    );
    assert_says(&said, &["1536×1280 px were drawn as 768×640"]);
    assert_says(&place.text("out.svg"), &[head]);
    // A refinement goes on from the drawing of a reduced picture.
    place.done("refine out.svg in.png -o more.svg --strokes +9 --preset draft --marks strokes");
    assert_says(&place.text("more.svg"), &[head]);
}

#[test]
fn the_look_is_as_asked_for() {
    let place = Place::of_picture(40, 30);
    // An SVG after the picture is the output.
    let fit = |options: &str| {
        place.done(&format!(
            "fit in.png out.svg --strokes 30 --preset draft {options}"
        ));
        place.text("out.svg")
    };
    assert!(!fit("--opaque").contains("-opacity"));
    assert!(!fit("--background none").contains("<rect"));
    assert!(fit("--background #0a0b0c").contains("fill=\"#0a0b0c\""));
    let staged = fit("--stages 3 --no-polish");
    let stages = staged.matches("inkscape:groupmode").count();
    assert!((1..=3).contains(&stages), "{stages}");
    let whole = fit("--precision 0");
    // The length of a dot and opacities are fractions at any precision.
    let numbers = whole
        .replace("h0.01", "")
        .replace("stroke-opacity=\"0.", "");
    let mut paths = numbers.lines().filter(|line| line.starts_with("<path"));
    assert!(!paths.any(|path| path.contains('.')), "{whole}");
}
