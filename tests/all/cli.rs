//! The program as its users meet it: exit statuses, lines on standard error, files left behind.

use std::fs;

use crate::support::output::stderr;
use crate::support::place::Place;
use crate::support::refusal::assert_refused;
use crate::support::repository::committed;

const RED_SVG: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><rect width="2" height="2" fill="#ff0000"/></svg>"##;

#[test]
fn pictures_that_cannot_be_read_are_refused() {
    let place = Place::new();
    place.picture("good.png", 30, 20);
    let good = fs::read(place.path("good.png")).unwrap();
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
    let refused = place.run(&["fit", "-", "-o", "out.svg"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains("standard input: the file is empty"));
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let place = Place::new();
    place.picture("in.png", 30, 20);
    place.file("file", "");
    fs::create_dir(place.path("folder")).unwrap();
    for name in ["folder", "file/out.svg", "file/none/out.svg"] {
        assert_refused(
            &place,
            &["fit", "in.png", "-o", name],
            1,
            &[name, "cannot be written"],
        );
        let args = ["fit", "in.png", "-o", "out.svg", "--report", name];
        assert_refused(&place, &args, 1, &[name, "cannot be written"]);
    }
}

#[test]
fn folders_of_outputs_are_made() {
    let place = Place::new();
    place.picture("in.png", 30, 20);
    place.done(&[
        "fit",
        "in.png",
        "-o",
        "a/{stem}.svg",
        "-o",
        "b/c/in.gif",
        "-o",
        "d/{n}.png",
        "--report",
        "e/r.json",
        "--events",
        "f/e.jsonl",
        "--strokes",
        "5",
    ]);
    for name in ["a/in.svg", "b/c/in.gif", "d/1.png", "e/r.json", "f/e.jsonl"] {
        let length = fs::metadata(place.path(name)).unwrap().len();
        assert!(length > 0, "{name}");
    }
    place.done(&["render", "a/in.svg", "-o", "g/h.png"]);
    assert!(place.path("g/h.png").is_file());
    // A command that is refused makes none.
    assert_refused(
        &place,
        &["fit", "no.png", "-o", "none/out.svg"],
        1,
        &["no.png"],
    );
    assert!(!place.path("none").exists());
}

#[test]
#[cfg(unix)]
fn a_write_protected_file_is_not_replaced() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    place.picture("in.png", 30, 20);
    place.file("out.svg", "precious");
    fs::set_permissions(place.path("out.svg"), fs::Permissions::from_mode(0o444)).unwrap();
    assert_refused(
        &place,
        &["fit", "in.png", "-o", "out.svg"],
        1,
        &["out.svg", "permission denied"],
    );
    assert_eq!(
        fs::read_to_string(place.path("out.svg")).unwrap(),
        "precious"
    );
}

#[test]
fn nonsense_options_are_refused() {
    let place = Place::new();
    place.picture("in.png", 30, 20);
    for (option, value) in [
        ("--strokes", "0"),
        ("--strokes", "many"),
        ("--strokes", "1000000000"),
        ("--psnr", "NaN"),
        ("--psnr", "inf"),
        ("--psnr", "-3"),
        ("--bytes", "0"),
        ("--time", "-1"),
        ("--time", "0"),
        ("--time", "1e300"),
        ("--stages", "0"),
        ("--precision", "9"),
        ("--threads", "0"),
        ("--preset", "ludicrous"),
        ("--coverage", "mystery"),
        ("--coverage", "atan:-1"),
        ("--background", "#12345"),
        ("--seed", "x"),
    ] {
        let args = ["fit", "in.png", "-o", "out.svg", option, value];
        assert_refused(&place, &args, 2, &[option, value]);
    }
    assert_refused(
        &place,
        &["fit", "in.png", "-o", "out.svg", "--stroke", "3"],
        2,
        &["--stroke", "--strokes"],
    );
    assert_refused(&place, &["fit", "in.png"], 2, &["--output"]);
    assert_refused(&place, &["paint"], 2, &["paint"]);
    assert_refused(
        &place,
        &["render", "in.svg", "-o", "a.png", "--scale", "0"],
        2,
        &["--scale", "0"],
    );
}

