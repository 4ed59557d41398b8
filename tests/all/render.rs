//! The fast renderer against the naive one in `f64`: images, gradients, leave-one-out; the same bits
//! at every SIMD level and number of threads.

use kurbo::{Line, ParamCurveNearest};
use proptest::prelude::*;

use crate::support::areas::{Rings, areas, paints};
use crate::support::paths::{mixed, paths};
use crate::support::rendered;
use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::math::{self, Point};
use strokefit::render::reference::{self, Reference};
use strokefit::render::{
    Backdrop, Canvas, Gradients, Grid, Paint, Params, Renderer, Softness, StrokeRef, Strokes,
    Survey,
};
use strokefit::rng::draw;
use strokefit::scene::{Cap, Path, PathPoint, PointKind, Scene, Stage, Stroke};
use strokefit::svg::{self, WriteOptions};

/// ε of the fast renderer's distances, px².
const EPS: f64 = 1e-6;
/// Largest change of a channel by culling behind opaque strokes (1/4096) and by `f32`.
const IMAGE_TOLERANCE: f64 = 4e-4;
/// Largest error of a gradient, relative to the largest gradient of its kind in the scene.
const GRADIENT_TOLERANCE: f64 = 1e-3;

/// Gradients and contributions below this are as good as none.
const FAINT: f64 = 1e-6;

#[derive(Clone)]
struct Case {
    name: String,
    width: usize,
    height: usize,
    strokes: Strokes,
    tolerance: f64,
}

impl Case {
    fn new(name: impl Into<String>, [width, height]: [usize; 2], strokes: Strokes) -> Self {
        Self {
            name: name.into(),
            width,
            height,
            strokes,
            tolerance: GRADIENT_TOLERANCE,
        }
    }
}

/// An edge of this width, the most usual one.
fn smoothstep(width: f32) -> Softness {
    Softness {
        coverage: Coverage::Smoothstep,
        width,
    }
}

/// Random strokes of mixed size and opacity, some off the picture.
fn random(seed: u64, width: usize, height: usize, count: usize) -> Case {
    let u = |i: usize, k: u64| draw(seed, 9, i as u64, k);
    let stroke = |i: usize| -> Params {
        let (x, y) = (
            (u(i, 0) * 1.2 - 0.1) * width as f32,
            (u(i, 1) * 1.2 - 0.1) * height as f32,
        );
        let (angle, length) = (u(i, 2) * 6.3, u(i, 3).powi(2) * 40.0);
        let opacity = if u(i, 8) > 0.8 { 1.0 } else { u(i, 8) };
        let radius = 0.2 + 9.0 * u(i, 4).powi(2);
        [
            x,
            y,
            x + length * angle.cos(),
            y + length * angle.sin(),
            radius,
            u(i, 5),
            u(i, 6),
            u(i, 7),
            opacity,
        ]
    };
    Case::new(
        format!("random {count} on {width}×{height}"),
        [width, height],
        (0..count).map(stroke).collect(),
    )
}

/// One kind of trouble each.
fn degenerate() -> Vec<Case> {
    let case = |name: &str, strokes: &[Params]| Case::new(name, SIZE, strokes.iter().collect());
    let red = |[ax, ay, bx, by]: [f32; 4], radius, opacity| -> Params {
        [ax, ay, bx, by, radius, 0.9, 0.2, 0.1, opacity]
    };
    let diagonal = [5.2, 6.1, 30.4, 25.7];
    let dot = [20.3, 17.1, 20.3, 17.1];
    let long = [-1e5, -1e5, 1e5, 1.001e5];
    vec![
        case("nothing", &[]),
        case("zero length", &[red(dot, 4.2, 0.7)]),
        case("zero radius", &[red(diagonal, 0.0, 0.9)]),
        case("negative radius", &[red(diagonal, -2.0, 0.9)]),
        case(
            "off the picture",
            &[red([-50.0, -9.0, -45.0, 50.0], 3.0, 1.0)],
        ),
        case(
            "across the edge",
            &[red([-12.0, 8.0, 60.0, 30.0], 5.0, 0.6)],
        ),
        case("opacity 0", &[red(diagonal, 3.0, 0.0)]),
        case("opaque and stacked", &[red(diagonal, 6.0, 1.0); 5]),
        case(
            "on pixel centres",
            &[red([10.5, 10.5, 30.5, 10.5], 1.5, 0.8)],
        ),
        case(
            "covers everything",
            &[
                red([20.0, 18.0, 21.0, 18.0], 90.0, 1.0),
                red([9.0, 9.0, 30.0, 20.0], 3.0, 0.5),
            ],
        ),
        case(
            "nearly zero length",
            &[red([20.3, 17.1, 20.3001, 17.1], 4.2, 0.7)],
        ),
        case("one end far away", &[red([7.0, 5.0, 1e6, 1e6], 2.0, 0.5)]),
        case(
            "a thousand on each other",
            &[red([3.0, 4.0, 9.0, 7.0], 2.0, 0.001); 1000],
        ),
        // Its ends are known to 1/128 px only, in f32.
        Case {
            tolerance: 3e-3,
            ..case("very long", &[red(long, 2.0, 0.5)])
        },
    ]
}

