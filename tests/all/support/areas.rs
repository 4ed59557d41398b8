//! Areas of every kind, each with one kind of trouble, and gradients for them.

use strokefit::math::Point;
use strokefit::render::Paint;
use strokefit::scene::{Axis, PointKind, Shade, ShadeStop};

use super::paths::of_letter;

/// The points of an area.
#[derive(Clone)]
pub(crate) struct Rings {
    pub(crate) name: String,
    pub(crate) points: Vec<[f32; 2]>,
    pub(crate) kinds: Vec<PointKind>,
    /// The index behind the last point of each ring.
    pub(crate) ends: Vec<u32>,
}

/// Gradients for areas of a picture of about 40 px.
pub(crate) fn paints() -> Vec<(&'static str, Paint)> {
    let linear = |scale: f64| Axis::Linear {
        from: Point::new(3.3 / scale, 7.5 / scale),
        to: Point::new(31.0 / scale, 19.0 / scale),
    };
    let radial = Axis::Radial {
        center: Point::new(17.3, 12.8),
        radius: 21.5,
    };
    let stop = |offset, color, opacity| ShadeStop {
        offset,
        color,
        opacity,
    };
    let (red, blue) = ([0.9, 0.2, 0.1], [0.1, 0.3, 0.8]);
    let two = [stop(0.0, red, 1.0), stop(1.0, blue, 1.0)];
    let steps = [
        stop(0.1, red, 0.2),
        stop(0.4, blue, 1.0),
        stop(0.4, red, 0.7),
        stop(0.9, blue, 0.0),
    ];
    let paint = |axis, stops: &[ShadeStop], scale| Paint {
        shade: Shade::new(axis, stops).unwrap(),
        scale,
    };
    vec![
        ("a slanted line", paint(linear(1.0), &two, 1.0)),
        (
            "a line of a picture twice as large",
            paint(linear(0.5), &two, 0.5),
        ),
        ("a line of four stops", paint(linear(1.0), &steps, 1.0)),
        ("a circle", paint(radial, &two, 1.0)),
        ("a glow", paint(radial, &steps[2..], 1.0)),
    ]
}

/// The areas; they lie in and around a picture of `width`×`height` px.
pub(crate) fn areas(width: f32, height: f32) -> Vec<Rings> {
    let area = |name: &str, rings: &[&[(f32, f32, char)]]| {
        let points = rings.concat();
        let ends = rings.iter().scan(0, |end, ring| {
            *end += ring.len() as u32;
            Some(*end)
        });
        Rings {
            name: name.into(),
            ends: ends.collect(),
            points: points
                .iter()
                .map(|&(x, y, _)| [x * width, y * height])
                .collect(),
            kinds: points.iter().map(|&(.., kind)| of_letter(kind)).collect(),
        }
    };
    let a = (0.131, 0.217, 'o');
    let b = (0.823, 0.345, 'o');
    let c = (0.671, 0.871, 'o');
    let d = (0.247, 0.743, 'o');
    let off = |(x, y, _): (f32, f32, char)| (x, y, '~');
    let within =
        |(x, y, kind): (f32, f32, char)| (0.45 + 0.3 * (x - 0.45), 0.53 + 0.3 * (y - 0.53), kind);
    let rect = |[x0, y0]: [f32; 2], [x1, y1]: [f32; 2]| {
        [(x0, y0, 'o'), (x1, y0, 'o'), (x1, y1, 'o'), (x0, y1, 'o')]
    };
    let centre = |x: f32, y: f32| [x / width, y / height];
    let [e, f, g, h] = [a, b, c, d].map(within);
    vec![
        area("a triangle", &[&[a, b, c]]),
        area("a square the other way around", &[&[d, c, b, a]]),
        area("a round shape", &[&[off(a), off(b), off(c), off(d)]]),
        area(
            "a shape of all kinds of pieces",
            &[&[
                a,
                (0.531, 0.031, 'a'),
                b,
                (0.931, 0.561, 'c'),
                (0.547, 0.613, 'c'),
                c,
                (0.447, 0.931, '~'),
                d,
            ]],
        ),
        area(
            "a disc of two arcs with a hole of one",
            &[
                &[a, (0.631, 0.031, 'a'), c, (0.171, 0.831, 'a')],
                &[
                    (0.431, 0.431, 'o'),
                    (0.531, 0.571, 'a'),
                    (0.471, 0.391, 'o'),
                ],
            ],
        ),
        area("a drop", &[&[a, off(b), off(c), off(d)]]),
        area("a hole", &[&[a, b, c, d], &[h, g, f, e]]),
        area(
            "a round hole",
            &[&[a, b, c, d], &[off(h), off(g), off(f), off(e)]],
        ),
        area("a ring in a ring", &[&[a, b, c, d], &[e, f, g, h]]),
        area(
            "an island in a hole",
            &[
                &[a, b, c, d],
                &[h, g, f, e],
                &[(0.42, 0.5, 'o'), (0.48, 0.5, 'o'), (0.45, 0.56, 'o')],
            ],
        ),
        area("rings that cross", &[&[a, b, d], &[b, c, (0.3, 0.1, 'o')]]),
        area("rings that share points", &[&[a, b, d], &[b, c, d]]),
        area(
            "rings that share an edge, one of them a hole",
            &[&[a, b, c, d], &[a, d, h, e]],
        ),
        area("a ring that crosses itself", &[&[a, c, b, d]]),
        area(
            "a ring around the same place twice",
            &[&[
                a,
                b,
                c,
                d,
                (0.2, 0.3, 'o'),
                (0.7, 0.4, 'o'),
                (0.6, 0.8, 'o'),
            ]],
        ),
        area("points that coincide", &[&[a, a, b, b, b, c]]),
        area("one point", &[&[c]]),
        area("two points", &[&[a, c]]),
        area("no area", &[&[a, b, a, b]]),
        area(
            "a sliver",
            &[&[a, b, (0.823, 0.352, 'o'), (0.131, 0.224, 'o')]],
        ),
        area(
            "a dot beside a square",
            &[&[a, b, c, d], &[(0.05, 0.9, 'o')]],
        ),
        area("all of the picture", &[&rect([-0.5, -0.5], [1.5, 1.5])]),
        area("off the picture", &[&rect([-0.5, -0.5], [-0.1, 1.5])]),
        area(
            "beyond the right edge",
            &[&[
                (0.8, 0.2, 'o'),
                (9.0, -3.0, '~'),
                (9.0, 5.0, 'o'),
                (0.7, 0.9, 'o'),
            ]],
        ),
        area(
            "on pixel centres",
            &[&rect(centre(2.5, 2.5), centre(6.5, 5.5))],
        ),
    ]
}
