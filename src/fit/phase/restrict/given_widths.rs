//! Given widths: every stroke gets the width of one of the pens, and the rest is fitted to that.
//!
//! The drawing has been fitted with widths between the thinnest and the widest pen. Rounds come in pairs. In the first
//! round widths are free, so that strokes tend to one pen or another; then each gets the nearest pen. In the second round
//! widths stay as they are. The drawing after it is compared with the best one so far.

use super::rounds;
use super::shared_styles::ROUNDS;
use super::width_grid::WidthGrid;
use crate::error::Result;
use crate::fit::config::Colors;
use crate::fit::drawing::Drawing;
use crate::fit::edits::Edit;
use crate::fit::run::session::Session;
use crate::render::StrokeRef;
use crate::scene::Stroke;

/// Gives every stroke the width of a pen, if pens are given. All strokes must be free.
pub(super) fn run(session: &mut Session<'_>) -> Result<()> {
    if session.radii.is_empty() {
        return Ok(());
    }
    let free = match session.config.colors {
        Colors::Free => session.recipe.polish.rates,
        _ => session.recipe.polish.rates.without_color(),
    };
    if session.config.pens_draw_lines() {
        even_out(&mut session.drawing);
    }
    hand_out(&mut session.drawing, &session.radii);
    rounds::best(session, ROUNDS, |session, round| {
        // Only the drawing after a round with held widths is fitted to them, so only it may be the best.
        let is_held = round % 2 == 1;
        let rates = if is_held { free.without_radius() } else { free };
        rounds::run(session, ROUNDS, round, rates)?;
        hand_out(&mut session.drawing, &session.radii);
        Ok(is_held)
    })?;
    Ok(())
}

/// Gives strokes whose width varies their mean width: a pen draws the middle of a line once.
fn even_out(drawing: &mut Drawing) {
    let even = |(i, mark): (usize, StrokeRef<'_>)| {
        let mark = mark.to_mark();
        let stroke = mark.as_stroke().filter(|stroke| stroke.is_varying())?;
        let even = Stroke {
            radius: stroke.radii.iter().sum::<f64>() / stroke.radii.len() as f64,
            radii: Vec::new(),
            ..stroke.clone()
        };
        Some(Edit::replacing(i, vec![even.into()], 0.0))
    };
    let edits: Vec<Edit> = drawing.free().iter().enumerate().filter_map(even).collect();
    drawing.apply(&edits);
}

/// Gives every stroke the nearest of the `radii`.
fn hand_out(drawing: &mut Drawing, radii: &[f32]) {
    let grid = WidthGrid::Given(radii);
    drawing.free_mut().change(|_, stroke| {
        if !stroke.is_area {
            stroke.style[0] = grid.nearest(stroke.style[0]);
        }
    });
}
