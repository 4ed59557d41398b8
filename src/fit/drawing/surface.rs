//! The surfaces of a drawing: for each matte the target, the backdrop and the canvas.
//!
//! A drawing without alpha has one surface. A transparent drawing is fitted on two at once, a black and a white matte.
//! A drawing with premultiplied colour P and alpha A looks like P + (1 − A)·g on a matte g. That is linear in every
//! channel of g, so that a drawing that is right on black and on white is right on every matte. Losses, gradients,
//! contributions and gains are means over the surfaces.

use crate::error::Result;
use crate::fit::base::Base;
use crate::fit::config::Background;
use crate::fit::drawing::background;
use crate::fit::drawing::focus::Focus;
use crate::fit::drawing::objective::{Objective, Target};
use crate::image::Image;
use crate::render::{self, Backdrop, Canvas, Grid, Renderer, Softness, Strokes};
use crate::scene::{Area, Rgb, Scene};
use crate::seed::{Pyramid, Residual};
use crate::verify;

const BLACK: Rgb = [0.0; 3];
const WHITE: Rgb = [1.0; 3];

/// Strokes are fitted at the coarsest resolution that leaves them this typical radius, px. At a smaller one their edges are finer than
/// the pixels; at a larger one time goes to pixels that add nothing. A reduced picture for large strokes: +0.15 dB at 0.8 of the
/// time. Half, twice: −0.23, +0.07 dB.
const MIN_SCALE: f32 = 2.5;

/// A picture, prepared for a fit.
pub(in crate::fit) struct Prepared {
    /// The picture to reproduce: without alpha unless there are two surfaces.
    pub(in crate::fit) target: Image,
    /// One, or two for a transparent drawing.
    pub(in crate::fit) surfaces: Vec<Surface>,
    /// True if the background keeps its colour.
    pub(in crate::fit) background_fixed: bool,
    /// The areas on the background, behind all marks.
    pub(in crate::fit) ground: Vec<Area>,
}

impl Prepared {
    /// The surfaces for a drawing of `picture` on `base`, or on a `background` and a `ground`, whose first strokes have a
    /// scale of `scale` px.
    pub(in crate::fit) fn new(
        picture: &Image,
        (background, ground): (Background, Vec<Area>),
        base: Option<&Base>,
        scale: f32,
    ) -> Result<Self> {
        let Some(Base {
            document, scene, ..
        }) = base
        else {
            return Self::on_page(picture, background, ground, scale);
        };
        if let Some(document) = document {
            return Self::on_document(picture, document.text(), scale);
        }
        let background = scene.background.map_or(Background::None, Background::Color);
        Self::on_page(picture, background, scene.ground.clone(), scale)
    }

    fn on_page(
        picture: &Image,
        background: Background,
        ground: Vec<Area>,
        scale: f32,
    ) -> Result<Self> {
        // A drawing on two mattes keeps its alpha in the target; on one it is flattened onto the background.
        let mattes = mattes(picture, background);
        let target = match *mattes {
            [matte] => picture.flattened(matte),
            _ => picture.clone(),
        };
        let (color, is_fixed) = background::choose(background, &target, mattes[0]);
        let surface = |&matte: &Rgb| {
            // On two mattes, the background is the matte itself.
            let color = if mattes.len() == 1 { color } else { matte };
            let target = target.flattened(matte);
            let backdrop = if ground.is_empty() {
                AnyBackdrop::Color(color)
            } else {
                let [width, height] = [target.width(), target.height()];
                let scene = Scene {
                    ground: ground.clone(),
                    ..Scene::empty(width as u32, height as u32, None)
                };
                let page = Image::new(width, height, render::ground(&scene, color))?;
                let color = Some(color).filter(|_| matches!(background, Background::Color(_)));
                AnyBackdrop::Picture(color, Pyramid::new(page))
            };
            Ok(Surface::new(target, matte, backdrop, scale))
        };
        Ok(Self {
            surfaces: mattes.iter().map(surface).collect::<Result<_>>()?,
            background_fixed: is_fixed || mattes.len() > 1 || !ground.is_empty(),
            ground,
            target,
        })
    }

