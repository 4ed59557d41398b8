//! The division of a time limit among the parts of a fit, in seconds.
//!
//! Descent gets all the time that later parts do not need. These write the drawing, settle it against its file, and
//! judge the file, which renders it once more. The forecast estimates all of them from the durations of the last write,
//! of steps and of searches.

use std::time::Duration;

use crate::fit::recipe::{Recipe, SETTLING_STEPS};

// The unit of most durations is a *write*: the time to round, write and render the drawing once, which is measured during the fit.
// With these numbers fits end within 5 % of limits from half a second to ten, in a simulation of machines that draw strokes up to a
// quarter faster or slower than expected (`the_limit_is_met_by_a_twentieth`).
/// Time to write and render a stroke, in units of that for a pixel.
const STROKE_PX: f64 = 160.0;
/// Cost of our own render of a file and the comparisons, in writes of an empty drawing.
const LOOKING: f64 = 1.15;
/// Cost of judging and reporting after the fit, in writes of the drawing: it is written and rendered once more, and compressed for the
/// report.
const JUDGING: f64 = 1.75;
/// That cost for a transparent drawing, which is rendered on two mattes.
const JUDGING_TRANSPARENT: f64 = 2.2;
/// Cost after the fit that does not depend on the strokes, in writes of an empty drawing: three comparisons, layers.
const JUDGING_EMPTY: f64 = 2.6;
/// Most of the limit, as a share, that rounds of settling take. Beyond it, descent gains more in the same time.
const SETTLING: f64 = 0.125;
/// Least share of the limit for descent, however long the rest takes.
const MIN_DESCENT: f64 = 0.25;
/// Least duration of a polish, in writes: this is a hundred steps or more. A polish begins with soft edges and long steps, so that one
/// of 20 steps takes a drawing from 34 dB to 25.
const MIN_POLISH: f64 = 15.0;
/// Share of the time that measuring writes may take.
const TRIAL_WRITES: f64 = 0.01;
/// Least number of steps that make a round of settling worth its write.
const MIN_ROUND: f64 = 2.0;
/// Weight of a new measurement in the running mean of the duration of steps.
const FRESHNESS: f64 = 0.2;
/// A stage is left out if there is time to search for less than one in this many of the strokes wanted.
const MIN_SEARCH: usize = 8;

/// Measured durations, s, and what they leave for the parts of a fit. Times are in seconds since the limit was set,
/// usually when the fit began.
#[derive(Debug, Clone)]
pub(in crate::fit) struct Forecast {
    limit: f64,
    pixels: f64,
    is_transparent: bool,
    /// True if the fit itself looks at the file, before it is judged.
    needs_file: bool,
    /// Rounds of settling.
    rounds: usize,
    /// Duration of a write, per pixel of its size.
    per_pixel: f64,
    /// Time of the next measurement of a write.
    due: f64,
    /// Duration of a step of descent, a running mean.
    step: f64,
    /// Duration of the search for a candidate.
    search: f64,
}

impl Forecast {
    /// The forecast of a fit to a picture of `pixels` pixels that may take `limit` in all. A transparent drawing takes
    /// longer to judge. A fit that `needs_file` looks at the file that it writes.
    pub(in crate::fit) fn new(
        limit: Duration,
        pixels: usize,
        is_transparent: bool,
        needs_file: bool,
        recipe: &Recipe,
    ) -> Self {
        Self {
            limit: limit.as_secs_f64(),
            pixels: pixels as f64,
            is_transparent,
            needs_file,
            rounds: recipe.settling_rounds,
            per_pixel: 0.0,
            due: 0.0,
            step: 0.0,
            search: 0.0,
        }
    }

    /// Records that writing and rendering `strokes` strokes took `span` and ended at `now`.
    pub(in crate::fit) fn wrote(&mut self, strokes: usize, span: f64, now: f64) {
        self.per_pixel = span / self.size(strokes);
        self.due = now + span / TRIAL_WRITES;
    }

    /// Records that a step of descent took `span`.
    pub(in crate::fit) fn stepped(&mut self, span: f64) {
        self.step = match self.step {
            0.0 => span,
            mean => mean + FRESHNESS * (span - mean),
        };
    }

