use super::*;
use crate::math::Point;
use crate::render::{Canvas, Grid};
use crate::rng;
use crate::scene::{Area, Path, Rgb, Stroke};
use crate::seed::Pyramid;
use crate::verify::{self, Size};

const BLACK: Rgb = [0.0; 3];
const WHITE: Rgb = [1.0; 3];

/// An SVG of 96×96 px.
fn svg(content: &str) -> String {
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="96" height="96" fill="none" stroke-linecap="round" stroke-linejoin="round">{content}</svg>"#
    )
}

/// A render of an SVG with exact edges.
fn picture(content: &str, matte: Rgb) -> Image {
    let large = verify::render(&svg(content), Size::Scale(4.0), Some(matte)).unwrap();
    large.halved().halved()
}

fn traced_on(pictures: &[(Image, Rgb)], marks: Marks) -> Vec<Traced> {
    let canvas = |(picture, matte): &(Image, Rgb)| {
        Canvas::flat(Grid::new(picture.width(), picture.height()), *matte)
    };
    let canvases: Vec<Canvas> = pictures.iter().map(canvas).collect();
    let targets: Vec<Pyramid> = pictures.iter().map(|p| Pyramid::new(p.0.clone())).collect();
    let residuals = targets
        .iter()
        .zip(&canvases)
        .map(|(target, canvas)| Residual {
            target,
            canvas,
            weights: None,
        });
    let residuals: Vec<Residual<'_>> = residuals.collect();
    // About that of 34 dB.
    let price = |mark: &Mark| 0.0012 * (40.0 + 10.0 * mark.points() as f32);
    let tracing = Tracing {
        most: usize::MAX,
        doubt: crate::restore::Doubt::default(),
        has_shades: true,
        may_place: true,
        is_of_details: false,
    };
    trace(&residuals, tracing, marks, &price)
}

fn traced(content: &str, marks: Marks) -> Vec<Traced> {
    traced_on(&[(picture(content, WHITE), WHITE)], marks)
}

fn strokes(content: &str) -> Vec<(Stroke, f32)> {
    let picture = verify::render(&svg(content), Size::Scale(1.0), Some(WHITE)).unwrap();
    let found = traced_on(&[(picture, WHITE)], Marks::Strokes);
    let stroke = |t: Traced| (t.mark.as_stroke().unwrap().clone(), t.gain);
    found.into_iter().map(stroke).collect()
}

fn areas(content: &str) -> Vec<Area> {
    let found = traced(content, Marks::Areas);
    let area = |t: Traced| t.mark.as_area().unwrap().clone();
    found.into_iter().map(area).collect()
}

/// The area within a ring, px², negative if it runs counterclockwise.
fn size(ring: &Path) -> f64 {
    let line = ring.flattened(0.01);
    let next = line.iter().cycle().skip(1);
    let pairs = line.iter().zip(next);
    0.5 * pairs.map(|(a, b)| a.x * b.y - a.y * b.x).sum::<f64>()
}

fn is_near(p: Point, [x, y]: [f64; 2], within: f64) -> bool {
    (p.x - x).abs() < within && (p.y - y).abs() < within
}

#[test]
fn a_clock_is_a_ring_and_its_hands() {
    let found = strokes(
        r##"<g stroke="#204080" stroke-width="7"><circle cx="48" cy="48" r="38"/><path d="M48 24v24l16 8"/></g>"##,
    );
    assert_eq!(found.len(), 2);
    for (stroke, gain) in &found {
        assert!((stroke.radius - 3.5).abs() < 0.5, "{}", stroke.radius);
        let wanted = [0x20, 0x40, 0x80].map(|c: u8| f32::from(c) / 255.0);
        let away = stroke.color.iter().zip(wanted).map(|(a, b)| (a - b).abs());
        assert!(away.fold(0.0, f32::max) < 0.02, "{:?}", stroke.color);
        assert!(*gain > 0.0);
    }
    let closed = found.iter().filter(|(stroke, _)| stroke.path.is_closed());
    assert_eq!(closed.count(), 1);
}

