//! The renderer: marks to a canvas, and `∂L/∂canvas` to the derivatives by all that was drawn.

use std::ops::Range;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray3, PyReadwriteArray3};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use strokefit::coverage::Coverage;
use strokefit::fit::Execution;
use strokefit::render::{
    self, Backdrop, BlockRgb, Canvas, CanvasLoss, Gradients, Grid, Run, Softness, Strokes, TILE,
    TileRgb,
};
use strokefit::threads::Workers;

use crate::failure::{Failure, expect_memory};
use crate::marks::{MarkGradients, PackedMarks};

const BLACK: Backdrop<'_> = Backdrop::Color([0.0; 3]);
const WHITE: Backdrop<'_> = Backdrop::Color([1.0; 3]);

/// Background of the marks: a colour, or a picture of height × width × 3. Without one the canvas has alpha, and its colours
/// are premultiplied.
#[derive(FromPyObject)]
pub(crate) enum Background<'py, T: Element> {
    Color([T; 3]),
    Picture(PyReadonlyArray3<'py, T>),
}

/// A soft edge.
#[pyclass(frozen, module = "strokefit._native")]
pub(crate) struct Edge {
    pub(crate) coverage: Coverage,
    /// px.
    pub(crate) softness: f64,
}

#[pymethods]
impl Edge {
    #[new]
    fn new(coverage: &str, softness: f64) -> PyResult<Self> {
        if !(softness > 0.0 && softness.is_finite()) {
            let message = format!("softness={softness}: give px above 0, such as 1.2");
            return Err(PyValueError::new_err(message));
        }
        let coverage = coverage.parse().map_err(Failure::Library)?;
        Ok(Self { coverage, softness })
    }
}

impl Edge {
    fn softness(&self) -> Softness {
        Softness {
            coverage: self.coverage,
            width: self.softness as f32,
        }
    }
}

/// Derivatives by the marks, and by the background if there is one.
type AllGradients<'py> = (MarkGradients<'py, f32>, Option<Py<PyAny>>);

/// Renders marks on pictures of one size, and keeps its memory from call to call. Of calls from several threads, one waits
/// for the other.
#[pyclass(frozen, module = "strokefit._native")]
pub(crate) struct Renderer {
    grid: Grid,
    execution: Execution,
    state: Mutex<Option<State>>,
}

/// Worker threads and what they work with.
struct State {
    /// A process that was forked has no threads of its parent.
    process: u32,
    pool: Workers,
    passes: Passes,
}

struct Passes {
    renderer: render::Renderer,
    canvas: Canvas,
    on_white: Option<Canvas>,
    gradients: Gradients,
}

#[pymethods]
impl Renderer {
    #[new]
    fn new(width: usize, height: usize, threads: Option<usize>) -> PyResult<Self> {
        /// Two canvases of 12 bytes, and as much to work with.
        const BYTES_PER_PIXEL: u64 = 48;
        let pixels = (width as u64).saturating_mul(height as u64);
        expect_memory(pixels.saturating_mul(BYTES_PER_PIXEL), width, height)?;
        let execution = Execution {
            threads,
            ..Execution::default()
        };
        Ok(Self {
            grid: Grid::new(width, height),
            execution,
            state: Mutex::new(None),
        })
    }

