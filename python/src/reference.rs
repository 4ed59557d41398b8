//! The reference renderer: everything in `f64`, every mark at every pixel.

use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use strokefit::render::reference::{Reference, Rgb, Scene, Stroke};

use crate::marks::{MarkGradients, PackedMarks64};
use crate::renderer::{Background, Edge, not_finite};

/// Width, height, and ε of the distance (px²).
type Setting = (usize, usize, f64);

/// Derivatives by the marks, and by the background if there is one.
type AllGradients<'py> = (MarkGradients<'py, f64>, Option<Py<PyAny>>);

/// The canvas of the reference, height × width × 3 with a background, else × 4.
#[pyfunction]
pub(crate) fn reference_render<'py>(
    py: Python<'py>,
    setting: Setting,
    edge: &Bound<'py, Edge>,
    marks: &Bound<'py, PackedMarks64>,
    background: Option<Background<'py, f64>>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let (reference, scene) = prepared(setting, edge.get(), &marks.get().0);
    let behind = Behind::of(background.as_ref())?;
    let samples: Vec<f64> = py.detach(|| behind.canvas(&reference, &scene));
    let channels = if background.is_some() { 3 } else { 4 };
    PyArray1::from_vec(py, samples).reshape([scene.height, scene.width, channels])
}

/// The derivatives by the marks and the background of a loss with the derivatives `d_canvas`.
#[pyfunction]
pub(crate) fn reference_backward<'py>(
    py: Python<'py>,
    setting: Setting,
    edge: &Bound<'py, Edge>,
    marks: &Bound<'py, PackedMarks64>,
    background: Option<Background<'py, f64>>,
    d_canvas: PyReadonlyArray3<'py, f64>,
) -> PyResult<AllGradients<'py>> {
    let (reference, scene) = prepared(setting, edge.get(), &marks.get().0);
    let behind = Behind::of(background.as_ref())?;
    let d_canvas = d_canvas.as_slice()?;
    if !d_canvas.iter().all(|d| d.is_finite()) {
        return Err(not_finite("d_canvas"));
    }
    let (strokes, by_background) = py.detach(|| behind.gradients(&reference, &scene, d_canvas));
    let by_background = match behind {
        Behind::Color(_) => Some(PyArray1::from_vec(py, by_background).into_py_any(py)?),
        Behind::Picture(_) => {
            let picture = PyArray1::from_vec(py, by_background);
            Some(
                picture
                    .reshape([scene.height, scene.width, 3])?
                    .into_py_any(py)?,
            )
        }
        Behind::Nothing => None,
    };
    Ok((PackedMarks64::unpack(&strokes).arrays(py)?, by_background))
}

/// For each mark, by how much the sum of squares of `error` = canvas − target grows when the mark is left out.
#[pyfunction]
pub(crate) fn reference_worth<'py>(
    py: Python<'py>,
    setting: Setting,
    edge: &Bound<'py, Edge>,
    marks: &Bound<'py, PackedMarks64>,
    background: [f64; 3],
    error: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (reference, scene) = prepared(setting, edge.get(), &marks.get().0);
    let error: &[Rgb] = error.as_slice()?.as_chunks().0;
    let contribution = py.detach(|| {
        let scene = on(&scene, background);
        let canvas = reference.render(&scene);
        let targets = canvas.iter().zip(error);
        let target: Vec<Rgb> = targets
            .map(|(c, e)| [0, 1, 2].map(|k| c[k] - e[k]))
            .collect();
        reference.leave_one_out(&scene, &target)
    });
    Ok(PyArray1::from_vec(py, contribution))
}

fn prepared((width, height, eps): Setting, edge: &Edge, strokes: &[Stroke]) -> (Reference, Scene) {
    let reference = Reference {
        eps,
        ..Reference::new(edge.coverage, edge.softness)
    };
    let scene = Scene {
        width,
        height,
        background: [0.0; 3],
        strokes: strokes.to_vec(),
    };
    (reference, scene)
}

