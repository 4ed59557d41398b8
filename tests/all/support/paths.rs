//! Paths of every kind, each with one kind of trouble.

use strokefit::math;
use strokefit::scene::{Path, PathPoint};

/// The paths with their names; they lie in and around a picture of `width`×`height` px.
pub(crate) fn paths(width: f32, height: f32) -> Vec<(&'static str, Path)> {
    let path = |points: &[(f32, f32, char)], closed: bool| {
        let point = |&(x, y, kind): &(f32, f32, char)| PathPoint {
            at: math::point([x * width, y * height]),
            is_on: kind == 'o',
        };
        Path::new(points.iter().map(point).collect(), closed).unwrap()
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
