//! Files for cutters, plotters and print: outlines, cut-outs, hatching, PDF and DXF.

use std::ffi::OsStr;
use std::fs;
use std::process::Command;

use crate::support::paths::of_letters;
use crate::support::{Place, Words, agreement, assert_refused, assert_says, committed, skip};
use kurbo::{Line, ParamCurveNearest, Shape};
use strokefit::image::Image;
use strokefit::machine::{self, Sheet};
use strokefit::math::Point;
use strokefit::scene::{Area, Cap, Mark, Path, PathPoint, Scene, Stage, Stroke};
use strokefit::svg::{self, WriteOptions};
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
    let spans = |area: &Vec<Vec<Point>>, y: f64| {
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
    let options = WriteOptions {
        form: svg::Form::Outlines,
        ..WriteOptions::default()
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

#[test]
fn a_line_whose_width_varies_is_drawn_once_by_a_pen_that_covers_it() {
    let path = Path::line((10.0, 20.0).into(), (90.0, 20.0).into());
    let line = Stroke::varying(path.clone(), vec![1.0, 3.0], [0.0; 3], 1.0).unwrap();
    let scene = Scene {
        stages: vec![Stage::from_iter([line])],
        ..Scene::empty(100, 40, None)
    };
    let by = |pen| machine::hatched(&scene, pen, pen, 45.0).unwrap();
    let once = by(6.0);
    let drawn: Vec<_> = once
        .strokes()
        .map(|s| (&s.path, s.radius, s.is_varying()))
        .collect();
    assert_eq!(drawn, [(&path, 3.0, false)]);
    assert!(by(2.0).strokes().count() > 2);
    // A DXF has its middle, and a cutter its outline.
    let dxf = machine::dxf(&Sheet {
        scene: &scene,
        width: None,
    });
    let lines = dxf.lines().filter(|line| *line == "AcDbLine").count();
    assert_eq!(lines, 1);
    let [cut] = sizes(&machine::cut_out(&scene).unwrap())[..] else {
        panic!("one area");
    };
    assert!((cut - 336.0).abs() < 3.0, "{cut}");
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

/// The vertices of the polylines of a DXF, mm, with their bulges.
fn polylines(text: &str) -> Vec<Vec<([f64; 2], f64)>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut polylines: Vec<Vec<([f64; 2], f64)>> = Vec::new();
    let mut is_polyline = false;
    for pair in lines.chunks(2) {
        let (code, value) = (pair[0].trim(), pair[1]);
        let number = || value.parse::<f64>().unwrap();
        if code == "0" {
            is_polyline = value == "LWPOLYLINE";
            polylines.extend(is_polyline.then(Vec::new));
        }
        match (code, polylines.last_mut().filter(|_| is_polyline)) {
            ("10", Some(last)) => last.push(([number(), 0.0], 0.0)),
            ("20", Some(last)) => last.last_mut().unwrap().0[1] = number(),
            ("42", Some(last)) => last.last_mut().unwrap().1 = number(),
            _ => {}
        }
    }
    polylines
}

/// The place at a share of the way from `a` to `b` along an arc, as the reference of DXF defines it (LWPOLYLINE, group 42): the
/// bulge is the tangent of a fourth of the angle that the arc includes, negative if the arc goes clockwise from the start to
/// the end; the y axis goes up.
fn along_bulge(a: [f64; 2], b: [f64; 2], bulge: f64, share: f64) -> [f64; 2] {
    let angle = 4.0 * bulge.atan();
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    // Seen from the start, the centre is a quarter turn less half the angle to the left of the end.
    let radius = dx.hypot(dy) / (2.0 * (0.5 * angle).sin());
    let to_center = dy.atan2(dx) + std::f64::consts::FRAC_PI_2 - 0.5 * angle;
    let center = [
        a[0] + radius * to_center.cos(),
        a[1] + radius * to_center.sin(),
    ];
    // Counter-clockwise is the direction in which angles grow.
    let [x, y] = [a[0] - center[0], a[1] - center[1]];
    let (sin, cos) = (share * angle).sin_cos();
    [center[0] + x * cos - y * sin, center[1] + x * sin + y * cos]
}

#[test]
fn arcs_of_a_dxf_go_where_the_paths_go() {
    let (center, radius) = ([48.0, 36.0], 24.0);
    // Angles that grow turn clockwise on the page, whose y axis goes down.
    let at = |angle: f64| {
        [
            center[0] + radius * angle.cos(),
            center[1] + radius * angle.sin(),
        ]
    };
    for (start, sweep) in [
        (0.3, 1.0),
        (0.3, -1.0),
        (2.0, 3.0),
        (2.0, -3.0),
        (4.0, 5.0),
        (4.0, -5.0),
        (1.0, 6.0),
    ] {
        let point = |share: f64| {
            let [x, y] = at(start + share * sweep);
            Point::new(x, y)
        };
        let arc = vec![
            PathPoint::on(point(0.0)),
            PathPoint::arc(point(0.4)),
            PathPoint::on(point(1.0)),
        ];
        let stroke = |path| Stroke {
            path,
            radius: 1.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.0; 3],
            opacity: 1.0,
        };
        // Open, and closed by a line.
        let paths = [false, true].map(|closed| Path::new(arc.clone(), closed).unwrap());
        let scene = Scene {
            stages: vec![Stage::from_iter(paths.map(stroke))],
            ..Scene::empty(96, 72, None)
        };
        let sheet = Sheet {
            scene: &scene,
            width: None,
        };
        let polylines = polylines(&machine::dxf(&sheet));
        assert_eq!(polylines.len(), 2);
        for vertices in polylines {
            let [(a, bulge), (b, after)] = vertices[..] else {
                panic!("{vertices:?}")
            };
            assert_eq!(after, 0.0);
            for share in [0.0, 0.1, 0.25, 0.5, 0.8, 1.0] {
                let [x, y] = at(start + share * sweep);
                let expected = [x, 72.0 - y].map(|px| px * 25.4 / 96.0);
                let got = along_bulge(a, b, bulge, share);
                let away = (got[0] - expected[0]).hypot(got[1] - expected[1]);
                assert!(
                    away < 1e-3,
                    "{start} {sweep} {share}: {got:?}, not {expected:?}"
                );
            }
        }
    }
}

#[test]
fn arcs_of_a_dxf_are_within_a_hundredth_of_a_millimetre_of_cubic_curves() {
    let at = Point::new;
    let points = vec![
        PathPoint::on(at(5.0, 60.0)),
        PathPoint::cubic(at(10.0, -40.0)),
        PathPoint::cubic(at(90.0, 110.0)),
        PathPoint::on(at(90.0, 10.0)),
        PathPoint::cubic(at(95.0, 0.0)),
        PathPoint::cubic(at(20.0, 5.0)),
        PathPoint::on(at(60.0, 65.0)),
    ];
    let path = Path::new(points, false).unwrap();
    let stroke = Stroke {
        path: path.clone(),
        radius: 1.0,
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.0; 3],
        opacity: 1.0,
    };
    let scene = Scene {
        stages: vec![Stage::from_iter([stroke])],
        ..Scene::empty(96, 72, None)
    };
    let sheet = Sheet {
        scene: &scene,
        width: Some("300mm".parse().unwrap()),
    };
    let mm = 300.0 / 96.0;
    let lines: Vec<Line> = path
        .flattened(1e-4)
        .windows(2)
        .map(|ends| Line::new(ends[0], ends[1]))
        .collect();
    let [vertices] = &polylines(&machine::dxf(&sheet))[..] else {
        panic!("one polyline")
    };
    for ends in vertices.windows(2) {
        for share in [0.0, 0.3, 0.5, 0.9] {
            let [x, y] = along_bulge(ends[0].0, ends[1].0, ends[0].1, share);
            let place = at(x / mm, 72.0 - y / mm);
            let gaps = lines
                .iter()
                .map(|line| line.nearest(place, 0.0).distance_sq.sqrt() * mm);
            let gap = gaps.fold(f64::INFINITY, f64::min);
            assert!(gap < 0.0105, "{gap} mm");
        }
    }
}

