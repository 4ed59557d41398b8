//! The clock of a fit, and the division of a time limit among its parts.
//!
//! Descent gets all the time that later parts do not need. These write the drawing, settle it against its file, and
//! judge the file, which renders it once more. The forecast estimates all of them from the durations of the last write,
//! of steps and of searches. Without a limit there is time for everything.

use std::time::Duration;

use crate::clock::Instant;

/// Iterations of a round of settling. 150 instead of 20: +0.005 dB.
pub(super) const SETTLING_STEPS: usize = 20;

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
pub(super) const MIN_ROUND: usize = 2;
/// Weight of a new measurement in the running mean of the duration of steps.
const FRESHNESS: f64 = 0.2;
/// A stage is left out if there is time to search for less than one in this many of the strokes wanted.
const MIN_SEARCH: usize = 8;

/// The clock of a fit.
pub(super) struct Timer {
    started: Instant,
    /// Time that the fit took before it was resumed.
    before: Duration,
    /// The forecast, if the time is limited, and when its limit was set: its times begin there.
    forecast: Option<Forecast>,
    set: Duration,
    /// The share of the time for descent by which the current phase has to end.
    pub(super) until: f32,
    /// Strokes of the drawing, when they were last counted.
    strokes: usize,
    /// When the last step ended.
    stepped: Option<Duration>,
    /// True if the limit made anything shorter than planned.
    pub(super) is_hurried: bool,
}

impl Timer {
    pub(super) fn new(started: Instant, forecast: Option<Forecast>) -> Self {
        Self {
            started,
            before: Duration::ZERO,
            forecast,
            set: Duration::ZERO,
            until: 1.0,
            strokes: 0,
            stepped: None,
            is_hurried: false,
        }
    }

    /// Time that the fit has taken, before and after it was resumed.
    pub(super) fn elapsed(&self) -> Duration {
        self.before + self.started.elapsed()
    }

    /// Adds the time that the fit took before it was resumed.
    pub(super) fn resume(&mut self, before: Duration) {
        self.before = before;
    }

    /// Sets a limit whose time begins now.
    pub(super) fn restart(&mut self, forecast: Forecast) {
        (self.forecast, self.set) = (Some(forecast), self.elapsed());
        self.stepped = None;
    }

    /// Time since the limit was set, s.
    fn now(&self) -> f64 {
        self.elapsed().saturating_sub(self.set).as_secs_f64()
    }

    /// Runs and times `work`, which writes and renders a drawing of `strokes` strokes.
    pub(super) fn writing<T>(&mut self, strokes: usize, work: impl FnOnce() -> T) -> T {
        self.strokes = strokes;
        let start = self.now();
        let done = work();
        let now = self.now();
        if let Some(forecast) = &mut self.forecast {
            forecast.wrote(strokes, now - start, now);
        }
        done
    }

    /// Runs and times `work`, which searches for `wanted` candidates.
    pub(super) fn searching<T>(&mut self, wanted: usize, work: impl FnOnce() -> T) -> T {
        let start = self.now();
        let done = work();
        let span = self.now() - start;
        if let Some(forecast) = &mut self.forecast {
            forecast.search_s = span / wanted.max(1) as f64;
        }
        // A search is no part of a step.
        self.stepped = None;
        done
    }

    /// Records the end of a step of a drawing of `strokes` strokes.
    pub(super) fn step(&mut self, strokes: usize) {
        let now = self.elapsed();
        if let (Some(forecast), Some(before)) = (&mut self.forecast, self.stepped) {
            forecast.stepped((now - before).as_secs_f64());
        }
        (self.strokes, self.stepped) = (strokes, Some(now));
    }

    /// True if it is time to write the drawing once, to measure how long that takes.
    pub(super) fn wants_trial_write(&self) -> bool {
        let forecast = self.forecast.as_ref();
        forecast.is_some_and(|forecast| self.now() >= forecast.due)
    }

    /// Number of `wanted` candidates that there is time to search for; 0 if too few. The first search is never limited.
    pub(super) fn affordable(&mut self, wanted: usize) -> usize {
        let Some(forecast) = self.forecast.as_ref().filter(|_| self.strokes > 0) else {
            return wanted;
        };
        let affordable = forecast.affordable(wanted, self.strokes, self.now());
        self.is_hurried |= affordable < wanted;
        affordable
    }

    /// True if there is time for a polish that is long enough to be of use.
    pub(super) fn allows_polish(&mut self) -> bool {
        let forecast = self.forecast.as_ref();
        let allows = forecast.is_none_or(|f| f.allows_polish(self.strokes, self.now()));
        self.is_hurried |= !allows;
        allows
    }

    /// True if a file can be written, looked at and judged in time after so many more steps.
    pub(super) fn allows_file_after(&self, steps: usize) -> bool {
        let forecast = self.forecast.as_ref();
        forecast.is_none_or(|f| f.allows_file_after(steps, self.strokes, self.now()))
    }

    /// The share of the time until `until` that is used; 0 without a limit.
    pub(super) fn used(&self) -> f32 {
        let forecast = self.forecast.as_ref();
        forecast.map_or(0.0, |f| {
            (self.now() / f.end_of_descent(self.strokes)) as f32
        }) / self.until
    }

    /// True if the whole time for descent is used.
    pub(super) fn is_over(&self) -> bool {
        self.used() * self.until >= 1.0
    }
}