    fn on_document(picture: &Image, svg: &str, scale: f32) -> Result<Self> {
        let surface = |&matte: &Rgb| {
            let target = picture.flattened(matte);
            let below = Pyramid::new(verify::render_like(svg, &target, matte)?);
            let backdrop = AnyBackdrop::Picture(None, below);
            Ok(Surface::new(target, matte, backdrop, scale))
        };
        let mattes = mattes(picture, Background::None);
        Ok(Self {
            target: picture.clone(),
            surfaces: mattes.iter().map(surface).collect::<Result<_>>()?,
            background_fixed: true,
            ground: Vec::new(),
        })
    }
}

/// The mattes that a drawing of `picture` is fitted on: two if the picture has alpha and no background colour is set.
fn mattes(picture: &Image, background: Background) -> Vec<Rgb> {
    match (picture.alpha(), background) {
        (Some(_), Background::Auto | Background::None) => vec![BLACK, WHITE],
        _ => vec![background::matte(background, picture)],
    }
}

/// The backdrop of all strokes, frozen and free, at any resolution.
enum AnyBackdrop {
    Color(Rgb),
    /// A ground on the background of this colour or, if there is none, on the matte; or the render of a base's document.
    Picture(Option<Rgb>, Pyramid),
}

impl AnyBackdrop {
    fn canvas(&self, grid: Grid, halvings: usize) -> Canvas {
        match self {
            Self::Color(color) => Canvas::flat(grid, *color),
            Self::Picture(_, pyramid) => Canvas::from_image(pyramid.level(halvings)),
        }
    }

    /// The backdrop of the free strokes: the canvas `below` if it holds `frozen` strokes, a ground or a document.
    fn backdrop<'a>(&self, below: &'a Canvas, frozen: usize) -> Backdrop<'a> {
        match self {
            Self::Color(color) if frozen == 0 => Backdrop::Color(*color),
            _ => Backdrop::Canvas(below),
        }
    }
}

/// Target, backdrop and canvas on one matte, at the current resolution of the drawing.
pub(in crate::fit) struct Surface {
    /// The matte that the SVG is rendered on.
    pub(in crate::fit) matte: Rgb,
    backdrop: AnyBackdrop,
    /// The picture on the matte, and its reductions.
    pyramid: Pyramid,
    /// Number of times that the picture is halved.
    halvings: usize,
    /// Where errors count, if not everywhere alike.
    focus: Option<Focus>,
    /// The roots of the weights of errors, at the current resolution; `None` where all count alike.
    error_weights: Option<Canvas>,
    /// The picture, halved, and multiplied by these roots.
    target: Target,
    /// The frozen strokes, rendered over the backdrop of all.
    frozen: Canvas,
    /// The last render of all strokes, with the final edge.
    pub(in crate::fit) canvas: Canvas,
}

impl Surface {
    fn new(target: Image, matte: Rgb, backdrop: AnyBackdrop, scale: f32) -> Self {
        let pyramid = Pyramid::new(target);
        let halvings = halvings(&pyramid, scale);
        let target = Target::new(Canvas::from_image(pyramid.level(halvings)), None);
        let frozen = backdrop.canvas(target.grid(), halvings);
        Self {
            matte,
            backdrop,
            halvings,
            canvas: frozen.clone(),
            frozen,
            focus: None,
            error_weights: None,
            target,
            pyramid,
        }
    }

    /// Lets errors count as `focus` says, everywhere alike if `None`. Nothing may be frozen.
    pub(in crate::fit) fn focus_on(&mut self, focus: Option<&Focus>) {
        if focus.is_some() || self.focus.is_some() {
            self.focus = focus.cloned();
            self.halve(self.halvings);
        }
    }

    /// The roots of the weights of errors, at the current resolution; `None` where all count alike.
    pub(in crate::fit) fn error_weights(&self) -> Option<&Canvas> {
        self.error_weights.as_ref()
    }