    /// Writes the canvas to `out`: height × width × 3 with a background, else × 4, and C-contiguous.
    fn render<'py>(
        &self,
        py: Python<'py>,
        marks: &Bound<'py, PackedMarks>,
        edge: &Bound<'py, Edge>,
        background: Option<Background<'py, f32>>,
        mut out: PyReadwriteArray3<'py, f32>,
    ) -> PyResult<()> {
        let (strokes, softness) = (&marks.get().0, edge.get().softness());
        let behind = background.as_ref().map(Behind::of).transpose()?;
        let samples = out.as_slice_mut()?;
        self.with(py, |passes| passes.draw(strokes, softness, behind, samples))
    }

    /// The derivatives by the marks and the background of a loss with the derivatives `d_canvas`.
    fn backward<'py>(
        &self,
        py: Python<'py>,
        marks: &Bound<'py, PackedMarks>,
        edge: &Bound<'py, Edge>,
        background: Option<Background<'py, f32>>,
        d_canvas: PyReadonlyArray3<'py, f32>,
    ) -> PyResult<AllGradients<'py>> {
        let (marks, softness, grid) = (marks.get(), edge.get().softness(), self.grid);
        let strokes = &marks.0;
        let behind = background.as_ref().map(Behind::of).transpose()?;
        let d_canvas = d_canvas.as_slice()?;
        let derivatives = self.with(py, |passes| {
            if !passes.differentiate(strokes, softness, behind, d_canvas) {
                return None;
            }
            let by_background = match behind {
                Some(Behind::Picture(_)) => passes.through(strokes, softness, d_canvas),
                Some(Behind::Color(_)) => passes.gradients.backdrop.to_vec(),
                None => Vec::new(),
            };
            Some((marks.unpack(&passes.gradients.strokes), by_background))
        })?;
        let (by_marks, by_background) = derivatives.ok_or_else(|| not_finite("d_canvas"))?;
        let by_background = PyArray1::from_vec(py, by_background);
        let by_background = match behind {
            Some(Behind::Picture(_)) => {
                let picture = by_background.reshape([grid.height, grid.width, 3])?;
                Some(picture.into_py_any(py)?)
            }
            Some(Behind::Color(_)) => Some(by_background.into_py_any(py)?),
            None => None,
        };
        Ok((by_marks.arrays(py)?, by_background))
    }

    /// For each mark, by how much the sum of squares of `error` = canvas − target grows when the mark is left out.
    fn worth<'py>(
        &self,
        py: Python<'py>,
        marks: &Bound<'py, PackedMarks>,
        edge: &Bound<'py, Edge>,
        background: Background<'py, f32>,
        error: PyReadonlyArray3<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (strokes, softness, grid) = (&marks.get().0, edge.get().softness(), self.grid);
        let behind = Behind::of(&background)?;
        let error = error.as_slice()?;
        let contribution = self.with(py, |passes| {
            let loss = Given::new(grid, error, |pixel: &[f32; 3]| *pixel);
            let Passes {
                renderer,
                gradients,
                ..
            } = passes;
            behind.with(grid, |backdrop| {
                renderer.backward_with_contributions(strokes, softness, backdrop, &loss, gradients);
            });
            loss.is_finite().then(|| gradients.contribution.clone())
        })?;
        Ok(PyArray1::from_vec(
            py,
            contribution.ok_or_else(|| not_finite("error"))?,
        ))
    }
}

impl Renderer {
    /// Runs `work` on the worker threads, without Python's lock.
    fn with<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Passes) -> R + Send,
    ) -> PyResult<R> {
        py.detach(|| {
            // What a panic leaves behind are numbers, which all work overwrites.
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let ready = state.take().filter(|state| state.process == process::id());
            let ready = ready.map_or_else(|| State::new(self.grid, self.execution), Ok)?;
            let State { pool, passes, .. } = state.insert(ready);
            Ok(pool.install(|| work(passes)))
        })
        .map_err(|failure: Failure| failure.into())
    }
}

impl State {
    fn new(grid: Grid, execution: Execution) -> Result<Self, Failure> {
        let level = execution.simd.require()?;
        let pool = execution.pool()?;
        let passes = pool.install(|| Passes {
            renderer: render::Renderer::new(grid, level),
            canvas: Canvas::flat(grid, [0.0; 3]),
            on_white: None,
            gradients: Gradients::default(),
        });
        Ok(Self {
            process: process::id(),
            pool,
            passes,
        })
    }
}

