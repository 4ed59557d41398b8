//! The strokes and areas of a drawing as arrays.

use std::iter;

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use strokefit::math::{self, Point};
use strokefit::scene::{Area, Mark, Path, PathPoint, PointKind, Scene, Stroke};

use crate::failure::Failure;

/// Points (m × 2, px), which of them are on their path (m), their kinds (m), where each stroke's points begin (n + 1), which
/// paths are closed (n), widths (n, px), half the width at each point (m, px), colours (n × 3), opacities (n), layers (n, from 0)
/// and places among all marks (n, from 0), for n strokes of m points.
pub(crate) type StrokeColumns<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<u8>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
);

/// Points (m × 2, px), which of them are on their ring (m), their kinds (m), where each ring's points begin (k + 1), where each
/// area's rings begin (n + 1), colours (n × 3), opacities (n), layers (n, from 0) and places among all marks (n, from 0), for
/// n areas of k rings of m points.
pub(crate) type AreaColumns<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<u8>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
);

/// Points (m × 2, px), where each mark's points begin (n + 1), widths (n, px), colours (n × 3), opacities (n), which points are
/// on their path (m), which paths are closed (n), which marks are areas (n), the points at which a further ring of an area
/// begins, and the kinds of points (m) if some are those of cubic curves or arcs, for n marks of m points.
pub(crate) type MarkColumns<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<i64>>,
    Option<Bound<'py, PyArray1<u8>>>,
);

/// The marks of `scene`, back to front.
pub(crate) fn marks<'py>(py: Python<'py>, scene: &Scene) -> PyResult<MarkColumns<'py>> {
    let scene = scene.clone().filled();
    let points = || scene.marks().flat_map(Mark::paths).flat_map(Path::points);
    let is_mixed = !points().all(|point| point.kind.is_quadratic());
    let (mut rings, mut end) = (Vec::new(), 0);
    for mark in scene.marks() {
        for (k, path) in mark.paths().iter().enumerate() {
            rings.extend((k > 0).then_some(end));
            end += path.points().len() as i64;
        }
    }
    Ok((
        places(py, points().map(|point| point.at))?,
        starts(py, scene.marks().map(Mark::points)),
        column(py, scene.marks().map(|mark| 2.0 * mark.radius() as f32)),
        rows(py, scene.marks().map(Mark::color))?,
        column(py, scene.marks().map(Mark::opacity)),
        column(py, points().map(PathPoint::is_on)),
        column(
            py,
            scene
                .marks()
                .map(|mark| mark.paths().iter().all(Path::is_closed)),
        ),
        column(py, scene.marks().map(|mark| mark.as_area().is_some())),
        PyArray1::from_vec(py, rings),
        is_mixed.then(|| column(py, points().map(|point| point.kind as u8))),
    ))
}

/// The strokes of `scene`, back to front.
pub(crate) fn strokes<'py>(py: Python<'py>, scene: &Scene) -> PyResult<StrokeColumns<'py>> {
    let scene = without_bands(scene);
    let (strokes, layers, order) = placed(&scene, Mark::as_stroke);
    let strokes = || strokes.iter().copied();
    let points = || strokes().flat_map(|stroke| stroke.path.points());
    Ok((
        places(py, points().map(|point| point.at))?,
        column(py, points().map(PathPoint::is_on)),
        column(py, points().map(|point| point.kind as u8)),
        starts(
            py,
            strokes().map(|stroke: &Stroke| stroke.path.points().len()),
        ),
        column(py, strokes().map(|stroke| stroke.path.is_closed())),
        column(py, strokes().map(|stroke| 2.0 * stroke.radius as f32)),
        column(
            py,
            strokes()
                .flat_map(|stroke| stroke.radii_of_points())
                .map(|r| r as f32),
        ),
        rows(py, strokes().map(|stroke| stroke.color))?,
        column(py, strokes().map(|stroke| stroke.opacity)),
        PyArray1::from_vec(py, layers),
        PyArray1::from_vec(py, order),
    ))
}

