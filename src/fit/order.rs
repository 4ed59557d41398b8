//! The order of a fit: its phases, and which follows which.
//!
//! ```text
//! base ─→ polish              shorten a base of more strokes or bytes than may be; otherwise
//!   ↓
//! trace ⇄ stage               draw the lines that are seen
//!   ↓
//! grow ⇄ stage                add strokes, stage by stage
//!   ↓
//! polish ⇄ stage              fit all strokes jointly, and double them while far from the fidelity asked for;
//!                             go on to grow at a lower price if the drawing looks too little like the picture
//!   ↓
//! recover ─→ stage ─→ polish  draw small things that were lost on the way
//!   ↓
//! finish                      restrict ─→ settle
//!   ↓
//! fidelity ─→ stage ─→ polish ─→ finish ─→ fidelity     until the file is as faithful as asked for
//!   ↓
//! bytes ─→ finish ─→ bytes                              until it is as short as asked for
//! bytes ─→ polish ─→ finish                             once, if bytes are left
//! ```
//!
//! To *finish* a drawing takes two phases:
//!
//! ```text
//! restrict    give strokes the colours and widths that the file may have
//! settle      fit them to what renderers make of the file, and keep the file if it is the best so far
//! ```

use serde::{Deserialize, Serialize};

use super::config::Config;

/// One step in the order of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Phase {
    /// Keep the base as it is if it already meets a budget, and shorten it if it has too many strokes.
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
    /// Trace small things that the polish lost, if there are such.
    Recover,
    /// Give the strokes the colours and widths that the file may have.
    Restrict(Limit),
    /// Fit the strokes to what renderers make of the file, which is kept if it serves the budget better than the best one so far.
    Settle(Limit),
    /// Add or remove strokes if the file misses or exceeds the fidelity asked for.
    MeetFidelity,
    /// Remove strokes if the file has more bytes than asked for.
    MeetBytes,
    /// Hand over the best file.
    Done,
}

/// Purpose of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Purpose {
    /// To draw the lines that were traced.
    Trace,
    /// To draw a planned stage.
    Plan,
    /// To draw small things that were lost.
    Recover,
    /// To fill up the budget of strokes, which rejected strokes have left short.
    TopUp,
    /// To reach the fidelity asked for.
    Correct,
}

/// The limit that a finished drawing is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Limit {
    /// The fidelity asked for, and then the bytes.
    Fidelity,
    /// The bytes alone: strokes were removed for these.
    Bytes,
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

/// True if all strokes are polished once no more are planned. Each layer of a progressive drawing has been already.
fn polishes_all(config: &Config) -> bool {
    config.polish && !config.progressive
}

/// The first of the phases that finish a drawing.
const FINISH: Phase = Phase::Restrict(Limit::Fidelity);

/// The phase that follows `phase`, given its outcome.
pub(super) fn next(phase: Phase, outcome: Outcome, config: &Config) -> Phase {
    use Outcome::{Met, Rejected, Removed, Seeded, Short};
    match (phase, outcome) {
        (Phase::Base, Met) => Phase::Done,
        (Phase::Base, Removed) if polishes_all(config) => Phase::Polish(Purpose::Plan),
        (Phase::Base, Removed) => FINISH,
        (Phase::Base, _) => Phase::Trace,

        (Phase::Trace, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Trace, _) => Phase::Grow,

        (Phase::Grow, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Grow, _) if polishes_all(config) => Phase::Polish(Purpose::Plan),
        (Phase::Grow, _) => FINISH,

        (Phase::Stage(purpose), _) if config.progressive => Phase::StagePolish(purpose),
        (Phase::Stage(purpose) | Phase::StagePolish(purpose), outcome) => match purpose {
            Purpose::Trace => Phase::Trace,
            Purpose::Plan => Phase::Grow,
            Purpose::TopUp => FINISH,
            Purpose::Recover if outcome == Rejected => FINISH,
            Purpose::Recover => Phase::Polish(Purpose::Recover),
            // No further stroke helps.
            Purpose::Correct if outcome == Rejected => Phase::MeetBytes,
            Purpose::Correct => Phase::Polish(Purpose::Correct),
        },

        (Phase::Polish(_), Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Polish(Purpose::Plan), _) => Phase::Recover,
        (Phase::Polish(_), _) => FINISH,

        (Phase::Recover, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::Recover, _) => FINISH,

        (Phase::Restrict(limit), _) => Phase::Settle(limit),
        (Phase::Settle(Limit::Fidelity), _) => Phase::MeetFidelity,
        (Phase::Settle(Limit::Bytes), _) => Phase::MeetBytes,

        (Phase::MeetFidelity, Seeded(purpose)) => Phase::Stage(purpose),
        (Phase::MeetFidelity, Removed) => Phase::Polish(Purpose::Correct),
        (Phase::MeetFidelity, _) => Phase::MeetBytes,

        (Phase::MeetBytes, Removed) => Phase::Restrict(Limit::Bytes),
        (Phase::MeetBytes, Short) => Phase::Polish(Purpose::Correct),
        (Phase::MeetBytes | Phase::Done, _) => Phase::Done,
    }
}

impl Phase {
    /// The first phase of a fit, on a base or not.
    pub(super) fn first(has_base: bool) -> Self {
        if has_base { Self::Base } else { Self::Trace }
    }

    /// True if it is a planned stage, and a polish of all strokes is to come.
    pub(super) fn precedes_polish(self, config: &Config) -> bool {
        matches!(
            self,
            Self::Stage(Purpose::Trace | Purpose::Plan | Purpose::Recover)
        ) && polishes_all(config)
    }

    /// True if a fit can go on from a state in the middle of this phase.
    pub(super) fn is_divisible(self) -> bool {
        matches!(
            self,
            Self::Stage(_) | Self::StagePolish(_) | Self::Polish(_)
        )
    }

    /// True if a checkpoint keeps the state before this phase even if it is not due: the phase takes long and cannot be
    /// divided, or nothing is left to do.
    pub(super) fn is_milestone(self) -> bool {
        matches!(self, Self::Restrict(_) | Self::Done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The phases that finish a drawing.
    const FINISHED: [Phase; 2] = [FINISH, Phase::Settle(Limit::Fidelity)];

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
        let polish = [Phase::Grow, Phase::Polish(Purpose::Plan), Phase::Recover];
        let rest = [Phase::MeetFidelity, Phase::MeetBytes, Phase::Done];
        let expected = [&stage[..], &stage, &polish, &FINISHED, &rest];
        assert_eq!(phases, expected.concat());
    }

    #[test]
    fn what_a_correction_adds_or_removes_is_polished_and_finished() {
        let phases = order(&Config::default(), |phase, visits| match (phase, visits) {
            (Phase::MeetFidelity, 1) => Outcome::Seeded(Purpose::Correct),
            (Phase::MeetFidelity, 2) => Outcome::Removed,
            _ => Outcome::Over,
        });
        let first = phases.iter().position(|&p| p == Phase::MeetFidelity);
        let polish = [Phase::Polish(Purpose::Correct)];
        let meet = [Phase::MeetFidelity];
        let fitted = [&polish[..], &FINISHED, &meet].concat();
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
        let shorter = Phase::Restrict(Limit::Bytes);
        assert_eq!(phases.iter().filter(|&&p| p == shorter).count(), 3);
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
