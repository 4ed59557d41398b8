//! Shapes and level lines: a circle, an ellipse or a rectangle in a picture comes back as one, and a level line is exactly so.

use std::fs;

use crate::support::{committed, drawn, picture, rendered};
use strokefit::fit::{Background, Config};
use strokefit::math::Point;
use strokefit::scene::{Area, Cap, Mark, Marks, Path, PathPoint, Scene, Shape, Stage, Stroke};
use strokefit::svg::{self, Group, WriteOptions};
use strokefit::verify::{self, Size};

/// The file that is fitted to the picture of these elements, 160×120 px.
fn fitted(elements: &str) -> (Scene, String) {
    fitted_in(elements, Group::Stage)
}

fn fitted_in(elements: &str, group: Group) -> (Scene, String) {
    let drawing = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="160" height="120"><rect width="160" height="120" fill="#fff"/>{elements}</svg>"##
    );
    let picture = verify::render(&drawing, Size::Scale(4.0), None).unwrap();
    let file = WriteOptions {
        group,
        ..WriteOptions::default()
    };
    let config = Config {
        background: Background::Color([1.0; 3]),
        file,
        ..Config::default()
    };
    let text = drawn(&picture.reduced(160, 120), &config).svg();
    (svg::read(&text).unwrap(), text)
}

/// The file that is fitted to a drawing of the plans, and its fidelity, dB.
fn fitted_plan(name: &str) -> (Scene, String, f64) {
    let drawing = fs::read_to_string(committed(&format!("tests/data/plans/{name}.svg")));
    let picture = rendered(&drawing.unwrap());
    let text = drawn(&picture, &Config::default()).svg();
    let db = verify::fidelity(&text, &picture).unwrap().psnr_db;
    (svg::read(&text).unwrap(), text, db)
}

/// The shapes that are elements of their own.
fn shapes(scene: &Scene) -> Vec<Shape> {
    scene.marks().filter_map(Mark::shape).collect()
}

fn circles(scene: &Scene) -> usize {
    let shapes = shapes(scene).into_iter();
    let circles = shapes.filter(|shape| matches!(shape, Shape::Circle { .. }));
    circles.count()
}

fn is_near(found: [f64; 4], expected: [f64; 4]) -> bool {
    let mut pairs = found.iter().zip(expected);
    pairs.all(|(a, b)| (a - b).abs() < 0.15)
}

#[test]
fn shapes_come_back_as_elements() {
    let (scene, text) = fitted(
        r##"<circle cx="32.3" cy="30.6" r="18.2" fill="#c03020"/><ellipse cx="110.4" cy="32.2" rx="30.3" ry="14.6" fill="#2060c0"/>
        <rect x="12.3" y="65.6" width="50" height="38.5" fill="#208040"/><rect x="80.5" y="62.2" width="60.3" height="44" rx="9.5" fill="#404858"/>"##,
    );
    let expected = |shape: &&Shape| match **shape {
        Shape::Circle { center: c, radius } => {
            is_near([c.x, c.y, radius, 0.0], [32.3, 30.6, 18.2, 0.0])
        }
        Shape::Ellipse {
            center: c,
            radii: [x, y],
        } => is_near([c.x, c.y, x, y], [110.4, 32.2, 30.3, 14.6]),
        Shape::Rect {
            low,
            high,
            radius: 0.0,
        } => is_near([low.x, low.y, high.x, high.y], [12.3, 65.6, 62.3, 104.1]),
        Shape::Rect { low, high, radius } => {
            is_near([low.x, low.y, high.x, high.y], [80.5, 62.2, 140.8, 106.2])
                && (radius - 9.5).abs() < 0.5
        }
    };
    assert_eq!(shapes(&scene).iter().filter(expected).count(), 4, "{text}");
}

