//! Strategies for scenes of all kinds, and for scenes whose marks often look alike.

use proptest::prelude::*;

use crate::math::{self, Point, Vec2};
use crate::scene::{
    Arc, Area, Axis, Cap, MAX_STOPS, Mark, Path, PathPoint, PointKind, Scene, Shade, ShadeStop,
    Shape, Stage, Stroke, quantized_anywhere,
};
use crate::svg::{Form, Group, WriteOptions};

fn point() -> impl Strategy<Value = Point> + Clone + 'static {
    let coordinate = prop_oneof![-20.0..120.0_f64, 0.0..0.02_f64, Just(50.0), -1e6..1e6_f64];
    (coordinate.clone(), coordinate).prop_map(|(x, y)| Point::new(x, y))
}

fn shape() -> impl Strategy<Value = Path> {
    prop_oneof![
        point().prop_map(Path::dot),
        (point(), point()).prop_map(|(a, b)| Path::line(a, b)),
        path(point()),
        path(close_point()),
        ring_of_shape(),
    ]
}

/// Rings of shapes, from a speck to more than the page.
fn ring_of_shape() -> impl Strategy<Value = Path> {
    let size = || prop_oneof![1.0..60.0_f64, 0.001..0.1_f64, Just(8.0)];
    (point(), size(), size(), size(), 0..4_u8).prop_map(|(center, x, y, radius, kind)| {
        let away = Vec2::new(x, y);
        let (low, high) = (center - away, center + away);
        let round = radius.min(x.min(y));
        let rect = |radius| Shape::Rect { low, high, radius };
        let shape = match kind {
            0 => Shape::Circle { center, radius },
            1 => Shape::Ellipse {
                center,
                radii: [x, y],
            },
            2 => rect(round),
            _ => rect(0.0),
        };
        shape.path()
    })
}

/// Places among which many coincide, or lie halfway between others, once they are rounded.
fn close_point() -> impl Strategy<Value = Point> + Clone + 'static {
    let coordinate = || prop_oneof![(0..5_u8).prop_map(f64::from), 0.0..4.0_f64];
    (coordinate(), coordinate()).prop_map(|(x, y)| Point::new(x, y))
}

/// Paths of all kinds of points, open and closed.
fn path(point: impl Strategy<Value = Point> + Clone + 'static) -> impl Strategy<Value = Path> {
    prop_oneof![
        2 => quadratic_path(point.clone()),
        1 => (mixed_points(point), any::<bool>()).prop_map(|(mut points, closed)| {
            // An open path ends on the path.
            let last = points.iter().rposition(PathPoint::is_on).unwrap();
            points.truncate(if closed { points.len() } else { last + 1 });
            Path::new(points, closed).unwrap()
        }),
    ]
}

/// On-points, each followed by nothing, or by what makes a curve or an arc to the next one.
fn mixed_points(
    point: impl Strategy<Value = Point> + 'static,
) -> impl Strategy<Value = Vec<PathPoint>> {
    // On few grids the point of an arc is halfway, so that some arcs are half circles.
    let bulge = prop_oneof![
        -3.0..3.0_f64,
        Just(1.0),
        Just(-1.0),
        0.99..1.01_f64,
        -0.01..0.01_f64
    ];
    let piece = (prop::array::uniform3(point), 0..5_u8, bulge);
    prop::collection::vec(piece, 1..7).prop_map(|pieces| {
        let ends = pieces.iter().cycle().skip(1).map(|([end, ..], ..)| *end);
        let points = pieces.iter().zip(ends);
        let points = points.flat_map(|(&([start, p, q], kind, bulge), end)| {
            let between = match kind {
                0 => vec![],
                1 => vec![PathPoint::off(p), PathPoint::off(q)],
                2 => [p, q].map(PathPoint::cubic).to_vec(),
                3 => vec![PathPoint::arc(p)],
                _ => vec![PathPoint::arc(Arc::of_bulge([start, end], bulge).through)],
            };
            [vec![PathPoint::on(start)], between].concat()
        });
        let points: Vec<PathPoint> = points.collect();
        // One point alone is on its path.
        if pieces.len() == 1 && points.len() == 2 {
            return points[..1].to_vec();
        }
        points
    })
}

/// Paths of lines and quadratic curves.
fn quadratic_path(point: impl Strategy<Value = Point>) -> impl Strategy<Value = Path> {
    let points = prop::collection::vec((point, any::<bool>()), 1..9);
    (points, any::<bool>()).prop_map(|(points, closed)| {
        let point = |(at, is_on)| PathPoint {
            at,
            kind: PointKind::on_if(is_on),
        };
        let mut points: Vec<_> = points.into_iter().map(point).collect();
        // An open path starts and ends on the path.
        let last = points.len() - 1;
        if !closed || last == 0 {
            points[0].kind = PointKind::On;
            points[last].kind = PointKind::On;
        }
        Path::new(points, closed).unwrap()
    })
}

