//! Files for cutters, plotters and print: outlines, cut-outs, hatching, PDF and DXF.

use std::ffi::OsStr;
use std::fs;
use std::process::Command;

use crate::support::{Place, Words, agreement, assert_refused, assert_says, committed, skip};
use kurbo::Shape;
use strokefit::image::Image;
use strokefit::scene::{Mark, Path, Scene};
use strokefit::svg;
use strokefit::verify::{self, Size};

/// A folder with a picture of a filled drawing, 256 px wide.
fn with_picture(name: &str) -> Place {
    let text = fs::read_to_string(committed(&format!("samples/filled/{name}.svg"))).unwrap();
    let size = Size::Exact {
        width: 256,
        height: 256,
    };
    let picture = verify::render(&text, size, Some([1.0; 3])).unwrap();
    let place = Place::new();
    place.file("a.png", picture.encode_png().unwrap());
    place
}

/// The SVG of a fit of `a.png` with these options.
fn fitted(place: &Place, options: &str) -> String {
    place.done(&format!("fit a.png -o a.svg -q {options}"));
    place.text("a.svg")
}

fn image(text: &str, scale: f64) -> Image {
    verify::render(text, Size::Scale(scale), Some([1.0; 3])).unwrap()
}

/// The area that a ring encloses, px², with a sign for its direction.
fn enclosed(ring: &Path) -> f64 {
    ring.bezier().area()
}

/// The areas of a scene, px².
fn sizes(scene: &Scene) -> Vec<f64> {
    let size = |mark: &Mark| mark.paths().iter().map(enclosed).sum::<f64>().abs();
    scene.marks().map(size).collect()
}

/// Farthest that a point of a scene is beyond its page, px.
fn beyond(scene: &Scene) -> f64 {
    let page = [f64::from(scene.width), f64::from(scene.height)];
    let points = scene.marks().flat_map(Mark::paths).flat_map(Path::points);
    let away = |(x, side): (f64, f64)| (-x).max(x - side);
    points
        .flat_map(|p| [(p.at.x, page[0]), (p.at.y, page[1])])
        .map(away)
        .fold(f64::MIN, f64::max)
}

#[test]
fn areas_that_are_cut_out_fill_the_page_and_do_not_overlap() {
    for name in ["twemoji__dog", "fluent-emoji-flat__koala"] {
        let place = with_picture(name);
        let plain = fitted(&place, "--opaque");
        let text = fitted(&place, "--cutout");
        let scene = svg::read(&text).unwrap();
        assert_eq!(scene.strokes().count(), 0);
        let mut colors: Vec<_> = scene
            .marks()
            .map(|mark| mark.color().map(f32::to_bits))
            .collect();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), scene.len(), "one path for each colour");
        // With neither gap nor overlap, the parts are as large as the whole.
        let gap = 256.0 * 256.0 - sizes(&scene).iter().sum::<f64>();
        assert!(gap.abs() < 0.01 * scene.len() as f64, "{name}: {gap}");
        let pairs = overlap_of_pairs(&scene);
        assert!(pairs < 0.01, "{name}: {pairs}");
        assert!(beyond(&scene) <= 0.0);
        // Between neighbours the page shines through at the edges of pixels.
        let seen = agreement(&image(&text, 1.0), &image(&plain, 1.0));
        assert!(seen > 30.0, "{name}: {seen}");
    }
}

