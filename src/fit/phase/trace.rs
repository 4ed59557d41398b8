//! Tracing: strokes are laid along the lines of the residual.

use super::grow;
use crate::error::Result;
use crate::fit::budget::plan::PlannedStage;
use crate::fit::config::Colors;
use crate::fit::drawing::Drawing;
use crate::fit::drawing::surface::Surface;
use crate::fit::edits::written_points;
use crate::fit::order::{Outcome, Purpose};

use crate::fit::result::Stop;
use crate::fit::run::history::OpenStage;
use crate::fit::run::session::Session;
use crate::metrics::psnr_db;
use crate::render::{Canvas, Strokes};
use crate::scene::{Mark, Marks, Stroke};
use crate::trace::{Traced, Tracing, trace};

/// Most times that a drawing is traced before its polish where nothing is traced after it; otherwise once. 1, 2, 3 of the latter: six
/// pictures of flat art have 37.97, 38.39, 38.61 dB in 15.9, 17.1, 18.0 kB and take 1.5, 1.9, 2.0 s; a comic of 36 dB needs 3 of
/// the former.
const ROUNDS: usize = 3;
/// Scale of the fit of traced strokes, px: they are about as far from where they belong. A guess.
const SCALE: f32 = 2.0;

/// Adds strokes along the lines of the residual, on top of all others.
pub(in crate::fit) fn trace_lines(session: &mut Session<'_>) -> Result<Outcome> {
    // Trace until nothing pays, or the fidelity is near; once if lost details are traced later.
    let rounds = match session.recovers() {
        true => 1,
        false => ROUNDS,
    };
    let is_rejected = session
        .history
        .stage
        .is_some_and(|stage| stage.accepted == Some(0));
    let is_over = session.progress.stopped().is_some()
        || is_rejected
        || !session.config.allows_points()
        // What is where it is seen leaves nothing.
        || session.drawing.is_placed()
        || session.history.traced[0] == rounds
        || grow::enough(session) == Some(Stop::Psnr);
    let traced = match is_over {
        true => Vec::new(),
        false => {
            let canvases = canvases(&mut session.drawing);
            let marks = session.config.marks();
            let tracing = tracing(session);
            let placed = paying(session, &canvases, marks, tracing);
            match is_faithful(session, &placed) {
                true => placed,
                // Damage hides where edges are exactly, so that a descent finds out.
                false if tracing.doubt.most() > 0.0 => fitted(placed),
                // Colours told wrongly what there is.
                false => paying(
                    session,
                    &canvases,
                    marks,
                    Tracing {
                        may_place: false,
                        ..tracing
                    },
                ),
            }
        }
    };
    if add(session, traced) {
        return Ok(Outcome::Seeded(Purpose::Trace));
    }
    // Stages go on with the strokes that are left to plan.
    session.history.stage = None;
    session.plan_rest();
    Ok(Outcome::Over)
}

/// Marks that are to be fitted.
fn fitted(mut traced: Vec<Traced>) -> Vec<Traced> {
    traced
        .iter_mut()
        .for_each(|traced| traced.is_placed = false);
    traced
}

/// The drawing on each surface, at full resolution.
pub(super) fn canvases(drawing: &mut Drawing) -> Vec<Canvas> {
    if drawing.len() == 0 {
        let surfaces = drawing.surfaces.iter();
        return surfaces.map(Surface::full_backdrop).collect();
    }
    drawing.sharpen(0.0);
    drawing.render();
    drawing.surfaces.iter().map(|s| s.canvas.clone()).collect()
}

/// What tracing looks for in the whole picture.
pub(super) fn tracing(session: &Session<'_>) -> Tracing {
    let (config, surfaces) = (session.config, &session.drawing.surfaces);
    let most = session.limit.min(session.task.most_marks);
    // A gradient has many colours, and on a transparent page many opacities.
    Tracing {
        doubt: session.task.doubt,
        has_shades: config.colors == Colors::Free && !(config.opaque && surfaces.len() > 1),
        most: most.saturating_sub(session.drawing.len()),
        may_place: true,
        is_of_details: false,
    }
}

/// Fidelity of areas that need no descent, dB. A guess.
const FAITHFUL_DB: f64 = 36.0;
/// As [`FAITHFUL_DB`], of lines of varying width, most of whose pixels are those of edges: 34 to 38 dB where they are exact.
const FAITHFUL_INK_DB: f64 = 32.0;