    /// The target that is `canvas`, with the weights of errors.
    pub(in crate::fit) fn target_of(&self, canvas: Canvas) -> Target {
        let roots = self.error_weights.as_ref();
        let canvas = match roots {
            Some(roots) => canvas.multiplied(roots),
            None => canvas,
        };
        Target::new(canvas, roots)
    }

    /// The grid of the canvases, at the current resolution.
    pub(in crate::fit) fn grid(&self) -> Grid {
        self.target.grid()
    }

    /// Number of times that the picture is halved.
    pub(in crate::fit) fn halvings(&self) -> usize {
        self.halvings
    }

    /// The picture at full resolution.
    pub(in crate::fit) fn picture(&self) -> &Image {
        self.pyramid.level(0)
    }

    /// The background's colour, unless the drawing is on top of a document.
    pub(in crate::fit) fn color(&self) -> Option<Rgb> {
        match self.backdrop {
            AnyBackdrop::Color(color) => Some(color),
            AnyBackdrop::Picture(color, _) => color,
        }
    }

    /// Mutable access to the background's colour.
    pub(in crate::fit) fn color_mut(&mut self) -> Option<&mut Rgb> {
        match &mut self.backdrop {
            AnyBackdrop::Color(color) => Some(color),
            AnyBackdrop::Picture(..) => None,
        }
    }

    /// Most halvings that leave strokes of `scale` px of the picture at their least scale or above.
    pub(in crate::fit) fn halvings_for(&self, scale: f32) -> usize {
        halvings(&self.pyramid, scale)
    }

    /// Switches to the picture halved `halvings` times, with nothing frozen.
    pub(in crate::fit) fn halve(&mut self, halvings: usize) {
        // Every canvas of this resolution depends on the level of the pyramid, the weights included, so all are made anew.
        self.halvings = halvings;
        self.error_weights = self.focus.as_ref().map(|focus| focus.roots(halvings));
        self.target = self.target_of(Canvas::from_image(self.pyramid.level(halvings)));
        self.frozen = self.backdrop.canvas(self.target.grid(), halvings);
        self.canvas.clone_from(&self.frozen);
    }

    /// Makes the canvas the backdrop of the free strokes.
    pub(in crate::fit) fn freeze(&mut self) {
        self.frozen.clone_from(&self.canvas);
        self.target.forget_backdrop();
    }

    /// Makes the backdrop of all strokes the backdrop of the free ones.
    pub(in crate::fit) fn thaw(&mut self) {
        // Of a flat background no canvas is kept: renders of all strokes begin with its colour.
        if let AnyBackdrop::Picture(..) = self.backdrop {
            self.frozen = self.backdrop.canvas(self.grid(), self.halvings);
        }
        self.target.forget_backdrop();
    }

