//! Weights of errors: how much an error counts in each pixel.
//!
//! The fit minimises `Σ w·(c − t)²`. It multiplies canvas and target by `√w`, so that all derivatives, contributions and gains are
//! exactly those of the weighted error; see [`Renderer::set_error_weights`](crate::render::Renderer::set_error_weights).

use std::sync::Arc;

use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::metrics;
use crate::render::Canvas;
use crate::scene::Rgb;
use crate::seed::Pyramid;

const BLACK: Rgb = [0.0; 3];

/// Weight of an error where a lifted mask is black. Without any, ends of strokes are left there as they come: a cat
/// of 400 strokes has 32.7 dB inside and 15.3 outside, with this weight 32.8 and 25.2, with 0.02 32.2 and 28.0.
const FLOOR: f32 = 0.002;

/// Weight of an error at each pixel, 0 to 1.
#[derive(Debug, Clone)]
pub struct Focus {
    /// The weights, and their reductions.
    weights: Arc<Pyramid>,
}

impl Focus {
    /// The weights in `mask`: the mean of its channels, on black where it is transparent.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when it is black everywhere.
    pub fn new(mask: &Image) -> Result<Self> {
        let mask = mask.on(BLACK);
        let [red, green, blue] = mask.planes();
        let channels = red.iter().zip(green).zip(blue);
        let weights: Vec<f32> = channels
            .map(|((r, g), b)| ((r + g + b) / 3.0).clamp(0.0, 1.0))
            .collect();
        if weights.iter().all(|&weight| weight == 0.0) {
            let message = "the mask is black everywhere, so that no error would count: make the pixels that \
                           matter white";
            return Err(Error::new(ErrorKind::Picture, message));
        }
        Ok(Self::of_weights([mask.width(), mask.height()], weights))
    }

    /// The weights in `mask` as in [`Self::new`], but a small one where it is black.
    ///
    /// # Errors
    /// As those of [`Self::new`].
    pub fn lifted(mask: &Image) -> Result<Self> {
        Self::new(mask)?;
        let mask = mask.clone().flattened(BLACK);
        let (width, height) = (mask.width(), mask.height());
        let lift = |plane: Vec<f32>| {
            let lifted = plane.into_iter().map(|v| FLOOR + (1.0 - FLOOR) * v);
            lifted.collect()
        };
        Self::new(&Image::new(width, height, mask.into_planes().map(lift))?)
    }

    /// The weights of the pixels, row by row.
    pub(in crate::fit) fn of_weights([width, height]: [usize; 2], weights: Vec<f32>) -> Self {
        // One weight a pixel, in three equal channels: it multiplies canvases channel by channel.
        let planes = [weights.clone(), weights.clone(), weights];
        Self {
            weights: Arc::new(Pyramid::new(Image::from_planes(width, height, planes))),
        }
    }

    /// Products of the weights of two masks of one size.
    pub(in crate::fit) fn times(&self, other: &Self) -> Self {
        let level = self.weights.level(0);
        let weights = self.values().iter().zip(other.values());
        Self::of_weights(
            [level.width(), level.height()],
            weights.map(|(a, b)| a * b).collect(),
        )
    }

    /// Checks that the mask has the size of `picture`.
    pub(in crate::fit) fn check_size(&self, picture: &Image) -> Result<()> {
        let mask = self.weights.level(0);
        let size = |image: &Image| (image.width(), image.height());
        if size(mask) == size(picture) {
            return Ok(());
        }
        let ((mask_width, mask_height), (width, height)) = (size(mask), size(picture));
        let message = format!(
            "the mask of {mask_width}×{mask_height} px is none for a picture of {width}×{height} px: give one of its size"
        );
        Err(Error::new(ErrorKind::Picture, message))
    }

    /// The mask reduced like a picture.
    pub(in crate::fit) fn reduced(&self, width: usize, height: usize) -> Self {
        Self {
            weights: Arc::new(Pyramid::new(self.weights.level(0).reduced(width, height))),
        }
    }

    /// The weights and their reductions.
    pub(in crate::fit) fn weights(&self) -> &Pyramid {
        &self.weights
    }

    /// The roots of the weights of the picture halved `halvings` times.
    pub(in crate::fit) fn roots(&self, halvings: usize) -> Canvas {
        let weights = self.weights.level(halvings);
        // Weights are reduced before the root is taken: the weight of a larger pixel is a mean of weights.
        let roots = |plane: &Vec<f32>| plane.iter().map(|weight| weight.sqrt()).collect();
        let planes = [0, 1, 2].map(|c| roots(&weights.planes()[c]));
        Canvas::from_image(&Image::from_planes(
            weights.width(),
            weights.height(),
            planes,
        ))
    }

    /// The fidelity of `picture` to `target`, dB, over the pixels with a weight of a half or more, and over the others;
    /// infinite where there are none.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when the sizes differ.
    pub fn psnrs_db(&self, target: &Image, picture: &Image) -> Result<[f64; 2]> {
        let [weights, ..] = self.weights.level(0).planes();
        let inside = |i: usize| weights.get(i).is_some_and(|&weight| weight >= 0.5);
        Ok([
            metrics::psnr_where(target, picture, inside)?,
            metrics::psnr_where(target, picture, |i| !inside(i))?,
        ])
    }