/// Between two ordinary strokes in a picture of two tiles by two, what `push` adds to those.
fn between(name: &str, push: impl Fn(&mut Strokes)) -> Case {
    let others = random(7, WIDTH, HEIGHT, 2).strokes;
    let mut strokes = Strokes::new();
    strokes.push(others.get(0));
    push(&mut strokes);
    strokes.push(others.get(1));
    Case::new(name, SIZE, strokes)
}

/// A path of every kind.
fn along_paths() -> Vec<Case> {
    let paths = paths(WIDTH as f32, HEIGHT as f32).into_iter().enumerate();
    let case = |(k, (name, path)): (usize, (&str, Path))| {
        let stroke = Stroke {
            path,
            radius: [1.3, 4.2, 0.4][k % 3],
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.9, 0.2, 0.1],
            opacity: [0.6, 1.0][k % 2],
        };
        between(name, |strokes| strokes.push_stroke(&stroke))
    };
    paths.map(case).collect()
}

/// An area of these rings on top.
fn push_area(
    strokes: &mut Strokes,
    rings: &Rings,
    color: [f32; 3],
    opacity: f32,
    paint: Option<&Paint>,
) {
    let [red, green, blue] = color;
    strokes.push(StrokeRef {
        points: &rings.points,
        kinds: &rings.kinds,
        closed: true,
        rings: &rings.ends,
        form: None,
        paint,
        sweep: None,
        style: &[0.0, red, green, blue, opacity],
    });
}

/// Two tiles by two.
const SIZE: [usize; 2] = [WIDTH, HEIGHT];
const WIDTH: usize = 40;
const HEIGHT: usize = 36;

/// An area of every kind, and one with a gradient of every kind.
fn of_areas() -> Vec<Case> {
    let areas = areas(WIDTH as f32, HEIGHT as f32);
    let paints = paints().into_iter();
    let painted = paints.map(|(name, paint)| (name.to_owned(), areas[0].clone(), Some(paint)));
    let plain = areas
        .iter()
        .map(|rings| (rings.name.clone(), rings.clone(), None));
    let case = |(k, (name, rings, paint)): (usize, (String, Rings, Option<Paint>))| {
        let (color, opacity) = ([0.9, 0.2, 0.1], [0.6, 1.0][k % 2]);
        between(&name, |strokes| {
            push_area(strokes, &rings, color, opacity, paint.as_ref());
        })
    };
    let plain = plain.enumerate().map(case);
    plain.chain(painted.enumerate().map(case)).collect()
}

/// Areas of one to three random rings among random strokes; a third of the rings have all kinds of pieces.
fn random_areas(seed: u64, width: usize, height: usize, count: usize) -> Case {
    let others = random_paths(seed, width, height, count);
    let u = |i: usize, k: u64| draw(seed, 12, i as u64, k);
    let mut strokes = Strokes::new();
    for (i, other) in others.strokes.iter().enumerate() {
        strokes.push(other);
        let mut rings = Rings {
            name: String::new(),
            points: Vec::new(),
            kinds: Vec::new(),
            ends: Vec::new(),
        };
        let [x, y] = other.points[0];
        let place = |k: u64| {
            let at = [0, 1].map(|axis| 50.0 * (u(i, 10 + 3 * k + axis) - 0.5));
            math::point([x + at[0], y + at[1]])
        };
        let kind = |k: u64| u(i, 12 + 3 * k);
        for ring in 0..1 + (3.0 * u(i, 0)) as u64 {
            let (first, count) = (100 * ring, 3 + (5.0 * u(i, 1 + ring)) as u64);
            let path = match u(i, 5 + ring) < 0.33 {
                true => mixed(count, true, |k| kind(first + k), |k| place(first + k)),
                false => {
                    let point = |k| PathPoint {
                        at: place(k),
                        kind: PointKind::on_if(kind(k) >= 0.4),
                    };
                    Path::new((first..first + count).map(point).collect(), true).unwrap()
                }
            };
            rings
                .points
                .extend(path.points().iter().map(|p| math::xy(p.at)));
            rings.kinds.extend(path.points().iter().map(|p| p.kind));
            rings.ends.push(rings.points.len() as u32);
        }
        push_area(&mut strokes, &rings, other.color(), other.opacity(), None);
    }
    Case {
        name: format!("random areas {count} on {width}×{height}"),
        strokes,
        ..others
    }
}