#[test]
fn dots_are_circles_each_and_holes_stay_holes() {
    let dots_and_hole = r##"<g fill="#c03020"><circle cx="30" cy="30" r="8"/><circle cx="60" cy="30" r="8"/><circle cx="90" cy="30" r="8"/></g>
        <path fill="#2060c0" fill-rule="evenodd" d="M20 60h110v50H20zM50 70h20v20H50z"/>"##;
    let on_a_box = r##"<rect x="20" y="20" width="120" height="80" fill="#d0a880"/><g fill="#662113"><circle cx="50.3" cy="60.4" r="3.6"/><circle cx="110.4" cy="60.4" r="3.6"/></g>"##;
    for (elements, dots, holes) in [(dots_and_hole, 3, 1), (on_a_box, 2, 0)] {
        let (scene, text) = fitted(elements);
        assert_eq!(circles(&scene), dots, "{text}");
        let holed = scene.areas().filter(|area| area.rings.len() == 2);
        assert_eq!(holed.count(), holes, "{text}");
    }
}

#[test]
fn a_circle_of_which_a_part_is_hidden_is_one() {
    let (scene, text) = fitted(
        r##"<circle cx="60" cy="60" r="50" fill="#c03020"/><path d="M95 40L140 50V80L90 85z" fill="#204060"/>"##,
    );
    let is_found = |shape: &Shape| match *shape {
        Shape::Circle { center: c, radius } => {
            is_near([c.x, c.y, radius, 0.0], [60.0, 60.0, 50.0, 0.0])
        }
        _ => false,
    };
    assert!(shapes(&scene).iter().any(is_found), "{text}");
}

#[test]
fn a_shape_with_a_gradient_is_an_element() {
    let (scene, text) = fitted(
        r##"<linearGradient id="a" gradientUnits="userSpaceOnUse" x1="40" y1="20" x2="40" y2="100"><stop stop-color="#f0a020"/><stop offset="1" stop-color="#a02060"/></linearGradient><circle cx="60" cy="60" r="40" fill="url(#a)"/>"##,
    );
    assert_eq!(shapes(&scene).len(), 1, "{text}");
    let circle = text.lines().find(|line| line.starts_with("<circle"));
    assert!(
        circle.is_some_and(|line| line.contains("fill=\"url(#")),
        "{text}"
    );
    assert_eq!(svg::write(&scene, &WriteOptions::default()), text);
}

#[test]
fn a_name_says_which_shape_it_is() {
    let (scene, text) = fitted_in(
        r##"<rect x="10" y="10" width="90" height="100" fill="#2060c0"/><circle cx="50" cy="60" r="20" fill="#f01010"/>"##,
        Group::Object,
    );
    for name in ["id=\"blue-rectangle-1-1\"", "id=\"red-circle-1-2\""] {
        assert!(text.contains(name), "{text}");
    }
    assert_eq!(scene.areas().count(), 2);
}

#[test]
fn a_ring_that_a_pen_draws_is_a_circle_with_a_stroke() {
    let (scene, text) = fitted(
        r##"<circle cx="80" cy="60" r="40" fill="none" stroke="#203040" stroke-width="6"/>"##,
    );
    let strokes: Vec<&Path> = scene.strokes().map(|stroke| &stroke.path).collect();
    let [path] = strokes[..] else {
        panic!("{text}")
    };
    assert!(matches!(path.shape(), Some(Shape::Circle { .. })), "{text}");
    assert!(text.contains("<circle"), "{text}");
}

#[test]
fn lines_that_are_nearly_level_are_so() {
    let (scene, text) = fitted(
        r##"<g fill="none" stroke="#203040" stroke-width="5" stroke-linecap="round"><path d="M20 30.2H140"/><path d="M40.3 50V110"/></g>"##,
    );
    let lines = scene.strokes().filter(|stroke| {
        let (a, b) = stroke.path.ends();
        stroke.path.points().len() == 2 && (a.x == b.x || a.y == b.y)
    });
    assert_eq!(lines.count(), 2, "{text}");
}

