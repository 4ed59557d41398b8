//! `strokefit._native`: what the Python package takes from the library.
//!
//! The package itself, with its types and documentation, is written in Python: `strokefit/`. It hands over pictures
//! as paths, bytes or arrays, and options as a dictionary.

mod aside;
mod columns;
mod failure;
mod job;
mod marks;
mod options;
mod picture;
mod reference;
mod renderer;
mod scene;

use std::ffi::OsString;
use std::panic;
use std::time::Instant;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use strokefit::cli;
use strokefit::fit::{self, Background, Execution, Stop};
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::report;
use strokefit::verify::{self, Size};

use aside::aside;
use columns::{AreaColumns, StrokeColumns};
use failure::Failure;
use job::{BaseText, Job};
use marks::{PackedMarks, PackedMarks64};
use picture::Picture;
use renderer::{Edge, Renderer};
use scene::Page;

/// A drawing as Python takes it: the SVG, the report as JSON, the strokes and the areas.
type Drawn<'py> = (String, String, StrokeColumns<'py>, AreaColumns<'py>);

/// Ends fits from other threads: give one as `cancel`, and call its method `cancel()`.
///
/// A fit that was cancelled returns the drawing as far as it has come; its report says `interrupted`.
#[pyclass(frozen, module = "strokefit")]
#[derive(Default)]
struct CancelToken(fit::CancelToken);

#[pymethods]
impl CancelToken {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Ends all fits that were given this token, now and from now on.
    fn cancel(&self) {
        self.0.cancel();
    }

    /// True if `cancel()` was called.
    #[getter]
    fn cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

/// Draws `picture`, on `base` (text, name, whether its strokes stay) if there is one.
#[pyfunction]
fn draw<'py>(
    py: Python<'py>,
    picture: &Bound<'py, PyAny>,
    base: Option<(String, String, bool)>,
    options: &Bound<'py, PyDict>,
    progress: Option<&Bound<'py, PyAny>>,
    cancel: Option<&Bound<'py, CancelToken>>,
) -> PyResult<Drawn<'py>> {
    let start = Instant::now();
    let job = Job {
        start,
        options: options::read(options)?,
        picture: Picture::of(picture)?,
        base: base.map(|(text, name, kept)| BaseText { text, name, kept }),
        token: cancel.map_or_else(Default::default, |token| token.get().0.clone()),
    };
    let (judged, report) = aside(py, progress, |observer| job.draw(observer))?;
    let fit = &judged.fit;
    if let Some(progress) = progress.filter(|_| fit.stop != Stop::Interrupted) {
        progress.call1((1.0, fit.scene.len(), judged.soft.psnr_db))?;
    }
    let strokes = columns::strokes(py, &fit.scene)?;
    let areas = columns::areas(py, &fit.scene)?;
    Ok((judged.svg, report, strokes, areas))
}

/// The centre line of a stroke, or a ring of an area, as a polyline, n × 2, at most `tolerance` px away from it.
#[pyfunction]
fn flatten<'py>(
    points: PyReadonlyArray2<'py, f32>,
    kinds: PyReadonlyArray1<'py, u8>,
    closed: bool,
    tolerance: f32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    columns::flattened(&points, &kinds, closed, tolerance)
}

/// The render of an SVG, height × width × 3 with a background, else × 4.
#[pyfunction]
fn render<'py>(
    py: Python<'py>,
    svg: String,
    scale: f64,
    background: &str,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let matte = match background.parse().map_err(Failure::Library)? {
        Background::Color(color) => Some(color),
        Background::Auto | Background::None => None,
    };
    let (samples, shape) = aside(py, None, move |_| {
        let image = verify::render(&svg, Size::Scale(scale), matte)?;
        Ok(interleaved(&image, matte.is_none()))
    })?;
    PyArray1::from_vec(py, samples).reshape(shape)
}

/// The samples of each pixel side by side, and their shape.
fn interleaved(image: &Image, alpha: bool) -> (Vec<u8>, [usize; 3]) {
    let (width, height) = (image.width(), image.height());
    let rgb = image.to_rgb8();
    if !alpha {
        return (rgb, [height, width, 3]);
    }
    let level = |pixel| {
        image
            .alpha()
            .map_or(255, |plane| (plane[pixel] * 255.0 + 0.5) as u8)
    };
    let pixels = rgb.as_chunks().0.iter().enumerate();
    let samples = pixels.flat_map(|(i, &[r, g, b])| [r, g, b, level(i)]);
    (samples.collect(), [height, width, 4])
}

/// The fidelity of an SVG to a picture, as JSON.
#[pyfunction]
fn judge(py: Python<'_>, svg: String, picture: &Bound<'_, PyAny>) -> PyResult<String> {
    let picture = Picture::of(picture)?;
    aside(py, None, move |_| {
        let (target, _) = picture.read()?;
        let judged = Execution::default().install(|| verify::fidelity(&svg, &target));
        let quality: Quality = judged??;
        Ok(report::json(&quality)?)
    })
}

/// The command line.
#[pyfunction]
fn main(py: Python<'_>, args: Vec<OsString>) -> u8 {
    /// Exit status of a Rust program after a panic.
    const PANICKED: u8 = 101;
    py.detach(|| panic::catch_unwind(|| cli::main(args)).unwrap_or(PANICKED))
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    verify::silence_panics();
    module.add_class::<CancelToken>()?;
    module.add_class::<Edge>()?;
    module.add_class::<Page>()?;
    module.add_class::<PackedMarks>()?;
    module.add_class::<PackedMarks64>()?;
    module.add_class::<Renderer>()?;
    module.add_function(wrap_pyfunction!(draw, module)?)?;
    module.add_function(wrap_pyfunction!(flatten, module)?)?;
    module.add_function(wrap_pyfunction!(render, module)?)?;
    module.add_function(wrap_pyfunction!(judge, module)?)?;
    module.add_function(wrap_pyfunction!(reference::reference_render, module)?)?;
    module.add_function(wrap_pyfunction!(reference::reference_backward, module)?)?;
    module.add_function(wrap_pyfunction!(reference::reference_worth, module)?)?;
    module.add_function(wrap_pyfunction!(scene::read, module)?)?;
    module.add_function(wrap_pyfunction!(scene::write, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)
}
