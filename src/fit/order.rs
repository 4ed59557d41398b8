//! The order of a fit: its phases, and which follows which.
//!
//! ```text
//! base ─→ trace ⇄ stage       draw the lines that are seen
//!           ↓
//!         grow ⇄ stage        add strokes, stage by stage
//!           ↓
//!         polish ⇄ stage      fit all strokes jointly, and double them while far from the fidelity asked for
//!           ↓
//!         settle              fit them to what the file looks like
//!           ↓
//!         fidelity ─→ stage ─→ polish ─→ settle ─→ fidelity     until the file is as faithful as asked for
//!           ↓
//!         bytes ─→ shorten ─→ bytes                             until it is as short as asked for
//!         bytes ─→ polish ─→ settle                             once, if bytes are left
//! ```

use serde::{Deserialize, Serialize};

use super::base::Base;
use super::config::Config;

/// One step in the order of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Phase {
    /// Keep the base as it is if it already meets a budget.
    Base,
    /// Trace the lines of what is not drawn yet, if there are such.
    Trace,
    /// Seed the next stage, if one is planned and the last one paid.
    Grow,
    /// Fit the strokes of a stage alone, and keep what pays.
    Stage(Purpose),
    /// Polish the strokes of a stage of a progressive drawing.
    StagePolish(Purpose),
    /// Fit all strokes jointly.
    Polish(Purpose),
    /// Restrict the drawing to its palette and pens, and settle it against its file.
    Settle,
    /// Add or remove strokes if the file misses or exceeds the fidelity asked for.
    MeetFidelity,
    /// Remove strokes if the file has more bytes than asked for.
    MeetBytes,
    /// Settle the drawing again after strokes were removed for bytes.
    Shorten,
    /// Hand over the best file.
    Done,
}

/// What a stage is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Purpose {
    /// To draw the lines that were traced.
    Trace,
    /// To draw a planned stage.
    Plan,
    /// To fill up the budget of strokes, which rejected strokes have left short.
    TopUp,
    /// To reach the fidelity asked for.
    Correct,
}

/// The result of a phase, as far as the next phase depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The phase has done its part, or had nothing to do.
    Over,
    /// A budget is met, so that the fit ends.
    Met,
    /// Strokes were added; a stage has to fit them first.
    Seeded(Purpose),
    /// Strokes were removed.
    Removed,
    /// None of the strokes of a stage was worth its price.
    Rejected,
    /// The file may have more bytes.
    Short,
}

/// Whether all strokes are polished once no more are planned. Each layer of a progressive drawing has been already.
fn polishes_all(config: &Config) -> bool {
    config.polish && !config.progressive
}

/// The phase that follows `phase`, given its outcome.
pub(super) fn next(phase: Phase, outcome: Outcome, config: &Config) -> Phase {
    use Outcome::{Met, Rejected, Removed, Seeded, Short};
    match (phase, outcome) {
        (Phase::Base, Met) => Phase::Done,
        (Phase::Base, _) => Phase::Trace,

        (Phase::Trace, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Trace, _) => Phase::Grow,

        (Phase::Grow, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Grow, _) if polishes_all(config) => Phase::Polish(Purpose::Plan),
        (Phase::Grow, _) => Phase::Settle,

        (Phase::Stage(purpose), _) if config.progressive => Phase::StagePolish(purpose),
        (Phase::Stage(purpose) | Phase::StagePolish(purpose), outcome) => match purpose {
            Purpose::Trace => Phase::Trace,
            Purpose::Plan => Phase::Grow,
            Purpose::TopUp => Phase::Settle,
            // No further stroke helps.
            Purpose::Correct if outcome == Rejected => Phase::MeetBytes,
            Purpose::Correct => Phase::Polish(Purpose::Correct),
        },

        (Phase::Polish(_), Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Polish(_), _) => Phase::Settle,
        (Phase::Settle, _) => Phase::MeetFidelity,

        (Phase::MeetFidelity, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::MeetFidelity, Removed) => Phase::Polish(Purpose::Correct),
        (Phase::MeetFidelity, _) => Phase::MeetBytes,

        (Phase::MeetBytes, Removed) => Phase::Shorten,
        (Phase::MeetBytes, Short) => Phase::Polish(Purpose::Correct),
        (Phase::Shorten, _) => Phase::MeetBytes,
        (Phase::MeetBytes | Phase::Done, _) => Phase::Done,
    }
}

