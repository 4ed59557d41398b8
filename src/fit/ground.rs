//! What lies under all strokes, and what the picture looks like there.
//!
//! An opaque drawing has one ground. A transparent one is fitted on two at once, black and white: a
//! drawing of premultiplied colour P and alpha A looks like P + (1 − A)·g on a ground g, which is linear
//! in every channel of g, so that what is right on black and on white is right on every ground. Losses,
//! gradients, worths and gains are means over the grounds.

use super::background::Background;
use super::base::Base;
use super::objective::{Objective, View};
use crate::error::Result;
use crate::image::Image;
use crate::loss::Loss;
use crate::render::{Backdrop, Canvas, Grid, Params, Renderer, Softness};
use crate::scene::{Rgb, Scene};
use crate::seed::{self, Pyramid};
use crate::verify;

const BLACK: Rgb = [0.0; 3];
const WHITE: Rgb = [1.0; 3];

/// Strokes are fitted at the coarsest resolution at which they still have this typical radius, px. Less,
/// and their edges are fitted to pixels that are not there; more, and time is spent on pixels that say
/// nothing about them.
const MIN_SCALE: f32 = 2.5;

/// What lies under all strokes.
pub(super) enum Floor {
    /// One colour.
    Flat(Rgb),
    /// A picture: what a foreign SVG looks like.
    Picture(Pyramid),
}

impl Floor {
    /// The floor at a resolution halved `halvings` times, whose grid is `grid`.
    fn canvas(&self, grid: Grid, halvings: usize) -> Canvas {
        match self {
            Self::Flat(color) => Canvas::flat(grid, *color),
            Self::Picture(pyramid) => Canvas::from_image(pyramid.level(halvings)),
        }
    }

    /// What lies behind strokes: the floor itself, or the picture `below` where it has `frozen` others.
    fn base<'a>(&self, below: &'a Canvas, frozen: usize) -> Backdrop<'a> {
        match self {
            Self::Flat(color) if frozen == 0 => Backdrop::Color(*color),
            _ => Backdrop::Canvas(below),
        }
    }
}

/// How a picture is to be looked at.
pub(super) struct Setting {
    /// The picture to be drawn: opaque unless there are two grounds.
    pub(super) target: Image,
    /// One, or two for a transparent drawing.
    pub(super) grounds: Vec<Ground>,
    /// Whether the colour of the only ground is not to be fitted.
    pub(super) is_fixed: bool,
}

impl Setting {
    /// The grounds for drawing `picture` on `start`, or on a `background`, with strokes of `scale` px
    /// at first.
    pub(super) fn new(
        picture: &Image,
        background: Background,
        start: Option<&Base>,
        scale: f32,
    ) -> Result<Self> {
        let Some(Base {
            document, scene, ..
        }) = start
        else {
            return Ok(Self::on_color(picture, background, scale));
        };
        if let Some(document) = document {
            return Self::on_svg(picture, document.text(), scale);
        }
        let background = scene.background.map_or(Background::None, Background::Color);
        Ok(Self::on_color(picture, background, scale))
    }

    fn on_color(picture: &Image, background: Background, scale: f32) -> Self {
        let papers = papers(picture, background);
        let target = match *papers {
            [_] => picture.flattened(background.ground()),
            _ => picture.clone(),
        };
        let (color, is_fixed) = background.choose(&target);
        let ground = |&paper: &Rgb| {
            let color = if papers.len() == 1 { color } else { paper };
            Ground::new(target.flattened(paper), paper, Floor::Flat(color), scale)
        };
        Self {
            grounds: papers.iter().map(ground).collect(),
            is_fixed: is_fixed || papers.len() > 1,
            target,
        }
    }

    fn on_svg(picture: &Image, svg: &str, scale: f32) -> Result<Self> {
        let ground = |&paper: &Rgb| {
            let target = picture.flattened(paper);
            let floor = Pyramid::new(verify::render_like(svg, &target, paper)?);
            Ok(Ground::new(target, paper, Floor::Picture(floor), scale))
        };
        let papers = papers(picture, Background::None);
        Ok(Self {
            target: picture.clone(),
            grounds: papers.iter().map(ground).collect::<Result<_>>()?,
            is_fixed: true,
        })
    }
}

/// What the SVG is to be laid on: a drawing is transparent where the picture is, unless there is a colour
/// to lay the picture on.
fn papers(picture: &Image, background: Background) -> Vec<Rgb> {
    match (picture.alpha(), background) {
        (Some(_), Background::Auto | Background::None) => vec![BLACK, WHITE],
        _ => vec![WHITE],
    }
}

/// One ground, at the resolution that the drawing has.
pub(super) struct Ground {
    /// What the SVG is laid on when it is rendered.
    pub(super) paper: Rgb,
    floor: Floor,
    /// The picture as it looks on the paper, and its reductions.
    pyramid: Pyramid,
    /// How many times the picture is halved.
    halvings: usize,
    /// The picture, halved.
    target: Canvas,
    /// The picture of the frozen strokes on the floor.
    below: Canvas,
    /// The picture of all strokes as they were last rendered, with the final edge.
    pub(super) canvas: Canvas,
}