/// Largest share of places that lie in two areas, as an area in px².
fn overlap_of_pairs(scene: &Scene) -> f64 {
    // Places where a row crosses an area come in pairs; in a row, intervals of two areas must not overlap.
    let rings: Vec<Vec<_>> = scene
        .marks()
        .map(|mark| {
            mark.paths()
                .iter()
                .map(|ring| ring.flattened(1e-3))
                .collect()
        })
        .collect();
    let spans = |area: &Vec<Vec<strokefit::math::Point>>, y: f64| {
        let mut cuts: Vec<f64> = Vec::new();
        for ring in area {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                let [ay, by] = [a.y, b.y];
                if (ay <= y) != (by <= y) {
                    let t = (y - ay) / (by - ay);
                    cuts.push(a.x + t * (b.x - a.x));
                }
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.as_chunks::<2>().0.to_vec()
    };
    let rows = (0..1024).map(|row| (f64::from(row) + 0.5) / 4.0);
    let mut sums = vec![0.0; rings.len()];
    for y in rows {
        let spans: Vec<_> = rings.iter().map(|area| spans(area, y)).collect();
        for (i, own) in spans.iter().enumerate() {
            for [from, to] in own {
                let others = spans[..i].iter().flatten();
                let common = |[a, b]: &[f64; 2]| (to.min(*b) - from.max(*a)).max(0.0);
                sums[i] += others.map(common).sum::<f64>() / 4.0;
            }
        }
    }
    sums.into_iter().fold(0.0, f64::max)
}

#[test]
fn without_a_background_the_paper_is_not_cut_out() {
    let place = with_picture("simple-icons__volvo");
    let text = fitted(&place, "--cutout --background none");
    let scene = svg::read(&text).unwrap();
    let inked: f64 = sizes(&scene).iter().sum();
    assert!(inked > 1000.0 && inked < 0.7 * 256.0 * 256.0, "{inked}");
    assert!(!text.contains("<rect"));
}

#[test]
fn every_stroke_has_one_outline_that_looks_like_it() {
    let place = Place::new();
    place.done("fit @samples/bicycle.png -o a.svg -q --preset draft --strokes 60 --marks strokes");
    let strokes = place.text("a.svg");
    let scene = svg::read(&strokes).unwrap();
    let options = svg::WriteOptions {
        form: svg::Form::Outlines,
        ..svg::WriteOptions::default()
    };
    let outlines = svg::write(&scene, &options);
    assert!(!outlines.contains("stroke="));
    let elements = outlines.matches("<path").count() + outlines.matches("<circle").count();
    assert_eq!(elements, scene.len());
    for scale in [1.0, 3.0] {
        let seen = agreement(&image(&outlines, scale), &image(&strokes, scale));
        assert!(seen > 45.0, "{scale}: {seen}");
    }
}

#[test]
fn nothing_runs_off_the_page_where_a_machine_reads_the_file() {
    let place = Place::new();
    for options in ["--pens 2,5", "--width 120mm", "--order travel"] {
        let few = "-q --preset draft --strokes 200";
        place.done(&format!(
            "fit @samples/coffee-300.png -o a.svg {few} {options}"
        ));
        let scene = svg::read(&place.text("a.svg")).unwrap();
        assert!(beyond(&scene) <= 0.0, "{options:?}: {}", beyond(&scene));
    }
}

#[test]
fn hatching_fills_areas_with_lines() {
    let place = with_picture("twemoji__dog");
    let text = fitted(&place, "--hatch 3px:30 --background none");
    let scene = svg::read(&text).unwrap();
    assert_eq!(scene.areas().count(), 0);
    let lines = scene.strokes().filter(|s| s.path.points().len() == 2);
    let slopes: Vec<f64> = lines
        .map(|line| {
            let (a, b) = line.path.ends();
            (a.y - b.y) / (b.x - a.x)
        })
        .collect();
    let right = slopes
        .iter()
        .filter(|slope| (**slope - 30_f64.to_radians().tan()).abs() < 0.03);
    assert!(right.count() > 100, "{}", slopes.len());
    // Lines as wide as they are apart leave little bare.
    let plain = fitted(&place, "--opaque --background none");
    let seen = agreement(&image(&text, 1.0), &image(&plain, 1.0));
    assert!(seen > 18.0, "{seen}");
}

/// The standard output of a program; `None`, and a word on it, if it is missing here.
fn output(program: &str, args: &[impl AsRef<OsStr>], place: &Place) -> Option<String> {
    match place.command(program).args(args).output() {
        Ok(output) if output.status.success() => Some(String::from_utf8(output.stdout).unwrap()),
        Ok(output) => panic!("{program}: {}", String::from_utf8_lossy(&output.stderr)),
        Err(_) => {
            skip(&format!("{program} is not installed"));
            None
        }
    }
}

#[test]
fn a_pdf_is_drawn_like_the_svg() {
    let place = Place::new();
    let options = "-q --preset draft --strokes 60 --width 100mm";
    place.done(&format!(
        "fit @samples/bicycle.png -o a.svg -o a.pdf {options}"
    ));
    place.done("render a.svg -o b.pdf");
    let pdf = place.bytes("a.pdf");
    assert!(pdf.starts_with(b"%PDF-1.5") && pdf.ends_with(b"%%EOF\n"));
    assert_eq!(pdf, place.bytes("b.pdf"));
    assert!(as_pdf(&place).is_none_or(|seen| seen > 34.0));
}

/// Agreement of `a.pdf`, as poppler draws it, with `a.svg`, dB; `None` without poppler. Both are drawn at four times the size
/// and averaged, since antialiasing differs.
fn as_pdf(place: &Place) -> Option<f64> {
    let svg = image(&place.text("a.svg"), 4.0);
    let size = format!("-scale-to-x {} -scale-to-y {}", svg.width(), svg.height());
    let args = format!("-png -singlefile {size} a.pdf a").words();
    output("pdftoppm", &args, place)?;
    let drawn = Image::open(place.path("a.png")).unwrap();
    Some(agreement(&averaged(&drawn), &averaged(&svg)))
}

/// The means of 4×4 pixels.
fn averaged(image: &Image) -> Image {
    let (width, height) = (image.width() / 4, image.height() / 4);
    let mean = |plane: &Vec<f32>| {
        let pixel = |i: usize| {
            let (x, y) = (4 * (i % width), 4 * (i / width));
            let parts = (0..16).map(|k| plane[(y + k / 4) * image.width() + x + k % 4]);
            parts.sum::<f32>() / 16.0
        };
        (0..width * height).map(pixel).collect()
    };
    Image::new(width, height, image.planes().each_ref().map(mean)).unwrap()
}

#[test]
fn a_pdf_has_gradients_opacities_square_ends_and_shapes() {
    let chevrons = Place::new();
    chevrons.done("render @tests/data/plans/chevrons.svg -o in.png -q");
    let dog = with_picture("twemoji__dog");
    for (place, fit, part, least_db) in [
        (
            &chevrons,
            "@samples/fade-400.png --preset draft",
            "<linearGradient",
            34.0,
        ),
        (
            &chevrons,
            "@samples/glow-300.png --preset draft",
            "<radialGradient",
            34.0,
        ),
        (&chevrons, "in.png", "<path d=", 33.0),
        (&dog, "a.png", "<circle", 34.0),
    ] {
        place.done(&format!("fit {fit} -o a.svg -o a.pdf -q"));
        let text = place.text("a.svg");
        assert_says(&text, &[part]);
        let has_areas = svg::read(&text).unwrap().areas().count() > 0;
        assert!(fit != "in.png" || !has_areas, "{text}");
        let seen = as_pdf(place);
        assert!(seen.is_none_or(|seen| seen > least_db), "{fit}: {seen:?}");
    }
}

/// Reads a DXF and prints how many things there are, their bounds in mm, its unit, and the errors that ezdxf finds.
const READ_DXF: &str = r#"
import ezdxf, ezdxf.bbox
drawing = ezdxf.readfile("a.dxf")
box = ezdxf.bbox.extents(drawing.modelspace())
errors = len(drawing.audit().errors)
low, high = box.extmin, box.extmax
print(len(drawing.modelspace()), low.x, low.y, high.x, high.y, drawing.units, errors, len(drawing.layers))
"#;

#[test]
fn a_dxf_has_lines_and_arcs_in_millimetres_on_layers_by_colour() {
    let place = with_picture("twemoji__dog");
    let scene = svg::read(&fitted(&place, "--cutout --width 100mm -o a.dxf")).unwrap();
    let text = place.text("a.dxf");
    let rings: usize = scene.marks().map(|mark| mark.paths().len()).sum();
    assert_eq!(text.matches("\nLWPOLYLINE\n").count(), rings);
    assert!(text.contains("$INSUNITS\n70\n4\n") && text.ends_with("EOF\n"));
    place.done("render a.svg -o b.dxf");
    let has_ezdxf = Command::new("python3")
        .args(["-c", "import ezdxf"])
        .output();
    if !has_ezdxf.is_ok_and(|output| output.status.success()) {
        return skip("ezdxf is not installed for python3");
    }
    let Some(said) = output("python3", &["-c", READ_DXF], &place) else {
        return;
    };
    let numbers: Vec<f64> = said
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect();
    assert_eq!(numbers[0], rings as f64);
    for (number, right) in numbers[1..5].iter().zip([0.0, 0.0, 100.0, 100.0]) {
        assert!((number - right).abs() < 0.02, "{said}");
    }
    // Millimetres, no errors, and a layer for each colour beside the one that every file has.
    assert_eq!((numbers[5], numbers[6]), (4.0, 0.0), "{said}");
    assert!(numbers[7] as usize > scene.len(), "{said}");
}

#[test]
fn render_makes_of_a_drawing_what_a_fit_makes() {
    let place = with_picture("simple-icons__volvo");
    let text = fitted(&place, "--opaque --width 80mm");
    let render = |option: &str| {
        place.done(&format!("render a.svg -o b.svg {option}"));
        place.text("b.svg")
    };
    for option in ["--cutout", "--outline"] {
        let made = render(option);
        assert!(made.contains("width=\"80mm\"") && !made.contains("stroke="));
        let seen = agreement(&image(&made, 1.0), &image(&text, 1.0));
        assert!(seen > 30.0, "{option}: {seen}");
    }
    let hatched = svg::read(&render("--hatch 1mm")).unwrap();
    assert!(hatched.areas().count() == 0 && hatched.strokes().count() > 20);
    assert_refused(&place, "render a.svg -o b.svg", 2, &["--cutout"]);
}

#[test]
fn files_for_machines_that_make_no_sense_are_refused() {
    let place = with_picture("simple-icons__volvo");
    for (options, word) in [
        ("--cutout --outline", "--cutout"),
        ("--cutout --hatch 1mm", "--cutout"),
        ("-o a.eps", ".eps"),
        ("--hatch 5", "0.5mm:30"),
        ("--hatch 0.01mm", "apart"),
    ] {
        assert_refused(&place, &format!("fit a.png -o a.svg {options}"), 2, &[word]);
    }
}