#[test]
fn an_icon_of_one_path_stays_one_and_shapes_alone_are_elements() {
    let icon = r##"<path fill="#203040" d="M30 30h40v20h-40zM100 60a10 10 0 1 0 0.1 0zM20 100L60 70L80 100L50 90z"/>"##;
    let (scene, text) = fitted(icon);
    assert_eq!(scene.len(), 1, "{text}");
    let alone = r##"<g fill="#203040"><ellipse cx="40" cy="60" rx="30" ry="18"/><ellipse cx="115" cy="50" rx="30" ry="18"/></g>"##;
    let (scene, text) = fitted(alone);
    assert_eq!((scene.len(), shapes(&scene).len()), (2, 2), "{text}");
}

/// Colours of all strokes, in levels, and their widths.
fn pens(scene: &Scene) -> Vec<([u8; 3], f64)> {
    let pen = |stroke: &Stroke| {
        let levels = stroke.color.map(|c| (255.0 * c).round() as u8);
        (levels, 2.0 * stroke.radius)
    };
    scene.strokes().map(pen).collect()
}

#[test]
fn a_plan_of_dots_and_lines_is_circles_and_lines() {
    let (scene, text) = fitted(
        r##"<path d="M20 25L140 40L70 100Z" fill="none" stroke="#1f77b4" stroke-width="2"/>
        <g fill="#1f77b4"><circle cx="20" cy="25" r="8"/><circle cx="140" cy="40" r="8"/><circle cx="70" cy="100" r="8"/></g>"##,
    );
    let circles = shapes(&scene);
    let dots = circles.iter().filter(|shape| match **shape {
        Shape::Circle { radius, .. } => (radius - 8.0).abs() < 0.2,
        _ => false,
    });
    assert_eq!(dots.count(), 3, "{text}");
    assert_eq!(pens(&scene).len(), 3, "{text}");
}

/// Plans whose lines, dots and arrows are one connected shape, or whose lines end at others.
#[test]
fn plans_come_back_as_their_things() {
    // The most strokes and areas, the fewest circles, and dB.
    let plans = [
        ("network", [12, 14, 9], 44.0),
        ("circuit", [18, 3, 3], 44.5),
        ("score", [38, 2, 0], 44.0),
        ("grid", [24, 0, 0], 43.5),
        ("flow", [8, 5, 0], 44.5),
        ("roads", [5, 4, 3], 49.0),
        ("markers", [10, 16, 13], 41.5),
        // Each piece of a grid line between two bars is a stroke.
        ("bars", [16, 4, 0], 45.5),
    ];
    for (name, [strokes, areas, least], least_db) in plans {
        let (scene, text, db) = fitted_plan(name);
        let filled = scene.areas().count();
        let is_few = scene.len() - filled <= strokes && filled <= areas;
        assert!(is_few && circles(&scene) >= least, "{name}: {text}");
        assert!(db > least_db, "{name}: {db}");
    }
}

/// Of shapes that overlap, the one whose outline is whole lies on top, and the other goes on beneath it.
#[test]
fn shapes_that_overlap_are_whole() {
    let discs = r##"<circle cx="60" cy="60" r="40" fill="#f00"/><circle cx="100" cy="60" r="40" fill="#00f"/>"##;
    let cards = r##"<rect x="20" y="20" width="70" height="60" fill="#f80"/><rect x="50" y="40" width="80" height="60" fill="#08f"/>"##;
    let row = r##"<circle cx="40" cy="60" r="30" fill="#f00"/><circle cx="80" cy="60" r="30" fill="#00f"/><circle cx="120" cy="60" r="30" fill="#0a0"/>"##;
    for drawing in [discs, cards, row] {
        let (scene, text) = fitted(drawing);
        let [whole, count] = [shapes(&scene).len(), drawing.matches("fill").count()];
        assert_eq!([whole, scene.len()], [count; 2], "{text}");
    }
}

