//! Findings of `strokefit-rig scaling`.

use serde::{Deserialize, Serialize};
use strokefit::report::SCHEMA;

use super::statistics::optional;
use super::{Column, Table};
use strokefit::math;

/// Largest exponent by which CPU time and memory may grow with strokes or pixels: linear growth, plus noise.
const MAX_GROWTH: f64 = 1.15;
/// Largest exponent by which CPU time may grow with threads: none, plus noise.
const MAX_OVERHEAD: f64 = 0.35;
/// The largest case: pixels, and strokes.
pub const LARGEST: [f64; 2] = [24e6, 20_000.0];

/// Most memory that the largest picture may take, bytes.
const MAX_BYTES: u64 = 4 << 30;

/// Verdict on a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseVerdict {
    /// It grows no faster than it may.
    Pass,
    /// It does, or was not measured.
    Fail,
}

impl CaseVerdict {
    fn of(holds: bool) -> Self {
        if holds { Self::Pass } else { Self::Fail }
    }

    /// The word that a line ends in.
    fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
        }
    }
}

/// All series of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalingReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per task and axis.
    pub series: Vec<SeriesEntry>,
    /// A draft of the largest picture, if that was tried.
    pub largest: Option<PointEntry>,
    /// Why there is none, if it was tried.
    pub largest_failure: Option<String>,
}

impl Default for ScalingReport {
    fn default() -> Self {
        Self {
            schema: SCHEMA,
            series: Vec::new(),
            largest: None,
            largest_failure: None,
        }
    }
}

/// Growth of one task along one axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeriesEntry {
    /// Task that was timed: `stages` or `fit`.
    pub task: String,
    /// Quantity that grows: `strokes`, `pixels` or `threads`.
    pub axis: String,
    /// Where each point lies on the axis.
    pub values: Vec<f64>,
    /// The points.
    pub points: Vec<PointEntry>,
    /// Exponent of wall time.
    pub wall: Exponent,
    /// Exponent of CPU time.
    pub cpu: Exponent,
    /// Exponent of memory.
    pub memory: Exponent,
    /// Points that could not be measured, and why.
    pub failures: Vec<String>,
    /// Verdict: a pass if growth is no worse than it may be, and all points were measured.
    pub verdict: CaseVerdict,
}

/// Cost of one point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PointEntry {
    /// Millions of pixels.
    pub megapixels: f64,
    /// Strokes.
    pub strokes: usize,
    /// Threads.
    pub threads: usize,
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time of all threads, s.
    pub cpu_s: Option<f64>,
    /// Most memory of the process, bytes.
    pub peak_rss_bytes: Option<u64>,
}

/// A power law by least squares in log–log; `null` where nothing is known or there is but one point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exponent {
    /// Over all points.
    pub all: Option<f64>,
    /// Over the last two, where constant costs weigh least.
    pub last: Option<f64>,
}

impl Exponent {
    fn new(values: &[f64], costs: &[Option<f64>]) -> Self {
        let points: Vec<_> = values
            .iter()
            .zip(costs)
            .filter_map(|(&x, &y)| Some((x, y?)))
            .collect();
        Self {
            all: slope(&points),
            last: slope(&points[points.len().saturating_sub(2)..]),
        }
    }

    fn words(self) -> String {
        let word = |v: Option<f64>| v.map_or_else(|| "?".to_owned(), |v| format!("{v:.2}"));
        format!("{} ({})", word(self.all), word(self.last))
    }

    fn is_at_most(self, most: f64) -> bool {
        self.all.is_none_or(|exponent| exponent <= most)
    }
}

/// Slope of ln y over ln x by least squares.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .map(|(x, y)| (math::ln(*x), math::ln(*y)))
        .collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
    let both: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let square: f64 = logs.iter().map(|(x, _)| math::powi(x - mean_x, 2)).sum();
    Some(both / square).filter(|slope| slope.is_finite())
}

