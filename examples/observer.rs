//! Watching a fit, and stopping it when it no longer gets better.
//!
//! ```sh
//! cargo run --release --example observer -- samples/coffee-300.png
//! ```
#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;

use strokefit::fit::{Budget, Config, Fit, Fitter, Observer, Progress};
use strokefit::image::Image;

/// Iterations that the polish may go on without a new best.
const PATIENCE: usize = 20;

/// A new best is better by this much, dB.
const NOTABLE: f64 = 0.02;

/// Stops the polish when it has not brought anything for a while.
#[derive(Default)]
pub(crate) struct Patience {
    stage: usize,
    best_db: f64,
    iterations_since: usize,
    /// The strokes that there were when a stage began.
    pub(crate) strokes: Vec<usize>,
}

impl Observer for Patience {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        // The best drawing of several is kept: this is one that the last one has to beat.
        if progress.is_trial {
            return ControlFlow::Continue(());
        }
        if !progress.polishing {
            if progress.stage > self.stage {
                self.stage = progress.stage;
                // The drawing itself is at hand, to be shown or saved.
                self.strokes.push(progress.scene().len());
            }
        } else if progress.psnr_db > self.best_db + NOTABLE {
            (self.best_db, self.iterations_since) = (progress.psnr_db, 0);
        } else {
            self.iterations_since += 1;
            if self.iterations_since > PATIENCE {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}

/// Draws `picture`; stopping early is no error, and what is there is finished and rounded.
pub(crate) fn draw(picture: &Image, patience: &mut Patience) -> strokefit::Result<Fit> {
    let config = Config {
        budget: Budget {
            strokes: Some(200),
            ..Budget::default()
        },
        ..Config::default()
    };
    Fitter::new(config).observer(patience).fit(picture)
}

#[allow(dead_code, reason = "the tests call `draw`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let input = std::env::args().nth(1).ok_or("say which picture to draw")?;
    let mut patience = Patience::default();
    let drawing = draw(&Image::open(input)?, &mut patience)?;
    println!("strokes when the stages began: {:?}", patience.strokes);
    println!(
        "{} strokes, stopped by {:?}",
        drawing.scene.len(),
        drawing.stop
    );
    Ok(())
}