/// What is partly hidden goes on beneath what hides it, so that nothing of the page is seen between both.
#[test]
fn a_wall_goes_on_beneath_its_roof() {
    let house = r##"<path d="M30.4 50.2H110.7V112.3H30.4Z" fill="#e8b04a"/><path d="M14.2 58.6L70.3 16.4L126.9 58.6Z" fill="#a03020"/><circle cx="104.3" cy="96.8" r="17.4" fill="#3a7d44"/>"##;
    let (scene, text) = fitted(house);
    assert_eq!(scene.areas().count(), 3, "{text}");
    assert_eq!(circles(&scene), 1, "{text}");
    let wall = scene.areas().find(|area| area.color[1] > 0.6).unwrap();
    let [top, bottom] = extents(wall, |p| p.y);
    let [left, right] = extents(wall, |p| p.x);
    assert!(
        (left - 30.4).abs() < 0.1 && (bottom - 112.3).abs() < 0.1,
        "{text}"
    );
    // Both sides are hidden above, the right one below, too.
    assert!((0.5..25.0).contains(&(58.6 - top)), "{top} {text}");
    assert!((right - 110.7).abs() < 0.1, "{right} {text}");
}

/// The least and the largest coordinate of the points of an area.
fn extents(area: &Area, along: impl Fn(Point) -> f64) -> [f64; 2] {
    let points = area.rings.iter().flat_map(|ring| ring.points());
    let places: Vec<f64> = points.map(|point| along(point.at)).collect();
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    [least, places.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

/// Where two edges coincide, a renderer lets a quarter of what is below the upper one through. That is no thing of its own.
#[test]
fn a_fringe_between_edges_that_coincide_is_nothing() {
    let bin = r##"<svg xmlns="http://www.w3.org/2000/svg" width="160" height="130"><path d="M40.25 30H120.25V120H40.25Z" fill="#3a3a8a"/><path d="M40.25 30H120.25V90H40.25Z" fill="#d1d3d3"/></svg>"##;
    let picture = verify::render(bin, Size::Scale(1.0), None).unwrap();
    let text = drawn(&picture, &Config::default()).svg();
    let scene = svg::read(&text).unwrap();
    let marks = [scene.areas().count(), scene.len()];
    assert_eq!(marks, [2, 2], "{text}");
}

/// Lines with square ends and mitred corners, as charts and technical drawings have them, are strokes with those.
#[test]
fn square_ends_and_mitred_corners_come_back() {
    // The artist's elements, of those the ones that are bands, and dB.
    for (name, most, [least, bands], least_db) in [
        ("chevrons", 5, [5, 5], 55.0),
        // Lines of one path are elements of their own.
        ("menu", 7, [7, 7], 60.0),
        ("frame", 6, [6, 4], 52.0),
        // The dashes are elements of their own.
        ("chart", 27, [24, 20], 46.0),
    ] {
        let (scene, text, db) = fitted_plan(name);
        assert!((least..=most).contains(&scene.len()), "{name}: {text}");
        let found = scene.marks().filter(|mark| mark.is_butt()).count();
        assert!(found >= bands, "{name}: {text}");
        assert!(db > least_db, "{name}: {db}");
    }
}

/// The line, the corners and the width of a frame are those that were drawn, and a line with round ends keeps them.
#[test]
fn a_frame_is_a_line_with_corners_and_round_ends_stay_round() {
    let (scene, text) = fitted(
        r##"<path d="M20 20H90V70H20Z" fill="none" stroke="#204080" stroke-width="6"/><path d="M20 95H140" stroke="#c03020" stroke-width="9" stroke-linecap="round"/>"##,
    );
    let bands = scene.strokes().filter(|stroke| stroke.cap == Cap::Butt);
    let bands: Vec<&Stroke> = bands.collect();
    let [frame] = &bands[..] else {
        panic!("{text}")
    };
    assert!(
        frame.path.is_closed() && (frame.radius - 3.0).abs() < 0.05,
        "{text}"
    );
    let corners = [[20.0, 20.0], [90.0, 20.0], [90.0, 70.0], [20.0, 70.0]];
    for [x, y] in corners {
        let is_here = |p: &PathPoint| (p.at.x - x).abs() < 0.1 && (p.at.y - y).abs() < 0.1;
        assert!(frame.path.points().iter().any(is_here), "{text}");
    }
    let round = scene.strokes().filter(|stroke| stroke.cap == Cap::Round);
    assert_eq!(round.count(), 1, "{text}");
    let only_areas = Config {
        marks: Marks::Areas,
        background: Background::Color([1.0; 3]),
        ..Config::default()
    };
    let areas = drawn(&rendered(&text), &only_areas).svg();
    assert!(
        !areas.contains("stroke=") && areas.contains("fill="),
        "{areas}"
    );
}

/// Staves and stems lie between rows and columns of pixels, where they look grey and 2 px wide.
#[test]
fn lines_between_rows_have_the_colour_of_their_pen() {
    let text = drawn(&picture("music.png"), &Config::default()).svg();
    let scene = svg::read(&text).unwrap();
    assert!(scene.len() <= 96, "{text}");
    let pens = pens(&scene);
    let dark = pens
        .iter()
        .filter(|(color, _)| color.iter().all(|&v| v < 32));
    assert!(20 * dark.count() >= 19 * pens.len(), "{text}");
    let hairs = pens.iter().filter(|(_, width)| (0.9..1.4).contains(width));
    assert!(2 * hairs.count() >= pens.len(), "{text}");
}

#[test]
fn thin_lines_have_their_colours_and_widths() {
    let (scene, text) = fitted(
        r##"<g fill="none" stroke-width="2"><path d="M10 20H150" stroke="#333"/><path d="M20 40V110H150" stroke="#b03060"/></g>"##,
    );
    let pens = pens(&scene);
    assert_eq!(pens.len(), 2, "{text}");
    for (color, width) in pens {
        let is_meant = |meant: &[u8; 3]| (0..3).all(|k| color[k].abs_diff(meant[k]) <= 2);
        assert!(
            [[0x33; 3], [0xb0, 0x30, 0x60]].iter().any(is_meant),
            "{text}"
        );
        assert!((width - 2.0).abs() < 0.1, "{text}");
    }
}

#[test]
fn lines_that_swell_come_back_one_by_one_through_their_crossing() {
    let line = |[from, control, middle]: [(f64, f64); 3], end: [(f64, f64); 2]| {
        let points = vec![
            PathPoint::on(from.into()),
            PathPoint::off(control.into()),
            PathPoint::on(middle.into()),
            PathPoint::off(end[0].into()),
            PathPoint::on(end[1].into()),
        ];
        let path = Path::new(points, false).unwrap();
        Stroke::varying(path, vec![0.6, 3.5, 0.6], [0.0; 3], 1.0).unwrap()
    };
    let lines = [
        line(
            [(10.0, 20.0), (40.0, 30.0), (75.0, 55.0)],
            [(110.0, 80.0), (150.0, 85.0)],
        ),
        line(
            [(12.0, 100.0), (45.0, 95.0), (85.0, 62.0)],
            [(125.0, 29.0), (148.0, 15.0)],
        ),
    ];
    let scene = Scene {
        stages: vec![Stage::from_iter(lines)],
        ..Scene::empty(160, 120, Some([1.0; 3]))
    };
    let drawing = svg::write(&scene, &WriteOptions::default());
    let picture = verify::render(&drawing, Size::Scale(4.0), None).unwrap();
    let text = drawn(&picture.reduced(160, 120), &Config::default()).svg();
    let found = svg::read(&text).unwrap();
    let varying: Vec<&Stroke> = found.strokes().filter(|s| s.is_varying()).collect();
    assert_eq!((varying.len(), found.len()), (2, 2), "{text}");
    for stroke in varying {
        let [first, last] = [stroke.radii[0], stroke.radii[stroke.radii.len() - 1]];
        assert!(first < 1.2 && last < 1.2, "{stroke:?}");
        assert!((stroke.radius - 3.5).abs() < 0.3, "{stroke:?}");
    }
}