impl SeriesEntry {
    /// The series of `points` at `values` of the axis.
    pub fn new(task: &str, axis: &str, values: &[f64], points: Vec<PointEntry>) -> Self {
        let costs = |of: fn(&PointEntry) -> Option<f64>| -> Vec<Option<f64>> {
            points.iter().map(of).collect()
        };
        let exponent = |of| Exponent::new(values, &costs(of));
        let (cpu, memory) = (
            exponent(|p| p.cpu_s),
            exponent(|p| p.peak_rss_bytes.map(|bytes| bytes as f64)),
        );
        let holds = if axis == "threads" {
            cpu.is_at_most(MAX_OVERHEAD)
        } else {
            cpu.is_at_most(MAX_GROWTH) && memory.is_at_most(MAX_GROWTH)
        };
        Self {
            task: task.into(),
            axis: axis.into(),
            values: values.to_vec(),
            wall: exponent(|p| Some(p.wall_s)),
            cpu,
            memory,
            points,
            failures: Vec::new(),
            verdict: CaseVerdict::of(holds),
        }
    }

    /// This report, but with points that could not be measured, if there are `failures`.
    #[must_use]
    pub fn failing(mut self, failures: Vec<String>) -> Self {
        if !failures.is_empty() {
            self.verdict = CaseVerdict::Fail;
        }
        self.failures = failures;
        self
    }

    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let Self {
            task,
            axis,
            wall,
            cpu,
            memory,
            failures,
            verdict,
            ..
        } = self;
        let failures: String = failures.iter().map(|why| format!(", {why}")).collect();
        format!(
            "{task} against {axis}: exponents (of the last two) of CPU time {}, wall time {}, memory {}{failures}: {}",
            cpu.words(),
            wall.words(),
            memory.words(),
            verdict.word()
        )
    }
}

impl ScalingReport {
    /// The line of the largest picture.
    pub fn largest_line(&self) -> Option<String> {
        if let Some(why) = &self.largest_failure {
            return Some(format!("{why}: {}", CaseVerdict::Fail.word()));
        }
        let point = self.largest?;
        let cpu_s = point.cpu_s.unwrap_or(f64::NAN);
        Some(format!(
            "draft of {} megapixels with {} strokes: {:.1} s, CPU {cpu_s:.1} s, peak {:.2} GiB of {}: {}",
            point.megapixels,
            point.strokes,
            point.wall_s,
            point.peak_rss_bytes.unwrap_or(0) as f64 / f64::from(1 << 30),
            MAX_BYTES >> 30,
            largest_verdict(&point).word()
        ))
    }

    /// Number of series, and of largest pictures, that are beyond their bounds or could not be measured.
    pub fn failures(&self) -> usize {
        let unmeasured = self.largest_failure.iter().map(|_| CaseVerdict::Fail);
        let largest = self.largest.as_ref().map(largest_verdict);
        let series = self.series.iter().map(|series| series.verdict);
        let all = series.chain(largest).chain(unmeasured);
        all.filter(|verdict| *verdict == CaseVerdict::Fail).count()
    }

    /// Table to quote: one row per series.
    pub fn growth_table(&self) -> Table {
        let columns: [Column<SeriesEntry>; 7] = [
            ("what", |s| format!("{}, {}", s.task, s.axis)),
            ("from … to", |s| ends(&s.values, |v| format!("{v}"))),
            ("exponent of wall time (last two points)", |s| {
                s.wall.words()
            }),
            ("of CPU time", |s| s.cpu.words()),
            ("of memory", |s| s.memory.words()),
            ("wall time, s", |s| {
                ends(&s.points, |p| significant(p.wall_s))
            }),
            ("peak memory, MiB", |s| {
                ends(&s.points, |p| {
                    (p.peak_rss_bytes.unwrap_or(0) >> 20).to_string()
                })
            }),
        ];
        Table::of(&columns, &self.series)
    }

