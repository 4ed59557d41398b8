//! Inks: a thin line has the colour that the picture has along its middle.
//!
//! A line of a pixel or two looks the same if it is darker and narrower, or less opaque, so a fit may end at any of these. The
//! picture shows which is right where the line covers whole pixels: there it has its colour. A line between two rows shows it
//! only at crossings.

use super::proposals::{Each, adopt, traced};
use crate::fit::config::Colors;
use crate::fit::descent::ties::Ties;
use crate::fit::drawing::Drawing;
use crate::fit::run::session::Session;
use crate::image::Image;
use crate::math::{Point, median};
use crate::render::STYLE;
use crate::scene::{Cap, Rgb, Stroke};
use crate::trace;

// All of these are guesses.
/// Lines of a larger radius, px, have the colours that they were fitted.
const THIN: f32 = 2.0;
/// Lines of a smaller one, px, cover no pixel as a whole.
const LEAST_RADIUS: f32 = 0.85;
/// Distance from the border of a line to the page beside it, px.
const BESIDE: f64 = 2.0;
/// Largest difference of the channels of colours that are one.
const ALIKE: f32 = 0.06;
/// The share of the page beside a line that has to be one colour.
const LEAST_EVEN: f32 = 0.7;
/// A colour of a larger share of a line's contrast is near enough.
const LEAST_CHANGE: f32 = 0.95;

/// Gives thin traced lines on one colour the colours of the picture, with as much ink as before, and returns those. All
/// strokes must be free.
pub(super) fn run(session: &mut Session<'_>) -> Vec<Rgb> {
    let is_free = session.config.colors == Colors::Free && session.config.pens.is_none();
    // On two mattes colour and coverage are told apart.
    if !is_free || session.drawing.surfaces.len() > 1 || session.drawing.formed() == 0 {
        return Vec::new();
    }
    let surface = session.drawing.surface();
    let picture = surface.picture();
    let halves = trace::halves(surface.residual_of(&surface.full_backdrop()));
    let inked = |stroke: &Stroke| {
        let drawn = halves.as_ref().and_then(|halves| halves.drawn(stroke));
        drawn.or_else(|| inked(stroke, picture))
    };
    let mut colors = Vec::new();
    let proposed = traced(&session.drawing, |_, mark| {
        let stroke = inked(mark.as_stroke()?)?;
        colors.push(stroke.color);
        Some(vec![stroke.into()])
    });
    adopt(session, proposed, Each::MayLose);
    colors
}

/// Ties of the strokes that have one of the `inks`: while they settle, their colours stay, and they stay opaque.
pub(super) fn ties(drawing: &Drawing, inks: &[Rgb]) -> Ties {
    let mut ties = Ties::default();
    let strokes = drawing.free().iter().enumerate();
    for (i, _) in strokes.filter(|(_, stroke)| !stroke.is_area() && inks.contains(&stroke.color()))
    {
        let end = drawing.free().range(i).end;
        // All of the style but its first number, the radius.
        (end - STYLE + 1..end).for_each(|place| ties.fix(place));
    }
    ties
}

/// The opaque stroke of as much ink in the colour that the picture has along its middle.
fn inked(stroke: &Stroke, picture: &Image) -> Option<Stroke> {
    if stroke.cap == Cap::Butt || stroke.is_varying() || stroke.radius as f32 > THIN {
        return None;
    }
    let (middle, sides) = seen_along(stroke, picture);
    // The page beside the line has to be of one colour; otherwise the coverage of a pixel can't be measured.
    let page: Rgb = channels(|k| median(sides.iter().map(|side| side[k])))?;
    let is_page = |side: &&Rgb| (0..3).all(|k| (side[k] - page[k]).abs() < ALIKE);
    if (sides.iter().filter(is_page).count() as f32) < LEAST_EVEN * sides.len() as f32 {
        return None;
    }
    // Coverage of a place: the projection of (seen − page) onto (colour − page), in units of the latter.
    let contrast = [0, 1, 2].map(|k| stroke.color[k] - page[k]);
    let contrast2: f32 = contrast.iter().map(|c| c * c).sum();
    // A line of the page's colour has no coverage to measure.
    if contrast2 < ALIKE * ALIKE {
        return None;
    }
    let covered = |seen: &Rgb| {
        let along = (0..3).map(|k| (seen[k] - page[k]) * contrast[k]);
        along.sum::<f32>() / contrast2
    };
    // The places that it covers most: a quarter of all.
    let shares = || middle.iter().map(covered);
    // The median of the upper half is the upper quartile.
    let half = median(shares())?;
    let most = median(shares().filter(|share| *share >= half))?;
    let most = || middle.iter().filter(|seen| covered(seen) >= most);
    let color: Rgb = channels(|k| median(most().map(|seen| seen[k])))?;
    let share = covered(&color);
    if share <= 0.0 || share >= LEAST_CHANGE {
        return None;
    }
    // As much ink as before: width · opacity · contrast is kept, and the contrast becomes `share` times what it was.
    let radius = stroke.radius as f32 * stroke.opacity / share;
    // A narrower line covers no pixel as a whole, and one of 1 px between two rows covers half of both.
    let is_halved = (share - 0.5).abs() < 0.04 && (radius - 1.0).abs() < 0.08;
    let is_told = (LEAST_RADIUS..=THIN).contains(&radius) && !is_halved;
    is_told.then(|| Stroke {
        radius: radius.into(),
        color,
        opacity: 1.0,
        ..stroke.clone()
    })
}

