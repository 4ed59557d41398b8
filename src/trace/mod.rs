//! Tracing: from the residual to strokes that follow the lines in it, and to areas that fill its shapes.
//!
//! ```text
//! areas      the pixels by colour; antialiased ones belong to the nearer of the colours beside them
//! shape      the connected shapes of each colour
//! halves     lines between two rows of pixels
//! parts      lines, and what they join that is much wider
//! skeleton   the middle of each shape, as a graph
//! lines      the graph's edges, joined to long lines that run through crossings
//! bridges    lines that go on below others, and rings
//! spline     corners and control points
//! gain       the share of the residual that each stroke explains
//! strokes    all of that
//! contour    the closed lines along which a field is ½
//! fill       filled shapes, stacked
//! edge       their outlines by description length, where edges are seen
//! even       which shapes a stroke draws
//! choice     strokes or areas
//! tracing    what is looked for
//! ```
//!
//! The result has the right lines, about a pixel off their places; descent makes it exact.

mod areas;
mod bridges;
mod choice;
mod contour;
mod edge;
mod even;
mod fill;
mod gain;
mod halves;
mod ink;
mod lines;
mod parts;
mod shape;
mod skeleton;
mod spline;
mod strokes;
mod tracing;

use std::borrow::Cow;

use crate::image::Image;
use crate::scene::{Mark, Marks, Path, Stroke};
use crate::seed::Residual;
use areas::{Areas, Pixels, Planes};
use choice::Choice;
use fill::Flat;
pub(crate) use halves::Halves;
use parts::Parts;
use shape::Shape;
use strokes::TracedStroke;
pub use tracing::Tracing;

/// A traced mark and what it gains.
#[derive(Debug, Clone)]
pub struct Traced {
    /// The mark.
    pub mark: Mark,
    /// Squared error that the mark removes, summed over pixels and channels: a stroke alone, an area on top of what it
    /// lies on.
    pub gain: f32,
    /// True if the mark is where it is seen, so that no descent knows better.
    pub is_placed: bool,
}

/// The rings around what covers at least half of a pixel; `shares` are those of all pixels of a page, row by row. They are
/// as exact as `tolerance` px, or as those of areas.
pub fn rings(shares: &[f32], width: usize, tolerance: f32) -> Vec<Path> {
    fill::rings(shares, width, tolerance)
}