/// Measured durations, s, and what they leave for the parts of a fit. Times are in seconds since the limit was set,
/// usually when the fit began.
pub(super) struct Forecast {
    /// The limit.
    limit_s: f64,
    pixels: usize,
    /// True if the drawing is rendered on two mattes to be judged.
    is_transparent: bool,
    /// True if the fit itself looks at the file, before it is judged.
    needs_file: bool,
    /// Rounds of settling.
    rounds: usize,
    /// Duration of a write, per pixel of its size.
    per_pixel_s: f64,
    /// Time of the next measurement of a write.
    due: f64,
    /// Duration of a step of descent, a running mean.
    step_s: f64,
    /// Duration of the search for a candidate.
    search_s: f64,
}

impl Forecast {
    /// The forecast for a `limit` on the time of all parts, before anything is measured.
    pub(super) fn new(
        limit: Duration,
        pixels: usize,
        is_transparent: bool,
        needs_file: bool,
        rounds: usize,
    ) -> Self {
        Self {
            limit_s: limit.as_secs_f64(),
            pixels,
            is_transparent,
            needs_file,
            rounds,
            per_pixel_s: 0.0,
            due: 0.0,
            step_s: 0.0,
            search_s: 0.0,
        }
    }

    /// Records that writing and rendering `strokes` strokes took `span` and ended at `now`.
    fn wrote(&mut self, strokes: usize, span: f64, now: f64) {
        self.per_pixel_s = span / self.size(strokes);
        self.due = now + span / TRIAL_WRITES;
    }

    /// Records that a step of descent took `span`.
    fn stepped(&mut self, span: f64) {
        self.step_s = match self.step_s {
            0.0 => span,
            mean => mean + FRESHNESS * (span - mean),
        };
    }

    /// Number of `wanted` candidates that there is time to search for, on a drawing of `strokes` strokes; 0 if too few. Leaves
    /// time for a few steps that fit the new strokes.
    fn affordable(&self, wanted: usize, strokes: usize, now: f64) -> usize {
        let left = self.end_of_descent(strokes) - now - SETTLING_STEPS as f64 * self.step_s;
        let affordable = (left / self.search_s.max(f64::MIN_POSITIVE)) as usize;
        let affordable = affordable.min(wanted);
        if affordable >= wanted / MIN_SEARCH {
            affordable
        } else {
            0
        }
    }

    fn allows_polish(&self, strokes: usize, now: f64) -> bool {
        now + MIN_POLISH * self.write_s(strokes) < self.end_of_descent(strokes)
    }

    fn allows_file_after(&self, steps: usize, strokes: usize, now: f64) -> bool {
        let end = now + steps as f64 * self.step_s + self.seeing(strokes);
        end + self.judging(strokes) < self.limit_s
    }

    /// The time by which the descent of a drawing of `strokes` strokes has to end: settling and judging follow it.
    fn end_of_descent(&self, strokes: usize) -> f64 {
        let seeing = self.seeing(strokes);
        let round = |steps: usize| seeing + steps as f64 * self.step_s;
        // Rounds are shorter if the limit is short.
        let most = self.limit_s * SETTLING;
        let settling = if self.rounds > 0 && round(MIN_ROUND) < most {
            seeing + (self.rounds as f64 * round(SETTLING_STEPS)).min(most)
        } else if self.needs_file {
            self.write_s(strokes)
        } else {
            0.0
        };
        let end = self.limit_s - settling - self.judging(strokes);
        end.max(self.limit_s * MIN_DESCENT)
    }

    /// The size of a write, in pixels.
    fn size(&self, strokes: usize) -> f64 {
        self.pixels as f64 + STROKE_PX * strokes as f64
    }

    /// Duration of rounding, writing and rendering a drawing of `strokes` strokes.
    fn write_s(&self, strokes: usize) -> f64 {
        self.per_pixel_s * self.size(strokes)
    }

    /// Duration of a write that a round of settling starts from, and of looking at it.
    fn seeing(&self, strokes: usize) -> f64 {
        self.write_s(strokes) + LOOKING * self.write_s(0)
    }

    /// The time reserved for what follows the fit.
    fn judging(&self, strokes: usize) -> f64 {
        let writes = match self.is_transparent {
            true => JUDGING_TRANSPARENT,
            false => JUDGING,
        };
        writes * self.write_s(strokes) + JUDGING_EMPTY * self.write_s(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let mut forecast =
                Forecast::new(Duration::from_secs_f64(limit), PIXELS, false, true, 5);
            let strokes = |now: f64| most.min((4000.0 * now) as usize);
            while self.now < forecast.end_of_descent(strokes(self.now)) {
                if self.now >= forecast.due {
                    self.write(&mut forecast, strokes(self.now));
                }
                self.step(&mut forecast, strokes(self.now));
            }
            let strokes = strokes(self.now);
            self.write(&mut forecast, strokes);
            if forecast.allows_file_after(MIN_ROUND, strokes, self.now) {
                self.look();
            }
            while forecast.allows_file_after(MIN_ROUND, strokes, self.now) {
                while forecast.allows_file_after(1, strokes, self.now) {
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
        let mut forecast = Forecast::new(Duration::from_secs(limit_s), PIXELS, false, true, 5);
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
        assert!(
            forecast.due > 2.0 && forecast.due <= 2.2,
            "{}",
            forecast.due
        );
    }

    #[test]
    fn strokes_are_sought_as_far_as_there_is_time() {
        let mut forecast = forecast(5);
        forecast.search_s = 0.001;
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
