//! The experiments of the article that this project starts from, and what they show beyond it.
//!
//! Each experiment is a file with a function `run`, which writes tables, pictures and animations to a
//! [`ResultFolder`]; `strokefit-rig lab` runs them by name. They use the same coverage functions, losses,
//! Adam and renderers as the fit.
//!
//! | experiment | question |
//! | --- | --- |
//! | [`sdf`] | what do distances, coverage functions and combinations look like? |
//! | [`field`] | which way does the loss pull a circle, from everywhere? |
//! | [`circle`] | does a circle find its target? |
//! | [`star`] | do sixteen strokes find a star of four? |
//! | [`compose`] | how do coloured strokes make a picture? |
//! | [`colors`] | do coloured strokes find coloured strokes? |
//! | [`article`] | how far do thousands of strokes get, all at once from a random start? |
//! | [`compare`] | which coverage function is best, in the render and in the file? |
//!
//! They share [`shapes`], [`optimizers`], [`descent`] (a problem, an optimiser, its trajectory), [`matching`] (a union of
//! shapes against a target) and [`table`].
//!
//! Like the article, the small experiments sample pixels at integer coordinates.

pub mod article;
pub mod circle;
pub mod colors;
pub mod compare;
pub mod compose;
pub mod descent;
pub mod field;
pub mod matching;
pub mod optimizers;
mod output;
pub mod sdf;
pub mod shapes;
pub mod star;
pub mod table;

pub use output::{Notice, ResultFolder, unwritten};

use crate::report::plot::{Chart, Panel, Sheet};
use descent::Trajectory;
use strokefit::Result;
use strokefit::coverage::Coverage;
use table::STEPS;

/// Side of the small experiments' pictures, px.
pub const SIZE: usize = 64;

/// The coverage functions that the article compares, with a legend for each.
pub const COVERAGES: [Coverage; 5] = [
    Coverage::Smoothstep,
    Coverage::Atan { k: 1.0 },
    Coverage::Atan { k: 4.0 },
    Coverage::Tanh,
    Coverage::Sigmoid,
];

/// Writes `NAME-loss.png`, the losses of descents; `NAME-end.png`, what they drew, after their target if that is given; and, if
/// asked for, `NAME.gif`, how they got there. `draw` draws what a descent has after a step.
fn show(
    output: &mut ResultFolder<'_>,
    name: &str,
    descents: &[(Coverage, Trajectory<f64>)],
    target: Option<&Panel>,
    is_animated: bool,
    draw: impl Fn(Coverage, &Trajectory<f64>, usize) -> Result<Panel>,
) -> Result<()> {
    let losses = descents.iter();
    let losses = losses.map(|(coverage, d)| (coverage.to_string(), d.losses.as_slice()));
    let losses = Chart::of_losses(name, losses).draw()?;
    output.picture(&format!("{name}-loss.png"), &losses)?;
    let sheet = |step: usize| {
        let mut panels: Vec<Panel> = target.cloned().into_iter().collect();
        for (coverage, descent) in descents {
            panels.push(Panel {
                title: format!("{coverage} {:.5}", descent.loss_at(step)),
                ..draw(*coverage, descent, step)?
            });
        }
        let sheet = Sheet {
            title: format!("{name}, step {step}"),
            columns: 3,
            zoom: 4,
            panels,
        };
        sheet.draw()
    };
    output.picture(&format!("{name}-end.png"), &sheet(STEPS)?)?;
    if is_animated {
        let frames = (0..=STEPS).step_by(4).map(sheet);
        output.animation(&format!("{name}.gif"), 80, frames)?;
    }
    Ok(())
}