/// One stroke of a thousand points, along a walk that crosses itself and the borders of tiles.
fn long(radius: f32, opacity: f32) -> Case {
    let (width, height) = (75, 70);
    let u = |i: usize, k: u64| draw(3, 4, i as u64, k) - 0.5;
    let walk = (0..1000).scan([35.0, 33.0], |at, i| {
        for (k, v) in at.iter_mut().enumerate() {
            *v = (*v + 7.0 * u(i, k as u64)).clamp(-5.0, 78.0);
        }
        Some(PathPoint {
            at: math::point([at[0], at[1]]),
            kind: PointKind::on_if(i == 0 || i == 999 || u(i, 2) > -0.2),
        })
    });
    let stroke = Stroke {
        path: Path::new(walk.collect(), false).unwrap(),
        radius: radius.into(),
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.2, 0.9, 0.4],
        opacity,
    };
    let name = format!("a thousand points, {radius} px");
    Case::new(name, [width, height], Strokes::from_iter([&stroke]))
}

/// Segments end to end along the border of two tiles, and on both sides of it.
fn along_borders() -> Case {
    let points = [
        [32.0, -3.0],
        [32.0, 9.0],
        [31.0, 17.0],
        [33.0, 31.9],
        [32.0, 32.0],
        [20.0, 32.1],
        [3.0, 31.5],
        [32.0, 33.0],
        [50.0, 32.0],
        [64.0, 63.9],
        [64.1, 40.0],
    ];
    let points = points.map(|[x, y]| PathPoint::on(Point::new(x, y)));
    let stroke = Stroke {
        path: Path::new(points.to_vec(), false).unwrap(),
        radius: 1.1,
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.7, 0.1, 0.4],
        opacity: 0.7,
    };
    let strokes = Strokes::from_iter([&stroke]);
    Case::new("along the borders of tiles", [70, 66], strokes)
}

/// Random strokes of one to nine points, open and closed, straight and curved; a third of them have all kinds of pieces.
fn random_paths(seed: u64, width: usize, height: usize, count: usize) -> Case {
    let capsules = random(seed, width, height, count);
    let u = |i: usize, k: u64| draw(seed, 11, i as u64, k);
    let stroke = |(i, capsule): (usize, StrokeRef<'_>)| {
        let points = 1 + (u(i, 0) * 9.0) as usize;
        let closed = u(i, 1) < 0.3;
        let [x, y] = capsule.points[0];
        let spread = 4.0 + 30.0 * u(i, 2);
        let place = |k: u64| {
            let at = [0, 1].map(|axis| spread * (u(i, 3 + 3 * k + axis) - 0.5));
            math::point([x + at[0], y + at[1]])
        };
        let kind = |k: u64| u(i, 5 + 3 * k);
        let point = |k: usize| {
            let is_end = !closed && (k == 0 || k == points - 1) || points == 1;
            PathPoint {
                at: place(k as u64),
                kind: PointKind::on_if(is_end || kind(k as u64) < 0.5),
            }
        };
        let is_mixed = u(i, 1000) < 0.33;
        let path = match is_mixed {
            true => mixed(points.div_ceil(2) as u64, closed, kind, place),
            false => Path::new((0..points).map(point).collect(), closed).unwrap(),
        };
        Stroke {
            path,
            radius: capsule.radius().into(),
            radii: Vec::new(),
            cap: Cap::Round,
            color: capsule.color(),
            opacity: capsule.opacity(),
        }
    };
    let strokes: Vec<Stroke> = capsules.strokes.iter().enumerate().map(stroke).collect();
    Case {
        name: format!("random paths {count} on {width}×{height}"),
        strokes: strokes.iter().collect(),
        ..capsules
    }
}

fn cases() -> Vec<Case> {
    let mut cases = degenerate();
    // Sizes around the blocks of 4 and the tiles of 32, so that every tail length occurs.
    for (k, (width, height)) in [(1, 1), (3, 70), (33, 31), (64, 64), (97, 35)]
        .into_iter()
        .enumerate()
    {
        cases.push(random(k as u64, width, height, 30));
        cases.push(random_paths(k as u64, width, height, 20));
        cases.push(random_areas(k as u64, width, height, 6));
    }
    cases.push(random(99, 70, 66, 200));
    cases.extend(along_paths());
    cases.extend(of_areas());
    cases.push(along_borders());
    cases.push(long(1.0, 0.5));
    cases.push(long(9.0, 0.6));
    cases
}

fn target(case: &Case) -> Image {
    let level = |x, y, c| draw(5, c as u64, (y * case.width + x) as u64, 0);
    Image::from_fn(case.width, case.height, 3, level).unwrap()
}

const BACKGROUND: [f32; 3] = [0.3, 0.6, 0.8];