    /// Records that the search for `strokes` candidates took `span`.
    pub(in crate::fit) fn searched(&mut self, strokes: usize, span: f64) {
        self.search = span / strokes.max(1) as f64;
    }

    /// True if it is time to write the drawing once, to measure how long that takes.
    pub(in crate::fit) fn wants_trial_write(&self, now: f64) -> bool {
        now >= self.due
    }

    /// The share of the time for descent that is used, for a drawing of `strokes` strokes.
    pub(in crate::fit) fn used(&self, strokes: usize, now: f64) -> f32 {
        (now / self.end_of_descent(strokes)) as f32
    }

    /// Number of `wanted` candidates that there is time to search for, on a drawing of `strokes` strokes; 0 if too few. Leaves
    /// time for a few steps that fit the new strokes.
    pub(in crate::fit) fn affordable(&self, wanted: usize, strokes: usize, now: f64) -> usize {
        let left = self.end_of_descent(strokes) - now - SETTLING_STEPS as f64 * self.step;
        let affordable = (left / self.search.max(f64::MIN_POSITIVE)) as usize;
        let affordable = affordable.min(wanted);
        if affordable >= wanted / MIN_SEARCH {
            affordable
        } else {
            0
        }
    }

    /// True if there is time for a polish that is long enough to be of use.
    pub(in crate::fit) fn allows_polish(&self, strokes: usize, now: f64) -> bool {
        now + MIN_POLISH * self.write_s(strokes) < self.end_of_descent(strokes)
    }

    /// True if another round of settling, of a few steps at least, ends in time.
    pub(in crate::fit) fn allows_round(&self, strokes: usize, now: f64) -> bool {
        self.ends_in_time(strokes, now + MIN_ROUND * self.step)
    }

    /// True if another step of a round of settling ends in time.
    pub(in crate::fit) fn allows_step(&self, strokes: usize, now: f64) -> bool {
        self.ends_in_time(strokes, now + self.step)
    }

    /// The time by which the descent of a drawing of `strokes` strokes has to end.
    fn end_of_descent(&self, strokes: usize) -> f64 {
        let end = self.limit - self.settling(strokes) - self.judging(strokes);
        end.max(self.limit * MIN_DESCENT)
    }

    /// True if a file whose writing begins at `now` can be looked at and judged in time.
    fn ends_in_time(&self, strokes: usize, now: f64) -> bool {
        now + self.seeing(strokes) + self.judging(strokes) < self.limit
    }

    /// The size of a write, in pixels.
    fn size(&self, strokes: usize) -> f64 {
        self.pixels + STROKE_PX * strokes as f64
    }

    /// Duration of rounding, writing and rendering a drawing of `strokes` strokes.
    fn write_s(&self, strokes: usize) -> f64 {
        self.per_pixel * self.size(strokes)
    }

    /// Duration of a write that a round of settling starts from, and of looking at it.
    fn seeing(&self, strokes: usize) -> f64 {
        self.write_s(strokes) + LOOKING * self.write_s(0)
    }

    /// The time reserved for the first write and the rounds of settling, which are shorter if the limit is short.
    fn settling(&self, strokes: usize) -> f64 {
        let seeing = self.seeing(strokes);
        let round = |steps: f64| seeing + steps * self.step;
        let rounds = self.rounds as f64 * round(SETTLING_STEPS as f64);
        let most = self.limit * SETTLING;
        if self.rounds > 0 && round(MIN_ROUND) < most {
            seeing + rounds.min(most)
        } else if self.needs_file {
            self.write_s(strokes)
        } else {
            0.0
        }
    }

