//! The objective of a fit: the mean loss over all pixels against a target, computed tile by tile.

use rayon::prelude::*;

use crate::loss::Loss;
use crate::render::{
    Backdrop, Canvas, CanvasLoss, Gradients, Grid, KeptLoss, Lanes, Renderer, Softness, Strokes,
    TILE, TileRgb,
};

/// The mean of `loss` over width·height·3 values against `target`.
#[derive(Debug, Clone, Copy)]
pub struct Objective<'a> {
    loss: Loss,
    target: &'a Canvas,
    moments: Option<&'a Moments>,
    kept: Option<&'a [KeptLoss]>,
    /// The roots of the weights of errors. The target is multiplied by them already.
    error_weights: Option<&'a Canvas>,
    /// 1/(width·height·3).
    scale: f32,
}

/// A target of the squared error, multiplied by the roots of the weights of errors.
#[derive(Debug)]
pub(in crate::fit) struct Target {
    canvas: Canvas,
    moments: Moments,
    /// For each tile, what is known of its part of the error.
    kept: Vec<KeptLoss>,
}

impl Target {
    /// The target that is `canvas`, which is multiplied by `error_weights` already.
    pub(in crate::fit) fn new(canvas: Canvas, error_weights: Option<&Canvas>) -> Self {
        Self {
            moments: Moments::of(&canvas, error_weights),
            kept: canvas.tiles().iter().map(|_| KeptLoss::default()).collect(),
            canvas,
        }
    }

    /// Forgets the errors of the backdrop, which has changed.
    pub(in crate::fit) fn forget_backdrop(&mut self) {
        self.kept.fill_with(KeptLoss::default);
    }

    /// The grid of tiles.
    pub(in crate::fit) fn grid(&self) -> Grid {
        self.canvas.grid()
    }
}

/// Sums over the pixels of each tile of a target, each as often as its error counts. The squared error of a tile in one
/// colour follows from them, so that an empty part of a page costs nothing.
#[derive(Debug)]
struct Moments(Vec<TileMoments>);

/// Weights where all errors count alike.
const EQUAL: Lanes = Lanes::splat(1.0);

#[derive(Debug, Clone, Copy, Default)]
struct TileMoments {
    /// The number of pixels.
    pixels: f64,
    /// Sums of the channels.
    sums: [f64; 3],
    /// The sum of the squares of all channels.
    squares: f64,
}

impl Moments {
    /// The sums of `target`, which is multiplied by `error_weights` already.
    fn of(target: &Canvas, error_weights: Option<&Canvas>) -> Self {
        let grid = target.grid();
        let moments = |(tile, pixels): (usize, &TileRgb)| {
            let (x, y) = grid.origin(tile);
            // Tiles at the right and lower borders are padded with zeros, which the sums ignore but a count must not.
            let (columns, rows) = (TILE.min(grid.width - x), TILE.min(grid.height - y));
            let mut moments = TileMoments {
                pixels: (columns * rows) as f64,
                ..TileMoments::default()
            };
            let roots = error_weights.map(|roots| roots.tiles()[tile].as_flattened());
            if let Some(roots) = roots {
                let roots = roots.iter().step_by(3).flat_map(|lanes| lanes.0);
                moments.pixels = roots.map(|v| f64::from(v) * f64::from(v)).sum();
            }
            for (i, lanes) in pixels.as_flattened().iter().enumerate() {
                let roots = roots.map_or(&EQUAL, |roots| &roots[i]);
                for (value, root) in lanes.0.into_iter().zip(roots.0) {
                    let value = f64::from(value);
                    // The target is √w·t, so √w times that is w·t, and its square w·t².
                    moments.sums[i % 3] += f64::from(root) * value;
                    moments.squares += value * value;
                }
            }
            moments
        };
        Self(target.tiles().par_iter().enumerate().map(moments).collect())
    }
}

impl<'a> Objective<'a> {
    /// The loss against `target`.
    pub fn new(loss: Loss, target: &'a Canvas) -> Self {
        let grid = target.grid();
        Self {
            loss,
            target,
            moments: None,
            kept: None,
            error_weights: None,
            scale: 1.0 / (grid.width * grid.height * 3) as f32,
        }
    }

    /// [`Renderer::backward`] for this objective, which is compiled here alone: another crate would have the kernels twice.
    #[doc(hidden)]
    pub fn backward(
        &self,
        renderer: &mut Renderer,
        strokes: &Strokes,
        softness: Softness,
        backdrop: Backdrop<'_>,
        gradients: &mut Gradients,
    ) {
        renderer.backward(strokes, softness, backdrop, self, gradients);
    }