impl Ground {
    fn new(target: Image, paper: Rgb, floor: Floor, scale: f32) -> Self {
        let pyramid = Pyramid::new(target);
        let halvings = resolution(&pyramid, scale);
        let target = Canvas::from_image(pyramid.level(halvings));
        let below = floor.canvas(target.grid(), halvings);
        Self {
            paper,
            floor,
            halvings,
            canvas: below.clone(),
            below,
            target,
            pyramid,
        }
    }

    /// How the picture is cut, at the current resolution.
    pub(super) fn grid(&self) -> Grid {
        self.target.grid()
    }

    /// How many times the picture is halved.
    pub(super) fn halvings(&self) -> usize {
        self.halvings
    }

    /// The picture at full resolution.
    pub(super) fn picture(&self) -> &Image {
        self.pyramid.level(0)
    }

    /// The colour of the floor if it is flat.
    pub(super) fn color(&self) -> Option<Rgb> {
        match self.floor {
            Floor::Flat(color) => Some(color),
            Floor::Picture(_) => None,
        }
    }

    /// The colour of the floor if it is flat, to be changed.
    pub(super) fn color_mut(&mut self) -> Option<&mut Rgb> {
        match &mut self.floor {
            Floor::Flat(color) => Some(color),
            Floor::Picture(_) => None,
        }
    }

    /// Goes to the resolution for strokes of `scale` px if that is finer than the current one; says by
    /// how many doublings. Nothing is frozen then.
    pub(super) fn refine(&mut self, scale: f32) -> usize {
        let halvings = resolution(&self.pyramid, scale);
        let doublings = self.halvings.saturating_sub(halvings);
        if doublings > 0 {
            self.enter(halvings);
        }
        doublings
    }

    /// Goes to the picture halved so many times. Nothing is frozen then.
    pub(super) fn enter(&mut self, halvings: usize) {
        self.halvings = halvings;
        self.target = Canvas::from_image(self.pyramid.level(halvings));
        self.below = self.floor.canvas(self.target.grid(), halvings);
        self.canvas.clone_from(&self.below);
    }

    /// Takes the canvas for what lies below the free strokes.
    pub(super) fn freeze(&mut self) {
        self.below.clone_from(&self.canvas);
    }

    /// Takes the floor for what lies below the free strokes.
    pub(super) fn thaw(&mut self) {
        if let Floor::Picture(pyramid) = &self.floor {
            self.below = Canvas::from_image(pyramid.level(self.halvings));
        }
    }

    /// What lies behind the free strokes, of which `frozen` lie below.
    pub(super) fn base(&self, frozen: usize) -> Backdrop<'_> {
        self.floor.base(&self.below, frozen)
    }

    /// What lies behind the strokes of `scene`, in a drawing without frozen strokes.
    pub(super) fn base_of(&self, scene: &Scene) -> Backdrop<'_> {
        scene.background.map_or(self.base(0), Backdrop::Color)
    }

    /// The page that the strokes of `scene` are drawn on.
    pub(super) fn page(&self, scene: &Scene) -> Canvas {
        match self.base_of(scene) {
            Backdrop::Color(color) => Canvas::flat(self.grid(), color),
            Backdrop::Canvas(canvas) => canvas.clone(),
        }
    }

    /// Renders the `free` strokes, on `frozen` others, to the canvas.
    pub(super) fn render(
        &mut self,
        renderer: &mut Renderer,
        free: &[Params],
        edge: Softness,
        frozen: usize,
    ) {
        let base = self.floor.base(&self.below, frozen);
        renderer.forward(free, edge, base, &mut self.canvas);
    }

    /// The mean squared error of `canvas`, at the current resolution.
    pub(super) fn loss_of(&self, canvas: &Canvas) -> f64 {
        Objective::new(Loss::L2, &self.target).of(canvas)
    }

    /// What the free strokes lie on, and what they are to look like there: the picture, or `target`.
    pub(super) fn view<'a>(&'a self, frozen: usize, target: Option<&'a Canvas>) -> View<'a> {
        View {
            base: self.base(frozen),
            objective: Objective::new(Loss::L2, target.unwrap_or(&self.target)),
        }
    }

    /// Picture and canvas, for seeding.
    pub(super) fn residual(&self) -> seed::View<'_> {
        seed::View {
            target: &self.pyramid,
            canvas: &self.canvas,
        }
    }
}

/// How many halvings leave strokes of `scale` px their least scale.
fn resolution(pyramid: &Pyramid, scale: f32) -> usize {
    // Rounded down: `halvings` alone would bring the scale below the least.
    pyramid.halvings(0, scale / 2.0, MIN_SCALE)
}

/// The picture that looks like this on black and on white.
pub(super) fn transparent(black: &Image, white: &Image) -> Result<Image> {
    let channels = || black.planes().iter().zip(white.planes());
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
    fn only_a_picture_with_alpha_and_without_a_colour_to_lie_on_is_transparent() {
        let (glass, wall) = (glass(), Image::filled(3, 1, [0.5; 3]).unwrap());
        let count = |picture, background| papers(picture, background).len();
        assert_eq!(count(&glass, Background::Auto), 2);
        assert_eq!(count(&glass, Background::None), 2);
        assert_eq!(count(&glass, Background::Color(WHITE)), 1);
        assert_eq!(count(&wall, Background::Auto), 1);
        assert_eq!(count(&wall, Background::None), 1);
    }
}