    /// The time reserved for what follows the fit.
    fn judging(&self, strokes: usize) -> f64 {
        let writes = if self.is_transparent {
            JUDGING_TRANSPARENT
        } else {
            JUDGING
        };
        writes * self.write_s(strokes) + JUDGING_EMPTY * self.write_s(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::recipe::Preset;

    const PIXELS: usize = 768 * 512;

    /// A machine that keeps its own time.
    struct Machine {
        now: f64,
        per_pixel: f64,
        stroke_px: f64,
    }

    impl Machine {
        fn write_s(&self, strokes: usize) -> f64 {
            self.per_pixel * (PIXELS as f64 + self.stroke_px * strokes as f64)
        }

        fn write(&mut self, forecast: &mut Forecast, strokes: usize) {
            let span = self.write_s(strokes);
            self.now += span;
            forecast.wrote(strokes, span, self.now);
        }

        fn look(&mut self) {
            self.now += LOOKING * self.write_s(0);
        }

        fn step(&mut self, forecast: &mut Forecast, strokes: usize) {
            let span = self.write_s(strokes) / 7.0;
            self.now += span;
            forecast.stepped(span);
        }

        /// Fits a drawing of `most` strokes, of which it adds as many as a second allows, and says what that takes.
        fn fit(mut self, limit: f64, most: usize) -> f64 {
            let recipe = Recipe::of(Preset::Balanced);
            let limit_s = Duration::from_secs_f64(limit);
            let mut forecast = Forecast::new(limit_s, PIXELS, false, true, &recipe);
            let strokes = |now: f64| most.min((4000.0 * now) as usize);
            while self.now < forecast.end_of_descent(strokes(self.now)) {
                if forecast.wants_trial_write(self.now) {
                    self.write(&mut forecast, strokes(self.now));
                }
                self.step(&mut forecast, strokes(self.now));
            }
            let strokes = strokes(self.now);
            self.write(&mut forecast, strokes);
            if forecast.allows_round(strokes, self.now) {
                self.look();
            }
            while forecast.allows_round(strokes, self.now) {
                while forecast.allows_step(strokes, self.now) {
                    self.step(&mut forecast, strokes);
                }
                self.write(&mut forecast, strokes);
                self.look();
            }
            self.now + JUDGING * self.write_s(strokes) + JUDGING_EMPTY * self.write_s(0)
        }
    }

    #[test]
    fn the_limit_is_met_by_a_twentieth() {
        for limit in [0.5, 1.0, 2.0, 5.0, 10.0] {
            for strokes in [500, 2900, 5000, 20_000] {
                // Strokes that are quicker to draw than they are taken to be, and slower.
                for stroke_px in [120.0, 160.0, 200.0] {
                    let machine = Machine {
                        now: 0.015,
                        per_pixel: 3e-8,
                        stroke_px,
                    };
                    let taken = machine.fit(limit, strokes);
                    assert!(
                        (taken / limit - 1.0).abs() < 0.05,
                        "{taken} s of {limit}, {strokes} strokes of {stroke_px} px"
                    );
                }
            }
        }
    }

    fn forecast(limit_s: u64) -> Forecast {
        let recipe = Recipe::of(Preset::Balanced);
        let mut forecast =
            Forecast::new(Duration::from_secs(limit_s), PIXELS, false, true, &recipe);
        forecast.wrote(1000, 0.02, 0.1);
        forecast.stepped(0.004);
        forecast
    }

    #[test]
    fn more_strokes_take_longer_to_end() {
        let forecast = forecast(5);
        let end = |strokes| forecast.end_of_descent(strokes);
        assert!(end(0) > end(1000) && end(1000) > end(20_000) && end(20_000) > 2.0);
    }

    #[test]
    fn descent_has_its_part_however_long_the_rest_takes() {
        assert!(forecast(1).end_of_descent(1_000_000) >= MIN_DESCENT);
    }

    #[test]
    fn writes_are_measured_now_and_then() {
        let forecast = forecast(5);
        assert!(!forecast.wants_trial_write(2.0) && forecast.wants_trial_write(2.2));
    }

    #[test]
    fn strokes_are_sought_as_far_as_there_is_time() {
        let mut forecast = forecast(5);
        forecast.searched(100, 0.1);
        let left = forecast.end_of_descent(1000) - 3.0;
        let affordable = forecast.affordable(2_000, 1000, 3.0);
        assert!(affordable > 0 && affordable as f64 * 0.001 < left);
        assert_eq!(forecast.affordable(2_000, 1000, 5.0), 0);
    }

    #[test]
    fn a_joint_fit_too_short_to_be_of_use_is_left_out() {
        let forecast = forecast(5);
        assert!(forecast.allows_polish(1000, 1.0) && !forecast.allows_polish(1000, 4.5));
    }
}