    /// All numbers that tell the mask from another.
    pub(in crate::fit) fn values(&self) -> &[f32] {
        &self.weights.level(0).planes()[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coverage::Coverage;
    use crate::fit::{Budget, Config, Fitter, Objective, Preset};
    use crate::loss::Loss;
    use crate::render::{Backdrop, Gradients, Renderer, Softness, Strokes};
    use crate::scene::{Cap, Marks, Path, Stroke};

    fn mask(values: [f32; 4]) -> Image {
        let plane = values.to_vec();
        Image::new(2, 2, [plane.clone(), plane.clone(), plane]).unwrap()
    }

    #[test]
    fn a_black_mask_is_refused() {
        assert!(Focus::new(&mask([0.0; 4])).is_err());
        let clear = mask([1.0; 4]).with_alpha(vec![0.0; 4]).unwrap();
        assert!(Focus::new(&clear).is_err());
        assert!(Focus::new(&mask([0.0, 0.0, 0.1, 0.0])).is_ok());
    }

    #[test]
    fn a_mask_of_another_size_is_refused() {
        let focus = Focus::new(&mask([1.0; 4])).unwrap();
        let error = focus.check_size(&Image::filled(3, 2, [0.0; 3]).unwrap());
        assert!(error.unwrap_err().to_string().contains("3×2"));
    }

    #[test]
    fn inside_and_outside_are_told_apart() {
        let focus = Focus::new(&mask([1.0, 0.5, 0.4, 0.0])).unwrap();
        let (target, drawn) = (mask([0.0; 4]), mask([0.0, 0.0, 0.2, 0.2]));
        let [inside, outside] = focus.psnrs_db(&target, &drawn).unwrap();
        assert_eq!(inside, f64::INFINITY);
        assert!((outside - 13.979_400_086_720_377).abs() < 1e-9, "{outside}");
    }

    /// A pattern of two colours, 64×48 px.
    fn checks() -> Image {
        let value = |i: usize| {
            if (i % 64 / 8 + i / 64 / 8).is_multiple_of(2) {
                0.2
            } else {
                0.8
            }
        };
        let plane: Vec<f32> = (0..64 * 48).map(value).collect();
        Image::new(64, 48, [plane.clone(), plane.clone(), plane]).unwrap()
    }

    /// A mask that is `left` in the left half and `right` in the right half.
    fn halves(left: f32, right: f32) -> Focus {
        let value = |i: usize| if i % 64 < 32 { left } else { right };
        let plane: Vec<f32> = (0..64 * 48).map(value).collect();
        Focus::new(&Image::new(64, 48, [plane.clone(), plane.clone(), plane]).unwrap()).unwrap()
    }

    /// Loss, contribution and ∂L/∂color of a dot on white, weighted by `focus`.
    fn judged(focus: Option<&Focus>, x: f32) -> (f64, f32, f32) {
        let target = Canvas::from_image(&checks());
        let dot = Stroke {
            path: Path::dot((x, 24.0).into()),
            radius: 6.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.5; 3],
            opacity: 0.8,
        };
        let strokes = Strokes::from_iter([&dot]);
        let softness = Softness {
            coverage: Coverage::Smoothstep,
            width: 1.0,
        };
        let mut renderer = Renderer::new(target.grid(), fearless_simd::Level::new());
        let roots = focus.map(|focus| focus.roots(0));
        let target = match &roots {
            Some(roots) => {
                renderer.set_error_weights(roots);
                target.multiplied(roots)
            }
            None => target,
        };
        let objective = Objective::new(Loss::L2, &target).weighted(roots.as_ref());
        let mut gradients = Gradients::default();
        let white = Backdrop::Color([1.0; 3]);
        renderer.backward_with_contributions(&strokes, softness, white, &objective, &mut gradients);
        let mut canvas = Canvas::flat(target.grid(), [1.0; 3]);
        renderer.forward(&strokes, softness, white, &mut canvas);
        assert!((objective.of(&canvas) - gradients.loss).abs() < 1e-4 * gradients.loss);
        (
            gradients.loss,
            gradients.contribution[0],
            gradients.strokes[3],
        )
    }

    #[test]
    fn an_error_of_half_the_weight_counts_half() {
        let (half, whole) = (judged(Some(&halves(0.5, 0.5)), 20.0), judged(None, 20.0));
        assert!((half.0 - 0.5 * whole.0).abs() < 1e-5 * whole.0);
        assert!((half.1 - 0.5 * whole.1).abs() < 1e-4 * whole.1.abs());
        assert!((half.2 - 0.5 * whole.2).abs() < 1e-4 * whole.2.abs());
    }

    #[test]
    fn what_does_not_count_has_no_contribution() {
        let left = halves(1.0, 0.0);
        let (here, there) = (judged(Some(&left), 16.0), judged(Some(&left), 48.0));
        let anywhere = judged(None, 16.0);
        assert!((here.1 - anywhere.1).abs() < 1e-4 * anywhere.1.abs());
        assert_eq!((there.1, there.2), (0.0, 0.0));
    }

    #[test]
    fn strokes_go_where_errors_count() {
        let config = Config {
            budget: Budget {
                strokes: Some(10),
                ..Budget::default()
            },
            preset: Preset::Draft,
            // Areas of few colours are where they are seen, whatever counts.
            marks: Marks::Strokes,
            ..Config::default()
        };
        let picture = checks();
        let psnrs_db = |focus: Focus| {
            let fitter = Fitter::new(config.clone()).focus(focus);
            let fit = fitter.fit(&picture).unwrap();
            halves(1.0, 0.0).psnrs_db(&picture, &fit.soft).unwrap()
        };
        let [left, right] = psnrs_db(halves(1.0, 0.0));
        assert!(left > right + 3.0, "{left} {right}");
        let [left, right] = psnrs_db(halves(0.0, 1.0));
        assert!(right > left + 3.0, "{left} {right}");
    }
}