pub(super) fn stroke() -> impl Strategy<Value = Stroke> {
    let unit = || {
        prop_oneof![
            0.0..=1.0_f32,
            Just(0.0),
            Just(1.0),
            -0.5..1.5_f32,
            Just(f32::NAN)
        ]
    };
    let radius = prop_oneof![0.0..20.0_f64, Just(0.5), 0.0..0.01_f64];
    let cap = prop_oneof![2 => Just(Cap::Round), 1 => Just(Cap::Butt)];
    let stroke = (shape(), radius, cap, unit(), unit(), unit(), unit()).prop_map(
        |(path, radius, cap, r, g, b, opacity)| Stroke {
            path,
            radius,
            radii: Vec::new(),
            cap,
            color: [r, g, b],
            opacity,
        },
    );
    let radius = prop_oneof![0.0..12.0_f64, Just(0.0), 0.0..0.01_f64];
    let radii = prop::option::weighted(0.3, prop::collection::vec(radius, 1..9));
    (stroke, radii).prop_map(|(stroke, radii)| with_radii(stroke, radii.as_deref()))
}

/// The stroke with these radii at its vertices, over and over; without any if that is no stroke.
fn with_radii(stroke: Stroke, radii: Option<&[f64]>) -> Stroke {
    let vertices = stroke.path.points().iter().filter(|p| p.is_on());
    let radii = radii.unwrap_or_default().iter().cycle();
    let radii = vertices.zip(radii).map(|(_, radius)| *radius).collect();
    let varying = Stroke::varying(stroke.path.clone(), radii, stroke.color, stroke.opacity);
    varying.unwrap_or(stroke)
}

/// Closed paths; few of them are simple, and many enclose nothing once they are rounded.
fn ring() -> impl Strategy<Value = Path> {
    let points = |point: BoxedStrategy<Point>| prop::collection::vec((point, any::<bool>()), 1..9);
    let free = prop_oneof![points(point().boxed()), points(close_point().boxed())];
    let free = free.prop_map(|points| closed(points.into_iter()));
    let mixed = prop_oneof![mixed_points(point()), mixed_points(close_point())];
    let free =
        prop_oneof![2 => free, 1 => mixed.prop_map(|points| Path::new(points, true).unwrap())];
    prop_oneof![1 => free, 2 => round_ring(), 1 => ring_of_shape()]
}

/// A ring around a place, in either sense, from a speck to more than the page.
fn round_ring() -> impl Strategy<Value = Path> {
    let radius = prop_oneof![1.0..60.0_f64, 0.001..0.1_f64];
    let points = prop::collection::vec((0.3..1.0_f64, any::<bool>()), 3..9);
    (point(), radius, any::<bool>(), points).prop_map(|(center, radius, turns_left, points)| {
        let step = std::f64::consts::TAU / points.len() as f64;
        let step = if turns_left { -step } else { step };
        closed(points.iter().enumerate().map(|(i, &(share, is_on))| {
            let (sin, cos) = math::sin_cos(i as f64 * step);
            let away = radius * share;
            (
                Point::new(center.x + away * cos, center.y + away * sin),
                is_on,
            )
        }))
    })
}

/// The closed path of these points; one point alone is on it.
fn closed(points: impl Iterator<Item = (Point, bool)>) -> Path {
    let mut points: Vec<_> = points
        .map(|(at, is_on)| PathPoint {
            at,
            kind: PointKind::on_if(is_on),
        })
        .collect();
    if points.len() == 1 {
        points[0].kind = PointKind::On;
    }
    Path::new(points, true).unwrap()
}

fn area() -> impl Strategy<Value = Area> {
    let unit = || prop_oneof![0.0..=1.0_f32, Just(0.0), Just(1.0), Just(f32::NAN)];
    let rings = prop::collection::vec(ring(), 1..4);
    let shade = prop::option::weighted(0.3, shade());
    let area = (rings, [unit(), unit(), unit()], unit(), shade);
    area.prop_map(|(rings, color, opacity, shade)| Area {
        shade,
        ..Area::plain(rings, color, opacity)
    })
}

/// A stroke or, seldom, an area.
pub(super) fn mark() -> impl Strategy<Value = Mark> {
    prop_oneof![2 => stroke().prop_map(Mark::from), 1 => area().prop_map(Mark::from)]
}

fn shade() -> impl Strategy<Value = Shade> {
    let linear = (point(), point()).prop_map(|(from, to)| Axis::Linear { from, to });
    let radial =
        (point(), 1.0..300.0_f64).prop_map(|(center, radius)| Axis::Radial { center, radius });
    let unit = || prop_oneof![0.0..=1.0_f32, Just(0.0), Just(1.0)];
    let stop = (unit(), [unit(), unit(), unit()], unit());
    let stop = stop.prop_map(|(offset, color, opacity)| ShadeStop {
        offset,
        color,
        opacity,
    });
    let stops = prop::collection::vec(stop, 2..=MAX_STOPS).prop_map(|mut stops| {
        stops.sort_by(|a, b| a.offset.total_cmp(&b.offset));
        stops
    });
    let whole = (prop_oneof![linear, radial], stops);
    whole.prop_filter_map("a short axis", |(axis, stops)| {
        Shade::new(axis, &stops).ok()
    })
}

