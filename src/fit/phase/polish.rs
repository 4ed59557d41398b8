//! Polish: all free strokes and the background are fitted jointly, with relocation.

use crate::error::Result;
use crate::fit::config::{Colors, Config};
use crate::fit::descent::jitter::Jitter;
use crate::fit::descent::{Course, Joint};
use crate::fit::drawing::Drawing;
use crate::fit::order::Purpose;
use crate::fit::phase::descend::descend;
use crate::fit::points;
use crate::fit::recipe::{Polish, Recipe, SPARSE};
use crate::fit::run::session::{RECOVERY_SHARE, Session};
use crate::svg::{Form, Group};

/// Iterations of polish as long as the drawing is far from the fidelity, in units of those of the first polish. 0.4 instead of 0.2:
/// kodim04 at 36 dB takes 24 instead of 11.7 s.
const APPROACH_SHARE: f64 = 0.2;
/// Iterations of polish after a correction, in units of those of the first polish.
const CORRECTION_SHARE: f64 = 0.4;
/// Iterations of the polish at a lower price, in units of those of the first polish. 0.2, 0.7 instead of 0.4: SSIMULACRA2 −2.0, +1.6 on four
/// photographs, in 0.9 and 1.2 times the time of the whole fit.
const AGAIN_SHARE: f64 = 0.4;
/// Iterations of a drawing with areas, which were traced, in units of those that it would have without. A guess: a hundred were
/// enough for areas alone.
const AREA_SHARE: f32 = 0.4;
/// Softness at the start, in units of the final one. 1, 1.5, 2.5: −0.19, 0, +0.17 dB; 3: −0.02 against 2.4.
const SOFTNESS: f32 = 2.4;
/// Most points that a stroke loses at the end of the polish. A guess.
const PRUNINGS: usize = 30;

/// Fits all strokes of the drawing jointly.
pub(in crate::fit) fn polish(session: &mut Session<'_>, purpose: Purpose) -> Result<()> {
    let is_begun = session.resumed.is_some();
    if !is_begun {
        if session.progress.stopped().is_some() || !session.timer.allows_polish() {
            return Ok(());
        }
        session.drawing.thaw();
        if session.drawing.is_placed() {
            return Ok(());
        }
        session.progress.enter(session.history.records.len());
    }
    // A fidelity is to be met by as few strokes as possible; their number is corrected afterwards.
    let limit = match session.config.budget.psnr_db {
        Some(_) => session.drawing.len(),
        None => session.limit,
    };
    let mut polish = match session.config.budget.psnr_db {
        Some(_) => of_density(&session.drawing, &session.recipe),
        None => session.recipe.polish,
    };
    if purpose == Purpose::Correct {
        // A drawing far from the fidelity asked for is polished again, with more strokes; and bytes that are left need
        // few iterations.
        let share = match session.history.corrections.files.is_empty() {
            true => APPROACH_SHARE,
            false => CORRECTION_SHARE,
        };
        polish.iterations = (polish.iterations as f64 * share) as usize;
    }
    if purpose == Purpose::Plan && session.history.eased_db > 0.0 {
        polish.iterations = (polish.iterations as f64 * AGAIN_SHARE) as usize;
    }
    if purpose == Purpose::Recover {
        let share = RECOVERY_SHARE;
        polish.iterations = (polish.iterations as f64 * share) as usize;
    }
    if session.drawing.free().has_areas() {
        polish.iterations = (polish.iterations as f32 * AREA_SHARE) as usize;
    }
    run(session, limit, polish)
}

/// The polish for as many points as the drawing has, where a fidelity is asked for: it is known only now.
fn of_density(drawing: &Drawing, recipe: &Recipe) -> Polish {
    let density = drawing.pixels() as f32 / drawing.free().points().max(1) as f32;
    recipe.for_density(density.min(SPARSE)).polish
}

/// Fits the free strokes jointly, and may add strokes until the drawing has `limit`.
pub(super) fn run(session: &mut Session<'_>, limit: usize, polish: Polish) -> Result<()> {
    session.progress.polish();
    let course = Course {
        // Edges that are softer than in the end would move areas away from where they were traced.
        softness: Some(match session.drawing.free().has_areas() {
            true => 1.0,
            false => SOFTNESS,
        }),
        until: Shares::of(session.config).polish,
        joint: Some(Joint {
            limit,
            jitter: Jitter { px: polish.jitter },
        }),
        ..Course::new(polish.iterations, polish.rates)
    };
    let mut descent = session.descent(course);
    descend(session, &mut descent, None)?;
    if session.config.allows_points() && session.drawing.counters.traced_until > 0 {
        // Tracing may have set points that no longer pay, now that the strokes are where they belong.
        points::prune(&mut session.drawing, session.price, PRUNINGS);
    }
    Ok(())
}

/// Iterations of all rounds of choosing colours, in units of those of the polish. Half, twice, in 12 colours: −0.10, +0.06 dB.
pub(super) const PALETTE_ITERATIONS: f64 = 0.6;
/// Iterations of all rounds of choosing pens, in units of those of the polish. Half, twice: −0.01, −0.06 dB.
pub(super) const PENS_ITERATIONS: f64 = 0.2;

/// The shares of a limited time for descent by which polish, palette and the stack of its colours have to end. The rest is
/// for pens. Each part is in proportion to its iterations.
pub(super) struct Shares {
    pub(super) polish: f32,
    pub(super) palette: f32,
    pub(super) stack: f32,
}

impl Shares {
    pub(super) fn of(config: &Config) -> Self {
        let polish = 1.0;
        let palette = match config.colors {
            Colors::Free => 0.0,
            _ => PALETTE_ITERATIONS,
        };
        let stack = match config.file.group {
            Group::Color => palette,
            Group::Stage | Group::Object => 0.0,
        };
        let pens = match config.file.form {
            Form::Smallest => PENS_ITERATIONS,
            _ => 0.0,
        };
        let all = polish + palette + stack + pens;
        Self {
            polish: (polish / all) as f32,
            // Ends, not lengths: each part begins where the one before it ends.
            palette: ((polish + palette) / all) as f32,
            stack: ((polish + palette + stack) / all) as f32,
        }
    }
}