fn naive(case: &Case) -> reference::Scene {
    reference::Scene {
        width: case.width,
        height: case.height,
        background: BACKGROUND.map(f64::from),
        strokes: case.strokes.iter().map(reference::Stroke::from).collect(),
    }
}

fn oracle(coverage: Coverage, softness: f32) -> Reference {
    Reference {
        eps: EPS,
        cut: true,
        ..Reference::new(coverage, f64::from(softness))
    }
}

fn renderer(case: &Case, simd: Simd) -> Renderer {
    Renderer::new(Grid::new(case.width, case.height), simd.level().unwrap())
}

fn fast_image(case: &Case, simd: Simd, softness: Softness) -> Image {
    let mut canvas = Canvas::flat(Grid::new(case.width, case.height), [0.0; 3]);
    renderer(case, simd).forward(
        &case.strokes,
        softness,
        Backdrop::Color(BACKGROUND),
        &mut canvas,
    );
    canvas.to_image()
}

fn differentiated(case: &Case, simd: Simd, softness: Softness, loss: Loss) -> Gradients {
    let target = Canvas::from_image(&target(case));
    let mut gradients = Gradients::default();
    renderer(case, simd).backward_with_contributions(
        &case.strokes,
        softness,
        Backdrop::Color(BACKGROUND),
        &Objective::new(loss, &target),
        &mut gradients,
    );
    gradients
}

/// Gradients of two losses, on a colour and on a picture: in one pass, and in one for each.
fn differentiated_on_mattes(case: &Case, simd: Simd, softness: Softness) -> [Gradients; 3] {
    let first = target(case);
    let [red, green, blue] = first.planes().clone();
    let second = Image::new(case.width, case.height, [blue, red, green]).unwrap();
    let dark = |x: usize, y: usize, c: usize| 1.0 - second.planes()[c][y * case.width + x];
    let below = Image::from_fn(case.width, case.height, 3, dark).unwrap();
    let below = Canvas::from_image(&below);
    let targets = [first, second].map(|image| Canvas::from_image(&image));
    let losses = targets
        .each_ref()
        .map(|target| Objective::new(Loss::L2, target));
    let backdrops = [Backdrop::Color(BACKGROUND), Backdrop::Canvas(&below)];
    let [mut both, mut one, mut other] = <[Gradients; 3]>::default();
    let strokes = &case.strokes;
    let mut renderer = renderer(case, simd);
    renderer.backward_on_mattes(strokes, softness, backdrops, losses.each_ref(), &mut both);
    renderer.backward(strokes, softness, backdrops[0], &losses[0], &mut one);
    renderer.backward(strokes, softness, backdrops[1], &losses[1], &mut other);
    [both, one, other]
}

/// Numbers that are not as expected.
#[derive(Default)]
struct Failures(Vec<String>);

impl Failures {
    fn compare(&mut self, what: impl FnOnce() -> String, got: f64, expected: f64, within: f64) {
        if (got - expected).abs() > within || got.is_nan() {
            self.0.push(format!("{}: {got} not {expected}", what()));
        }
    }

    #[track_caller]
    fn assert_none(&self) {
        let Self(failures) = self;
        assert!(
            failures.is_empty(),
            "{} failures:\n{}",
            failures.len(),
            failures.join("\n")
        );
    }
}

/// Compares the fast image with the naive one.
fn compare_images(case: &Case, softness: Softness, failures: &mut Failures) {
    let fast = fast_image(case, Simd::Auto, softness);
    let Softness { coverage, width } = softness;
    let slow = oracle(coverage, width).render(&naive(case));
    for (i, expected) in slow.iter().enumerate() {
        for (plane, &expected) in fast.planes().iter().zip(expected) {
            let what = || format!("{}, {coverage} {width}, pixel {i}", case.name);
            failures.compare(what, plane[i].into(), expected, IMAGE_TOLERANCE);
        }
    }
}

#[test]
fn images_are_the_oracles() {
    let mut failures = Failures::default();
    for case in cases() {
        for coverage in Coverage::EACH {
            for width in [0.6, 1.0, 3.0] {
                compare_images(&case, Softness { coverage, width }, &mut failures);
            }
        }
    }
    failures.assert_none();
}

/// A ring of as many points as a path may have, in waves around the middle.
#[test]
fn an_area_of_65_535_points_is_the_oracles() {
    let place = |k: u32| {
        let angle = k as f32 * (std::f32::consts::TAU / 65_535.0);
        let radius = 13.0 + 3.0 * (9.0 * angle).sin();
        [20.3 + radius * angle.cos(), 17.8 + radius * angle.sin()]
    };
    let rings = Rings {
        name: String::new(),
        points: (0..65_535).map(place).collect(),
        kinds: vec![PointKind::On; 65_535],
        ends: vec![65_535],
    };
    let mut case = Case::new("65,535 points", SIZE, Strokes::new());
    push_area(&mut case.strokes, &rings, [0.9, 0.2, 0.1], 0.8, None);
    let mut failures = Failures::default();
    compare_images(&case, smoothstep(1.0), &mut failures);
    failures.assert_none();
}