impl Phase {
    /// The first phase of a fit.
    pub(super) fn first(config: &Config, base: Option<&Base>) -> Self {
        // A base that uses colours outside the palette, or other pens, cannot stay as it is.
        match base {
            Some(base) if config.pens.is_none() && config.colors.allow(&base.scene) => Self::Base,
            _ => Self::Trace,
        }
    }

    /// Whether it is a planned stage, and a polish of all strokes is to come.
    pub(super) fn precedes_polish(self, config: &Config) -> bool {
        matches!(self, Self::Stage(Purpose::Trace | Purpose::Plan)) && polishes_all(config)
    }

    /// Whether a fit can go on from a state in the middle of this phase.
    pub(super) fn is_divisible(self) -> bool {
        matches!(
            self,
            Self::Stage(_) | Self::StagePolish(_) | Self::Polish(_)
        )
    }

    /// Whether to keep the state before this phase even if the checkpoint is not due: the phase takes long and cannot
    /// be divided, or nothing is left to do.
    pub(super) fn is_milestone(self) -> bool {
        matches!(self, Self::Settle | Self::Shorten | Self::Done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The phases from the first to the last, each with the outcome that `outcome` gives it.
    fn order(config: &Config, outcome: impl Fn(Phase, usize) -> Outcome) -> Vec<Phase> {
        let mut phases = vec![Phase::Grow];
        while let Some(&phase) = phases.last().filter(|&&phase| phase != Phase::Done) {
            let visits = phases.iter().filter(|&&p| p == phase).count();
            phases.push(next(phase, outcome(phase, visits), config));
            assert!(phases.len() < 100, "{phases:?}");
        }
        phases
    }

    #[test]
    fn a_plain_fit_goes_straight_through() {
        let phases = order(&Config::default(), |phase, visits| match phase {
            Phase::Grow if visits <= 2 => Outcome::Seeded(Purpose::Plan),
            _ => Outcome::Over,
        });
        let stage = [Phase::Grow, Phase::Stage(Purpose::Plan)];
        let rest = [
            Phase::Grow,
            Phase::Polish(Purpose::Plan),
            Phase::Settle,
            Phase::MeetFidelity,
            Phase::MeetBytes,
            Phase::Done,
        ];
        assert_eq!(phases, [&stage[..], &stage, &rest].concat());
    }

    #[test]
    fn what_a_correction_adds_or_removes_is_polished_and_settled() {
        let phases = order(&Config::default(), |phase, visits| match (phase, visits) {
            (Phase::MeetFidelity, 1) => Outcome::Seeded(Purpose::Correct),
            (Phase::MeetFidelity, 2) => Outcome::Removed,
            _ => Outcome::Over,
        });
        let first = phases.iter().position(|&p| p == Phase::MeetFidelity);
        let fitted = [
            Phase::Polish(Purpose::Correct),
            Phase::Settle,
            Phase::MeetFidelity,
        ];
        let stage = [Phase::MeetFidelity, Phase::Stage(Purpose::Correct)];
        let end = [Phase::MeetBytes, Phase::Done];
        let expected = [&stage[..], &fitted, &fitted, &end].concat();
        assert_eq!(phases[first.unwrap()..], expected);
    }

    #[test]
    fn a_correction_that_adds_nothing_ends_the_corrections() {
        let phases = order(&Config::default(), |phase, _| match phase {
            Phase::MeetFidelity => Outcome::Seeded(Purpose::Correct),
            Phase::Stage(_) => Outcome::Rejected,
            _ => Outcome::Over,
        });
        let visits = phases.iter().filter(|&&p| p == Phase::MeetFidelity);
        assert_eq!(visits.count(), 1);
    }

    #[test]
    fn a_file_is_shortened_until_it_is_short_enough() {
        let phases = order(&Config::default(), |phase, visits| match phase {
            Phase::MeetBytes if visits <= 3 => Outcome::Removed,
            _ => Outcome::Over,
        });
        let shortened = phases.iter().filter(|&&p| p == Phase::Shorten).count();
        assert_eq!(shortened, 3);
    }

    #[test]
    fn layers_of_a_progressive_drawing_are_polished_one_by_one() {
        let config = Config {
            progressive: true,
            ..Config::default()
        };
        let phases = order(&config, |phase, visits| match phase {
            Phase::Grow if visits == 1 => Outcome::Seeded(Purpose::Plan),
            _ => Outcome::Over,
        });
        assert_eq!(phases[2], Phase::StagePolish(Purpose::Plan));
        assert!(!phases.contains(&Phase::Polish(Purpose::Plan)));
    }
}
