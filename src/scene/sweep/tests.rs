use super::*;
use crate::scene::path::is_inside;

fn on(x: f64, y: f64) -> PathPoint {
    PathPoint::on((x, y).into())
}

fn off(x: f64, y: f64) -> PathPoint {
    PathPoint::off((x, y).into())
}

fn stroke(points: &[PathPoint], is_closed: bool, radii: &[f64]) -> Stroke {
    let path = Path::new(points.to_vec(), is_closed).unwrap();
    Stroke::varying(path, radii.to_vec(), [0.0; 3], 1.0).unwrap()
}

/// How far inside the union of discs a place is, px.
fn depth(discs: &[(Point, f64)], p: Point) -> f64 {
    let depths = discs.iter().map(|(at, radius)| radius - length(p - *at));
    depths.fold(f64::NEG_INFINITY, f64::max)
}

/// Discs at many parameters.
fn union(stroke: &Stroke) -> Vec<(Point, f64)> {
    const STEPS: u32 = 150;
    let spans = spans(&stroke.path, &stroke.radii);
    let discs = spans.iter().flat_map(|(piece, [from, to])| {
        (0..=STEPS).map(move |i| {
            let t = f64::from(i) / f64::from(STEPS);
            (place(piece, t), (1.0 - t) * from + t * to)
        })
    });
    let dot = (stroke.path.ends().0, stroke.radii[0]);
    discs.chain([dot]).collect()
}

/// Cases of strokes and their names.
fn cases() -> Vec<(&'static str, Stroke)> {
    let arc = |x: f64, y: f64| PathPoint::arc((x, y).into());
    let cubic = |x: f64, y: f64| PathPoint::cubic((x, y).into());
    vec![
        (
            "cone",
            stroke(&[on(10.0, 20.0), on(50.0, 30.0)], false, &[2.0, 9.0]),
        ),
        (
            "steep cone",
            stroke(&[on(20.0, 20.0), on(40.0, 30.0)], false, &[2.0, 18.0]),
        ),
        (
            "even line",
            stroke(&[on(10.0, 20.0), on(50.0, 30.0)], false, &[3.0, 3.0]),
        ),
        (
            "tip",
            stroke(&[on(10.0, 20.0), on(50.0, 30.0)], false, &[5.0, 0.0]),
        ),
        (
            "two tips",
            stroke(
                &[on(10.0, 20.0), on(30.0, 25.0), on(50.0, 20.0)],
                false,
                &[0.0, 6.0, 0.05],
            ),
        ),
        (
            "one in the next",
            stroke(&[on(30.0, 30.0), on(33.0, 30.0)], false, &[2.0, 12.0]),
        ),
        (
            "one in the next, the other way",
            stroke(&[on(30.0, 30.0), on(33.0, 30.0)], false, &[12.0, 2.0]),
        ),
        (
            "a disc in the middle",
            stroke(
                &[
                    on(10.0, 30.0),
                    on(30.0, 30.0),
                    on(33.0, 31.0),
                    on(55.0, 33.0),
                ],
                false,
                &[3.0, 3.0, 12.0, 2.0],
            ),
        ),
        ("dot", stroke(&[on(30.0, 30.0)], false, &[7.0])),
        (
            "dot of two",
            stroke(&[on(30.0, 30.0), on(30.0, 30.0)], false, &[7.0, 3.0]),
        ),
        (
            "two in one place",
            stroke(
                &[
                    on(10.0, 30.0),
                    on(30.0, 30.0),
                    on(30.0, 30.0),
                    on(50.0, 35.0),
                ],
                false,
                &[3.0, 3.0, 8.0, 2.0],
            ),
        ),
        (
            "corner",
            stroke(
                &[on(10.0, 50.0), on(30.0, 10.0), on(50.0, 50.0)],
                false,
                &[2.0, 6.0, 3.0],
            ),
        ),
        (
            "sharp corner",
            stroke(
                &[on(10.0, 30.0), on(50.0, 31.0), on(10.0, 33.0)],
                false,
                &[2.0, 6.0, 3.0],
            ),
        ),
        (
            "turned back",
            stroke(
                &[on(10.0, 30.0), on(50.0, 30.0), on(20.0, 30.0)],
                false,
                &[2.0, 4.0, 6.0],
            ),
        ),
        (
            "short corner",
            stroke(
                &[on(10.0, 30.0), on(40.0, 30.0), on(40.0, 32.0)],
                false,
                &[2.0, 6.0, 5.0],
            ),
        ),
        (
            "S",
            stroke(
                &[
                    on(10.0, 20.0),
                    off(30.0, -5.0),
                    off(30.0, 65.0),
                    on(55.0, 40.0),
                ],
                false,
                &[1.0, 7.0],
            ),
        ),
        (
            "spline",
            stroke(
                &[
                    on(10.0, 20.0),
                    off(20.0, 10.0),
                    on(30.0, 20.0),
                    off(40.0, 30.0),
                    off(50.0, 30.0),
                    on(55.0, 15.0),
                ],
                false,
                &[1.0, 5.0, 2.0],
            ),
        ),
        (
            "hairpin",
            stroke(
                &[on(10.0, 25.0), off(70.0, 30.0), on(10.0, 35.0)],
                false,
                &[3.0, 9.0],
            ),
        ),
        (
            "hairpin of an arc",
            stroke(
                &[
                    on(10.0, 25.0),
                    on(40.0, 25.0),
                    arc(41.5, 26.5),
                    on(40.0, 28.0),
                    on(10.0, 28.0),
                ],
                false,
                &[3.0, 6.0, 7.0, 3.0],
            ),
        ),
        (
            "curl",
            stroke(
                &[
                    on(10.0, 30.0),
                    on(30.0, 30.0),
                    arc(32.0, 28.0),
                    on(30.0, 26.0),
                    arc(28.5, 27.5),
                    on(30.0, 29.0),
                ],
                false,
                &[2.0, 5.0, 6.0, 2.0],
            ),
        ),
        (
            "cubic with a cusp",
            stroke(
                &[
                    on(15.0, 45.0),
                    cubic(50.0, 10.0),
                    cubic(15.0, 10.0),
                    on(50.0, 45.0),
                ],
                false,
                &[2.0, 4.0],
            ),
        ),
        (
            "cubic with a loop",
            stroke(
                &[
                    on(15.0, 45.0),
                    cubic(80.0, 5.0),
                    cubic(-15.0, 5.0),
                    on(50.0, 45.0),
                ],
                false,
                &[2.0, 4.0],
            ),
        ),
        (
            "handle at its end",
            stroke(
                &[
                    on(15.0, 45.0),
                    cubic(15.0, 45.0),
                    cubic(20.0, 5.0),
                    on(50.0, 45.0),
                ],
                false,
                &[2.0, 4.0],
            ),
        ),
        (
            "closed",
            stroke(
                &[
                    on(15.0, 15.0),
                    on(45.0, 20.0),
                    off(55.0, 55.0),
                    on(20.0, 45.0),
                ],
                true,
                &[2.0, 5.0, 3.0],
            ),
        ),
        (
            "closed curve",
            stroke(
                &[
                    on(15.0, 30.0),
                    off(15.0, 10.0),
                    off(50.0, 10.0),
                    on(50.0, 30.0),
                    off(50.0, 50.0),
                    off(15.0, 50.0),
                ],
                true,
                &[2.0, 6.0],
            ),
        ),
        (
            "closed and filled",
            stroke(
                &[on(25.0, 25.0), on(35.0, 25.0), on(30.0, 35.0)],
                true,
                &[8.0, 6.0, 9.0],
            ),
        ),
        (
            "circle",
            stroke(
                &[
                    on(15.0, 30.0),
                    arc(30.0, 15.0),
                    on(45.0, 30.0),
                    arc(30.0, 45.0),
                ],
                true,
                &[2.0, 5.0],
            ),
        ),
    ]
}