#[test]
fn outputs_may_not_collide() {
    let place = Place::new();
    place.picture("in.png", 30, 20);
    assert_refused(
        &place,
        &["fit", "in.png", "-o", "out.svg", "-o", "./in.png"],
        2,
        &["in.png", "overwritten"],
    );
    assert_refused(
        &place,
        &["fit", "in.png", "-o", "-", "--report", "-"],
        2,
        &["same place"],
    );
    place.file("a.svg", RED_SVG);
    assert_refused(
        &place,
        &["render", "a.svg", "-o", "a.svg"],
        2,
        &["a.svg", "overwritten"],
    );
    assert_refused(&place, &["check", "-", "-"], 2, &["standard input"]);
}

#[test]
fn files_that_are_no_svg_are_refused() {
    let place = Place::new();
    place.picture("in.png", 4, 2);
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
    place.file("red.svg", RED_SVG);
    place.picture("tall.png", 2, 4);
    assert_refused(
        &place,
        &["check", "red.svg", "tall.png"],
        1,
        &["red.svg", "aspect ratio"],
    );
    assert_refused(
        &place,
        &["render", "red.svg", "-o", "a.png", "--scale", "1e9"],
        1,
        &["red.svg", "px"],
    );
}

#[test]
fn help_and_version_go_to_standard_output() {
    let place = Place::new();
    for args in [
        &["--help"][..],
        &["fit", "--help"],
        &["check", "-h"],
        &["render", "-h"],
        &["--version"],
    ] {
        let output = place.done(args);
        assert!(
            !output.stdout.is_empty() && output.stderr.is_empty(),
            "{args:?}"
        );
    }
    assert_eq!(place.run("").status.code(), Some(2));
}

#[test]
fn render_draws_at_the_scale_asked_for() {
    let place = Place::new();
    place.file("red.svg", RED_SVG);
    place.done(&["render", "red.svg", "-o", "a.png", "--scale", "2"]);
    let picture = image::open(place.path("a.png")).unwrap().to_rgba8();
    assert_eq!(picture.dimensions(), (8, 4));
    assert_eq!(picture.get_pixel(0, 0).0, [255, 0, 0, 255]);
    assert_eq!(picture.get_pixel(7, 3).0[3], 0);
    let piped = place.pipe(
        &["render", "-", "-o", "-", "--scale", "2"],
        RED_SVG.as_bytes(),
    );
    assert_eq!(piped.stdout, fs::read(place.path("a.png")).unwrap());
}

#[test]
fn check_prints_a_table_or_json() {
    let place = Place::new();
    place.file("red.svg", RED_SVG);
    place.run(&["render", "red.svg", "-o", "red.png"]);
    let check = [
        "check",
        "red.svg",
        "red.png",
        "--renderer",
        "resvg",
        "--report",
    ];
    let table = place.done(&[&check[..], &["r.json"]].concat());
    let table = String::from_utf8(table.stdout).unwrap();
    assert!(table.contains("resvg") && table.contains("inf"), "{table}");
    let mut record = place.report("r.json");
    assert_eq!(record["schema"], 1);
    assert_eq!(record["renderers"][0]["renderer"], "resvg");
    assert!(
        record["renderers"][0]["fidelity"]["psnr_db"].is_null(),
        "{record}"
    );
    let piped = place.run(&[&check[..], &["-"]].concat());
    let mut piped: serde_json::Value = serde_json::from_slice(&piped.stdout).unwrap();
    // All but how long it took.
    for record in [&mut record, &mut piped] {
        assert!(record["renderers"][0]["wall_s"].take().is_f64());
    }
    assert_eq!(piped, record);
}

