//! Paths of every kind, each with one kind of trouble.

use strokefit::math::{self, Point};
use strokefit::scene::{Path, PathPoint, PointKind};

/// The kind of a point: `o` on its path, `~` the control point of a quadratic curve, `c` one of a cubic curve, and `a` of an arc.
pub(crate) fn of_letter(letter: char) -> PointKind {
    match letter {
        'o' => PointKind::On,
        '~' => PointKind::Quad,
        'c' => PointKind::Cubic,
        'a' => PointKind::Arc,
        _ => panic!("{letter} is no kind of point"),
    }
}

/// A path of points, px, with the letters of their kinds.
pub(crate) fn of_letters(points: &[(f32, f32, char)], closed: bool) -> Path {
    let point = |&(x, y, kind): &(f32, f32, char)| PathPoint {
        at: math::point([x, y]),
        kind: of_letter(kind),
    };
    Path::new(points.iter().map(point).collect(), closed).unwrap()
}

/// A path of so many pieces of all kinds: each is of the kind that `kind` gives for it, 0..1, and `place` gives the points.
pub(crate) fn mixed(
    pieces: u64,
    closed: bool,
    kind: impl Fn(u64) -> f32,
    place: impl Fn(u64) -> Point,
) -> Path {
    let points = (0..pieces).flat_map(|i| {
        let [start, p, q] = [0, 1, 2].map(|k| place(3 * i + k));
        let between = match (5.0 * kind(i)) as u8 {
            0 => vec![],
            1 => vec![PathPoint::off(p)],
            2 => [p, q].map(PathPoint::off).to_vec(),
            3 => [p, q].map(PathPoint::cubic).to_vec(),
            _ => vec![PathPoint::arc(p)],
        };
        [vec![PathPoint::on(start)], between].concat()
    });
    let end = (!closed).then(|| PathPoint::on(place(3 * pieces)));
    Path::new(points.chain(end).collect(), closed).unwrap()
}

/// The paths with their names; they lie in and around a picture of `width`×`height` px.
pub(crate) fn paths(width: f32, height: f32) -> Vec<(&'static str, Path)> {
    let path = |points: &[(f32, f32, char)], closed: bool| {
        let scaled = points
            .iter()
            .map(|&(x, y, kind)| (x * width, y * height, kind));
        of_letters(&scaled.collect::<Vec<_>>(), closed)
    };
    let (open, closed) = (false, true);
    let a = (0.131, 0.217, 'o');
    let b = (0.823, 0.345, 'o');
    let c = (0.371, 0.861, 'o');
    let d = (0.647, 0.113, 'o');
    let off = |(x, y, _): (f32, f32, char)| (x, y, '~');
    vec![
        ("a dot", path(&[a], open)),
        ("a corner", path(&[a, b, c], open)),
        ("a cusp", path(&[a, b, (0.137, 0.263, 'o')], open)),
        ("there and back", path(&[a, b, a], open)),
        ("points that coincide", path(&[a, b, b, b, c], open)),
        ("nothing but coinciding points", path(&[b, b, b], open)),
        ("ends of no length", path(&[a, a, b, b], open)),
        ("a closed dot", path(&[c], closed)),
        ("a closed line", path(&[a, b], closed)),
        ("a closed triangle", path(&[a, b, c], closed)),
        ("a path that crosses itself", path(&[a, b, d, c], open)),
        (
            "a closed path that crosses itself",
            path(&[a, b, c, d], closed),
        ),
        ("a curve", path(&[a, off(c), b], open)),
        (
            "a curve in round numbers",
            path(&[(0.0, 0.5, 'o'), (0.5, 0.0, '~'), (1.0, 0.5, 'o')], open),
        ),
        (
            "a spline",
            path(&[a, off(b), off(c), off(d), (0.9, 0.9, 'o')], open),
        ),
        (
            "a curve with a cusp",
            path(&[a, off((1.4, 0.9, '~')), a], open),
        ),
        (
            "a curve that is straight",
            path(&[a, off((0.477, 0.281, '~')), b], open),
        ),
        ("a control point on an end", path(&[a, off(a), c], open)),
        (
            "control points that coincide",
            path(&[a, off(c), off(c), b], open),
        ),
        (
            "a cubic curve",
            path(&[a, (0.431, 0.961, 'c'), (0.947, 0.913, 'c'), b], open),
        ),
        (
            "a cubic curve with a loop",
            path(&[a, (1.031, 0.861, 'c'), (-0.147, 0.913, 'c'), b], open),
        ),
        (
            "a closed path of two cubic curves",
            path(
                &[
                    a,
                    (0.431, -0.061, 'c'),
                    (0.847, 0.013, 'c'),
                    b,
                    (0.931, 0.761, 'c'),
                    (0.147, 0.913, 'c'),
                ],
                closed,
            ),
        ),
        ("an arc", path(&[a, (0.331, 0.461, 'a'), b], open)),
        (
            "an arc the other way",
            path(&[b, (0.331, 0.461, 'a'), a], open),
        ),
        ("a flat arc", path(&[a, (0.477, 0.283, 'a'), b], open)),
        (
            "most of a circle",
            path(&[a, (0.561, 0.781, 'a'), (0.231, 0.117, 'o')], open),
        ),
        (
            "an arc of three points in a row",
            path(&[a, (0.477, 0.281, 'a'), b, c], open),
        ),
        (
            "two arcs and a line, closed",
            path(&[a, (0.531, 0.061, 'a'), b, (0.661, 0.661, 'a'), c], closed),
        ),
        (
            "all kinds of pieces",
            path(
                &[
                    a,
                    (0.231, 0.061, 'a'),
                    (0.431, 0.161, 'o'),
                    off(d),
                    b,
                    (0.931, 0.761, 'c'),
                    (0.647, 0.913, 'c'),
                    c,
                    (0.131, 0.517, 'o'),
                ],
                open,
            ),
        ),
        ("a curve and a line", path(&[a, off(c), b, d], open)),
        (
            "a loop of control points",
            path(&[off(a), off(b), off(c), off(d)], closed),
        ),
        (
            "a loop of two control points",
            path(&[off(a), off(b)], closed),
        ),
        (
            "a loop of both kinds",
            path(&[a, off(b), off(c), d], closed),
        ),
        (
            "a loop that begins off it",
            path(&[off(a), b, off(c), off(d)], closed),
        ),
        ("a loop of one point on it", path(&[a, off(b)], closed)),
        (
            "a loop of curves that crosses itself",
            path(&[off(a), off(c), off(d), off(b)], closed),
        ),
        (
            "partly off the picture",
            path(
                &[(-0.4, 0.3, 'o'), (0.5, 0.6, '~'), (1.5, -0.2, 'o'), b],
                open,
            ),
        ),
        (
            "wholly off the picture",
            path(&[(-0.9, 2.3, 'o'), (0.5, 2.6, '~'), (1.5, 3.2, 'o')], open),
        ),
    ]
}