/// Traces full-size pictures on their canvases, which have one size. The marks are in painting order. `price` is the
/// squared error that a mark has to remove.
pub fn trace(
    residuals: &[Residual<'_>],
    tracing: Tracing,
    marks: Marks,
    price: &(dyn Fn(&Mark) -> f32 + Sync),
) -> Vec<Traced> {
    let Some(mut pixels) = Pixels::of(residuals) else {
        return Vec::new();
    };
    // Lines between two rows of pixels have no colour of their own there.
    let halves = Halves::set_on_rows(&mut pixels);
    let mut traced = marks_of(&pixels, residuals.len(), tracing, marks, price);
    if let Some(halves) = halves {
        halves.put_back(&mut traced);
    }
    traced
}

/// The marks of a picture, in painting order.
fn marks_of(
    pixels: &Pixels<'_>,
    mattes: usize,
    tracing: Tracing,
    marks: Marks,
    price: &(dyn Fn(&Mark) -> f32 + Sync),
) -> Vec<Traced> {
    // Areas of one colour. A picture without them, such as a photograph, has no lines that could be traced.
    let areas = Areas::of(pixels, tracing);
    let areas = areas.filter(|_| marks != Marks::Areas);
    let mut parts = parts(areas.as_ref(), pixels, tracing);
    let strokes_of = |parts: &Parts| match &areas {
        Some(areas) => strokes::strokes(pixels, areas, parts, mattes, tracing),
        None => Vec::new(),
    };
    let swelling = || {
        let whole = Parts::whole(pixels.width);
        let flat = Flat::of(pixels, mattes, &whole, tracing)?;
        let choice = Choice::of(&flat, strokes_of(&whole), pixels);
        choice.placed(true, price).filter(|placed| has_ink(placed))
    };
    let mut round = 0;
    loop {
        let strokes = strokes_of(&parts);
        let flat = match marks {
            Marks::Strokes => None,
            _ => Flat::of(pixels, mattes, &parts, tracing),
        };
        let Some(flat) = flat else {
            return strokes.into_iter().map(Traced::from).collect();
        };
        let choice = Choice::of(&flat, strokes, pixels);
        let may_be_ink = round == 0 && parts.are_whole();
        let placed = || choice.placed(may_be_ink, price);
        let placed = tracing.may_place.then(placed).flatten();
        // A drawing of lines stays one where they are not found before a descent.
        let has_areas = |traced: &[Traced]| traced.iter().any(|t| t.mark.as_area().is_some());
        if let Some(placed) = &placed
            && (!has_areas(placed) || has_ink(placed) || !choice.may_be_lines())
        {
            return placed.clone();
        }
        match choice.fitted(price) {
            Ok(traced) => return placed.filter(|_| has_areas(&traced)).unwrap_or(traced),
            Err(lines) => {
                // Lines that swell come apart into lines and blobs, too. Lines of one width between blobs are drawn as such.
                if round == 0
                    && tracing.may_place
                    && !parts.are_whole()
                    && let Some(placed) = swelling()
                {
                    return placed;
                }
                // What strokes do not draw stays with what it came apart from.
                let pixels = |line| flat.pixels_of(line).collect();
                let lines = lines.into_iter().map(|(shape, line)| (shape, pixels(line)));
                parts.join(lines.collect(), round < MOST_ROUNDS);
                round += 1;
            }
        }
    }
}

/// True if one of the marks is a line of varying width.
fn has_ink(traced: &[Traced]) -> bool {
    let mut strokes = traced.iter().filter_map(|t| t.mark.as_stroke());
    strokes.any(Stroke::is_varying)
}

/// The lines of a picture on its canvas that lie between two rows of pixels, if crossings tell that there are such.
pub(crate) fn halves(residual: Residual<'_>) -> Option<Halves> {
    Halves::set_on_rows(&mut Pixels::of(&[residual])?)
}

/// Rounds in which single lines of a shape are joined with its blobs, before all are. A guess.
const MOST_ROUNDS: usize = 2;

/// The parts of the shapes of all colours.
fn parts(areas: Option<&Areas>, pixels: &Pixels<'_>, tracing: Tracing) -> Parts {
    let keys: Vec<Option<u8>> =
        areas.map_or(Vec::new(), |areas| areas.colors_of_pixels().collect());
    let shapes = match areas {
        Some(_) => shape::shapes(&keys, pixels.width, tracing.least_pixels()),
        None => Vec::new(),
    };
    let shapes: Vec<&Shape> = shapes.iter().map(|(_, shape)| shape).collect();
    Parts::of(&shapes, pixels.width, pixels.width * pixels.height)
}

impl From<TracedStroke> for Traced {
    fn from(TracedStroke { stroke, gain, .. }: TracedStroke) -> Self {
        Self {
            mark: stroke.into(),
            gain,
            is_placed: false,
        }
    }
}

impl<'a> Pixels<'a> {
    /// The pixels of pictures on one or two mattes.
    fn of(residuals: &[Residual<'a>]) -> Option<Self> {
        let first = residuals.first()?;
        let size = |image: &Image| [image.width(), image.height()];
        let targets = residuals.iter().map(|r| r.target.level(0));
        let canvases: Vec<Image> = residuals.iter().map(|r| r.canvas.to_image()).collect();
        let [width, height] = size(first.target.level(0));
        if canvases.iter().any(|c| size(c) != [width, height]) {
            return None;
        }
        let target = targets.flat_map(|t| t.planes().iter().map(Cow::from));
        let canvas = canvases.into_iter().flat_map(Image::into_planes);
        Some(Self {
            width,
            height,
            target: Planes(target.collect()),
            canvas: Planes(canvas.map(Cow::from).collect()),
            weights: first.weights.map(|weights| &*weights.level(0).planes()[0]),
        })
    }
}

#[cfg(test)]
mod tests;