pub(super) fn scene() -> impl Strategy<Value = Scene> {
    let stage = prop::collection::vec(mark(), 0..8).prop_map(Stage::from_iter);
    let background = prop::option::of([0.0..=1.0_f32, 0.0..=1.0_f32, 0.0..=1.0_f32]);
    (
        1..100_u32,
        1..100_u32,
        background,
        prop::option::of(shade()),
        prop::collection::vec(prop_oneof![shadow(), thing()], 0..4),
        prop::collection::vec(stage, 0..4),
    )
        .prop_map(|(width, height, background, shade, shadows, stages)| {
            let page = shade.map(|shade| Area::page(shade, [width, height]));
            let shadows = shadows.into_iter().flatten();
            Scene {
                ground: page.into_iter().chain(shadows).collect(),
                stages,
                ..Scene::empty(width, height, background)
            }
        })
}

/// A thing below shadows, unless nothing of it is left.
fn thing() -> impl Strategy<Value = Option<Area>> {
    area().prop_map(|area| quantized_anywhere(&area.into(), 2)?.as_area().cloned())
}

/// A shadow, unless nothing of it is left.
fn shadow() -> impl Strategy<Value = Option<Area>> {
    (area(), 0.5..60.0_f32).prop_map(|(area, blur)| {
        let plain = Area::plain(area.rings, area.color, area.opacity);
        plain.blurred(blur).ok()
    })
}

/// A stroke of few styles between few places, so that neighbours often share a style or an end.
fn alike() -> impl Strategy<Value = Stroke> {
    let place =
        || (0..5_u8, 0..5_u8).prop_map(|(x, y)| Point::new(9.5 * f64::from(x), 9.5 * f64::from(y)));
    let look = (0..2_u8, 0..2_u8, 0..3_u8);
    let line = (place(), place()).prop_map(|(a, b)| Path::line(a, b));
    let path = prop_oneof![3 => line, 1 => path(place())];
    let stroke = (path, look).prop_map(|(path, (color, width, opacity))| Stroke {
        path,
        radius: 1.0 + f64::from(width),
        radii: Vec::new(),
        cap: Cap::Round,
        color: [f32::from(color), 0.2, 0.6],
        opacity: if opacity == 0 { 0.5 } else { 1.0 },
    });
    let radii = prop::option::weighted(0.2, Just([0.0, 2.0, 1.0]));
    (stroke, radii).prop_map(|(stroke, radii)| with_radii(stroke, radii.as_ref().map(|r| &r[..])))
}

/// An area of few styles around few places, sometimes with a hole or a second part.
fn area_alike() -> impl Strategy<Value = Area> {
    let place = (0..5_u8, 0..5_u8).prop_map(|(x, y)| [x, y].map(|i| 9.5 * f64::from(i)));
    let ring = (place, 1..4_u8, any::<bool>(), any::<bool>()).prop_map(
        |([x, y], size, is_round, turns_left)| {
            let away = 4.0 * f64::from(size);
            let mut corners = [[-away, -away], [away, -away], [away, away], [-away, away]];
            if turns_left {
                corners.reverse();
            }
            closed(
                corners
                    .into_iter()
                    .map(|[dx, dy]| (Point::new(x + dx, y + dy), !is_round)),
            )
        },
    );
    let style = (0..2_u8, 0..3_u8);
    (prop::collection::vec(ring, 1..4), style).prop_map(|(rings, (color, opacity))| {
        let opacity = if opacity == 0 { 0.5 } else { 1.0 };
        Area::plain(rings, [f32::from(color), 0.2, 0.6], opacity)
    })
}

pub(super) fn scene_of_few_styles() -> impl Strategy<Value = Scene> {
    let mark =
        prop_oneof![3 => alike().prop_map(Mark::from), 1 => area_alike().prop_map(Mark::from)];
    let stage = prop::collection::vec(mark, 0..30).prop_map(Stage::from_iter);
    prop::collection::vec(stage, 0..3).prop_map(|stages| Scene {
        stages,
        ..Scene::empty(40, 40, Some([1.0; 3]))
    })
}

pub(super) fn options() -> impl Strategy<Value = WriteOptions> {
    let form = prop::sample::select(vec![
        Form::Plain,
        Form::Smallest,
        Form::Css,
        Form::Powerstroke,
    ]);
    let group = prop::sample::select(Group::ALL.to_vec());
    let width = prop::option::of(Just("120.5mm".parse().unwrap()));
    (0..=6_u8, form, group, width).prop_map(|(precision, form, group, width)| WriteOptions {
        precision,
        form,
        group,
        width,
        ..WriteOptions::default()
    })
}
