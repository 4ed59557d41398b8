//! Strokes get the points that their picture asks for: bent and closed lines are one stroke, straight ones keep two
//! points, and budgets hold.

use crate::support::{of_bytes, of_strokes, rendered, within};
use strokefit::fit::{Background, Base, Budget, Config, Fit, Fitter};
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
        radii: Vec::new(),
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
    rendered(&svg::write(&scene, &WriteOptions::default()))
}

/// The default of a drawing within `budget` on white, of strokes of at most `points` points.
fn config(budget: Budget, points: Option<usize>) -> Config {
    Config {
        points,
        background: Background::Color([1.0; 3]),
        ..within(budget)
    }
}

/// A drawing and its fidelity, dB.
fn fitted(picture: &Image, config: Config) -> (Fit, f64) {
    judged(picture, Fitter::new(config))
}

fn judged(picture: &Image, fitter: Fitter<'_>) -> (Fit, f64) {
    let fit = fitter.fit(picture).unwrap();
    let db = metrics::psnr(picture, &rendered(&fit.svg())).unwrap();
    (fit, db)
}

fn points(scene: &Scene) -> Vec<usize> {
    let points = scene.strokes().map(|s| s.path.points().len());
    points.collect()
}

#[test]
fn bent_lines_get_points() {
    let (fit, db) = fitted(&ring(), config(of_strokes(4), None));
    let (straight, straight_db) = fitted(&ring(), config(of_strokes(4), Some(2)));
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
        ..config(Budget::default(), None)
    };
    let (fit, _) = fitted(&straight, config);
    let most = points(&fit.scene).into_iter().max();
    assert_eq!(most, Some(2), "{:?}", points(&fit.scene));
}

#[test]
fn no_stroke_has_more_points_than_allowed_and_more_draw_better() {
    let zigzag = [
        (10.0, 20.0),
        (80.0, 28.0),
        (14.0, 48.0),
        (84.0, 60.0),
        (12.0, 80.0),
    ];
    let zigzag = picture(&zigzag, false);
    let db = [2, 3, 6].map(|most| {
        let (fit, db) = fitted(&zigzag, config(of_strokes(3), Some(most)));
        let points = points(&fit.scene);
        assert!(points.iter().all(|&n| n <= most), "{most}: {points:?}");
        db
    });
    assert!(db[1] > db[0] && db[2] > db[0], "{db:?}");
}

#[test]
fn a_budget_of_bytes_is_kept_with_points() {
    let ring = ring();
    let db = [None, Some(2)].map(|points| {
        let (fit, db) = fitted(&ring, config(of_bytes(1500), points));
        assert!(fit.svg().len() <= 1500);
        db
    });
    assert!(db[0] > db[1] + 1.0, "{db:?}");
}

#[test]
fn strokes_that_have_points_are_fitted_further() {
    let bent = picture(&[(16.0, 76.0), (40.0, 20.0), (80.0, 56.0)], false);
    let (fit, db) = fitted(&bent, config(of_strokes(1), None));
    let base = Base::read(fit.svg(), &bent, false).unwrap();
    let (more, refined) = judged(&bent, Fitter::new(within(of_strokes(2))).on(base));
    let most = points(&more.scene).into_iter().max().unwrap();
    assert!(most > 2, "{:?}", points(&more.scene));
    assert!(refined >= db, "{refined} < {db}");
}