#[test]
fn a_border_has_the_stroke_on_one_side() {
    for (name, stroke) in cases() {
        let [outline, border] = [stroke.swept(), stroke.border()].map(|rings| {
            let lines = rings.iter().flat_map(|ring| ring.lines(0.005));
            lines.collect::<Vec<_>>()
        });
        let discs = union(&stroke);
        for line in &border {
            let depth = depth(&discs, line.p0.midpoint(line.p1));
            assert!(depth < 0.15, "{name}: {line:?} {depth}");
        }
        for i in 0..3600 {
            let p = Point::new(f64::from(i % 60) + 0.037, f64::from(i / 60) + 0.041);
            if depth(&discs, p).abs() > 0.1 {
                assert_eq!(is_inside(&border, p), is_inside(&outline, p), "{name}: {p}");
            }
        }
    }
}

#[test]
fn an_outline_is_that_of_the_union_of_discs() {
    let mut wrong = Vec::new();
    for (name, stroke) in cases() {
        let discs = union(&stroke);
        let rings = stroke.swept();
        let lines: Vec<kurbo::Line> = rings.iter().flat_map(|ring| ring.lines(0.005)).collect();
        let (mut missing, mut extra) = ((0, 0.0_f64, 0, 0), (0, 0.0_f64, 0, 0));
        for y in 0..180 {
            for x in 0..180 {
                let p = Point::new(0.35 * f64::from(x) + 0.037, 0.35 * f64::from(y) + 0.041);
                let depth = depth(&discs, p);
                match is_inside(&lines, p) {
                    false if depth > 0.1 => missing = (missing.0 + 1, missing.1.max(depth), x, y),
                    true if depth < -0.1 => extra = (extra.0 + 1, extra.1.max(-depth), x, y),
                    _ => {}
                }
            }
        }
        if missing.0 + extra.0 > 0 {
            wrong.push(format!("{name}: missing {missing:?}, extra {extra:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn points_off_the_path_have_the_radius_of_the_curve_beside_them() {
    let arc = PathPoint::arc((5.0, 3.0).into());
    let points = [
        on(0.0, 0.0),
        off(1.0, 3.0),
        off(3.0, 3.0),
        on(4.0, 2.0),
        arc,
        on(6.0, 2.0),
    ];
    let open = stroke(&points, false, &[0.0, 4.0, 2.0]);
    assert_eq!(open.radii_of_points(), [0.0, 1.0, 3.0, 4.0, 3.0, 2.0]);
    let closed = stroke(
        &[off(0.0, 0.0), on(4.0, 0.0), on(4.0, 4.0)],
        true,
        &[1.0, 3.0],
    );
    assert_eq!(closed.radii_of_points(), [2.0, 1.0, 3.0]);
    let even = Stroke {
        radii: Vec::new(),
        ..open
    };
    assert_eq!(even.radii_of_points(), [4.0; 6]);
}
