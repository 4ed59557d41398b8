//! Settling: the last steps are taken against renders of the written file.
//!
//! An SVG renderer rounds to 8 bits after every stroke and has its own antialiasing. So its picture differs from our
//! canvas by an offset, which hardly changes when strokes move a little. Each round writes the drawing and renders the file
//! with resvg, subtracts a part of that offset from the target, and descends for a few iterations. The best file is kept.

mod decimals;

use crate::error::Result;
use crate::fit::budget;
use crate::fit::descent::constraints::Constraints;
use crate::fit::descent::{Aim, Course};
use crate::fit::drawing::objective::Target;
use crate::fit::drawing::{Drawing, Snapshot};
use crate::fit::file::RenderedFile;
use crate::fit::order::Outcome;
use crate::fit::phase::descend::descend;
use crate::fit::recipe::Rates;
use crate::fit::result::Stop;
use crate::fit::run::session::Session;
use crate::fit::time::{MIN_ROUND, SETTLING_STEPS};
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::render::Canvas;

/// A round that changes the fidelity by less than this, dB, is the last. 0 instead of 0.02: +0.02 dB on photographs, in
/// five rounds instead of three.
const LEAST_DB: f64 = 0.02;
/// Share of the offset that a round subtracts from the target. The more, the better in resvg, and the worse in programs that round
/// faint layers down where tiny-skia rounds them up. 0, 0.35, 0.7 for rocket-320 of 2,300 strokes: 40.9, 41.9, 42.4 dB in
/// resvg and 40.3, 39.7, 39.0 in Chromium; 0, 0.7 for icons: 42.1, 43.1 and 40.2, 40.9. Exact areas as a second judge
/// draw as 0.35 does.
const OFFSET_TAKEN: f32 = 0.5;
/// Step sizes, in units of the polish's. Half, twice: −0.03, +0.02 dB.
const PACE: f32 = 0.02;
/// Step sizes of the points of areas, px, before that factor. A guess: about as far as traced strokes move.
const AREA_RATE: f32 = 0.6;
/// Additional factor on the rates of colours and opacities, as the strokes hardly move. Half, twice: −0.03, −0.03 dB.
const COLOR_RATE: f32 = 5.0;
/// Side of a picture from which on marks that are where they were seen may have fewer decimals, px. Of 41 drawings at 128 px that
/// would save 5 % of the bytes for 3 % more of colour error, of 63 at 512 px 8 % for 5 %.
const LARGE: usize = 400;
/// Distance that strokes move in a round, in units of the round before. How resvg antialiases an edge depends on the
/// position of the edge, so that a correction holds only for edges that stay where they are. Half, twice: −0.03, +0.01 dB.
const NEXT_PACE: f32 = 0.1;

/// Settles the restricted drawing if the fit depends on its file, which becomes the best one if it serves the budget better.
pub(in crate::fit) fn settle(session: &mut Session<'_>) -> Result<Outcome> {
    if budget::needs_file(&session.config.budget, &session.recipe) {
        // Errors count as the user's mask says, but not less where detail hides them: resvg differs most at the
        // outlines of strokes, which are detail.
        session.drawing.focus_on(session.task.focus.as_ref());
        let file = run(session)?;
        session.drawing.focus_on(session.weights.as_ref());
        session.offer(file);
    }
    Ok(Outcome::Over)
}