/// The areas of `scene`, back to front.
pub(crate) fn areas<'py>(py: Python<'py>, scene: &Scene) -> PyResult<AreaColumns<'py>> {
    let scene = without_bands(scene);
    let (areas, layers, order) = placed(&scene, Mark::as_area);
    let areas = || areas.iter().copied();
    let rings = || areas().flat_map(|area: &Area| &area.rings);
    let points = || rings().flat_map(Path::points);
    Ok((
        places(py, points().map(|point| point.at))?,
        column(py, points().map(PathPoint::is_on)),
        column(py, points().map(|point| point.kind as u8)),
        starts(py, rings().map(|ring| ring.points().len())),
        starts(py, areas().map(|area| area.rings.len())),
        rows(py, areas().map(|area| area.color))?,
        column(py, areas().map(|area| area.opacity)),
        PyArray1::from_vec(py, layers),
        PyArray1::from_vec(py, order),
    ))
}

/// The scene with an area in the place of each stroke with square ends.
fn without_bands(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let marks = scene.stages.iter_mut().flat_map(|stage| &mut stage.marks);
    for mark in marks.filter(|mark| mark.is_butt()) {
        *mark = mark.clone().filled();
    }
    scene
}

/// Marks of one kind, with their layers and their places among all marks, both from 0.
fn placed<'a, M>(
    scene: &'a Scene,
    kind: impl Fn(&'a Mark) -> Option<M>,
) -> (Vec<M>, Vec<i64>, Vec<i64>) {
    let layers = scene.stages.iter().zip(0..);
    let all = layers.flat_map(|(stage, layer)| stage.marks.iter().map(move |mark| (mark, layer)));
    let (mut marks, mut of_layers, mut order) = (Vec::new(), Vec::new(), Vec::new());
    for ((mark, layer), place) in all.zip(0..) {
        if let Some(mark) = kind(mark) {
            marks.push(mark);
            of_layers.push(layer);
            order.push(place);
        }
    }
    (marks, of_layers, order)
}

/// Where each of some runs begins, and where the last one ends.
fn starts(py: Python<'_>, lengths: impl Iterator<Item = usize>) -> Bound<'_, PyArray1<i64>> {
    let ends = lengths.scan(0, |end, length| {
        *end += length as i64;
        Some(*end)
    });
    PyArray1::from_vec(py, iter::once(0).chain(ends).collect())
}

/// The centre line of a stroke, or a ring of an area, as the corners of a polyline that is at most `tolerance` px away from it.
pub(crate) fn flattened<'py>(
    points: &PyReadonlyArray2<'py, f32>,
    kinds: &PyReadonlyArray1<'py, u8>,
    closed: bool,
    tolerance: f32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    if tolerance.is_nan() || tolerance <= 0.0 {
        let message = format!("tolerance={tolerance}: give px above 0, such as 0.1");
        return Err(PyValueError::new_err(message));
    }
    let (py, points, kinds) = (points.py(), points.as_array(), kinds.as_array());
    let points = points.outer_iter().zip(kinds).map(|(at, &kind)| {
        Ok(PathPoint {
            at: math::point([at[0], at[1]]),
            kind: point_kind(kind)?,
        })
    });
    let points = points.collect::<PyResult<_>>()?;
    let path = Path::new(points, closed).map_err(Failure::Library)?;
    places(py, path.flattened(tolerance.into()))
}

/// The kind of a point by its number.
pub(crate) fn point_kind(kind: u8) -> PyResult<PointKind> {
    Ok(PointKind::try_from(kind).map_err(|error| Failure::Library(error.within("kinds")))?)
}

/// Places, n × 2.
fn places(
    py: Python<'_>,
    places: impl IntoIterator<Item = Point>,
) -> PyResult<Bound<'_, PyArray2<f32>>> {
    rows(py, places.into_iter().map(math::xy))
}

fn column<T: Element>(py: Python<'_>, values: impl Iterator<Item = T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_iter(py, values)
}

/// One row of `N` values each.
fn rows<const N: usize>(
    py: Python<'_>,
    rows: impl Iterator<Item = [f32; N]>,
) -> PyResult<Bound<'_, PyArray2<f32>>> {
    let values: Vec<f32> = rows.flatten().collect();
    let count = values.len() / N;
    PyArray1::from_vec(py, values).reshape([count, N])
}
