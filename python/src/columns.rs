//! The strokes of a drawing as arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use strokefit::scene::Scene;

/// Points (m × 2, px), where each stroke's points begin (n + 1), widths (n, px), colours (n × 3), opacities (n) and
/// layers (n, from 0), for n strokes of m points.
pub(crate) type Columns<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<i64>>,
);

/// The strokes of `scene`, back to front.
pub(crate) fn of<'py>(py: Python<'py>, scene: &Scene) -> PyResult<Columns<'py>> {
    let mut points = Vec::new();
    let mut starts = vec![0];
    for stroke in scene.strokes() {
        points.extend(stroke.shape.points().iter().flat_map(|p| [p.x, p.y]));
        starts.push((points.len() / 2) as i64);
    }
    let widths = scene.strokes().map(|stroke| 2.0 * stroke.radius);
    let colors: Vec<f32> = scene.strokes().flat_map(|stroke| stroke.color).collect();
    let opacities = scene.strokes().map(|stroke| stroke.opacity);
    let layers = scene.stages.iter().zip(0_i64..);
    let layers = layers.flat_map(|(stage, layer)| stage.strokes.iter().map(move |_| layer));
    Ok((
        rows(py, points, 2)?,
        PyArray1::from_vec(py, starts),
        PyArray1::from_iter(py, widths),
        rows(py, colors, 3)?,
        PyArray1::from_iter(py, opacities),
        PyArray1::from_iter(py, layers),
    ))
}

/// Rows of `columns` values each.
fn rows<'py>(
    py: Python<'py>,
    values: Vec<f32>,
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let count = values.len() / columns;
    PyArray1::from_vec(py, values).reshape([count, columns])
}
