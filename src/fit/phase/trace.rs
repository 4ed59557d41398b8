//! Tracing: strokes are laid along the lines of the residual.

use super::grow;
use crate::error::Result;
use crate::fit::history::OpenStage;
use crate::fit::order::{Outcome, Purpose};
use crate::fit::plan::PlannedStage;
use crate::fit::points::written_points;
use crate::fit::result::Stop;
use crate::fit::session::Session;
use crate::fit::surface::Surface;
use crate::metrics::psnr_db;
use crate::render::{Canvas, Strokes};
use crate::scene::Stroke;
use crate::trace::{Traced, trace};

/// Scale of the fit of traced strokes, px: they are about as far from where they belong.
const SCALE: f32 = 2.0;
/// Most times that a drawing is traced.
const ROUNDS: usize = 3;

/// Adds strokes along the lines of the residual, on top of all others.
pub(in crate::fit) fn trace_lines(session: &mut Session<'_>) -> Result<Outcome> {
    let is_rejected = session
        .history
        .stage
        .is_some_and(|stage| stage.accepted == Some(0));
    let is_over = session.progress.stopped().is_some()
        || is_rejected
        || !session.config.allows_points()
        || session.history.traced[0] == ROUNDS
        || grow::enough(session) == Some(Stop::Psnr);
    let traced = if is_over { Vec::new() } else { lines(session) };
    let index = session.history.records.len();
    let room = session.limit.saturating_sub(session.drawing.len());
    let count = session.timer.affordable(traced.len().min(room));
    if count == 0 {
        session.history.stage = None;
        session.plan_rest();
        return Ok(Outcome::Over);
    }
    let strokes = most_gaining(traced, count);
    let began = session.timer.elapsed();
    session.progress.enter(index);
    session.drawing.sharpen(0.0);
    session.drawing.freeze();
    let before = (session.drawing.len(), psnr_db(session.drawing.mse()));
    session.drawing.extend_by(&strokes, index);
    session.drawing.counters.traced_until = index + 1;
    session.history.stage = Some(OpenStage {
        planned: PlannedStage {
            index,
            count,
            scale: SCALE,
        },
        began,
        before,
        accepted: None,
    });
    Ok(Outcome::Seeded(Purpose::Trace))
}

/// The traced strokes that are worth their price, in painting order.
fn lines(session: &mut Session<'_>) -> Vec<Traced> {
    let drawing = &mut session.drawing;
    let canvases: Vec<Canvas> = if drawing.len() == 0 {
        drawing.surfaces.iter().map(Surface::bare).collect()
    } else {
        drawing.sharpen(0.0);
        drawing.render();
        drawing.surfaces.iter().map(|s| s.canvas.clone()).collect()
    };
    let surfaces = drawing.surfaces.iter().zip(&canvases);
    let residuals: Vec<_> = surfaces.map(|(s, canvas)| s.residual_of(canvas)).collect();
    let mut traced = trace(&residuals, session.recipe.tracing);
    let most = session.config.points.unwrap_or(usize::MAX);
    let price = session.price;
    traced.retain(|t| {
        let strokes = Strokes::from_iter([&t.stroke]);
        written_points(strokes.get(0)) <= most && t.gain > price.least_gain(&t.stroke)
    });
    traced
}

/// The strokes of the `count` largest gains, in the order that they have.
fn most_gaining(traced: Vec<Traced>, count: usize) -> Vec<Stroke> {
    let mut order: Vec<usize> = (0..traced.len()).collect();
    order.sort_by(|&i, &k| traced[k].gain.total_cmp(&traced[i].gain).then(i.cmp(&k)));
    let mut keep = vec![false; traced.len()];
    order.iter().take(count).for_each(|&i| keep[i] = true);
    let kept = traced.into_iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(traced, _)| traced.stroke).collect()
}
