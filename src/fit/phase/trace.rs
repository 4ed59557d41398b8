//! Tracing: strokes are laid along the lines of the residual.

use super::grow;
use crate::error::Result;
use crate::fit::budget::plan::PlannedStage;
use crate::fit::budget::price::Price;
use crate::fit::config::{Colors, Config};
use crate::fit::drawing::Drawing;
use crate::fit::drawing::surface::Surface;
use crate::fit::order::{Outcome, Purpose};
use crate::fit::points::written_points;
use crate::fit::result::Stop;
use crate::fit::run::history::OpenStage;
use crate::fit::run::session::Session;
use crate::metrics::psnr_db;
use crate::render::{Canvas, Strokes};
use crate::scene::{Mark, Stroke};
use crate::trace::{Traced, Tracing, trace};

/// Adds strokes along the lines of the residual, on top of all others.
pub(in crate::fit) fn trace_lines(session: &mut Session<'_>) -> Result<Outcome> {
    // Traced until nothing pays, or the fidelity is near.
    let is_rejected = session
        .history
        .stage
        .is_some_and(|stage| stage.accepted == Some(0));
    let is_over = session.progress.stopped().is_some()
        || is_rejected
        || !session.config.allows_points()
        || session.history.traced[0] == session.recipe.tracing.rounds
        || grow::enough(session) == Some(Stop::Psnr);
    let traced = match is_over {
        true => Vec::new(),
        false => lines(
            &mut session.drawing,
            session.config,
            session.recipe.tracing,
            session.price,
        ),
    };
    // As many strokes as there is room and time for; without any, stages go on with what is left.
    let index = session.history.records.len();
    // Bytes plan for strokes, of which an area may take the place of many; what is too much is shed.
    let is_by_bytes = session.config.budget.bytes.is_some()
        && session.config.budget.strokes.is_none()
        && traced.iter().any(|traced| traced.mark.as_area().is_some());
    let room = match is_by_bytes {
        true => traced.len(),
        false => session.limit.saturating_sub(session.drawing.len()),
    };
    let count = session.timer.affordable(traced.len().min(room));
    if count == 0 {
        session.history.stage = None;
        session.plan_rest();
        return Ok(Outcome::Over);
    }
    let marks = most_gaining(traced, count);
    // They lie on top of all others, which are frozen.
    let began = session.timer.elapsed();
    session.progress.enter(index);
    session.drawing.sharpen(0.0);
    session.drawing.freeze();
    let before = (session.drawing.len(), psnr_db(session.drawing.mse()));
    session.drawing.extend_by(&marks, index);
    session.drawing.counters.traced_until = index + 1;
    session.history.stage = Some(OpenStage {
        planned: PlannedStage {
            index,
            count,
            scale: session.recipe.tracing.scale,
        },
        began,
        before,
        accepted: None,
    });
    Ok(Outcome::Seeded(Purpose::Trace))
}

/// The traced strokes that are worth their price, in painting order.
fn lines(
    drawing: &mut Drawing,
    config: &Config,
    mut tracing: Tracing,
    price: Price,
) -> Vec<Traced> {
    // A gradient has many colours, and on a transparent page many opacities.
    let is_see_through = drawing.surfaces.len() > 1;
    if config.colors != Colors::Free || config.opaque && is_see_through {
        tracing.fills.shades.most = 0;
    }
    let canvases: Vec<Canvas> = if drawing.len() == 0 {
        drawing
            .surfaces
            .iter()
            .map(Surface::full_backdrop)
            .collect()
    } else {
        drawing.sharpen(0.0);
        drawing.render();
        drawing.surfaces.iter().map(|s| s.canvas.clone()).collect()
    };
    let surfaces = drawing.surfaces.iter().zip(&canvases);
    let residuals: Vec<_> = surfaces.map(|(s, canvas)| s.residual_of(canvas)).collect();
    let by_bytes = price.of_bytes_alone();
    let mut traced = trace(&residuals, tracing, config.marks(), |mark| {
        by_bytes.least_gain(mark)
    });
    let most = config.points.unwrap_or(usize::MAX);
    let has_room = |stroke: &Stroke| {
        let strokes = Strokes::from_iter([stroke]);
        written_points(strokes.get(0)) <= most
    };
    traced
        .retain(|t| t.mark.as_stroke().is_none_or(has_room) && t.gain > price.least_gain(&t.mark));
    traced
}

/// The strokes of the `count` largest gains, in the order that they have.
fn most_gaining(traced: Vec<Traced>, count: usize) -> Vec<Mark> {
    let mut order: Vec<usize> = (0..traced.len()).collect();
    order.sort_by(|&i, &k| traced[k].gain.total_cmp(&traced[i].gain).then(i.cmp(&k)));
    let mut keep = vec![false; traced.len()];
    order.iter().take(count).for_each(|&i| keep[i] = true);
    let kept = traced.into_iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(traced, _)| traced.mark).collect()
}
