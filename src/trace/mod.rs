//! Tracing: from the residual to strokes that follow the lines in it.
//!
//! ```text
//! areas      the pixels by colour; antialiased ones belong to the nearer of the colours beside them
//! shape      the connected shapes of each colour
//! skeleton   the middle of each shape, as a graph
//! lines      the graph's edges, joined to long lines that run through crossings
//! bridges    lines that go on below others, and rings
//! spline     corners and control points
//! gain       the share of the residual that each stroke explains
//! recipe     the tuned numbers of all that
//! ```
//!
//! The result has the right lines, about a pixel off their places; descent makes it exact.

mod areas;
mod bridges;
mod gain;
mod lines;
mod recipe;
mod shape;
mod skeleton;
mod spline;

use std::borrow::Cow;

use rayon::prelude::*;

use crate::image::Image;
use crate::scene::{Path, Stroke};
use crate::seed::Residual;
use areas::{Areas, Label, Pixel, Pixels, Planes};
use bridges::Colored;
use gain::Gain;
use lines::Line;
pub use recipe::{AreaColors, Bridges, LineJoins, Splines, Tracing};
use shape::Shape;
use skeleton::Graph;

/// A traced stroke and what it gains.
#[derive(Debug, Clone)]
pub struct Traced {
    /// The stroke, opaque.
    pub stroke: Stroke,
    /// Squared error that the stroke alone would remove, summed over pixels and channels.
    pub gain: f32,
}

/// Traces the lines of full-size pictures on their canvases, which have one size. The strokes are in painting order.
pub fn trace(residuals: &[Residual<'_>], tracing: Tracing) -> Vec<Traced> {
    let Some(pixels) = Pixels::of(residuals) else {
        return Vec::new();
    };
    // Areas of one colour. A picture without them, such as a photograph, has no lines that could be traced.
    let Some(areas) = Areas::of(&pixels, tracing.min_flat_share, tracing.colors) else {
        return Vec::new();
    };
    // Connected shapes, and the lines in the middle of each.
    let keys: Vec<Option<u8>> = areas
        .labels
        .iter()
        .map(|label| match label {
            Label::Color(color) => Some(*color),
            _ => None,
        })
        .collect();
    let shapes = shape::shapes(&keys, pixels.width, tracing.least_area);
    let colored = |(color, shape): &(u8, Shape)| {
        let mut lines = lines::lines(Graph::of(shape, tracing.growth), tracing.lines);
        widen(&mut lines, area(shape, *color, &areas, &pixels));
        let colored = |line: Line| Colored {
            line,
            color: *color,
            is_covered: false,
        };
        lines.into_iter().map(colored).collect::<Vec<_>>()
    };
    let lines: Vec<Colored> = shapes.par_iter().flat_map_iter(colored).collect();
    // Lines that others cover become one before they are drawn, since their halves would be two strokes for ever.
    let lines = bridges::bridged(lines, &areas, &pixels, tracing.bridges);
    // Strokes along those lines, if they explain what is there.
    let mattes = residuals.len();
    let traced = |line: &Colored| stroke(line, &areas, &pixels, mattes, &tracing);
    let mut strokes: Vec<(bool, Traced)> = lines.par_iter().filter_map(traced).collect();
    // Lines that go on below others are drawn before them, and wide strokes before narrow ones.
    strokes.sort_by(|a, b| {
        let radius = |t: &(bool, Traced)| t.1.stroke.radius;
        (b.0.cmp(&a.0)).then(radius(b).total_cmp(&radius(a)))
    });
    strokes.into_iter().map(|(_, traced)| traced).collect()
}

/// The area of a shape, px², to which antialiased pixels add as much as is covered of them.
fn area(shape: &Shape, color: u8, areas: &Areas, pixels: &Pixels<'_>) -> f32 {
    let Some(color) = areas.colors.get(usize::from(color)) else {
        return 0.0;
    };
    let around = shape.with_border();
    let places = around.filter_map(|[x, y]| {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < pixels.width && y < pixels.height).then_some(y * pixels.width + x)
    });
    places.map(|i| pixels.coverage(i, color)).sum()
}