/// The kinds of numbers whose gradients are of one unit.
const KINDS: [&str; 5] = ["points", "radius", "colour", "opacity", "other"];
const OTHER: usize = 4;

/// Gradients of one stroke by number: its kind and its value. Those by points that coincide are added up, since it hangs
/// on rounding which of them a pixel counts for.
fn by_number(stroke: StrokeRef<'_>, gradients: &[f64]) -> Vec<(usize, f64)> {
    let (points, style) = gradients.split_at(2 * stroke.points.len());
    let summed = |k: usize| -> f64 {
        let same = stroke.points.iter().zip(points.as_chunks::<2>().0);
        let same = same.filter(|(p, _)| **p == stroke.points[k / 2]);
        same.map(|(_, g)| g[k % 2]).sum()
    };
    let points = (0..points.len()).map(|k| (0, summed(k)));
    let style = style.iter().zip([1, 2, 2, 2, 3]);
    points.chain(style.map(|(&g, kind)| (kind, g))).collect()
}

/// The gradients of all strokes by number, with the names of the numbers.
fn numbered(strokes: &Strokes, gradients: &[f64]) -> Vec<(String, usize, f64)> {
    let of_stroke = |i: usize| {
        let values = by_number(strokes.get(i), &gradients[strokes.range(i)]);
        let named = move |(k, (kind, value))| {
            (
                format!("{} of stroke {i}, number {k}", KINDS[kind]),
                kind,
                value,
            )
        };
        values.into_iter().enumerate().map(named)
    };
    (0..strokes.len()).flat_map(of_stroke).collect()
}

/// The pixels of a picture in `f64`.
fn pixels(image: &Image) -> Vec<[f64; 3]> {
    let [red, green, blue] = image.planes();
    let pixels = red.iter().zip(green).zip(blue);
    pixels
        .map(|((&r, &g), &b)| [r, g, b].map(f64::from))
        .collect()
}

/// `∂L/∂canvas` of the mean loss.
fn slopes(loss: Loss, canvas: &[[f64; 3]], target: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let slopes = loss.gradient(canvas.as_flattened(), target.as_flattened());
    slopes.as_chunks().0.to_vec()
}

/// The largest value of each kind.
fn largest(numbers: &[(String, usize, f64)]) -> [f64; KINDS.len()] {
    let mut largest = [FAINT; KINDS.len()];
    for (_, kind, value) in numbers {
        largest[*kind] = value.abs().max(largest[*kind]);
    }
    largest
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().copied().map(f64::from).collect()
}

/// Compares the fast gradients and contributions with the naive ones.
fn compare_gradients(case: &Case, softness: Softness, loss: Loss, failures: &mut Failures) {
    let fast = differentiated(case, Simd::Auto, softness, loss);
    let (scene, oracle) = (naive(case), oracle(softness.coverage, softness.width));
    let canvas = oracle.render(&scene);
    let target = pixels(&target(case));
    let slow = oracle.gradients(&scene, &slopes(loss, &canvas, &target));
    let mut compare = |what: &str, got: f64, expected: f64, within: f64| {
        let what = || format!("{}, {}: {what}", case.name, softness.coverage);
        failures.compare(what, got, expected, within);
    };
    let flat: Vec<f64> = slow.strokes.iter().flat_map(|s| s.to_params()).collect();
    let expected = numbered(&case.strokes, &flat);
    let got = numbered(&case.strokes, &wide(&fast.strokes));
    let most = largest(&expected);
    for ((name, kind, expected), (.., got)) in expected.iter().zip(&got) {
        compare(name, *got, *expected, case.tolerance * most[*kind]);
    }
    for (&got, expected) in fast.backdrop.iter().zip(slow.background) {
        compare("background", f64::from(got), expected, 1e-4);
    }
    let contributions = oracle.leave_one_out(&scene, &target);
    let most = contributions.iter().fold(FAINT, |m, v| m.max(v.abs()));
    for (&got, expected) in fast.contribution.iter().zip(contributions) {
        compare(
            "contribution",
            f64::from(got),
            expected,
            case.tolerance * most,
        );
    }
}

#[test]
fn gradients_and_contributions_are_the_oracles() {
    let mut failures = Failures::default();
    let losses = [Loss::L2, Loss::L1].into_iter().cycle();
    let edges: Vec<_> = Coverage::EACH.into_iter().zip(losses).collect();
    for case in cases() {
        for &(coverage, loss) in &edges {
            let width = 1.5;
            compare_gradients(&case, Softness { coverage, width }, loss, &mut failures);
        }
    }
    failures.assert_none();
}