/// True unless the drawing with marks that were traced where they are seen is less like the picture than descents make it.
fn is_faithful(session: &mut Session<'_>, traced: &[Traced]) -> bool {
    if !traced.iter().any(|traced| traced.is_placed) {
        return true;
    }
    session.drawing.sharpen(0.0);
    let before = session.drawing.snapshot();
    let marks: Vec<Mark> = traced.iter().map(|traced| traced.mark.clone()).collect();
    let stage = session.drawing.last_stage();
    session.drawing.extend_by(&marks, stage);
    let least = match marks.iter().any(Mark::is_varying) {
        true => FAITHFUL_INK_DB,
        false => FAITHFUL_DB,
    };
    let is_faithful = psnr_db(session.drawing.mse()) >= least;
    session.drawing.revert(before);
    is_faithful
}

/// The marks traced on `canvases` that are worth their price, in painting order.
pub(super) fn paying(
    session: &Session<'_>,
    canvases: &[Canvas],
    marks: Marks,
    tracing: Tracing,
) -> Vec<Traced> {
    let (config, price) = (session.config, session.price);
    let surfaces = &session.drawing.surfaces;
    let surfaces = surfaces.iter().zip(canvases);
    let residuals: Vec<_> = surfaces.map(|(s, canvas)| s.residual_of(canvas)).collect();
    // Areas and strokes compete by their bytes alone; whether each is worth its price is asked below.
    let by_bytes = price.of_bytes_alone();
    let mut traced = trace(&residuals, tracing, marks, &|mark| {
        by_bytes.least_gain(mark)
    });
    if config.opaque {
        let translucent = traced.iter_mut().filter(|t| t.mark.opacity() < 1.0);
        translucent.for_each(|t| make_opaque(&mut t.mark));
    }
    let most = config.points.unwrap_or(usize::MAX);
    let has_room = |stroke: &Stroke| {
        // The points of its line count, and not those of an outline.
        let strokes = Strokes::from_iter([&Stroke {
            radii: Vec::new(),
            ..stroke.clone()
        }]);
        written_points(strokes.get(0)) <= most
    };
    traced
        .retain(|t| t.mark.as_stroke().is_none_or(has_room) && t.gain > price.least_gain(&t.mark));
    traced
}

/// Gives a mark the colour that it has on black and on white in the mean.
fn make_opaque(mark: &mut Mark) {
    let (color, opacity) = match mark {
        Mark::Stroke(stroke) => (&mut stroke.color, &mut stroke.opacity),
        Mark::Area(area) => (&mut area.color, &mut area.opacity),
    };
    // On black it looks like αc, on white like αc + 1 − α: the mean is ½ + α(c − ½).
    *color = color.map(|c| 0.5 + *opacity * (c - 0.5));
    *opacity = 1.0;
}

/// Seeds a stage of as many of the traced marks as there is room and time for, on top of all others, which it freezes. Returns
/// whether there are any.
pub(super) fn add(session: &mut Session<'_>, traced: Vec<Traced>) -> bool {
    let index = session.history.records.len();
    // A budget of bytes plans for strokes, and an area may take the place of many. Excess is shed later.
    let is_by_bytes = session.config.budget.bytes.is_some()
        && session.config.budget.strokes.is_none()
        && traced.iter().any(|traced| traced.mark.as_area().is_some());
    let room = match is_by_bytes {
        true => traced.len(),
        false => session.limit.saturating_sub(session.drawing.len()),
    };
    let count = session.timer.affordable(traced.len().min(room));
    if count == 0 {
        return false;
    }
    let are_placed = traced.iter().all(|traced| traced.is_placed);
    let marks = most_gaining(traced, count);
    let began = session.timer.elapsed();
    session.progress.enter(index);
    session.drawing.sharpen(0.0);
    session.drawing.freeze();
    let before = (session.drawing.len(), psnr_db(session.drawing.mse()));
    session.drawing.extend_by(&marks, index);
    let counters = &mut session.drawing.counters;
    counters.traced_until = index + 1;
    if are_placed && counters.placed_until == index {
        counters.placed_until = index + 1;
    }
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
    true
}

/// The strokes of the `count` largest gains, in the order that they have.
fn most_gaining(traced: Vec<Traced>, count: usize) -> Vec<Mark> {
    let mut order: Vec<usize> = (0..traced.len()).collect();
    // Equal gains keep their order, so that the choice is the same on every machine.
    order.sort_by(|&i, &k| traced[k].gain.total_cmp(&traced[i].gain).then(i.cmp(&k)));
    let mut keep = vec![false; traced.len()];
    order.iter().take(count).for_each(|&i| keep[i] = true);
    // In painting order again: marks above others have to stay above them.
    let kept = traced.into_iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(traced, _)| traced.mark).collect()
}
