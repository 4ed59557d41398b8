//! Strokes get the points that their picture asks for: bent and closed lines are one stroke, straight ones keep two
//! points, and budgets hold.

use crate::support::{of_bytes, of_strokes, rendered};
use strokefit::fit::{Background, Config, Fit, Fitter};
use strokefit::image::Image;
use strokefit::math::Point;
use strokefit::metrics;
use strokefit::scene::{Cap, Path, PathPoint, Scene, Stage, Stroke};
use strokefit::svg::{self, WriteOptions};

const SIDE: u32 = 96;

/// The picture of a stroke of 7 px in dark blue on white, through these points.
fn picture(points: &[(f64, f64)], closed: bool) -> Image {
    let points = points.iter().map(|&(x, y)| PathPoint::on(Point::new(x, y)));
    drawn(Stroke {
        path: Path::new(points.collect(), closed).unwrap(),
        radius: 3.5,
        cap: Cap::Round,
        color: [0.1, 0.2, 0.5],
        opacity: 1.0,
    })
}

/// The picture of an ellipse.
fn ring() -> Image {
    let turn = |k: usize| (k as f64 * std::f64::consts::TAU / 24.0).sin_cos();
    let points = (0..24).map(turn);
    let points: Vec<_> = points
        .map(|(y, x)| (48.0 + 30.0 * x, 48.0 + 24.0 * y))
        .collect();
    picture(&points, true)
}

fn drawn(stroke: Stroke) -> Image {
    let scene = Scene {
        stages: vec![Stage::from_iter([stroke])],
        ..Scene::empty(SIDE, SIDE, Some([1.0; 3]))
    };
    let text = svg::write(&scene, &WriteOptions::default());
    rendered(&text)
}

/// A drawing of `strokes` strokes, each of at most `points` points, and its fidelity, dB.
fn fitted(picture: &Image, strokes: usize, points: Option<usize>) -> (Fit, f64) {
    let config = Config {
        budget: of_strokes(strokes),
        points,
        background: Background::Color([1.0; 3]),
        ..Config::default()
    };
    let fit = Fitter::new(config).fit(picture).unwrap();
    let file = rendered(&fit.svg());
    let db = metrics::psnr(picture, &file).unwrap();
    (fit, db)
}

fn points(scene: &Scene) -> Vec<usize> {
    let points = scene.strokes().map(|s| s.path.points().len());
    points.collect()
}

#[test]
fn bent_lines_get_points() {
    let (fit, db) = fitted(&ring(), 4, None);
    let (straight, straight_db) = fitted(&ring(), 4, Some(2));
    assert_eq!(points(&straight.scene), [2; 4]);
    let points = points(&fit.scene);
    assert!(points.iter().any(|&n| n > 2), "{points:?}");
    assert!(db > straight_db + 3.0, "{db} {straight_db}");
}

#[test]
fn a_straight_line_keeps_two_points() {
    let straight = picture(&[(16.0, 70.0), (80.0, 30.0)], false);
    // At this quality a point has to remove a third of a grey level of a pixel.
    let config = Config {
        quality: Some(20.0),
        background: Background::Color([1.0; 3]),
        ..Config::default()
    };
    let fit = Fitter::new(config).fit(&straight).unwrap();
    let most = points(&fit.scene).into_iter().max();
    assert_eq!(most, Some(2), "{:?}", points(&fit.scene));
}

#[test]
fn no_stroke_has_more_points_than_allowed() {
    let zigzag = [
        (10.0, 20.0),
        (80.0, 28.0),
        (14.0, 48.0),
        (84.0, 60.0),
        (12.0, 80.0),
    ];
    let zigzag = picture(&zigzag, false);
    for most in [2, 3, 5] {
        let (fit, _) = fitted(&zigzag, 3, Some(most));
        let points = points(&fit.scene);
        assert!(points.iter().all(|&n| n <= most), "{most}: {points:?}");
    }
}

#[test]
fn more_points_draw_better() {
    let zigzag = [
        (10.0, 20.0),
        (80.0, 28.0),
        (14.0, 48.0),
        (84.0, 60.0),
        (12.0, 80.0),
    ];
    let zigzag = picture(&zigzag, false);
    let db: Vec<f64> = [2, 3, 6].map(|n| fitted(&zigzag, 3, Some(n)).1).into();
    assert!(db[1] > db[0] && db[2] > db[0], "{db:?}");
}

#[test]
fn a_budget_of_bytes_is_kept_with_points() {
    let ring = ring();
    let budget = of_bytes(1500);
    let config = |points| Config {
        budget,
        points,
        background: Background::Color([1.0; 3]),
        ..Config::default()
    };
    let db = [None, Some(2)].map(|points| {
        let fit = Fitter::new(config(points)).fit(&ring).unwrap();
        assert!(fit.svg().len() <= 1500);
        let file = rendered(&fit.svg());
        metrics::psnr(&ring, &file).unwrap()
    });
    assert!(db[0] > db[1] + 1.0, "{db:?}");
}

#[test]
fn strokes_that_have_points_are_fitted_further() {
    let bent = picture(&[(16.0, 76.0), (40.0, 20.0), (80.0, 56.0)], false);
    let (fit, db) = fitted(&bent, 1, None);
    let base = strokefit::fit::Base::read(fit.svg(), &bent, false).unwrap();
    let config = Config {
        budget: of_strokes(2),
        ..Config::default()
    };
    let more = Fitter::new(config).on(base).fit(&bent).unwrap();
    let most = points(&more.scene).into_iter().max().unwrap();
    assert!(most > 2, "{:?}", points(&more.scene));
    let file = rendered(&more.svg());
    let refined = metrics::psnr(&bent, &file).unwrap();
    assert!(refined >= db, "{refined} < {db}");
}