#[test]
fn gradients_on_two_mattes_are_the_sums_of_those_on_each() {
    let mut failures = Failures::default();
    for (case, &coverage) in cases().iter().zip(Coverage::EACH.iter().cycle()) {
        let width = 1.5;
        let of_each = differentiated_on_mattes(case, Simd::Auto, Softness { coverage, width });
        let [both, first, second] = of_each.map(|g| {
            let mut numbers = numbered(&case.strokes, &wide(&g.strokes));
            let others = wide(&g.backdrop).into_iter().chain([g.loss]);
            numbers.extend(others.map(|value| ("backdrop or loss".into(), OTHER, value)));
            numbers
        });
        let most = largest(&[&first[..], &second].concat());
        let sums = first.iter().zip(&second).map(|(a, b)| a.2 + b.2);
        for ((name, kind, got), sum) in both.iter().zip(sums) {
            let what = || format!("{}, {coverage}: {name}", case.name);
            failures.compare(what, *got, sum, 1e-5 * most[*kind]);
        }
    }
    failures.assert_none();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Any paths, images and gradients: a few strokes, whose segments lie thick and far.
    #[test]
    fn random_paths_are_drawn_as_the_oracle_draws_them(
        seed in 0_u64..1 << 40, count in 1_usize..5, width in 1_usize..80, height in 1_usize..50,
    ) {
        let case = random_paths(seed, width, height, count);
        let mut failures = Failures::default();
        compare_images(&case, smoothstep(1.5), &mut failures);
        let tanh = Softness { coverage: Coverage::Tanh, width: 1.5 };
        compare_gradients(&case, tanh, Loss::L2, &mut failures);
        prop_assert!(failures.0.is_empty(), "{}", failures.0.join("\n"));
    }

    /// A stroke is no other when its line is cut in two, or when a tile sees a part of it alone.
    #[test]
    fn a_point_on_a_line_changes_no_picture(seed in 0_u64..1 << 40, share in 0.0_f32..1.0) {
        let whole = random(seed, 60, 50, 1);
        let stroke = whole.strokes.get(0);
        let [a, b] = [stroke.points[0], stroke.points[1]];
        let between = [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
        let mut cut = whole.clone();
        cut.strokes = Strokes::new();
        cut.strokes.push(StrokeRef { points: &[a, between, b], kinds: &[PointKind::On; 3], ..stroke });
        let [whole, cut] = [whole, cut].map(|case| fast_image(&case, Simd::Auto, smoothstep(1.5)));
        for (x, y) in whole.planes().iter().flatten().zip(cut.planes().iter().flatten()) {
            prop_assert!((x - y).abs() < 1e-3, "{x} {y}");
        }
    }
}

proptest! {
    #[test]
    fn no_written_stroke_has_a_hole(
        points in prop::collection::vec((-1.5..1.5_f32, -1.5..1.5_f32, any::<bool>()), 3..11),
        [x, y] in [3.0..45.0_f32, 3.0..45.0_f32],
        radius in 2.0..42.0_f32,
        is_round in any::<bool>(),
    ) {
        // A loop around the page's middle, or any points.
        let count = points.len() as f32;
        let points = points.iter().enumerate().map(|(i, &(dx, dy, is_on))| {
            let (sin, cos) = (i as f32 / count * std::f32::consts::TAU).sin_cos();
            let [u, v] = if is_round { [cos + 0.2 * dx, sin + 0.2 * dy] } else { [dx, dy] };
            PathPoint { at: math::point([60.0 + x * u, 60.0 + y * v]), kind: PointKind::on_if(is_on) }
        });
        let path = Path::new(points.collect(), true).unwrap();
        let text = stroke_text(path, radius);
        prop_assert!(deepest_hole(&text) < 1.5, "{text}");
    }

    #[test]
    fn no_written_stroke_of_all_kinds_of_pieces_has_a_hole(
        seed in 0_u64..1 << 40,
        pieces in 2..6_u64,
        closed in any::<bool>(),
        radius in 2.0..42.0_f32,
    ) {
        let u = |axis: u64, k: u64| draw(seed, 13, axis, k);
        let place = |k: u64| math::point([0, 1].map(|axis| 15.0 + 90.0 * u(axis, k)));
        let path = mixed(pieces, closed, |k| u(2, k), place);
        // Three points of an arc may be nearly in line and out of order; a render refuses what is farther away than 2²⁰ px.
        let is_near = |p: &Point| p.x.abs().max(p.y.abs()) < 1e6;
        prop_assume!(path.flattened(1.0).iter().all(is_near));
        let text = stroke_text(path, radius);
        prop_assert!(deepest_hole(&text) < 1.5, "{text}");
    }
}

/// The file of one black stroke on a white page of 120 px.
fn stroke_text(path: Path, radius: f32) -> String {
    let stroke = Stroke {
        path,
        radius: radius.into(),
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.0; 3],
        opacity: 1.0,
    };
    let scene = Scene {
        stages: vec![Stage::from_iter([stroke])],
        ..Scene::empty(120, 120, Some([1.0; 3]))
    };
    svg::write(&scene, &WriteOptions::default())
}