    /// The squared error against `target`.
    pub(in crate::fit) fn squared(target: &'a Target) -> Self {
        Self {
            moments: Some(&target.moments),
            kept: Some(&target.kept),
            ..Self::new(Loss::L2, &target.canvas)
        }
    }

    /// The objective with weighted errors; see
    /// [`Renderer::set_error_weights`](crate::render::Renderer::set_error_weights). The target is multiplied by the roots already.
    pub(in crate::fit) fn weighted(self, error_weights: Option<&'a Canvas>) -> Self {
        Self {
            error_weights,
            ..self
        }
    }

    /// The loss of `canvas`, which is not multiplied by the roots of the weights.
    pub(in crate::fit) fn of(&self, canvas: &Canvas) -> f64 {
        let tiles = canvas.tiles().par_iter().enumerate();
        let sum = |(tile, canvas): (usize, &TileRgb)| {
            let roots = self.error_weights.map(|roots| &roots.tiles()[tile]);
            self.sum(canvas, roots, &self.target.tiles()[tile])
        };
        // Tiles are added in their order, so that the sum doesn't depend on the number of threads.
        let sums: Vec<f64> = tiles.map(sum).collect();
        sums.iter().sum::<f64>() * f64::from(self.scale)
    }

    fn sum(&self, canvas: &TileRgb, roots: Option<&TileRgb>, target: &TileRgb) -> f64 {
        let roots = roots.map(|roots| roots.as_flattened());
        let mut sums = Lanes::splat(0.0);
        let lanes = canvas.as_flattened().iter().zip(target.as_flattened());
        for (i, (c, t)) in lanes.enumerate() {
            let roots = roots.map_or(&EQUAL, |roots| &roots[i]);
            for (lane, sum) in sums.0.iter_mut().enumerate() {
                *sum += self.loss.value(c.0[lane] * roots.0[lane] - t.0[lane]);
            }
        }
        sums.0.iter().map(|&s| f64::from(s)).sum()
    }
}