/// Descends against renders of the file. Returns the best file; the drawing becomes the one that it was written from.
fn run(session: &mut Session<'_>) -> Result<RenderedFile> {
    session.progress.settle();
    let mut file = session.render_file()?;
    if !allows_round(session, 0) {
        return Ok(file);
    }
    // Marks are where they were traced. In a small picture tenths of a px are seen once it is enlarged.
    if session.drawing.is_placed() {
        let page = session.drawing.surfaces[0].picture();
        return match page.width().max(page.height()) < LARGE {
            true => Ok(file),
            false => with_fewer_decimals(session, file),
        };
    }
    let rates = session.restricted_rates();
    // Rounds may make the file worse, so the best one is kept with the drawing that it was written from.
    let mut best = (file.clone(), session.drawing.snapshot());
    let (mut round, mut pace) = (0, 1.0);
    while allows_round(session, round) && session.progress.tell(&session.drawing, file.mse()) {
        round += 1;
        // 1. The offset of the file's render from our own, as of this round.
        let targets = targets(&mut session.drawing, &file);
        let aim = Aim {
            targets: &targets,
            mse: file.mse(),
        };
        let mut descent = session.descent(course(rates, pace));
        // 2. A few steps towards the corrected target. What strokes share, and their forms, stay.
        descent.ties.clone_from(&session.history.ties);
        descent.constraints = Constraints::of(session.drawing.free(), session.drawing.formed());
        descend(session, &mut descent, Some(aim))?;
        if session.progress.is_halted() {
            break;
        }
        // 3. Measure the file that the steps led to.
        let before = file.mse();
        file = session.render_file()?;
        if file.mse() < best.0.mse() {
            best = (file.clone(), session.drawing.snapshot());
        }
        if (psnr_db(file.mse()) - psnr_db(before)).abs() < LEAST_DB {
            break;
        }
        // Each round moves edges less, as the correction holds for edges that stay.
        pace *= NEXT_PACE;
    }
    let (file, snapshot): (RenderedFile, Snapshot) = best;
    session.drawing.revert(snapshot);
    with_fewer_decimals(session, file)
}

/// The file of the drawing with its areas rounded where that pays; `file` if that is nowhere.
fn with_fewer_decimals(session: &mut Session<'_>, file: RenderedFile) -> Result<RenderedFile> {
    let (scene, precision) = (&file.rounded.scene, session.config.file.precision);
    if decimals::drop_decimals(&mut session.drawing, session.price, scene, precision) {
        return session.render_file();
    }
    Ok(file)
}

/// The targets of a round, one per surface: the picture less a part of the offset of resvg's render from our own.
fn targets(drawing: &mut Drawing, file: &RenderedFile) -> Vec<Target> {
    // Our own render of the rounded scene, so that rounding to the file's decimals is no part of the offset.
    let own = drawing.soft(&file.rounded.scene);
    let renders = file.drawn.iter().zip(&own);
    let targets = drawing.surfaces.iter().zip(renders);
    let corrected = targets.map(|(surface, (drawn, own))| {
        surface.target_of(Canvas::from_image(&corrected(
            surface.picture(),
            drawn,
            own,
        )))
    });
    corrected.collect()
}

/// `picture` less a part of the offset of a render from our `own`.
fn corrected(picture: &Image, drawn: &Image, own: &Image) -> Image {
    let planes = [0, 1, 2].map(|c| {
        let offsets = drawn.planes()[c].iter().zip(&own.planes()[c]);
        let pixels = picture.planes()[c].iter().zip(offsets);
        pixels
            // Where our own render meets this target, the file's render is the picture plus the rest of the offset.
            .map(|(pixel, (drawn, own))| pixel - OFFSET_TAKEN * (drawn - own))
            .collect()
    });
    Image::from_planes(picture.width(), picture.height(), planes)
}

/// True if another round runs after `done` rounds. If the time limit cut the descent short, rounds go on past their
/// planned number as long as there is time.
fn allows_round(session: &Session<'_>, done: usize) -> bool {
    let planned = session.recipe.settling_rounds;
    let is_cut = session.is_leaving() || session.cut_by() == Some(Stop::Time);
    let is_wanted = done < planned || (planned > 0 && is_cut);
    is_wanted && session.timer.allows_file_after(MIN_ROUND)
}

/// The course of a round; `pace` is a factor on the rates of the geometry.
fn course(rates: Rates, pace: f32) -> Course {
    let rates = Rates {
        // Geometry slows down from round to round; colours don't, as they correct the offset itself.
        position: pace * rates.position,
        area: pace * AREA_RATE,
        radius: pace * rates.radius,
        color: COLOR_RATE * rates.color,
        opacity: COLOR_RATE * rates.opacity,
        ..rates
    };
    Course {
        pace: PACE,
        ..Course::new(SETTLING_STEPS, rates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_offset_is_subtracted() {
        let gray = |level| Image::filled(2, 1, [level; 3]).unwrap();
        let image = corrected(&gray(0.5), &gray(0.5), &gray(0.25));
        assert_eq!(image.planes()[1], [0.5 - 0.25 * OFFSET_TAKEN; 2]);
    }
}
