//! What is still to come of a fit whose time is limited, in seconds.
//!
//! Descent is given all the time that what follows it does not need: the drawing is written and settled against
//! its file, and at last the file is judged, which renders it again. All of that is reckoned from how long a
//! writing took when one was last tried, and from how long steps, searches and rounds take.

use std::time::Duration;

use super::recipe::Recipe;

/// A stroke takes as long to write and to render as so many pixels do, about.
const STROKE_PX: f64 = 160.0;
/// What looking at the file as a browser does takes beside a writing, in writings of the drawing …
const LOOKING: f64 = 0.25;
/// … and, whatever the strokes, in writings of an empty page: our own render, and comparisons.
const LOOKING_AT_PAGE: f64 = 1.15;
/// What follows the fit, in writings of the drawing: the judge writes and renders it once more, the report
/// packs it.
const JUDGING: f64 = 1.75;
/// The same of a transparent drawing, whose writings render two grounds.
const JUDGING_CLEAR: f64 = 2.2;
/// What follows the fit whatever the strokes, in writings of an empty page: three comparisons, layers.
const COMPARING: f64 = 2.6;
/// Rounds of settling may take up to this part of the limit; they bring less than as much descent beyond.
const SETTLING: f64 = 0.125;
/// Share of a limit that is for the descent however long the rest takes.
const MIN_DESCENT: f64 = 0.25;
/// A joint fit takes this many writings at least, which are a hundred steps or more: it begins with soft edges
/// and long steps, and one of twenty leaves a drawing of 34 dB at 25.
const MIN_POLISH: f64 = 15.0;
/// Trying how long a writing takes may take this part of the time.
const TRYING: f64 = 0.01;
/// Steps that make a round of settling worth its writing.
const MIN_ROUND: f64 = 2.0;
/// Share of a new measurement in the mean of steps.
const FRESHNESS: f64 = 0.2;

/// What a limited fit knows of the time that its parts take.
#[derive(Debug, Clone)]
pub(super) struct Forecast {
    limit: f64,
    pixels: f64,
    is_clear: bool,
    /// Whether the drawing is written before it is judged.
    needs_file: bool,
    /// Rounds of settling, and steps of each.
    rounds: usize,
    steps: usize,
    /// How long a pixel takes to write.
    per_pixel: f64,
    /// When a writing is to be tried next.
    due: f64,
    /// How long a step of descent takes.
    step: f64,
    /// How long the search for a stroke takes.
    search: f64,
}

impl Forecast {
    /// For a fit that may take `limit` in all, of a picture of so many pixels, `is_clear` if it is transparent;
    /// it `needs_file` if it looks at what it writes.
    pub(super) fn new(
        limit: Duration,
        pixels: usize,
        is_clear: bool,
        needs_file: bool,
        recipe: &Recipe,
    ) -> Self {
        Self {
            limit: limit.as_secs_f64(),
            pixels: pixels as f64,
            is_clear,
            needs_file,
            rounds: recipe.settle_rounds,
            steps: recipe.settle_iterations,
            per_pixel: 0.0,
            due: 0.0,
            step: 0.0,
            search: 0.0,
        }
    }

    /// Takes down that a writing of so many strokes took `span` seconds and was done at `now`.
    pub(super) fn has_written(&mut self, strokes: usize, span: f64, now: f64) {
        self.per_pixel = span / self.size(strokes);
        self.due = now + span / TRYING;
    }

    /// Takes down that a step took `span` seconds.
    pub(super) fn has_stepped(&mut self, span: f64) {
        self.step = match self.step {
            0.0 => span,
            mean => mean + FRESHNESS * (span - mean),
        };
    }

    /// Takes down that the search for so many strokes took `span` seconds.
    pub(super) fn has_searched(&mut self, strokes: usize, span: f64) {
        self.search = span / strokes.max(1) as f64;
    }

    /// Whether it is time to try a writing again.
    pub(super) fn is_due(&self, now: f64) -> bool {
        now >= self.due
    }

    /// When the descent of a drawing of so many strokes has to end.
    pub(super) fn end_of_descent(&self, strokes: usize) -> f64 {
        let end = self.limit - self.settling(strokes) - self.judging(strokes);
        end.max(self.limit * MIN_DESCENT)
    }

    /// For how many strokes there is time to search, and to fit them for a few steps.
    pub(super) fn affordable(&self, strokes: usize, now: f64) -> usize {
        let left = self.end_of_descent(strokes) - now - self.steps as f64 * self.step;
        (left / self.search.max(f64::MIN_POSITIVE)) as usize
    }

    /// Whether there is time for enough steps of all strokes jointly.
    pub(super) fn allows_polish(&self, strokes: usize, now: f64) -> bool {
        now + MIN_POLISH * self.writing(strokes) < self.end_of_descent(strokes)
    }