/// Scales the radii of the lines of a shape so that they cover its `area`. The distances that they come from are whole
/// pixels.
fn widen(lines: &mut [Line], area: f32) {
    let covered: f32 = lines.iter().map(Line::area).sum();
    let factor = (area / covered.max(f32::MIN_POSITIVE)).clamp(0.5, 2.0);
    for spot in lines.iter_mut().flat_map(|line| &mut line.spots) {
        spot.radius *= factor;
    }
}

/// The stroke along a line, if it explains what lies under it.
fn stroke(
    Colored {
        line,
        color,
        is_covered,
    }: &Colored,
    areas: &Areas,
    pixels: &Pixels<'_>,
    mattes: usize,
    tracing: &Tracing,
) -> Option<(bool, Traced)> {
    let radius = median(line.spots.iter().map(|spot| spot.radius))?;
    let path: Path = spline::path(line, radius, tracing.splines);
    let pixel: &Pixel = areas.colors.get(usize::from(*color))?;
    let gain = Gain::of(&path, radius, *color, pixel, areas, pixels);
    let is_explained = gain.removed > tracing.explained * gain.under;
    let stroke = Stroke {
        path,
        radius,
        color: areas::color(pixel, mattes).map(|c| c.clamp(0.0, 1.0)),
        opacity: 1.0,
    };
    let gain = gain.removed / mattes as f32;
    is_explained.then_some((*is_covered, Traced { stroke, gain }))
}

fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
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
mod tests {
    use super::*;
    use crate::fit::{Preset, Recipe};
    use crate::image::Image;
    use crate::render::{Canvas, Grid};
    use crate::rng;
    use crate::seed::Pyramid;
    use crate::verify::{self, Size};

    /// Strokes that are traced of an SVG of 96×96 px, on white.
    fn traced(content: &str) -> Vec<Traced> {
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="96" height="96" fill="none" stroke-linecap="round" stroke-linejoin="round">{content}</svg>"#
        );
        let picture = verify::render(&svg, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        traced_of(picture)
    }

    fn traced_of(picture: Image) -> Vec<Traced> {
        let canvas = Canvas::flat(Grid::new(picture.width(), picture.height()), [1.0; 3]);
        let target = Pyramid::new(picture);
        let residual = Residual {
            target: &target,
            canvas: &canvas,
            weights: None,
        };
        trace(&[residual], Recipe::of(Preset::Balanced).tracing)
    }

    #[test]
    fn a_clock_is_a_ring_and_its_hands() {
        let found = traced(
            r##"<g stroke="#204080" stroke-width="7"><circle cx="48" cy="48" r="38"/><path d="M48 24v24l16 8"/></g>"##,
        );
        assert_eq!(found.len(), 2);
        for Traced { stroke, gain } in &found {
            assert!((stroke.radius - 3.5).abs() < 0.5, "{}", stroke.radius);
            let wanted = [0x20, 0x40, 0x80].map(|c: u8| f32::from(c) / 255.0);
            let away = stroke.color.iter().zip(wanted).map(|(a, b)| (a - b).abs());
            assert!(away.fold(0.0, f32::max) < 0.02, "{:?}", stroke.color);
            assert!(*gain > 0.0);
        }
        assert_eq!(
            found.iter().filter(|t| t.stroke.path.is_closed()).count(),
            1
        );
    }

    #[test]
    fn a_line_below_another_is_one_and_is_drawn_first() {
        let found = traced(
            r##"<path d="M10 30L86 60" stroke="#d02020" stroke-width="5"/><path d="M40 8L52 88" stroke="#2040d0" stroke-width="8"/>"##,
        );
        assert_eq!(found.len(), 2);
        assert!(found[0].stroke.color[0] > 0.7, "{:?}", found[0].stroke);
    }

    #[test]
    fn nothing_is_traced_of_noise_or_of_an_empty_page() {
        let noise = |channel: u64| {
            let value = |i: u64| rng::draw(7, channel, i, 0);
            (0..96 * 96).map(value).collect()
        };
        let picture = Image::new(96, 96, [0, 1, 2].map(noise)).unwrap();
        assert!(traced_of(picture).is_empty());
        assert!(traced_of(Image::filled(96, 96, [1.0; 3]).unwrap()).is_empty());
        assert!(trace(&[], Recipe::of(Preset::Balanced).tracing).is_empty());
    }
}