#[test]
fn a_line_below_another_is_one_and_is_drawn_first() {
    let found = strokes(
        r##"<path d="M10 30L86 60" stroke="#d02020" stroke-width="5"/><path d="M40 8L52 88" stroke="#2040d0" stroke-width="8"/>"##,
    );
    assert_eq!(found.len(), 2);
    assert!(found[0].0.color[0] > 0.7, "{:?}", found[0].0);
}

#[test]
fn nothing_is_traced_of_noise_or_of_an_empty_page() {
    let noise = |channel: u64| {
        let value = |i: u64| rng::draw(7, channel, i, 0);
        (0..96 * 96).map(value).collect()
    };
    let noise = Image::new(96, 96, [0, 1, 2].map(noise)).unwrap();
    for marks in [Marks::Auto, Marks::Strokes, Marks::Areas] {
        assert!(traced_on(&[(noise.clone(), WHITE)], marks).is_empty());
        let empty = Image::filled(96, 96, WHITE).unwrap();
        assert!(traced_on(&[(empty, WHITE)], marks).is_empty());
        assert!(traced_on(&[], marks).is_empty());
    }
}

#[test]
fn a_square_has_four_exact_corners() {
    let found = areas(r##"<path d="M20.3 30.6H70.8V75.2H20.3Z" fill="#204080"/>"##);
    let [Area { rings, .. }] = &found[..] else {
        panic!("{found:?}");
    };
    let points = rings[0].points();
    assert_eq!((rings.len(), points.len()), (1, 4), "{points:?}");
    for corner in [[20.3, 30.6], [70.8, 30.6], [70.8, 75.2], [20.3, 75.2]] {
        let is_there = points.iter().any(|p| is_near(p.at, corner, 0.05));
        assert!(is_there, "{corner:?} in {points:?}");
    }
}

#[test]
fn a_disc_is_a_circle() {
    let found = areas(r##"<circle cx="48.3" cy="47.1" r="30" fill="#204080"/>"##);
    assert_eq!(found.len(), 1);
    let ring = &found[0].rings[0];
    let Some(crate::scene::Shape::Circle { center, radius }) = ring.shape() else {
        panic!("{ring:?}");
    };
    let away = center.distance(Point::new(48.3, 47.1)) + (radius - 30.0).abs();
    assert!(away < 0.02, "{ring:?}");
}

#[test]
fn a_small_disc_has_no_corners() {
    let found = areas(r##"<circle cx="48.3" cy="47.1" r="4" fill="#204080"/>"##);
    for p in found[0].rings[0].flattened(0.05) {
        let away = p.distance(Point::new(48.3, 47.1)) - 4.0;
        assert!(away.abs() < 0.4, "{away} px off at {p:?}");
    }
}

#[test]
fn a_hole_runs_the_other_way() {
    let found = areas(r##"<path d="M10 10H86V86H10ZM30 30V66H66V30Z" fill="#204080"/>"##);
    assert_eq!(found.len(), 1);
    let mut sizes: Vec<f64> = found[0].rings.iter().map(size).collect();
    sizes.sort_by(f64::total_cmp);
    assert_eq!(sizes.len(), 2);
    assert!(sizes[0] * sizes[1] < 0.0, "{sizes:?}");
}

#[test]
fn what_lies_below_goes_straight_on() {
    // A disc hides the middle of a panel's right side.
    let found = areas(
        r##"<path d="M10 10H60V86H10Z" fill="#204080"/><circle cx="60" cy="48" r="18" fill="#d02020"/>"##,
    );
    assert_eq!(found.len(), 2);
    assert!(found[0].color[2] > found[0].color[0]);
    let ring = &found[0].rings[0];
    assert!(ring.points().len() <= 5, "{ring:?}");
    assert!((size(ring).abs() - 50.0 * 76.0).abs() < 20.0, "{ring:?}");
}

#[test]
fn a_word_is_one_area() {
    let letters = r##"<path d="M10 20H18V60H30V68H10ZM40 20H48V68H40ZM58 20H66V40H78V48H66V68H58Z" fill="#204080"/>"##;
    let found = areas(letters);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].rings.len(), 3);
}

#[test]
fn a_line_beside_a_blob_is_a_stroke() {
    let found = traced(
        r##"<path d="M10 14C40 30 60 0 86 14" stroke="#d02020" stroke-width="4"/><path d="M20 40L80 50L60 86L30 60Z" fill="#204080"/>"##,
        Marks::Auto,
    );
    let strokes = found.iter().filter(|t| t.mark.as_stroke().is_some());
    assert_eq!((strokes.count(), found.len()), (1, 2), "{found:?}");
}

/// The numbers of strokes and areas that are traced.
fn counts(content: &str) -> [usize; 2] {
    let found = traced(content, Marks::Auto);
    let strokes = found.iter().filter(|t| t.mark.as_stroke().is_some());
    let strokes = strokes.count();
    [strokes, found.len() - strokes]
}

#[test]
fn dots_and_the_lines_between_them_are_marks_each() {
    let lines = r##"<path d="M18 20L78 30L40 78Z" stroke="#222" stroke-width="2.4"/>"##;
    let dots = r##"<g fill="#222"><circle cx="18" cy="20" r="8"/><circle cx="78" cy="30" r="8"/><circle cx="40" cy="78" r="8"/></g>"##;
    assert_eq!(counts(&format!("{lines}{dots}")), [3, 3]);
}

#[test]
fn a_line_runs_straight_through_a_blob() {
    let staff = r##"<path d="M6 30H90M6 46H90M6 62H90" stroke="#222" stroke-width="2"/>"##;
    let note = r##"<ellipse cx="48" cy="46" rx="13" ry="9" fill="#222"/>"##;
    assert_eq!(counts(&format!("{staff}{note}")), [3, 1]);
}

#[test]
fn the_head_of_an_arrow_is_an_area() {
    let arrow = r##"<path d="M10 48H66" stroke="#222" stroke-width="3"/><path d="M88 48L64 38V58Z" fill="#222"/>"##;
    assert_eq!(counts(arrow), [1, 1]);
}

#[test]
fn lines_that_meet_at_a_sharp_angle_have_no_blob() {
    let corner = r##"<path d="M20 84L80 14L44 88M80 14L12 50" stroke="#222" stroke-width="7"/>"##;
    assert_eq!(counts(corner)[1], 0);
}

#[test]
fn a_handle_and_what_swells_slowly_stay_with_their_shape() {
    let mug = r##"<path d="M14 20H60V80H14Z" fill="#222"/><path d="M60 32C90 30 90 68 60 66" stroke="#222" stroke-width="4"/>"##;
    assert_eq!(counts(mug), [0, 1]);
    let brush = r##"<path d="M6 48Q48 28 90 48Q48 68 6 48Z" fill="#222"/>"##;
    assert_eq!(counts(brush), [0, 1]);
}

#[test]
fn square_ends_are_no_stroke() {
    let found = traced(
        r##"<path d="M20 20H34V80H20Z" fill="#204080"/>"##,
        Marks::Auto,
    );
    assert!(
        matches!(
            &found[..],
            [Traced {
                mark: Mark::Area(_),
                ..
            }]
        ),
        "{found:?}"
    );
}

#[test]
fn shapes_on_a_transparent_page_are_areas() {
    let shape = r##"<path d="M20.3 30.6H70.8V75.2H20.3Z" fill="#a04080"/>"##;
    let pictures = [[0.0; 3], WHITE].map(|matte| (picture(shape, matte), matte));
    let found = traced_on(&pictures, Marks::Auto);
    let [Traced { mark, .. }] = &found[..] else {
        panic!("{found:?}");
    };
    assert_eq!(mark.as_area().unwrap().rings[0].points().len(), 4);
    let wanted = [0xa0, 0x40, 0x80].map(|c: u8| f32::from(c) / 255.0);
    assert!(
        mark.color()
            .iter()
            .zip(wanted)
            .all(|(a, b)| (a - b).abs() < 0.01)
    );
}

/// A gradient from red to blue: an axis in the words of SVG.
fn gradient(axis: &str) -> String {
    let kind = if axis.contains("x1") {
        "linear"
    } else {
        "radial"
    };
    format!(
        r##"<{kind}Gradient id="g" gradientUnits="userSpaceOnUse" {axis}><stop offset="0" stop-color="#e03020"/><stop offset="1" stop-color="#2040e0"/></{kind}Gradient>"##
    )
}

#[test]
fn smooth_shapes_have_the_gradients_that_they_were_drawn_with() {
    let shapes = [
        r##"x1="20" y1="20" x2="70" y2="60""##,
        r##"cx="40" cy="50" r="42""##,
    ];
    for axis in shapes {
        let gradient = gradient(axis);
        let found = areas(&format!(
            r##"{gradient}<path d="M20 15H70V80H20Z" fill="url(#g)"/><circle cx="45" cy="45" r="9" fill="#f0d020"/>"##
        ));
        let [below, Area { shade: None, .. }] = &found[..] else {
            panic!("{axis}: {found:?}");
        };
        assert_eq!(below.rings.len(), 1, "it goes on below the disc");
        let shade = below.shade.as_ref().unwrap();
        for [x, y] in [[25.0, 20.0], [65.0, 20.0], [30.0, 75.0], [60.0, 70.0]] {
            let seen = picture(
                &format!(r##"{gradient}<path d="M0 0H96V96H0Z" fill="url(#g)"/>"##),
                WHITE,
            );
            let at = y as usize * seen.width() + x as usize;
            let (color, opacity) = shade.at(Point::new(x + 0.5, y + 0.5));
            let apart = (0..3).map(|c| (color[c] - seen.planes()[c][at]).abs());
            assert_eq!(opacity, 1.0);
            assert!(
                apart.fold(0.0, f32::max) < 3.0 / 255.0,
                "{axis} at {x}, {y}: {color:?}"
            );
        }
    }
}

#[test]
fn a_glow_on_a_transparent_page_fades_away() {
    let content = r##"<radialGradient id="g" gradientUnits="userSpaceOnUse" cx="48" cy="48" r="36"><stop offset="0" stop-color="#2040e0"/><stop offset="1" stop-color="#2040e0" stop-opacity="0"/></radialGradient><circle cx="48" cy="48" r="36" fill="url(#g)"/>"##;
    let found = traced_on(
        &[
            (picture(content, BLACK), BLACK),
            (picture(content, WHITE), WHITE),
        ],
        Marks::Areas,
    );
    let [Traced { mark, .. }] = &found[..] else {
        panic!("{found:?}");
    };
    let shade = mark.shade().unwrap();
    for (x, expected) in [(48.0, 1.0), (66.0, 0.5), (81.0, 1.0 / 12.0)] {
        let (_, opacity) = shade.at(Point::new(x, 48.0));
        assert!((opacity - expected).abs() < 0.03, "{opacity} at {x}");
    }
}

#[test]
fn flat_shapes_and_steps_have_no_gradient() {
    let steps: String = (0..9)
        .map(|k| {
            format!(
                r##"<path d="M{} 10h9v70h-9z" fill="#20{:02x}e0"/>"##,
                8 + 9 * k,
                20 * k
            )
        })
        .collect();
    for content in [
        steps.as_str(),
        r##"<circle cx="48" cy="48" r="30" fill="#204080"/>"##,
    ] {
        assert!(
            areas(content).iter().all(|area| area.shade.is_none()),
            "{content}"
        );
    }
}

#[test]
fn a_shape_across_the_border_goes_on_beyond_it() {
    let found = areas(r##"<path d="M-10 40H50V120H-10Z" fill="#204080"/>"##);
    assert_eq!(found.len(), 1);
    let points = found[0].rings[0].points();
    assert_eq!(points.len(), 4, "{points:?}");
    let at = |k: fn(Point) -> f64| points.iter().map(move |p| k(p.at));
    assert!(at(|p| p.x).fold(0.0, f64::min) < 0.0 && at(|p| p.y).fold(0.0, f64::max) > 96.0);
}

#[test]
fn threads_change_nothing() {
    let content = r##"<path d="M10 10H60V86H10Z" fill="#204080"/><circle cx="60" cy="48" r="18" fill="#d02020"/><path d="M10 90H80" stroke="#208020" stroke-width="3"/>"##;
    let traced_by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let found = pool.install(|| traced(content, Marks::Auto));
        found
            .into_iter()
            .map(|t| (t.mark, t.gain.to_bits()))
            .collect::<Vec<_>>()
    };
    assert_eq!(traced_by(1), traced_by(3));
}