    /// One row per point.
    pub fn table(&self) -> Table {
        let head = [
            "task",
            "axis",
            "megapixels",
            "strokes",
            "threads",
            "wall_s",
            "cpu_s",
            "peak_mib",
        ];
        let mut table = Table::new(&head);
        for series in &self.series {
            for point in &series.points {
                let mib = point.peak_rss_bytes.map(|bytes| (bytes >> 20) as f64);
                table.row([
                    series.task.clone(),
                    series.axis.clone(),
                    point.megapixels.to_string(),
                    point.strokes.to_string(),
                    point.threads.to_string(),
                    format!("{:.4}", point.wall_s),
                    optional(point.cpu_s, 4),
                    optional(mib, 0),
                ]);
            }
        }
        table
    }

    /// Everything as Markdown.
    pub fn markdown(&self) -> String {
        let lines = self
            .series
            .iter()
            .map(SeriesEntry::line)
            .chain(self.largest_line());
        let lines: String = lines.map(|line| format!("- {line}\n")).collect();
        let (growth, all) = (self.growth_table().markdown(), self.table().markdown());
        format!("# Growth\n\n{growth}\n## Verdicts\n\n{lines}\n## Points\n\n{all}")
    }
}

/// The first and the last of `values`, in words.
fn ends<T>(values: &[T], word: impl Fn(&T) -> String) -> String {
    match values {
        [] => String::new(),
        [only] => word(only),
        [first, .., last] => format!("{} … {}", word(first), word(last)),
    }
}

/// Seconds with two digits or more.
fn significant(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{s:.4}"),
        s if s < 1.0 => format!("{s:.2}"),
        s => format!("{s:.1}"),
    }
}

fn largest_verdict(point: &PointEntry) -> CaseVerdict {
    CaseVerdict::of(point.peak_rss_bytes.is_none_or(|bytes| bytes <= MAX_BYTES))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(exponent: f64) -> SeriesEntry {
        let values = [100.0, 1000.0, 10_000.0];
        let point = |x: f64| PointEntry {
            megapixels: 1.0,
            strokes: x as usize,
            threads: 2,
            wall_s: 0.5 * math::powf(x, exponent),
            cpu_s: Some(math::powf(x, exponent)),
            peak_rss_bytes: Some(1 << 20),
        };
        SeriesEntry::new("fit", "strokes", &values, values.map(point).to_vec())
    }

    #[test]
    fn power_laws_are_found() {
        let series = series(0.8);
        assert!((series.cpu.all.unwrap() - 0.8).abs() < 1e-12);
        assert!((series.wall.last.unwrap() - 0.8).abs() < 1e-12);
        assert_eq!(series.memory.all, Some(0.0));
        assert!(series.line().ends_with(": pass"), "{}", series.line());
    }

    #[test]
    fn worse_than_linear_growth_fails() {
        assert_eq!(series(1.4).verdict, CaseVerdict::Fail);
    }

    #[test]
    fn a_point_that_could_not_be_measured_fails_its_series() {
        let series = series(0.8).failing(vec!["at 7: killed".into()]);
        assert!(
            series.line().ends_with(", at 7: killed: FAIL"),
            "{}",
            series.line()
        );
        let report = ScalingReport {
            series: vec![series],
            largest_failure: Some("no memory".into()),
            ..ScalingReport::default()
        };
        assert_eq!(report.failures(), 2);
    }

    #[test]
    fn a_series_is_quoted_from_end_to_end() {
        let report = ScalingReport {
            series: vec![series(0.5)],
            ..ScalingReport::default()
        };
        let row =
            "\"fit, strokes\",100 … 10000,0.50 (0.50),0.50 (0.50),0.00 (0.00),5.0 … 50.0,1 … 1\n";
        assert!(
            report.growth_table().csv().ends_with(row),
            "{}",
            report.growth_table().csv()
        );
    }

    #[test]
    fn one_point_has_no_exponent() {
        let one = Exponent::new(&[2.0], &[Some(1.0)]);
        assert_eq!((one.all, one.last), (None, None));
    }
}
