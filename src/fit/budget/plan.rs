//! The plan: how many strokes each stage adds, and how large they are.

use serde::{Deserialize, Serialize};

use crate::fit::base::Base;
use crate::fit::config::Config;
use crate::math;

/// Number of stages, unless the configuration sets it. With more stages, seeding sees the residual more often. Half, twice: −0.05,
/// +0.04 dB.
const COUNT: usize = 8;
/// Strokes of a stage, in units of the strokes of the stage before. 1.35 instead of 1.6: +0.08 dB; twice: −0.05.
const GROWTH: f64 = 1.35;
/// Strokes of the first stage if the total is not known in advance. Half, twice, at the default quality: −0.04, +0.06 dB at −0.8,
/// −4.5 % of the bytes.
pub(in crate::fit) const FIRST: usize = 12;
/// Pixels per stroke of an ordinary drawing: a guess, for the report of progress and for a number of stages without a budget.
const PIXELS_PER_STROKE: usize = 250;

/// One planned stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::fit) struct PlannedStage {
    /// From 0.
    pub(in crate::fit) index: usize,
    /// Strokes to add.
    pub(in crate::fit) count: usize,
    /// Their typical radius, px.
    pub(in crate::fit) scale: f32,
}

/// The layers and strokes of the base.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::fit) struct Before {
    pub(in crate::fit) layers: usize,
    pub(in crate::fit) strokes: usize,
}

impl Before {
    pub(in crate::fit) fn of(base: Option<&Base>) -> Self {
        base.map_or_else(Self::default, |Base { scene, .. }| Self {
            layers: scene.stages.len(),
            strokes: scene.len(),
        })
    }
}

/// The stages of a fit, coarse to fine.
#[derive(Debug, Clone)]
pub(in crate::fit) struct Plan {
    /// Layers of the base; the numbers of the stages follow theirs.
    before: usize,
    /// Stages of an open plan that the strokes of the base stand for.
    covered: usize,
    /// Strokes of each planned stage.
    counts: Vec<usize>,
    /// True if stages are added as long as they pay.
    open: bool,
    pixels: usize,
    /// Most strokes of an open plan.
    most: usize,
    /// See `Stages::scale`.
    scale: f32,
}

impl Plan {
    /// A plan for `limit` strokes, or for as many as will pay, less the strokes that are there `before`.
    pub(in crate::fit) fn new(
        config: &Config,
        limit: Option<usize>,
        before: Before,
        pixels: usize,
    ) -> Self {
        let stages = config.stages.unwrap_or(COUNT);
        let guess = config
            .stages
            .map(|_| (pixels / PIXELS_PER_STROKE).max(FIRST));
        let counts = limit
            .or(guess)
            .map(|total| rest(&counts(total, stages, GROWTH), before.strokes));
        Self {
            before: before.layers,
            covered: covered(before.strokes),
            open: counts.is_none(),
            counts: counts.unwrap_or_default(),
            pixels,
            most: config.most_strokes(pixels),
            scale: config.recipe().stages.scale,
        }
    }

    /// The number of layers of the base and of the stages planned so far.
    pub(in crate::fit) fn len(&self) -> usize {
        self.before + self.counts.len()
    }

    /// Strokes of all planned stages; a guess if the plan is open.
    pub(in crate::fit) fn strokes(&self) -> usize {
        if self.open {
            let guess = self.pixels / PIXELS_PER_STROKE;
            guess.clamp(1, self.most)
        } else {
            self.counts.iter().sum()
        }
    }

    /// Stage `index`, on top of `before` strokes; `None` after the last stage.
    pub(in crate::fit) fn stage(&self, index: usize, before: usize) -> Option<PlannedStage> {
        let step = index.checked_sub(self.before)?;
        let count = match self.counts.get(step) {
            Some(&count) => count,
            None if self.open => {
                // An open plan grows geometrically; the strokes of a base count as the stages that they would have been.
                let count = FIRST as f64 * math::powi(GROWTH, (self.covered + step) as i32);
                (count as usize).min(self.most.saturating_sub(before))
            }
            None => return None,
        };
        // The side of the square that each stroke has to itself once the stage is drawn.
        let spacing = (self.pixels as f32 / (before + count).max(1) as f32).sqrt();
        (count > 0).then_some(PlannedStage {
            index,
            count,
            scale: self.scale * spacing,
        })
    }
}

/// `total` strokes in at most `stages` stages, each `growth` times the one before.
fn counts(total: usize, stages: usize, growth: f64) -> Vec<usize> {
    let weights: Vec<f64> = (0..stages).map(|k| math::powi(growth, k as i32)).collect();
    let whole: f64 = weights.iter().sum();
    let (mut counts, mut before, mut reached) = (Vec::new(), 0, 0.0);
    for weight in weights {
        reached += weight;
        // Round the running sum, not each count: so the counts add up to `total`. Stages that round to none are left out.
        let after = (total as f64 * reached / whole).round() as usize;
        if after > before {
            counts.push(after - before);
        }
        before = after;
    }
    counts
}

/// Rest of planned stages if there are `before` strokes already. The rest of a stage that is more than half
/// done is added to the next.
fn rest(counts: &[usize], before: usize) -> Vec<usize> {
    let (mut rest, mut there, mut carried) = (Vec::new(), before, 0);
    for &count in counts {
        let covered = count.min(there);
        there -= covered;
        carried += count - covered;
        // A stage that is half done, or less, stays, and takes what earlier ones carried over.
        if covered * 2 <= count {
            rest.push(std::mem::take(&mut carried));
        }
    }
    // The last stage has no next one to carry to.
    if carried > 0 {
        rest.push(carried);
    }
    rest
}

/// Number of stages of an open plan that `before` strokes stand for.
fn covered(before: usize) -> usize {
    let (mut stages, mut strokes) = (0, 0.0);
    while strokes + FIRST as f64 * math::powi(GROWTH, stages) <= before as f64 {
        strokes += FIRST as f64 * math::powi(GROWTH, stages);
        stages += 1;
    }
    stages as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_grow_and_add_up() {
        let counts = counts(1000, 8, 1.6);
        assert_eq!(counts.len(), 8);
        assert_eq!(counts.iter().sum::<usize>(), 1000);
        assert!(counts.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn few_strokes_make_few_stages() {
        let counts = counts(2, 8, 1.6);
        assert_eq!(counts.iter().sum::<usize>(), 2);
        assert!(counts.iter().all(|&count| count > 0));
    }

    #[test]
    fn open_plans_go_on_to_a_stroke_for_sixteen_pixels() {
        let config = Config::default();
        let plan = Plan::new(&config, None, Before::default(), 3200);
        let mut strokes = 0;
        let mut index = 0;
        while let Some(stage) = plan.stage(index, strokes) {
            strokes += stage.count;
            index += 1;
        }
        assert_eq!(strokes, 200);
    }

    #[test]
    fn what_is_there_is_not_planned_again() {
        let counts = [10, 20, 40, 80];
        assert_eq!(rest(&counts, 0), counts);
        assert_eq!(rest(&counts, 30), [40, 80]);
        assert_eq!(rest(&counts, 35), [35, 80]);
        assert_eq!(
            rest(&counts, 60),
            [90],
            "10 strokes make no stage of their own"
        );
        assert_eq!(rest(&counts, 149), [1]);
        assert!(rest(&counts, 150).is_empty() && rest(&counts, 999).is_empty());
    }
}
