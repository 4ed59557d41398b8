//! Drawings between SVG and arrays.

use std::ffi::CString;

use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use strokefit::fit::Base;
use strokefit::render;
use strokefit::scene::{Mark, Rgb, Scene, Stage};
use strokefit::svg::{self, Length};

use crate::columns::{self, MarkColumns};
use crate::failure::Failure;
use crate::marks::PackedMarks;
use crate::options;

/// All of a drawing but its marks: its size, background and ground, and the size that its file says.
#[pyclass(frozen, module = "strokefit._native")]
#[derive(Clone)]
pub(crate) struct Page {
    scene: Scene,
    width: Option<Length>,
}

#[pymethods]
impl Page {
    #[new]
    fn new(width: u32, height: u32, background: Option<Rgb>) -> Self {
        Self {
            scene: Scene::empty(width, height, background),
            width: None,
        }
    }

    /// This page on another background, without its ground.
    fn on(&self, background: Option<Rgb>) -> Self {
        let mut page = self.clone();
        page.scene.background = background;
        page.scene.ground.clear();
        page
    }

    /// Width and height, px.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.scene.width, self.scene.height)
    }

    #[getter]
    fn background(&self) -> Option<Rgb> {
        self.scene.background
    }

    /// The gradient and the shadows on the background, or on `behind` where there is none, height × width × 3.
    fn ground<'py>(
        &self,
        py: Python<'py>,
        behind: Rgb,
    ) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        if self.scene.ground.is_empty() {
            return Ok(None);
        }
        let [width, height] = [self.scene.width, self.scene.height].map(|side| side as usize);
        let planes = render::ground(&self.scene, behind);
        let samples = (0..width * height).flat_map(|i| [0, 1, 2].map(|channel| planes[channel][i]));
        let samples = PyArray1::from_vec(py, samples.collect());
        Ok(Some(samples.reshape([height, width, 3])?))
    }
}

/// The page, the marks and the layers of a drawing.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    text: &str,
    name: &str,
) -> PyResult<(Page, MarkColumns<'py>, Bound<'py, PyArray1<i64>>)> {
    let mut scene = svg::read(text).map_err(|error| Failure::Library(error.within(name)))?;
    let columns = columns::marks(py, &scene)?;
    let shaded = scene.areas().filter(|area| area.shade.is_some()).count();
    if shaded > 0 {
        let message = format!(
            "{shaded} of the areas of {name} have a gradient, which marks in arrays do not: they have its mean colour instead"
        );
        let category = py.get_type::<PyUserWarning>();
        PyErr::warn(py, &category, &CString::new(message)?, 2)?;
    }
    let varying = scene.marks().filter(|mark| mark.is_varying()).count();
    if varying > 0 {
        let message = format!(
            "{varying} of the strokes of {name} have a width that varies, which marks in arrays do not: they are areas instead"
        );
        let category = py.get_type::<PyUserWarning>();
        PyErr::warn(py, &category, &CString::new(message)?, 2)?;
    }
    let layers = scene.stages.iter().zip(0..);
    let layers = layers.flat_map(|(stage, layer)| stage.marks.iter().map(move |_| layer));
    let layers = PyArray1::from_iter(py, layers.collect::<Vec<i64>>());
    scene.stages.clear();
    let width = svg::page_width(text);
    Ok((Page { scene, width }, columns, layers))
}

/// The SVG of marks, of which each has a layer.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    page: &Bound<'_, Page>,
    marks: &Bound<'_, PackedMarks>,
    layers: Vec<i64>,
    options: &Bound<'_, PyDict>,
) -> PyResult<String> {
    let options = options::read(options)?.config.file;
    let page = page.get();
    let base = Base {
        document: None,
        scene: Scene::empty(page.scene.width, page.scene.height, None),
        width: page.width,
    };
    let marks: Vec<Mark> = marks.get().marks().collect();
    if marks.len() != layers.len() || !layers.is_sorted() {
        return Err(PyValueError::new_err(
            "layers: give one number for each mark, none smaller than that before it",
        ));
    }
    Ok(py.detach(|| {
        let mut scene = page.scene.clone();
        let stages = marks.into_iter().zip(&layers).collect::<Vec<_>>();
        for of_layer in stages.chunk_by(|(_, a), (_, b)| a == b) {
            let marks = of_layer.iter().map(|(mark, _)| mark.clone());
            scene.stages.push(Stage {
                marks: marks.collect(),
            });
        }
        Base::write(Some(&base), &scene, &options)
    }))
}