/// The colours of a picture along the middle of a stroke, and beside it on both sides.
fn seen_along(stroke: &Stroke, picture: &Image) -> (Vec<Rgb>, Vec<Rgb>) {
    let (width, height) = (picture.width(), picture.height());
    let at = |p: Point| {
        let Point { x, y } = p.floor();
        let is_inside = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
        is_inside.then(|| {
            let i = y as usize * width + x as usize;
            [0, 1, 2].map(|k| picture.planes()[k][i])
        })
    };
    let (mut middle, mut sides) = (Vec::new(), Vec::new());
    for pair in stroke.path.flattened(0.1).windows(2) {
        let along = pair[1] - pair[0];
        let length = along.hypot();
        // Sample about once per px of length, at the middles of equal steps.
        let away = (stroke.radius + BESIDE) / length.max(f64::MIN_POSITIVE);
        for step in 0..length.ceil() as usize {
            let p = pair[0] + along * ((step as f64 + 0.5) / length.ceil());
            middle.extend(at(p));
            for side in [away, -away] {
                sides.extend(at(p + side * along.turn_90()));
            }
        }
    }
    (middle, sides)
}

fn channels(channel: impl Fn(usize) -> Option<f32>) -> Option<Rgb> {
    Some([channel(0)?, channel(1)?, channel(2)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Path, PathPoint};

    /// A picture of 32×16 px with these levels from row 8 on, on white.
    fn rows(levels: &[f32]) -> Image {
        let level = |i: usize| {
            (i / 32)
                .checked_sub(8)
                .and_then(|row| levels.get(row).copied())
        };
        let plane: Vec<f32> = (0..32 * 16).map(|i| level(i).unwrap_or(1.0)).collect();
        Image::new(32, 16, [plane.clone(), plane.clone(), plane]).unwrap()
    }

    /// A level line in the middle of the picture, in the colour that the picture has there.
    fn told(picture: &Image, radius: f64, level: f32, y: f64) -> Option<Stroke> {
        let at = |x: f64| PathPoint::on(Point::new(x, y));
        let stroke = Stroke {
            path: Path::new(vec![at(2.0), at(30.0)], false).unwrap(),
            radius,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [level; 3],
            opacity: 1.0,
        };
        inked(&stroke, picture)
    }

    #[test]
    fn a_dark_narrow_line_has_its_colour_and_as_much_ink() {
        let stroke = told(&rows(&[0.2, 0.2]), 0.8, 0.0, 9.0).unwrap();
        assert!((stroke.color[0] - 0.2).abs() < 1e-6, "{stroke:?}");
        assert!((stroke.radius - 1.0).abs() < 1e-5, "{stroke:?}");
    }

    #[test]
    fn what_the_picture_does_not_tell_stays() {
        // It has its colour.
        assert!(told(&rows(&[0.2, 0.2]), 1.0, 0.2, 9.0).is_none());
        // A line of 1 px between two rows.
        assert!(told(&rows(&[0.5, 0.5]), 0.5, 0.0, 9.0).is_none());
        // A wide line covers enough pixels.
        assert!(told(&rows(&[0.2, 0.2, 0.2, 0.2]), 2.1, 0.0, 10.0).is_none());
        // Two colours beside it.
        let mut levels = [0.6; 8];
        levels[..2].fill(0.2);
        assert!(told(&rows(&levels), 0.8, 0.0, 9.0).is_none());
    }
}
