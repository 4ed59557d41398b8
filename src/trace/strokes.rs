//! Strokes along the lines of a picture.

use rayon::prelude::*;

use super::areas::{self, Areas, Pixel, Pixels};
use super::bridges::{self, Colored};
use super::gain::Gain;
use super::lines::{self, Line};
use super::parts::{Part, Parts};
use super::shape::{self, Shape};
use super::skeleton::Graph;
use super::spline;
use super::tracing::Tracing;
use crate::math::median;
use crate::scene::{Cap, Path, Stroke};

/// The share of the squared residual under a stroke that the stroke has to remove. 0.4, 0.6, 0.75: text has 200, 215, 253 strokes at
/// equal fidelity, as bars of letters one pixel thin are hardly explained before they are fitted.
const EXPLAINED: f32 = 0.4;

/// A traced stroke, and what it gains alone.
#[derive(Debug, Clone)]
pub(super) struct TracedStroke {
    pub(super) stroke: Stroke,
    /// Its colour in the picture.
    pub(super) pixel: Pixel,
    pub(super) gain: f32,
    /// True if it goes on below others.
    pub(super) is_covered: bool,
    /// The part that it is of a shape that came apart.
    pub(super) part: Part,
}

/// The strokes along the lines of some areas, in painting order.
pub(super) fn strokes(
    pixels: &Pixels<'_>,
    areas: &Areas,
    parts: &Parts,
    mattes: usize,
    tracing: Tracing,
) -> Vec<TracedStroke> {
    // Connected shapes, and the lines in the middle of each.
    let keys = areas.colors_of_pixels().enumerate();
    let keys: Vec<Option<(u8, Part)>> =
        keys.map(|(i, color)| Some((color?, parts.at(i)))).collect();
    let shapes = shape::shapes(&keys, pixels.width, tracing.least_pixels());
    let colored = |((color, part), shape): &((u8, Part), Shape)| {
        let mut lines = lines::lines(Graph::of(shape));
        widen(
            &mut lines,
            area(shape, (*color, *part), areas, parts, pixels),
        );
        let colored = |line: Line| Colored {
            line,
            color: *color,
            is_covered: false,
            part: *part,
        };
        lines.into_iter().map(colored).collect::<Vec<_>>()
    };
    let lines: Vec<Colored> = shapes.par_iter().flat_map_iter(colored).collect();
    // Lines that others cover become one before they are drawn, since their halves would be two strokes for ever.
    let mut lines = bridges::bridged(lines, areas, parts, pixels);
    lines
        .iter_mut()
        .for_each(|line| line.reach_into_blobs(parts, pixels));
    // Strokes along those lines, if they explain what is there.
    let traced = |line: &Colored| stroke(line, areas, pixels, mattes);
    let mut strokes: Vec<TracedStroke> = lines.par_iter().filter_map(traced).collect();
    // Lines that go on below others are drawn before them, and wide strokes before narrow ones.
    strokes.sort_by(|a, b| {
        let radius = |traced: &TracedStroke| traced.stroke.radius;
        (b.is_covered.cmp(&a.is_covered)).then(radius(b).total_cmp(&radius(a)))
    });
    strokes
}

/// The area of a shape, px², to which antialiased pixels add as much as is covered of them.
fn area(
    shape: &Shape,
    (color, part): (u8, Part),
    areas: &Areas,
    parts: &Parts,
    pixels: &Pixels<'_>,
) -> f32 {
    let Some(color) = areas.colors.get(usize::from(color)) else {
        return 0.0;
    };
    let around = shape.with_border();
    let places = around.filter_map(|[x, y]| {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < pixels.width && y < pixels.height).then_some(y * pixels.width + x)
    });
    let places = places.filter(|&i| [Part::Whole, part].contains(&parts.at(i)));
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
        part,
    }: &Colored,
    areas: &Areas,
    pixels: &Pixels<'_>,
    mattes: usize,
) -> Option<TracedStroke> {
    let radius = median(line.spots.iter().map(|spot| spot.radius))?;
    let path: Path = spline::path(line, radius);
    let pixel: &Pixel = areas.colors.get(usize::from(*color))?;
    let gain = Gain::of(&path, radius, *color, pixel, areas, pixels);
    let is_explained = gain.removed > EXPLAINED * gain.under;
    // On top of a drawing, descent finds the opacity.
    let mut places = line.spots.iter().filter_map(|spot| pixels.at(spot.at));
    let (color, opacity) = match places.all(|i| pixels.is_clear(i)) {
        true => areas::ink(pixel, mattes),
        false => (areas::color(pixel, mattes), 1.0),
    };
    let stroke = Stroke {
        path,
        radius: radius.into(),
        radii: Vec::new(),
        cap: Cap::Round,
        color,
        opacity,
    };
    let gain = gain.removed / mattes as f32;
    is_explained.then_some(TracedStroke {
        stroke,
        pixel: *pixel,
        gain,
        is_covered: *is_covered,
        part: *part,
    })
}