/// A [`Background`] whose samples can be read without Python's lock.
#[derive(Clone, Copy)]
enum Behind<'a> {
    Color([f32; 3]),
    Picture(&'a [f32]),
}

impl<'a> Behind<'a> {
    fn of(background: &'a Background<'_, f32>) -> PyResult<Self> {
        Ok(match background {
            Background::Color(color) => Self::Color(*color),
            Background::Picture(picture) => Self::Picture(picture.as_slice()?),
        })
    }

    fn with<R>(self, grid: Grid, work: impl FnOnce(Backdrop<'_>) -> R) -> R {
        match self {
            Self::Color(color) => work(Backdrop::Color(color)),
            Self::Picture(samples) => {
                let pixels = samples.as_chunks().0;
                work(Backdrop::Canvas(&Canvas::from_fn(grid, |i| pixels[i])))
            }
        }
    }
}

impl Passes {
    /// Writes the canvas to `samples`, row by row.
    fn draw(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        behind: Option<Behind<'_>>,
        samples: &mut [f32],
    ) {
        let Self {
            renderer,
            canvas,
            on_white,
            ..
        } = self;
        let grid = renderer.grid();
        let Some(behind) = behind else {
            // What shows on white and not on black is the light that the marks let through.
            let white = on_white.get_or_insert_with(|| canvas.clone());
            renderer.forward(strokes, softness, BLACK, canvas);
            renderer.forward(strokes, softness, WHITE, white);
            return write(grid, samples, |tile, block, lanes, out| {
                let black = runs(&canvas.tiles()[tile][block], lanes.clone());
                let white = &white.tiles()[tile][block][0].0[lanes];
                let pixels = black.zip(white);
                for (out, ([red, green, blue], on_white)) in out.iter_mut().zip(pixels) {
                    *out = [red, green, blue, 1.0 - (on_white - red)];
                }
            });
        };
        behind.with(grid, |backdrop| {
            renderer.forward(strokes, softness, backdrop, canvas)
        });
        write(grid, samples, |tile, block, lanes, out| {
            let pixels = runs(&canvas.tiles()[tile][block], lanes);
            out.iter_mut()
                .zip(pixels)
                .for_each(|(out, pixel)| *out = pixel);
        });
    }

    /// Computes the derivatives; false if `d_canvas` is not finite.
    fn differentiate(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        behind: Option<Behind<'_>>,
        d_canvas: &[f32],
    ) -> bool {
        let Self {
            renderer,
            gradients,
            ..
        } = self;
        let grid = renderer.grid();
        let Some(behind) = behind else {
            // Alpha is 1 + red on black − red on white.
            type Take = fn(&[f32; 4]) -> [f32; 3];
            let takes: [Take; 2] = [
                |&[red, green, blue, alpha]| [red + alpha, green, blue],
                |&[.., alpha]| [-alpha, 0.0, 0.0],
            ];
            let [black, white] = takes.map(|take| Given::new(grid, d_canvas, take));
            renderer.backward_on_mattes(
                strokes,
                softness,
                [BLACK, WHITE],
                [&black, &white],
                gradients,
            );
            return black.is_finite() && white.is_finite();
        };
        let loss = Given::new(grid, d_canvas, |pixel: &[f32; 3]| *pixel);
        behind.with(grid, |backdrop| {
            renderer.backward(strokes, softness, backdrop, &loss, gradients);
        });
        loss.is_finite()
    }

