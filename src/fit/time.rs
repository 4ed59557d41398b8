//! Time: the clock of a fit, and what a limit leaves room for.

mod forecast;
mod timer;

pub(super) use forecast::Forecast;
pub(super) use timer::Timer;