#[test]
fn a_quiet_check_says_by_its_status_alone() {
    let place = Place::new();
    place.file("red.svg", RED_SVG);
    place.done(&["render", "red.svg", "-o", "red.png"]);
    let check = ["check", "-q", "red.svg", "red.png", "--renderer", "resvg"];
    let quiet = place.done(&check);
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let record = place
        .done(&[&check[..], &["--report", "-"]].concat())
        .stdout;
    assert!(record.starts_with(b"{"));
}

#[test]
fn fit_writes_a_file_that_check_and_render_understand() {
    let place = Place::new();
    let input = committed("samples/noto-gem.png");
    let fit = ["fit", &input, "-o", "gem.svg", "--report", "gem.json"];
    let few = ["--strokes", "150", "--preset", "draft"];
    let output = place.done(&[&fit[..], &few].concat());
    let summary = stderr(&output);
    assert_eq!(summary.lines().count(), 1, "{summary}");
    for word in ["gem.svg", "strokes", "bytes", "fidelity", "agreement", "dB"] {
        assert!(summary.contains(word), "{summary}");
    }
    assert!(output.stdout.is_empty());
    assert_eq!(place.names(), ["gem.json", "gem.svg"]);

    let record = place.report("gem.json");
    assert_eq!(
        record["svg_bytes"],
        fs::metadata(place.path("gem.svg")).unwrap().len()
    );
    assert!(record["strokes"].as_u64().unwrap() <= 150);
    let staged: u64 = record["stages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["strokes"].as_u64().unwrap())
        .sum();
    assert_eq!(staged, record["strokes"]);
    assert!(
        record["agreement"]["psnr_db"].as_f64().unwrap() > 36.0,
        "{record}"
    );

    // The report says what anyone can measure; the gem's transparent parts are laid on white.
    let check = ["check", "gem.svg", &input, "--report", "-"];
    let check = place.run(&[&check[..], &["--renderer", "resvg"]].concat());
    let check: serde_json::Value = serde_json::from_slice(&check.stdout).unwrap();
    assert_eq!(check["renderers"][0]["fidelity"], record["fidelity"]);
    place.done(&["render", "gem.svg", "-o", "gem.png"]);
}

#[test]
fn fit_works_in_a_pipe_and_quietly() {
    let place = Place::new();
    place.picture("in.png", 30, 20);
    let bytes = fs::read(place.path("in.png")).unwrap();
    let piped = place.pipe(&["fit", "-", "-o", "-", "-q", "--strokes", "20"], &bytes);
    assert_eq!(piped.status.code(), Some(0), "{}", stderr(&piped));
    assert_eq!(stderr(&piped), "");
    place.run(&["fit", "in.png", "-o", "out.svg", "--strokes", "20"]);
    assert_eq!(piped.stdout, fs::read(place.path("out.svg")).unwrap());
}

#[test]
fn threads_change_no_byte() {
    let place = Place::new();
    place.picture("in.png", 60, 40);
    for threads in ["1", "3"] {
        let options = format!("--preset draft --threads {threads}");
        place.done(&format!("fit in.png -o {threads}.svg {options}"));
    }
    assert!(fs::read(place.path("1.svg")).unwrap() == fs::read(place.path("3.svg")).unwrap());
}

#[test]
fn the_smallest_and_thinnest_pictures_work() {
    let place = Place::new();
    for (width, height) in [(1, 1), (1, 4096), (4096, 1), (3, 2)] {
        let input = format!("{width}×{height}.png");
        place.picture(&input, width, height);
        for strokes in ["1", "40"] {
            let options = format!("--preset draft --strokes {strokes}");
            place.done(&format!("fit {input} -o out.svg {options}"));
        }
        let text = fs::read_to_string(place.path("out.svg")).unwrap();
        assert!(
            text.contains(&format!("viewBox=\"0 0 {width} {height}\"")),
            "{text}"
        );
    }
}

#[test]
fn a_target_out_of_reach_is_exit_3_and_the_file_is_kept() {
    let place = Place::new();
    let output = place.run(&[
        "fit",
        &committed("samples/coffee-300.png"),
        "-o",
        "out.svg",
        "--strokes",
        "5",
        "--psnr",
        "60",
    ]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("target not reached"),
        "{}",
        stderr(&output)
    );
    assert_eq!(place.names(), ["out.svg"]);
}

/// dB of a fit that asks for 60, and what it says.
fn asked_for_60(place: &Place, input: &str, options: &[&str]) -> (f64, String) {
    let fit = [
        "fit", input, "-o", "out.svg", "--psnr", "60", "--report", "r.json",
    ];
    let output = place.run(&[&fit[..], options].concat());
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let reached = place.report("r.json")["fidelity"]["psnr_db"]
        .as_f64()
        .unwrap();
    (reached, stderr(&output))
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

    let (few, line) = asked_for_60(&place, "in.png", &["--strokes", "5"]);
    assert!(line.contains("allow more strokes"), "{line}");
    let (more, _) = asked_for_60(&place, "in.png", &["--strokes", "20"]);
    assert!(more > few, "{few} {more}");

    let (short, line) = asked_for_60(&place, "in.png", &["--bytes", "700"]);
    assert!(line.contains("allow more bytes"), "{line}");
    let (long, _) = asked_for_60(&place, "in.png", &["--bytes", "2800"]);
    assert!(long > short, "{short} {long}");

    let (opaque, line) = asked_for_60(&place, "in.png", &["--opaque", "--preset", "draft"]);
    assert!(
        line.contains("leave out --opaque, --preset draft"),
        "{line}"
    );
    let (free, line) = asked_for_60(&place, "in.png", &[]);
    assert!(free > opaque, "{opaque} {free}");

    assert!(line.contains("allow more strokes"), "{line}");
    let (many, _) = asked_for_60(&place, "in.png", &["--strokes", "400"]);
    assert!(many > free, "{free} {many}");
    let (large, _) = asked_for_60(&place, "twice.png", &[]);
    assert!(large > free, "{free} {large}");
}

#[test]
fn what_is_said_to_help_a_picture_of_few_pixels_helps() {
    let place = Place::new();
    let mut picture =
        image::RgbImage::from_fn(4, 4, |x, y| image::Rgb([255 * ((x + y) % 2) as u8; 3]));
    picture.put_pixel(3, 3, image::Rgb([128; 3]));
    picture.save(place.path("in.png")).unwrap();
    let output = place.run(&["fit", "in.png", "-o", "out.svg", "--preset", "draft"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        stderr(&output).contains("16 times its size"),
        "{}",
        stderr(&output)
    );
    let large = image::imageops::resize(&picture, 64, 64, image::imageops::FilterType::Nearest);
    large.save(place.path("in.png")).unwrap();
    place.done(&["fit", "in.png", "-o", "out.svg"]);
    place.done(&["render", "out.svg", "-o", "out.png"]);
    let drawn = image::open(place.path("out.png")).unwrap().to_rgb8();
    for (x, y, pixel) in picture.enumerate_pixels() {
        let middle = drawn.get_pixel(16 * x + 8, 16 * y + 8);
        let worst = pixel
            .0
            .iter()
            .zip(middle.0)
            .map(|(a, b)| a.abs_diff(b))
            .max()
            .unwrap();
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
    let frame = || {
        image::Frame::new(image::RgbaImage::from_pixel(
            9,
            9,
            image::Rgba([9, 90, 200, 255]),
        ))
    };
    let mut gif = Vec::new();
    let mut encoder = image::codecs::gif::GifEncoder::new(&mut gif);
    encoder.encode_frames([frame(), frame()]).unwrap();
    drop(encoder);
    place.file("f.gif", gif);
    let output = place.done(&["-v", "fit", "f.gif", "-o", "out.svg", "--report", "r.json"]);
    assert_eq!(stderr(&output).matches("first frame").count(), 1);
    let remark = &place.report("r.json")["input"]["remarks"][0];
    assert!(remark.as_str().unwrap().contains("first frame"), "{remark}");
}

#[test]
fn what_matters_of_colours_is_said_unasked() {
    let place = Place::new();
    let clear = committed("tests/data/pictures/alltransparent.png");
    let output = place.done(&["fit", &clear, "-o", "a.svg"]);
    assert!(stderr(&output).contains("every pixel of the picture is transparent"));
    let inks = committed("tests/data/pictures/cmyk_icc.jpg");
    let output = place.done(&["fit", &inks, "-o", "a.svg", "--report", "r.json"]);
    assert!(!stderr(&output).contains("sRGB"));
    let remark = &place.report("r.json")["input"]["remarks"][0];
    assert!(remark.as_str().unwrap().contains("sRGB"), "{remark}");
}

#[test]
fn an_svg_after_the_picture_is_the_output() {
    let place = Place::new();
    place.picture("a.png", 20, 16);
    place.done(&["fit", "a.png", "b.svg", "--strokes", "5"]);
    assert!(place.path("b.svg").exists());
    let words = ["no output is named", "add -o a.svg"];
    assert_refused(&place, &["fit", "a.png"], 2, &words);
    let words = ["hint: strokefit fit a.png -o c.svg"];
    assert_refused(&place, &["a.png", "-o", "c.svg"], 2, &words);
}

#[test]
fn a_large_picture_is_drawn_of_fewer_pixels() {
    let place = Place::new();
    let picture = image::GrayImage::from_fn(1536, 1280, |x, y| {
        image::Luma([(((x * x + y * y) as f32 / 3e5).sin() * 50.0 + 120.0) as u8])
    });
    picture.save(place.path("in.png")).unwrap();
    let fit = |options: &[&str]| {
        let fit = ["fit", "in.png", "-o", "out.svg", "--preset", "draft"];
        stderr(&place.done(&[&fit[..], options].concat()))
    };
    let said = fit(&[]);
    assert!(
        said.contains("1536×1280 px were drawn as 768×640"),
        "{said}"
    );
    let text = fs::read_to_string(place.path("out.svg")).unwrap();
    assert!(text.contains(r#"width="1536" height="1280" viewBox="0 0 768 640""#));
    // A refinement goes on from the drawing of a reduced picture.
    let refine = "refine out.svg in.png -o more.svg --strokes +20 --preset draft";
    place.done(&refine);
    let more = fs::read_to_string(place.path("more.svg")).unwrap();
    assert!(more.contains(r#"width="1536" height="1280" viewBox="0 0 768 640""#));
}

#[test]
fn the_look_is_as_asked_for() {
    let place = Place::new();
    place.picture("in.png", 40, 30);
    let fit = |options: &str| {
        let fit = "fit in.png -o out.svg --strokes 30 --preset draft";
        place.done(&format!("{fit} {options}"));
        fs::read_to_string(place.path("out.svg")).unwrap()
    };
    assert!(!fit("--opaque").contains("stroke-opacity"));
    assert!(!fit("--background none").contains("<rect"));
    assert!(fit("--background #0a0b0c").contains("fill=\"#0a0b0c\""));
    let stages = fit("--stages 3 --no-polish")
        .matches("inkscape:groupmode")
        .count();
    assert!((1..=3).contains(&stages), "{stages}");
    let whole = fit("--precision 0");
    // The length of a dot and opacities are fractions at any precision.
    let numbers = whole
        .replace("h0.01", "")
        .replace("stroke-opacity=\"0.", "");
    assert!(
        !numbers
            .lines()
            .any(|line| line.starts_with("<path") && line.contains('.')),
        "{whole}"
    );
}