/// The farthest, px, that a pixel within the one stroke of a file is from its edge, of pixels that resvg leaves light.
fn deepest_hole(text: &str) -> f64 {
    let scene = svg::read(text).unwrap();
    let stroke = scene.strokes().next().unwrap();
    let line = stroke.path.flattened(0.02);
    let seen = rendered(text);
    let width = seen.width();
    let light = seen.planes()[0]
        .iter()
        .enumerate()
        .filter(|(_, level)| **level > 0.5);
    let depth = |(pixel, _)| {
        let p = Point::new((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        let away2 = |ends: &[Point]| Line::new(ends[0], ends[1]).nearest(p, 0.0).distance_sq;
        let depths = line
            .windows(2)
            .map(|ends| stroke.radius - away2(ends).sqrt());
        depths.fold(f64::MIN, f64::max)
    };
    light.map(depth).fold(f64::MIN, f64::max)
}

/// Survey of `case`, with at least `least` segments for each line and curve.
fn surveyed(case: &Case, least: usize, softness: Softness) -> Survey {
    let target = Canvas::from_image(&target(case));
    let mut survey = Survey::default();
    renderer(case, Simd::Auto).survey(
        &case.strokes,
        least,
        softness,
        Backdrop::Color(BACKGROUND),
        &Objective::new(Loss::L2, &target),
        &mut survey,
    );
    survey
}

/// The strokes of a case as the polylines of a survey, for the reference.
fn polylines(case: &Case, survey: &Survey) -> reference::Scene {
    let mut scene = naive(case);
    for (i, stroke) in scene.strokes.iter_mut().enumerate() {
        let vertices = survey.firsts[i] as usize..survey.firsts[i + 1] as usize;
        let places = survey.vertices[vertices].iter();
        stroke.points = places.map(|v| v.map(f64::from)).collect();
        stroke.kinds = vec![PointKind::On; stroke.points.len()];
        stroke.closed = false;
    }
    scene
}

/// Values by vertex, added up over those within a thousandth of a px: where a line lies on itself, it hangs on rounding
/// which of them a pixel counts for.
fn by_place(vertices: &[[f32; 2]], values: impl Fn(usize) -> f64) -> Vec<f64> {
    let is_same = |i: usize, k: usize| {
        let apart = [0, 1].map(|axis| (vertices[i][axis] - vertices[k][axis]).abs());
        apart.iter().all(|&v| v < 1e-3)
    };
    let same = |i: usize| (0..vertices.len()).filter(move |&k| is_same(i, k));
    let sum = |i: usize| same(i).map(&values).sum();
    (0..vertices.len()).map(sum).collect()
}

#[test]
fn surveys_are_the_oracles() {
    let softness = smoothstep(1.5);
    let mut failures = Failures::default();
    let cases = along_paths()
        .into_iter()
        .chain([random_paths(2, 64, 64, 8), random(2, 64, 64, 8)]);
    for (case, least) in cases.zip([1, 2, 4].into_iter().cycle()) {
        let survey = surveyed(&case, least, softness);
        let (scene, oracle) = (
            polylines(&case, &survey),
            oracle(softness.coverage, softness.width),
        );
        let canvas = oracle.render(&scene);
        let slow = oracle.gradients(&scene, &slopes(Loss::L2, &canvas, &pixels(&target(&case))));
        let stiffness = oracle.stiffness(&scene);
        for (i, stiffness) in stiffness.iter().enumerate() {
            let range = survey.firsts[i] as usize..survey.firsts[i + 1] as usize;
            let vertices = &survey.vertices[range.clone()];
            let mut compare = |what: &str, got: Vec<f64>, expected: Vec<f64>| {
                let largest = expected.iter().fold(FAINT, |m, v| m.max(v.abs()));
                for (k, (&got, &expected)) in got.iter().zip(&expected).enumerate() {
                    let name = &case.name;
                    let what = || format!("{name}, {least} segments: {what} {k} of stroke {i}");
                    failures.compare(what, got, expected, case.tolerance * largest);
                }
            };
            for axis in 0..2 {
                compare(
                    "slope",
                    by_place(vertices, |k| {
                        f64::from(survey.slopes[range.start + k][axis])
                    }),
                    by_place(vertices, |k| slow.strokes[i].points[k][axis]),
                );
            }
            compare(
                "stiffness",
                by_place(vertices, |k| f64::from(survey.stiffness[range.start + k])),
                by_place(vertices, |k| stiffness[k]),
            );
        }
    }
    failures.assert_none();
}

/// The squared error over the picture does not curve more, after Gauss and Newton, than a vertex is stiff.
#[test]
fn stiffness_is_an_upper_bound() {
    let oracle = oracle(Coverage::Smoothstep, 1.5);
    let step = 1e-4;
    for case in [random_paths(5, 40, 36, 4), along_borders()] {
        let mut straight = naive(&case);
        for stroke in &mut straight.strokes {
            stroke.kinds.fill(PointKind::On);
            stroke.closed = false;
        }
        let stiffness = oracle.stiffness(&straight);
        let (mut most, mut checked) = (0.0_f64, 0);
        for (i, bounds) in stiffness.iter().enumerate() {
            assert_eq!(bounds.len(), straight.strokes[i].points.len());
            for (k, axis) in (0..bounds.len()).flat_map(|k| [(k, 0), (k, 1)]) {
                let [low, high] = [-1.0, 1.0].map(|sign| {
                    let mut moved = straight.clone();
                    moved.strokes[i].points[k][axis] += sign * step;
                    oracle.render(&moved)
                });
                let pairs = low.as_flattened().iter().zip(high.as_flattened());
                let slopes = pairs.map(|(l, h)| (h - l) / (2.0 * step));
                let curvature: f64 = slopes.map(|slope| 2.0 * slope.powi(2)).sum();
                let (bound, name) = (bounds[k], &case.name);
                assert!(
                    curvature <= 1.001 * bound + 1e-6,
                    "{name}: {curvature} {bound}"
                );
                most = most.max(curvature / bound.max(1e-9));
                checked += 1;
            }
        }
        assert!(checked > 8 && most > 0.3, "{}: {checked} {most}", case.name);
    }
}

#[test]
fn every_level_gives_the_same_bits() {
    for case in cases() {
        for coverage in Coverage::EACH {
            let softness = Softness {
                coverage,
                width: 1.25,
            };
            let bits = |simd| {
                let gradients = differentiated(&case, simd, softness, Loss::L2);
                let [on_mattes, ..] = differentiated_on_mattes(&case, simd, softness);
                [gradients, on_mattes].map(|g| {
                    let values = g.strokes.iter().chain(&g.backdrop).chain(&g.contribution);
                    let bits: Vec<u32> = values.map(|v| v.to_bits()).collect();
                    (bits, g.loss.to_bits())
                })
            };
            let narrowest = Simd::available().next_back().unwrap();
            let expected = bits(narrowest);
            for simd in Simd::available().filter(|&simd| simd != narrowest) {
                assert!(bits(simd) == expected, "{simd}, {coverage}, {}", case.name);
            }
        }
    }
}

#[test]
fn every_number_of_threads_gives_the_same_bits() {
    let mut case = random(1, 200, 150, 300);
    case.strokes
        .append(&mut random_paths(1, 200, 150, 100).strokes);
    let softness = smoothstep(1.25);
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let differentiate = || differentiated(&case, Simd::Auto, softness, Loss::L2);
        let gradients = pool.build().unwrap().install(differentiate);
        (
            gradients.strokes,
            gradients.contribution,
            gradients.loss.to_bits(),
        )
    };
    let expected = with_threads(1);
    for threads in [2, 3, 8] {
        assert_eq!(with_threads(threads), expected, "{threads} threads");
    }
}

#[test]
fn strokes_with_numbers_that_are_not_finite_draw_nothing_and_spoil_nothing() {
    let softness = smoothstep(1.0);
    for clean in [random(2, 40, 40, 5), random_paths(2, 40, 40, 5)] {
        let expected = fast_image(&clean, Simd::Auto, softness);
        let gradients = differentiated(&clean, Simd::Auto, softness, Loss::L2);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for i in 0..clean.strokes.len() {
                for k in 0..clean.strokes.range(i).len() {
                    let mut case = clean.clone();
                    case.strokes.push(clean.strokes.get(i));
                    let number = case.strokes.range(clean.strokes.len()).start + k;
                    case.strokes.numbers_mut()[number] = bad;
                    let name = format!("{}: number {k} of stroke {i} is {bad}", clean.name);
                    assert_eq!(fast_image(&case, Simd::Auto, softness), expected, "{name}");
                    let got = differentiated(&case, Simd::Auto, softness, Loss::L2);
                    let others = gradients.strokes.len();
                    assert_eq!(got.strokes[..others], gradients.strokes, "{name}");
                    assert!(got.strokes[others..].iter().all(|&v| v == 0.0), "{name}");
                    assert_eq!(got.contribution.last(), Some(&0.0), "{name}");
                }
            }
        }
    }
}
