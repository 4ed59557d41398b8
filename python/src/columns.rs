//! The strokes of a drawing as arrays.

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use strokefit::math::Point;
use strokefit::scene::{Mark, Path, PathPoint, Scene};

use crate::failure::Failure;

/// Points (m × 2, px), which of them are on their path (m), where each stroke's points begin (n + 1), which paths are
/// closed (n), widths (n, px), colours (n × 3), opacities (n) and layers (n, from 0), for n strokes of m points.
pub(crate) type Columns<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<i64>>,
);

/// The strokes of `scene`, back to front.
pub(crate) fn of<'py>(py: Python<'py>, scene: &Scene) -> PyResult<Columns<'py>> {
    let points = || scene.strokes().flat_map(|stroke| stroke.path.points());
    let ends = scene.strokes().scan(0, |end, stroke| {
        *end += stroke.path.points().len() as i64;
        Some(*end)
    });
    let starts: Vec<i64> = std::iter::once(0).chain(ends).collect();
    let closed = scene.strokes().map(|stroke| stroke.path.is_closed());
    let widths = scene.strokes().map(|stroke| 2.0 * stroke.radius);
    let opacities = scene.strokes().map(|stroke| stroke.opacity);
    let layers = scene.stages.iter().zip(0..);
    let layers = layers.flat_map(|(stage, layer)| {
        let strokes = stage.marks.iter().filter_map(Mark::as_stroke);
        strokes.map(move |_| layer)
    });
    Ok((
        places(py, points().map(|point| point.at))?,
        column(py, points().map(|point| point.is_on)),
        PyArray1::from_vec(py, starts),
        column(py, closed),
        column(py, widths),
        rows(py, scene.strokes().map(|stroke| stroke.color))?,
        column(py, opacities),
        column(py, layers),
    ))
}

/// The centre line of one stroke as the corners of a polyline that is at most `tolerance` px away from it.
pub(crate) fn flattened<'py>(
    points: &PyReadonlyArray2<'py, f32>,
    on_path: &PyReadonlyArray1<'py, bool>,
    closed: bool,
    tolerance: f32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    if tolerance.is_nan() || tolerance <= 0.0 {
        let message = format!("tolerance={tolerance}: give px above 0, such as 0.1");
        return Err(PyValueError::new_err(message));
    }
    let (points, kinds) = (points.as_array(), on_path.as_array());
    let points = points
        .outer_iter()
        .zip(kinds)
        .map(|(at, &is_on)| PathPoint {
            at: Point::new(at[0], at[1]),
            is_on,
        });
    let path = Path::new(points.collect(), closed).map_err(Failure::Library)?;
    places(on_path.py(), path.flattened(tolerance))
}

/// Places, n × 2.
fn places(
    py: Python<'_>,
    places: impl IntoIterator<Item = Point>,
) -> PyResult<Bound<'_, PyArray2<f32>>> {
    rows(py, places.into_iter().map(|place| [place.x, place.y]))
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