    /// Whether another round of settling, if only of a few steps, ends in time.
    pub(super) fn allows_round(&self, strokes: usize, now: f64) -> bool {
        self.ends_in_time(strokes, now + MIN_ROUND * self.step)
    }

    /// Whether another step of a round of settling ends in time.
    pub(super) fn allows_step(&self, strokes: usize, now: f64) -> bool {
        self.ends_in_time(strokes, now + self.step)
    }

    /// Whether what is written from `now` on is judged in time.
    fn ends_in_time(&self, strokes: usize, now: f64) -> bool {
        now + self.seeing(strokes) + self.judging(strokes) < self.limit
    }

    /// How much there is to write, in pixels.
    fn size(&self, strokes: usize) -> f64 {
        self.pixels + STROKE_PX * strokes as f64
    }

    fn writing(&self, strokes: usize) -> f64 {
        self.per_pixel * self.size(strokes)
    }

    /// A writing that is settled from.
    fn seeing(&self, strokes: usize) -> f64 {
        (1.0 + LOOKING) * self.writing(strokes) + LOOKING_AT_PAGE * self.writing(0)
    }

    /// The time that is kept for the first writing and for rounds of settling; short rounds where it is short.
    fn settling(&self, strokes: usize) -> f64 {
        let seeing = self.seeing(strokes);
        let round = |steps: f64| seeing + steps * self.step;
        let rounds = self.rounds as f64 * round(self.steps as f64);
        let most = self.limit * SETTLING;
        if self.rounds > 0 && round(MIN_ROUND) < most {
            seeing + rounds.min(most)
        } else if self.needs_file {
            self.writing(strokes)
        } else {
            0.0
        }
    }

    fn judging(&self, strokes: usize) -> f64 {
        let writings = if self.is_clear {
            JUDGING_CLEAR
        } else {
            JUDGING
        };
        writings * self.writing(strokes) + COMPARING * self.writing(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::config::Preset;

    const PIXELS: usize = 768 * 512;

    /// A machine that keeps its own time.
    struct Machine {
        now: f64,
        per_pixel: f64,
        stroke_px: f64,
    }

    impl Machine {
        fn writing(&self, strokes: usize) -> f64 {
            self.per_pixel * (PIXELS as f64 + self.stroke_px * strokes as f64)
        }

        fn write(&mut self, forecast: &mut Forecast, strokes: usize) {
            let span = self.writing(strokes);
            self.now += span;
            forecast.has_written(strokes, span, self.now);
        }

        fn look(&mut self, strokes: usize) {
            self.now += LOOKING * self.writing(strokes) + LOOKING_AT_PAGE * self.writing(0);
        }

        fn step(&mut self, forecast: &mut Forecast, strokes: usize) {
            let span = self.writing(strokes) / 7.0;
            self.now += span;
            forecast.has_stepped(span);
        }

        /// Fits a drawing of `most` strokes, of which it adds as many as a second allows, and says what that takes.
        fn fit(mut self, limit: f64, most: usize) -> f64 {
            let recipe = Recipe::of(Preset::Balanced);
            let limit_s = Duration::from_secs_f64(limit);
            let mut forecast = Forecast::new(limit_s, PIXELS, false, true, &recipe);
            let strokes = |now: f64| most.min((4000.0 * now) as usize);
            while self.now < forecast.end_of_descent(strokes(self.now)) {
                if forecast.is_due(self.now) {
                    self.write(&mut forecast, strokes(self.now));
                }
                self.step(&mut forecast, strokes(self.now));
            }
            let strokes = strokes(self.now);
            self.write(&mut forecast, strokes);
            if forecast.allows_round(strokes, self.now) {
                self.look(strokes);
            }
            while forecast.allows_round(strokes, self.now) {
                while forecast.allows_step(strokes, self.now) {
                    self.step(&mut forecast, strokes);
                }
                self.write(&mut forecast, strokes);
                self.look(strokes);
            }
            self.now + JUDGING * self.writing(strokes) + COMPARING * self.writing(0)
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
        forecast.has_written(1000, 0.02, 0.1);
        forecast.has_stepped(0.004);
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
    fn writings_are_tried_now_and_then() {
        let forecast = forecast(5);
        assert!(!forecast.is_due(2.0) && forecast.is_due(2.2));
    }

    #[test]
    fn strokes_are_sought_as_far_as_there_is_time() {
        let mut forecast = forecast(5);
        forecast.has_searched(100, 0.1);
        let left = forecast.end_of_descent(1000) - 3.0;
        let affordable = forecast.affordable(1000, 3.0);
        assert!(affordable > 0 && affordable as f64 * 0.001 < left);
        assert_eq!(forecast.affordable(1000, 5.0), 0);
    }

    #[test]
    fn a_joint_fit_too_short_to_be_of_use_is_left_out() {
        let forecast = forecast(5);
        assert!(forecast.allows_polish(1000, 1.0) && !forecast.allows_polish(1000, 4.5));
    }
}
