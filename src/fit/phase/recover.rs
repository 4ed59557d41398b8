//! Recovery: small things that the drawing has lost are traced once more, and errors near them count more from then on.
//!
//! A label costs few bytes beside all others, and its error is small beside that of the whole picture. So at the price of a
//! byte, which is one for the whole picture, letters go while strokes find their places, and nothing brings them back. People see
//! what is small and stands alone, though: see [`Details`].
//!
//! They are looked for in the render of the file by resvg. An area that has become too thin has no inside there, though our own
//! edges, which are soft, show it.

use super::restrict::pixels;
use super::trace;
use crate::error::Result;
use crate::fit::edits::{Room, choose, drop_marks};
use crate::fit::order::{Outcome, Purpose};
use crate::fit::run::session::Session;
use crate::image::Image;
use crate::metrics::Details;
use crate::render::Canvas;
use crate::scene::Marks;
use crate::trace::Tracing;

/// Least contrast of recovered details. `details_kept` counts details from this contrast on, too.
const CONTRAST: f32 = 10.0 / 255.0;
/// Increase of that contrast, levels per level of doubt.
const CONTRAST_OF_DOUBT: f32 = 8.0;
/// Rows and columns beside details that are traced, and weighed, too. A guess.
const REACH: usize = 4;

/// Seeds a stage of strokes along the details that the polished drawing has lost.
pub(in crate::fit) fn recover(session: &mut Session<'_>) -> Result<Outcome> {
    let [traced, _] = session.history.traced;
    // A drawing that is where it is seen has lost no more than the antialiasing of a renderer.
    let is_over = traced == 0
        || session.drawing.is_placed()
        || !session.recovers()
        || session.progress.stopped().is_some()
        || session.cut_by().is_some();
    if is_over {
        return Ok(Outcome::Over);
    }
    // 1. Find the lost details in the file's render.
    session.drawing.sharpen(0.0);
    let drawn = session.render_file()?.drawn;
    let lost = lost(session, &drawn);
    if !lost.contains(&true) {
        return Ok(Outcome::Over);
    }
    // 2. Let errors count more there. The price of a stroke is then measured in weighted errors.
    let places = (0_u32..).zip(&lost).filter(|(_, is_lost)| **is_lost);
    session.history.lost = places.map(|(place, _)| place).collect();
    session.weigh_lost();
    // 3. Trace there alone: elsewhere the canvas gets the picture itself, so that the residual is 0.
    let surfaces = session.drawing.surfaces.iter().zip(drawn);
    let canvases: Vec<Canvas> = surfaces
        .map(|(surface, drawn)| inside(drawn, surface.picture(), &lost))
        .collect();
    let marks = match session.config.marks() {
        Marks::Areas => Marks::Areas,
        Marks::Auto | Marks::Strokes => Marks::Strokes,
    };
    let tracing = Tracing {
        may_place: false,
        is_of_details: true,
        ..trace::tracing(session)
    };
    let traced = trace::paying(session, &canvases, marks, tracing);
    Ok(match trace::add(session, traced) {
        true => Outcome::Seeded(Purpose::Recover),
        false => Outcome::Over,
    })
}

/// Change of the pixels of a recovered stroke, RMS in units of what compression leaves beside edges, below which it is no detail. Of those
/// of a logo in JPEG of quality 60, four smudges beside discs have 2.4 to 3.8, and all parts of letters 5.4 or more.
const SMUDGE: f32 = 4.0;

/// Removes strokes of the last stage, which recovered details, that change their pixels no more than compression does beside edges.
pub(in crate::fit) fn drop_smudges(session: &mut Session<'_>) {
    let least = SMUDGE * session.task.doubt.near / 255.0;
    if least == 0.0 {
        return;
    }
    // 1. Measure changes in the picture, not weighted ones.
    let drawing = &mut session.drawing;
    drawing.thaw();
    drawing.focus_on(None);
    let mut losses = drop_marks(drawing, |mark| match mark.is_area() {
        true => 0.0,
        false => 3.0 * pixels(mark) * least * least,
    });
    // 2. Of the last stage alone.
    losses.drain(..drawing.earlier());
    drawing.apply(&choose(losses, Room::default()));
    drawing.focus_on(session.weights.as_ref());
}

/// The pixels in and near lost details, on any matte.
fn lost(session: &Session<'_>, drawn: &[Image]) -> Vec<bool> {
    let drawing = &session.drawing;
    let contrast = CONTRAST + CONTRAST_OF_DOUBT * session.task.doubt.most() / 255.0;
    let mut lost = vec![false; drawing.pixels()];
    for (surface, drawn) in drawing.surfaces.iter().zip(drawn) {
        let details = Details::of(surface.picture(), contrast);
        let near = details.near_losses(drawn, REACH);
        let pixels = lost.iter_mut().zip(near);
        pixels.for_each(|(lost, near)| *lost |= near);
    }
    lost
}

/// The picture that was `drawn` where details are lost, and the target elsewhere.
fn inside(drawn: Image, restored: &Image, lost: &[bool]) -> Canvas {
    let mut planes = drawn.into_planes();
    for (plane, restored) in planes.iter_mut().zip(restored.planes()) {
        let pixels = plane.iter_mut().zip(restored).zip(lost);
        let others = pixels.filter(|(_, is_lost)| !**is_lost);
        others.for_each(|((value, restored), _)| *value = *restored);
    }
    let (width, height) = (restored.width(), restored.height());
    Canvas::from_image(&Image::from_planes(width, height, planes))
}
