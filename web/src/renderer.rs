//! The renderer and its gradients, for losses of one's own.

use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::loss::Loss;
use strokefit::render::{
    self, Backdrop, Canvas, Gradients, Grid, STYLE, Softness, StrokeRef, Strokes,
};
use strokefit::scene::PointKind;
use wasm_bindgen::prelude::*;

/// Bits of a point's kind: what it is to its path, the number of a [`PointKind`]; and that it is the last of a ring, and the last
/// of a mark, whose path is closed.
const KIND: u8 = 3;
const ENDS_RING: u8 = 4;
const ENDS_MARK: u8 = 8;
const CLOSED: u8 = 16;

/// Renders marks on pictures of one size.
#[wasm_bindgen]
pub struct Renderer {
    renderer: render::Renderer,
    softness: Softness,
    strokes: Strokes,
    background: [f32; 3],
    canvas: Canvas,
    gradients: Gradients,
}

#[wasm_bindgen]
impl Renderer {
    /// A renderer for pictures of `width`×`height` px.
    ///
    /// # Errors
    /// When there is no such coverage function.
    #[wasm_bindgen(constructor)]
    pub fn new(
        width: usize,
        height: usize,
        coverage: &str,
        softness: f32,
    ) -> Result<Self, JsError> {
        let grid = Grid::new(width, height);
        Ok(Self {
            renderer: render::Renderer::new(grid, Simd::Auto.require()?),
            softness: Softness {
                coverage: coverage.parse::<Coverage>()?,
                width: softness,
            },
            strokes: Strokes::new(),
            background: [0.0; 3],
            canvas: Canvas::flat(grid, [0.0; 3]),
            gradients: Gradients::default(),
        })
    }

    /// The picture of marks, three samples for each pixel. `numbers` are those of [`Strokes`] in their order, and `kinds` has
    /// the bits of each point; both are checked in `web/js/gradients.js`.
    pub fn render(
        &mut self,
        numbers: &[f32],
        kinds: &[u8],
        red: f32,
        green: f32,
        blue: f32,
    ) -> Vec<f32> {
        self.strokes = strokes(numbers, kinds);
        self.background = [red, green, blue];
        let backdrop = Backdrop::Color(self.background);
        self.renderer
            .forward(&self.strokes, self.softness, backdrop, &mut self.canvas);
        let Grid { width, height, .. } = self.renderer.grid();
        let pixels = (0..width * height).map(|i| self.canvas.pixel(i % width, i / width));
        pixels.collect::<Vec<_>>().into_flattened()
    }

    /// The derivatives of a loss by the numbers of the last picture's marks and, last, by its background, from those by the
    /// picture.
    pub fn backward(&mut self, d_canvas: &[f32]) -> Vec<f32> {
        // The loss is half of the squared error against a picture from which the canvas is `d_canvas` away, up to a factor. A
        // loss of its own would be another copy of the kernels, for which a page would wait.
        let largest = d_canvas
            .iter()
            .fold(f32::MIN_POSITIVE, |most, d| most.max(d.abs()));
        let (canvas, grid) = (&self.canvas, self.renderer.grid());
        let away: &[[f32; 3]] = d_canvas.as_chunks().0;
        let target = Canvas::from_fn(grid, |i| {
            let colors = canvas.pixel(i % grid.width, i / grid.width);
            let away = away.get(i).unwrap_or(&colors);
            std::array::from_fn(|k| colors[k] - away[k] / largest)
        });
        let backdrop = Backdrop::Color(self.background);
        Objective::new(Loss::L2, &target).backward(
            &mut self.renderer,
            &self.strokes,
            self.softness,
            backdrop,
            &mut self.gradients,
        );
        let Gradients {
            strokes, backdrop, ..
        } = &self.gradients;
        // An objective is a mean over all values.
        let back = 0.5 * largest * d_canvas.len() as f32;
        strokes.iter().chain(backdrop).map(|d| d * back).collect()
    }
}

fn strokes(numbers: &[f32], kinds: &[u8]) -> Strokes {
    let mut strokes = Strokes::new();
    let (mut numbers, mut rings) = (numbers, Vec::new());
    let mut of_points = Vec::new();
    for kind in kinds {
        of_points.push(PointKind::ALL[usize::from(kind & KIND)]);
        if kind & ENDS_RING != 0 {
            rings.push(of_points.len() as u32);
        }
        if kind & ENDS_MARK == 0 {
            continue;
        }
        let (own, rest) = numbers
            .split_at_checked(2 * of_points.len() + STYLE)
            .unwrap_or_default();
        if let Some((points, style)) = own.split_last_chunk() {
            strokes.push(StrokeRef {
                points: points.as_chunks().0,
                kinds: &of_points,
                closed: kind & CLOSED != 0,
                rings: &rings,
                form: None,
                paint: None,
                sweep: None,
                style,
            });
        }
        numbers = rest;
        of_points.clear();
        rings.clear();
    }
    strokes
}