    /// `d_canvas` times the transmittance of all marks: the derivatives by a picture behind them.
    fn through(&mut self, strokes: &Strokes, softness: Softness, d_canvas: &[f32]) -> Vec<f32> {
        let mut black = strokes.clone();
        black.change(|_, mut stroke| stroke.color_mut().fill(0.0));
        let mut samples = vec![0.0; d_canvas.len()];
        self.draw(
            &black,
            softness,
            Some(Behind::Color([1.0; 3])),
            &mut samples,
        );
        samples
            .iter_mut()
            .zip(d_canvas)
            .for_each(|(sample, d)| *sample *= d);
        samples
    }
}

/// The colours of some lanes of a block.
fn runs(block: &BlockRgb, lanes: Range<usize>) -> impl Iterator<Item = [f32; 3]> {
    let [red, green, blue] = block.each_ref().map(|channel| &channel.0[lanes.clone()]);
    let pixels = red.iter().zip(green).zip(blue);
    pixels.map(|((&red, &green), &blue)| [red, green, blue])
}

/// A loss of which the derivatives are given, `N` for each pixel, of which `take` makes three.
struct Given<'a, const N: usize, F> {
    grid: Grid,
    pixels: &'a [[f32; N]],
    take: F,
    is_finite: AtomicBool,
}

impl<'a, const N: usize, F: Fn(&[f32; N]) -> [f32; 3]> Given<'a, N, F> {
    fn new(grid: Grid, samples: &'a [f32], take: F) -> Self {
        Self {
            grid,
            pixels: samples.as_chunks().0,
            take,
            is_finite: AtomicBool::new(true),
        }
    }

    /// True if all numbers that were used are finite.
    fn is_finite(&self) -> bool {
        self.is_finite.load(Ordering::Relaxed)
    }
}

impl<const N: usize, F: Fn(&[f32; N]) -> [f32; 3] + Sync> CanvasLoss for Given<'_, N, F> {
    fn tile(
        &self,
        tile: usize,
        _canvas: &TileRgb,
        error: Option<&mut TileRgb>,
        gradient: &mut TileRgb,
    ) -> f64 {
        let (x, y) = self.grid.origin(tile);
        if x + TILE > self.grid.width || y + TILE > self.grid.height {
            gradient
                .as_flattened_mut()
                .iter_mut()
                .for_each(|lanes| lanes.0.fill(0.0));
        }
        // 0 times a number is 0, and NaN if the number is not finite. Sums side by side, so that none waits for the last.
        let mut zeros = [[0.0; 3]; 4];
        self.grid.runs(tile).for_each(|run| {
            let [red, green, blue] = &mut gradient[run.block];
            let red = &mut red.0[run.lanes.clone()];
            let green = &mut green.0[run.lanes.clone()];
            let blue = &mut blue.0[run.lanes];
            let lanes = red.iter_mut().zip(green).zip(blue).zip(&mut zeros);
            let pixels = self.pixels[run.first..].iter().zip(lanes);
            for (pixel, (((red, green), blue), zeros)) in pixels {
                let values = (self.take)(pixel);
                [*red, *green, *blue] = values;
                for (zero, value) in zeros.iter_mut().zip(values) {
                    *zero += 0.0 * value;
                }
            }
        });
        if zeros != [[0.0; 3]; 4] {
            self.is_finite.store(false, Ordering::Relaxed);
        }
        if let Some(error) = error {
            error.clone_from(gradient);
        }
        0.0
    }
}

/// Writes `N` samples for each pixel, row by row. `run` writes those of some lanes of a block of a tile.
fn write<const N: usize>(
    grid: Grid,
    samples: &mut [f32],
    run: impl Fn(usize, usize, Range<usize>, &mut [[f32; N]]) + Sync,
) {
    let band = TILE * grid.width;
    let bands = samples.as_chunks_mut().0.par_chunks_mut(band);
    bands.enumerate().for_each(|(row, out)| {
        for tile in row * grid.columns..(row + 1) * grid.columns {
            grid.runs(tile).for_each(
                |Run {
                     block,
                     lanes,
                     first,
                 }| {
                    run(tile, block, lanes, &mut out[first - row * band..]);
                },
            );
        }
    });
}

pub(crate) fn not_finite(name: &str) -> PyErr {
    PyValueError::new_err(format!("{name} holds NaN or infinity: give finite numbers"))
}