fn on(scene: &Scene, background: Rgb) -> Scene {
    Scene {
        background,
        ..scene.clone()
    }
}

/// Background of the marks.
///
/// The reference knows colours alone. A canvas on anything else is linear in those on black and on white, whose difference
/// is the transmittance of all marks.
enum Behind<'a> {
    Color(Rgb),
    Picture(&'a [Rgb]),
    Nothing,
}

impl<'a> Behind<'a> {
    fn of(background: Option<&'a Background<'_, f64>>) -> PyResult<Self> {
        Ok(match background {
            Some(Background::Color(color)) => Self::Color(*color),
            Some(Background::Picture(picture)) => Self::Picture(picture.as_slice()?.as_chunks().0),
            None => Self::Nothing,
        })
    }

    /// The samples of the canvas, row by row.
    fn canvas(&self, reference: &Reference, scene: &Scene) -> Vec<f64> {
        if let Self::Color(color) = *self {
            return reference.render(&on(scene, color)).into_flattened();
        }
        let [black, white] = [0.0, 1.0].map(|level| reference.render(&on(scene, [level; 3])));
        let pairs = black.into_iter().zip(white).enumerate();
        let pixel = |(i, (black, white)): (usize, (Rgb, Rgb))| {
            let through = white[0] - black[0];
            match self {
                Self::Picture(picture) => [0, 1, 2]
                    .map(|k| black[k] + through * picture[i][k])
                    .to_vec(),
                _ => [&black[..], &[1.0 - through]].concat(),
            }
        };
        pairs.flat_map(pixel).collect()
    }

    /// The derivatives by the strokes and by the background.
    fn gradients(
        &self,
        reference: &Reference,
        scene: &Scene,
        d_canvas: &[f64],
    ) -> (Vec<Stroke>, Vec<f64>) {
        let (on_black, on_white): (Vec<Rgb>, Vec<Rgb>) = match self {
            Self::Color(color) => {
                let by = reference.gradients(&on(scene, *color), d_canvas.as_chunks().0);
                return (by.strokes, by.background.to_vec());
            }
            Self::Picture(picture) => {
                let pixels = d_canvas.as_chunks().0.iter().zip(*picture);
                let shares = |(d, color): (&Rgb, &Rgb)| {
                    // The red of the canvases alone tells the transmittance.
                    let by_through: f64 = (0..3).map(|k| d[k] * color[k]).sum();
                    ([d[0] - by_through, d[1], d[2]], [by_through, 0.0, 0.0])
                };
                pixels.map(shares).unzip()
            }
            Self::Nothing => {
                let pixels = d_canvas.as_chunks().0.iter();
                let shares = |&[red, green, blue, alpha]: &[f64; 4]| {
                    ([red + alpha, green, blue], [-alpha, 0.0, 0.0])
                };
                pixels.map(shares).unzip()
            }
        };
        let mut sums = reference.gradients(&on(scene, [0.0; 3]), &on_black).strokes;
        let others = reference.gradients(&on(scene, [1.0; 3]), &on_white).strokes;
        for (sum, other) in sums.iter_mut().zip(others) {
            let numbers = sum.to_params().into_iter().zip(other.to_params());
            *sum = sum.with_params(&numbers.map(|(a, b)| a + b).collect::<Vec<_>>());
        }
        let by_background = match self {
            Self::Picture(_) => {
                let [black, white] =
                    [0.0, 1.0].map(|level| reference.render(&on(scene, [level; 3])));
                let through = black
                    .iter()
                    .zip(&white)
                    .map(|(black, white)| white[0] - black[0]);
                let pixels = through.zip(d_canvas.as_chunks::<3>().0);
                pixels
                    .flat_map(|(through, d)| d.map(|d| through * d))
                    .collect()
            }
            _ => Vec::new(),
        };
        (sums, by_background)
    }
}