/// Opaque marks of cubic curves and arcs: an area with a hole, a line, and one with square ends.
fn of_curves_and_arcs() -> Scene {
    let ring = [
        (20.0, 60.0, 'o'),
        (60.0, 10.0, 'a'),
        (100.0, 60.0, 'o'),
        (150.0, 60.0, 'c'),
        (90.0, 140.0, 'c'),
        (60.0, 130.0, 'o'),
    ];
    let hole = [(50.0, 70.0, 'o'), (60.0, 50.0, 'a'), (80.0, 80.0, 'o')];
    let line = [
        (110.0, 20.0, 'o'),
        (170.0, 0.0, 'c'),
        (170.0, 70.0, 'c'),
        (130.0, 70.0, 'o'),
    ];
    let arc = [(120.0, 130.0, 'o'), (150.0, 95.0, 'a'), (185.0, 110.0, 'o')];
    let stroke = |points: &[_], cap| Stroke {
        path: of_letters(points, false),
        radius: 5.0,
        radii: Vec::new(),
        cap,
        color: [0.1, 0.4, 0.8],
        opacity: 1.0,
    };
    let area = Area::plain(
        vec![of_letters(&ring, true), of_letters(&hole, true)],
        [0.8, 0.3, 0.1],
        1.0,
    );
    let marks = [
        Mark::from(area),
        stroke(&line, Cap::Round).into(),
        stroke(&arc, Cap::Butt).into(),
    ];
    Scene {
        stages: vec![Stage::from_iter(marks)],
        ..Scene::empty(200, 150, Some([1.0; 3]))
    }
}

#[test]
fn every_file_has_cubic_curves_and_arcs() {
    let place = Place::new();
    let text = svg::write(&of_curves_and_arcs(), &WriteOptions::default());
    assert_says(
        &text,
        &["0c50 0-10 80-40 70z", "a35.63 35.63 0 0 1", "\"butt\""],
    );
    place.file("a.svg", &text);
    for (option, least_db) in [
        ("--cutout", 32.0),
        ("--outline", 45.0),
        ("--hatch 2px", 20.0),
    ] {
        place.done(&format!("render a.svg -o b.svg {option}"));
        let seen = agreement(&image(&place.text("b.svg"), 2.0), &image(&text, 2.0));
        assert!(seen > least_db, "{option}: {seen}");
    }
    place.done("render a.svg -o a.pdf -o a.dxf");
    assert!(as_pdf(&place).is_none_or(|seen| seen > 34.0));
    assert_eq!(place.text("a.dxf").matches("\nLWPOLYLINE\n").count(), 4);
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
