//! Colours one above the other: all strokes of a colour are neighbours in the order of the drawing, so that its file has
//! one layer for each colour.
//!
//! The order of the colours changes little: where strokes of two colours meet, the colour that lies below in more of the
//! visible pixels also lies below in the stack. The fit then repairs the rest.

use std::collections::BTreeMap;

use super::palette::{Palette, ROUNDS};
use super::preferences::{PreferredColor, preferences};
use super::rounds;
use crate::error::Result;
use crate::fit::drawing::Drawing;
use crate::fit::phase::polish::Shares;
use crate::fit::run::session::Session;
use crate::metrics::psnr_db;
use crate::render::StrokeRef;
use crate::scene::{Mark, Precedence, quantized_anywhere, quantum};

/// Number of neighbouring strokes that are compared to stack their colours, which takes time with its square. A guess.
const WINDOW: usize = 4096;

/// An 8-bit colour.
type Color = [u8; 3];

/// Stacks the colours, fits the drawing to that, and takes down by how many dB it is worse than before. All strokes must
/// be free.
pub(super) fn run(session: &mut Session<'_>, palette: &mut Palette) -> Result<()> {
    let until = Shares::of(session.config).stack;
    session.timer.until = until;
    let rates = session.recipe.polish.rates.without_color();
    let precision = session.config.file.precision;
    let free_db = psnr_db(session.drawing.mse());
    let order = order(&mut session.drawing, precision);
    arrange(&mut session.drawing, &order);
    let mse = rounds::best(session, ROUNDS, |session, round| {
        rounds::run(session, ROUNDS, round, rates)?;
        palette.recolor(&mut session.drawing);
        arrange(&mut session.drawing, &order);
        Ok(true)
    })?;
    session.history.stacking_db = Some(free_db - psnr_db(mse));
    session.timer.until = 1.0;
    Ok(())
}

/// Sorts the strokes by their colours' places in `order`. Strokes of one colour keep their order.
fn arrange(drawing: &mut Drawing, order: &[Color]) {
    let place = |color: Color| {
        let place = order.iter().position(|&c| c == color);
        place.unwrap_or(order.len())
    };
    let strokes = drawing.free().iter().enumerate();
    // Colours that came later are on top, one after the other.
    let mut keys: Vec<(usize, Color, usize)> = strokes
        .map(|(i, stroke)| {
            let color = stroke.color().map(quantum);
            (place(color), color, i)
        })
        .collect();
    keys.sort_unstable();
    let sources: Vec<usize> = keys.into_iter().map(|(_, _, i)| i).collect();
    drawing.reorder(&sources);
}

/// Colours from the back to the front. A stroke counts by the pixels that it shows in; `precision` is the file's.
fn order(drawing: &mut Drawing, precision: u8) -> Vec<Color> {
    let shown = preferences(drawing, 0.0);
    let strokes = drawing.free().iter().zip(&shown);
    let written = |(stroke, shown): (StrokeRef<'_>, &PreferredColor)| {
        let written = quantized_anywhere(&stroke.to_mark(), precision)?;
        Some((written, shown.weight))
    };
    stacked(&strokes.filter_map(written).collect::<Vec<_>>(), WINDOW)
}

/// The colours of strokes, each with the pixels in which it shows, in an order that agrees with the order of the strokes as
/// far as possible: the next colour is the one whose strokes lie below the remaining colours rather than above.
fn stacked(strokes: &[(Mark, f32)], window: usize) -> Vec<Color> {
    let color = |mark: &Mark| mark.color().map(quantum);
    // For each pair of colours, in how many pixels the first lies below the second: at most as many as either stroke shows in.
    let mut below: BTreeMap<(Color, Color), f32> = BTreeMap::new();
    for window in strokes.chunks(window) {
        let precedence = Precedence::of(window.iter().map(|(stroke, _)| stroke));
        for (i, (lower, weight)) in window.iter().enumerate() {
            for (upper, other) in precedence.above(i).iter().map(|&k| &window[k]) {
                let pair = (color(lower), color(upper));
                *below.entry(pair).or_default() += weight.min(*other);
            }
        }
    }
    let mut left: Vec<Color> = strokes.iter().map(|(stroke, _)| color(stroke)).collect();
    left.sort_unstable();
    left.dedup();
    let mut order = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let pull = |color: Color| {
            let pairs = left.iter().map(|&other| {
                let weight = |pair| below.get(&pair).copied().unwrap_or(0.0);
                weight((color, other)) - weight((other, color))
            });
            pairs.sum::<f32>()
        };
        let pulls: Vec<f32> = left.iter().map(|&color| pull(color)).collect();
        // Greedy linear ordering: next is the colour with the largest balance of pixels below the others. Ties go to the
        // smaller colour, so that the order is the same on every machine.
        let lowest = (0..left.len()).max_by(|&i, &j| pulls[i].total_cmp(&pulls[j]).then(j.cmp(&i)));
        order.push(left.remove(lowest.unwrap_or(0)));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::scene::{Cap, Path, Stroke};

    /// Vertical strokes at `x`, of grey `level`.
    fn stroke(x: f64, level: f32) -> (Mark, f32) {
        let stroke = Stroke {
            path: Path::line(Point::new(x, 10.0), Point::new(x, 50.0)),
            radius: 4.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [level; 3],
            opacity: 1.0,
        };
        (quantized_anywhere(&stroke.into(), 2).unwrap(), 100.0)
    }

    #[test]
    fn what_lies_below_where_strokes_meet_is_below_in_the_stack() {
        // White over black at one place, black over white at two; grey is nowhere near.
        let strokes = [
            stroke(10.0, 0.0),
            stroke(12.0, 1.0),
            stroke(50.0, 1.0),
            stroke(52.0, 0.0),
            stroke(90.0, 1.0),
            stroke(92.0, 0.0),
            stroke(200.0, 0.5),
        ];
        let order = stacked(&strokes, 100);
        let place = |level: u8| order.iter().position(|c| c[0] == level).unwrap();
        assert!(place(255) < place(0), "{order:?}");
        assert_eq!(order.len(), 3);
    }
}
