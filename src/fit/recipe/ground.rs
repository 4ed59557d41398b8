//! The ground: tuned numbers of the choice of what lies behind all marks.

pub use crate::shading::ShadeFit;
use crate::trace::Outlines;

/// Choice of the background.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackgroundChoice {
    /// The most common colour becomes the background if at least this share of the pixels has it; otherwise the mean
    /// colour does.
    pub prevailing_share: f64,
    /// Share of the pixels along the border from which on their most common colour is the background. A guess: three of
    /// eleven logos on white had the logo's colour as paper.
    pub border_share: f64,
    /// Share of the border that has about one colour, from which on it is spotted paper of that colour. A guess.
    pub spotted_share: f64,
    /// Farthest that the spots of paper are from its colour, levels of 8 bits. A guess.
    pub spots: u8,
    /// Share of the pixels in translucent areas that opaque strokes may miss. Beyond it, the picture is flattened onto
    /// white for them.
    pub translucent_share: f64,
    /// Pixels with alpha between these are translucent.
    pub translucent: [f32; 2],
    /// When a gradient becomes the page.
    pub shade: ShadeChoice,
    /// When there are shadows on it.
    pub shadow: ShadowChoice,
}

/// When a gradient becomes the page. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadeChoice {
    /// Blocks along the longer side of the picture, whose means are fitted.
    pub blocks: usize,
    /// The least share of the blocks that a gradient has to meet.
    pub least_share: f32,
    /// Share of the blocks that it has to meet beyond those of the best single colour.
    pub least_gain: f32,
    /// Largest change of a page per px: a larger one is the edge of a thing.
    pub steepest: f32,
    /// The fit of one.
    pub fit: ShadeFit,
}

/// When there are shadows on the page. All of it is a guess, colours in 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowChoice {
    /// Largest difference from the page of what is the page.
    pub page: f32,
    /// Largest second difference of what is soft.
    pub bend: f32,
    /// Largest difference of what is soft from a mixture of the page with one colour.
    pub near: f32,
    /// The least share of the pixels that is soft.
    pub least_share: f32,
    /// Number of times that the colour is found, each time by what is near the last one.
    pub rounds: usize,
    /// Fewest pixels of what casts a shadow.
    pub least_pixels: usize,
    /// The least share of its outline that a shadow is seen along.
    pub surrounded: f32,
    /// Blocks along the longer side of the picture, whose shares are fitted.
    pub blocks: usize,
    /// Standard deviations of the blurs that are tried first, px.
    pub blurs: [f32; 8],
    /// The factor between the best of these and its neighbours; its root is the next one, and so on.
    pub blur_step: f32,
    /// Number of times that blurs are tried.
    pub refinements: usize,
    /// The first and the last step of the search for a place, blocks.
    pub shift_step: f32,
    /// The last step.
    pub shift_finest: f32,
    /// Most shadows of one thing.
    pub most: usize,
    /// Of the squared error, no second shadow is looked for below this share.
    pub explained: f32,
    /// A shadow has to leave less than this share of the squared error.
    pub least_gain: f32,
    /// All shadows have to leave less than this share of it.
    pub left: f32,
    /// Bytes of a shadow, about.
    pub bytes: f32,
    /// Blur of the pixels of what casts a shadow before its outline is traced, px: as they are, they have stairs.
    pub outline_blur: f32,
    /// Farthest that the outline of a shadow may be off, in units of its blur.
    pub outline_of_blur: f32,
    /// Farthest that an outline may be from a circle, an ellipse or a rectangle, px, to be one.
    pub shape: f32,
    /// Blocks along the longer side of the picture that a gradient is fitted to.
    pub gradient_blocks: usize,
    /// Share of the soft ones of them that a gradient has to meet to be the better explanation.
    pub gradient_share: f32,
    /// The fit of that gradient.
    pub fit: ShadeFit,
    /// Numbers of the tracing of outlines.
    pub outlines: Outlines,
}