    /// The backdrop of the free strokes if `frozen` others are frozen.
    pub(in crate::fit) fn backdrop(&self, frozen: usize) -> Backdrop<'_> {
        self.backdrop.backdrop(&self.frozen, frozen)
    }

    /// The backdrop of the strokes of `scene`, in a drawing without frozen strokes.
    pub(in crate::fit) fn backdrop_of(&self, scene: &Scene) -> Backdrop<'_> {
        match scene.background {
            Some(color) if scene.ground.is_empty() => Backdrop::Color(color),
            _ => self.backdrop(0),
        }
    }

    /// The backdrop of the strokes of `scene`, as a canvas.
    pub(in crate::fit) fn backdrop_canvas(&self, scene: &Scene) -> Canvas {
        match self.backdrop_of(scene) {
            Backdrop::Color(color) => Canvas::flat(self.grid(), color),
            Backdrop::Canvas(canvas) => canvas.clone(),
        }
    }

    /// Renders the `free` strokes, on top of `frozen` others, to the canvas.
    pub(in crate::fit) fn render(
        &mut self,
        renderer: &mut Renderer,
        free: &Strokes,
        edge: Softness,
        frozen: usize,
    ) {
        let backdrop = self.backdrop.backdrop(&self.frozen, frozen);
        renderer.forward(free, edge, backdrop, &mut self.canvas);
    }

    /// The mean squared error of `canvas`, at the current resolution.
    pub(in crate::fit) fn mse_of(&self, canvas: &Canvas) -> f64 {
        self.objective(None).of(canvas)
    }

    /// The loss against the picture, or against `target`.
    pub(in crate::fit) fn objective<'a>(&'a self, target: Option<&'a Target>) -> Objective<'a> {
        Objective::squared(target.unwrap_or(&self.target)).weighted(self.error_weights())
    }

    /// The backdrop of all strokes, at full resolution.
    pub(in crate::fit) fn full_backdrop(&self) -> Canvas {
        let picture = self.picture();
        let full = Grid::new(picture.width(), picture.height());
        self.backdrop.canvas(full, 0)
    }

    /// The picture and a canvas at any resolution.
    pub(in crate::fit) fn residual_of<'a>(&'a self, canvas: &'a Canvas) -> Residual<'a> {
        Residual {
            target: &self.pyramid,
            canvas,
            weights: self.focus.as_ref().map(Focus::weights),
        }
    }

    /// Picture and canvas, to search for candidates in.
    pub(in crate::fit) fn residual(&self) -> Residual<'_> {
        self.residual_of(&self.canvas)
    }
}

/// Most halvings that leave strokes of `scale` px a scale of [`MIN_SCALE`] or more.
fn halvings(pyramid: &Pyramid, scale: f32) -> usize {
    // `Pyramid::halvings` rounds up; with half the scale it leaves one halving less.
    pyramid.halvings(0, scale / 2.0, MIN_SCALE)
}

/// The transparent picture that looks like these on black and on white.
pub(in crate::fit) fn transparent(black: &Image, white: &Image) -> Result<Image> {
    let channels = || black.planes().iter().zip(white.planes());
    // P on black, P + (1 − A) on white: A is 1 less their difference, a mean over the channels.
    let mut alpha = vec![1.0; black.width() * black.height()];
    for (black, white) in channels() {
        for ((a, b), w) in alpha.iter_mut().zip(black).zip(white) {
            *a -= (w - b) / 3.0;
        }
    }
    let straight = |plane: &[f32]| {
        let pixels = plane.iter().zip(&alpha);
        pixels
            .map(|(&p, &a)| if a > 0.0 { p / a } else { 0.0 })
            .collect()
    };
    // On black the picture is premultiplied, and straight colour is P / A.
    let planes = [0, 1, 2].map(|c| straight(&black.planes()[c]));
    Image::new(black.width(), black.height(), planes)?.with_alpha(alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Image {
        let plane = |k: f32| vec![0.25 * k, 0.1 * k, 0.5];
        let image = Image::new(3, 1, [plane(1.0), plane(2.0), plane(3.0)]).unwrap();
        image.with_alpha(vec![1.0, 0.5, 0.25]).unwrap()
    }

    #[test]
    fn black_and_white_tell_colour_and_alpha() {
        let glass = glass();
        let seen = transparent(&glass.flattened(BLACK), &glass.flattened(WHITE)).unwrap();
        for (a, b) in seen.planes().iter().zip(glass.planes()) {
            assert!(
                a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6),
                "{a:?} {b:?}"
            );
        }
        let alphas = seen.alpha().unwrap().iter().zip(glass.alpha().unwrap());
        assert!(alphas.into_iter().all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn only_a_picture_with_alpha_and_without_a_background_to_lie_on_is_transparent() {
        let (glass, wall) = (glass(), Image::filled(3, 1, [0.5; 3]).unwrap());
        let count = |picture, background| mattes(picture, background).len();
        assert_eq!(count(&glass, Background::Auto), 2);
        assert_eq!(count(&glass, Background::None), 2);
        assert_eq!(count(&glass, Background::Color(WHITE)), 1);
        assert_eq!(count(&wall, Background::Auto), 1);
        assert_eq!(count(&wall, Background::None), 1);
    }
}