/// Padding adds nothing: it is 0 both in a canvas made from a picture and in the renderer's.
impl CanvasLoss for Objective<'_> {
    #[inline(always)]
    fn tile(
        &self,
        tile: usize,
        canvas: &TileRgb,
        mut error: Option<&mut TileRgb>,
        gradient: &mut TileRgb,
    ) -> f64 {
        let target = &self.target.tiles()[tile];
        let mut sums = Lanes::splat(0.0);
        for block in 0..canvas.len() {
            for channel in 0..3 {
                let (c, t) = (&canvas[block][channel], &target[block][channel]);
                let g = &mut gradient[block][channel];
                for lane in 0..sums.0.len() {
                    let e = c.0[lane] - t.0[lane];
                    sums.0[lane] += self.loss.value(e);
                    g.0[lane] = self.loss.derivative(e) * self.scale;
                }
                // In a loop of its own: inside the one above it would keep that from being vectorised well.
                if let Some(error) = &mut error {
                    let e = &mut error[block][channel];
                    for lane in 0..e.0.len() {
                        e.0[lane] = c.0[lane] - t.0[lane];
                    }
                }
            }
        }
        sums.0.iter().map(|&s| f64::from(s)).sum::<f64>() * f64::from(self.scale)
    }

    fn uniform(&self, tile: usize, color: [f32; 3]) -> Option<(f64, [f32; 3])> {
        let &TileMoments {
            pixels,
            sums,
            squares,
        } = self.moments?.0.get(tile)?;
        let (color, scale) = (color.map(f64::from), f64::from(self.scale));
        // Σ w(c − t)² = c²·Σw − 2c·Σwt + Σwt², with the derivative 2(c·Σw − Σwt).
        let products = color.iter().zip(sums);
        let error: f64 = products
            .map(|(c, sum)| pixels * c * c - 2.0 * c * sum)
            .sum();
        let slope = |channel: usize| 2.0 * (pixels * color[channel] - sums[channel]) * scale;
        // Where the colour meets the target, rounding of the difference may leave less than 0.
        let loss = (error + squares).max(0.0) * scale;
        Some((loss, [0, 1, 2].map(|channel| slope(channel) as f32)))
    }

    fn kept(&self, tile: usize) -> Option<&KeptLoss> {
        self.kept?.get(tile)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::math::Point;
    use crate::rng;
    use crate::scene::{Area, Mark, Path, PathPoint};

    /// Tiles of this size are padded.
    const SIZE: [usize; 2] = [40, 33];

    /// A picture of this size, with noise.
    fn random(key: u64, [width, height]: [usize; 2]) -> Canvas {
        let draw = |x, y, c| rng::draw(0, key, c as u64, (y * width + x) as u64);
        Canvas::from_image(&Image::from_fn(width, height, 3, draw).unwrap())
    }

    #[test]
    fn a_tile_in_one_colour_is_judged_by_its_sums_as_by_its_pixels() {
        // A pixel has the same weight in all channels.
        let through: Vec<f32> = (0..40 * 33).map(|i| 1.5 * rng::draw(0, 9, 9, i)).collect();
        let planes = [through.clone(), through.clone(), through];
        let roots = Canvas::from_image(&Image::from_planes(40, 33, planes));
        let color = [0.2, 0.5, 0.9];
        for roots in [None, Some(&roots)] {
            let target = match roots {
                Some(roots) => random(1, SIZE).multiplied(roots),
                None => random(1, SIZE),
            };
            let target = Target::new(target, roots);
            let objective = Objective::squared(&target);
            let flat = Canvas::flat(Grid::new(40, 33), color);
            let canvas = match roots {
                Some(roots) => flat.multiplied(roots),
                None => flat,
            };
            for (tile, pixels) in canvas.tiles().iter().enumerate() {
                let (mut error, mut gradient) = (*pixels, *pixels);
                let expected = objective.tile(tile, pixels, Some(&mut error), &mut gradient);
                let (loss, slope) = objective.uniform(tile, color).unwrap();
                assert!(
                    (loss - expected).abs() < 1e-5 * expected,
                    "{loss} {expected}"
                );
                for channel in 0..3 {
                    let lanes = gradient.iter().enumerate().flat_map(|(block, gradient)| {
                        let through =
                            roots.map_or(EQUAL, |roots| roots.tiles()[tile][block][channel]);
                        gradient[channel].0.into_iter().zip(through.0)
                    });
                    let sum: f32 = lanes.map(|(g, through)| g * through).sum();
                    assert!((slope[channel] - sum).abs() < 1e-4 * sum.abs().max(1e-3));
                }
            }
        }
    }

    /// An area with these corners, of this colour and opacity.
    fn area(corners: &[[f64; 2]], color: [f32; 3], opacity: f32) -> Mark {
        let place = |&[x, y]: &[f64; 2]| PathPoint::on(Point::new(x, y));
        let ring = Path::new(corners.iter().map(place).collect(), true).unwrap();
        Area::plain(vec![ring], color, opacity).into()
    }

    #[test]
    fn tiles_that_nothing_touches_are_judged_once_for_each_backdrop() {
        let corners = [[5.0, 5.0], [30.0, 9.0], [12.0, 28.0]];
        let strokes: Strokes = [area(&corners, [0.9, 0.2, 0.3], 0.6)].iter().collect();
        let mut target = Target::new(random(3, [150, 100]), None);
        let mut renderer = Renderer::new(target.grid(), fearless_simd::Level::new());
        let edge = Softness {
            coverage: crate::coverage::Coverage::Smoothstep,
            width: 1.3,
        };
        for key in [4, 5] {
            let canvases = [key, key + 9].map(|key| random(key, [150, 100]));
            let [black, white] = canvases.each_ref().map(Backdrop::Canvas);
            let mut of = |objective: &Objective<'_>| {
                let mut each = [(); 2].map(|()| Gradients::default());
                renderer.backward(&strokes, edge, black, objective, &mut each[0]);
                renderer.backward_with_contributions(
                    &strokes,
                    edge,
                    black,
                    objective,
                    &mut each[1],
                );
                let numbers = each.map(|g| (g.loss, g.backdrop, g.strokes, g.contribution));
                (numbers, renderer.loss(&strokes, edge, black, objective))
            };
            let expected = of(&Objective::new(Loss::L2, &target.canvas));
            target.forget_backdrop();
            for call in 0..2 {
                let known = of(&Objective::squared(&target));
                assert_eq!(known, expected, "backdrop {key}, call {call}");
            }
            // Two mattes, whose backdrops have targets of their own.
            let other = Target::new(random(7, [150, 100]), None);
            let mut of = |losses: [&Objective<'_>; 2]| {
                let mut gradients = Gradients::default();
                renderer.backward_on_mattes(&strokes, edge, [black, white], losses, &mut gradients);
                (gradients.loss, gradients.strokes)
            };
            let unknown = [&target, &other].map(|t| Objective::new(Loss::L2, &t.canvas));
            let (expected_loss, expected) = of(unknown.each_ref());
            for _ in 0..2 {
                let known = [&target, &other].map(Objective::squared);
                let (loss, slopes) = of(known.each_ref());
                assert_eq!(slopes, expected);
                assert!((loss - expected_loss).abs() < 1e-6 * loss, "{loss}");
            }
        }
    }

    #[test]
    fn a_tile_that_keeps_its_loss_has_that_of_the_strokes_that_reach_it() {
        let left = [[5.0, 5.0], [60.0, 9.0], [12.0, 58.0]];
        let moved = [[5.0, 5.0], [60.5, 9.0], [12.0, 58.0]];
        let right = [[90.0, 20.0], [140.0, 9.0], [112.0, 88.0]];
        let strokes = |left, color, opacity| -> Strokes {
            let left = area(left, color, 0.6);
            [left, area(&right, [0.1, 0.5, 0.8], opacity)]
                .iter()
                .collect()
        };
        let red = [0.9, 0.2, 0.3];
        let drawings = [
            strokes(&left, red, 1.0),
            strokes(&moved, red, 1.0),
            strokes(&left, [0.9, 0.2, 0.4], 1.0),
            strokes(&left, red, 0.9),
        ];
        let target = Target::new(random(3, [150, 100]), None);
        let mut renderer = Renderer::new(target.grid(), fearless_simd::Level::new());
        let edge = Softness {
            coverage: crate::coverage::Coverage::Smoothstep,
            width: 1.3,
        };
        let picture = random(4, [150, 100]);
        let [black, white] = [[0.0; 3], [1.0; 3]].map(Backdrop::Color);
        // Each drawing follows each other one, and itself.
        for backdrop in [black, Backdrop::Canvas(&picture), white] {
            for i in [0, 1, 0, 2, 2, 1, 3, 0, 3, 1, 2, 0] {
                let mut loss =
                    |loss: &Objective<'_>| renderer.loss(&drawings[i], edge, backdrop, loss);
                // An objective of another target that keeps nothing.
                let anew = Target::new(target.canvas.clone(), None);
                let expected = loss(&Objective::squared(&anew));
                assert_eq!(loss(&Objective::squared(&target)), expected, "drawing {i}");
            }
        }
    }

    #[test]
    fn tiles_that_areas_fill_are_differentiated_by_their_sums_as_by_their_pixels() {
        // Both areas fill tiles between edges: the lower one has a notch, the upper one ends on the page.
        let notched = [
            [-9.0, -9.0],
            [200.0, -9.0],
            [200.0, 90.0],
            [70.0, 90.0],
            [70.0, 50.0],
            [40.0, 110.0],
            [-9.0, 110.0],
        ];
        let marks = [
            area(&notched, [0.9, 0.2, 0.3], 0.6),
            area(
                &[[90.0, -5.0], [210.0, 4.0], [190.0, 120.0]],
                [0.1, 0.5, 0.8],
                1.0,
            ),
        ];
        let strokes: Strokes = marks.iter().collect();
        let target = Target::new(random(3, [150, 100]), None);
        let known = Objective::squared(&target);
        let unknown = Objective::new(Loss::L2, &target.canvas);
        let mut renderer = Renderer::new(target.grid(), fearless_simd::Level::new());
        let edge = Softness {
            coverage: crate::coverage::Coverage::Smoothstep,
            width: 1.3,
        };
        let [black, white] = [[0.0; 3], [1.0; 3]].map(Backdrop::Color);
        let mut of = |objective: &Objective<'_>| {
            let mut each = [Gradients::default(), Gradients::default()];
            renderer.backward(&strokes, edge, white, objective, &mut each[0]);
            let mattes = [objective, objective];
            renderer.backward_on_mattes(&strokes, edge, [black, white], mattes, &mut each[1]);
            (each, renderer.loss(&strokes, edge, white, objective))
        };
        let ((by_sums, loss), (by_pixels, _)) = (of(&known), of(&unknown));
        assert!((loss - by_pixels[0].loss).abs() < 1e-6 * loss, "{loss}");
        for (sums, pixels) in by_sums.iter().zip(&by_pixels) {
            assert!((sums.loss - pixels.loss).abs() < 1e-6 * pixels.loss);
            let numbers = sums.strokes.iter().chain(&sums.backdrop);
            for (a, b) in numbers.zip(pixels.strokes.iter().chain(&pixels.backdrop)) {
                assert!((a - b).abs() < 1e-6 + 1e-4 * b.abs(), "{a} {b}");
            }
            assert!(sums.blocks < pixels.blocks, "{} blocks", sums.blocks);
        }
    }
}
