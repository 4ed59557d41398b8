//! The report of `strokefit-rig pareto`: cost against error of our drawings and others'.
//!
//! An entry holds all that is known of one drawing. Fronts, comparisons, tables and plots are made from entries alone.

use serde::{Deserialize, Serialize};
use strokefit::Result;
use strokefit::metrics::Quality;
use strokefit::report::SCHEMA;

pub use super::OWN;
use super::plot::Chart;
use super::statistics::{distinct, optional};
use super::{Column, Table};

/// The family of the drawings of the article's recipe.
pub const ARTICLE: &str = "article";

/// Settings of the article's own run. The claim is made of this run only.
pub const ARTICLE_RUN: &str = "--strokes 5000 --iterations 1500";

/// Settings of the draft that the recipe is compared with, and of the quickest fit.
pub const DRAFTS: [&str; 2] = [
    "--strokes 5000 --preset draft",
    "--strokes 5000 --preset draft --no-polish",
];

/// Least gain of a fit over the article's recipe at equal strokes, dB.
const MIN_GAIN_DB: f64 = 6.0;
/// Largest share of the recipe's CPU time that the fit may take.
const MAX_TIME: f64 = 0.25;
/// Least pixels per stroke for the claim; the article's demo has 24. Where strokes are as small as pixels, there
/// is little to gain.
const MIN_ROOM: usize = 8;

/// Resolution of CPU time, s.
const TICK_S: f64 = 0.01;

/// Note on the meaning of the figures.
const NOTE: &str = "Fidelity compares resvg's render of the file with the picture, over 8-bit RGB on white. CPU time is the sum over all \
                    threads of the process, of ours with judging the file, in hundredths of a second. Memory is the most that the \
                    process held; that of other programs is sampled every 2 ms.";

/// All drawings of a run, and what follows from them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParetoReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per drawing.
    pub entries: Vec<ParetoEntry>,
    /// Claims, and whether they hold.
    pub comparisons: Vec<Comparison>,
}

/// One drawing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParetoEntry {
    /// The picture's name, without folder and ending.
    pub picture: String,
    /// A hash of its pixels.
    pub digest: String,
    /// Its width in px.
    pub width: usize,
    /// Its height in px.
    pub height: usize,
    /// Who made the drawing: `strokefit`, `article`, or another's name.
    pub family: String,
    /// With which settings; family and label tell the drawings of a picture apart.
    pub label: String,
    /// Wall time of making it, s.
    pub wall_s: Option<f64>,
    /// CPU time of making it, all threads, s; to a hundredth.
    pub cpu_s: Option<f64>,
    /// Most memory held at once while it was made, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// Length of the SVG, bytes.
    pub svg_bytes: usize,
    /// Its length after gzip, bytes.
    pub gzip_bytes: usize,
    /// The file as resvg draws it against the picture.
    pub fidelity: Option<Quality>,
    /// Why there is no drawing.
    pub failure: Option<String>,
}

impl ParetoEntry {
    /// The name of its files, without their endings.
    pub fn file_name(&self) -> String {
        let words = [&self.picture, &self.digest, &self.family, &self.label];
        let parts = words.iter().flat_map(|word| {
            let parts = word.split(|c: char| !c.is_ascii_alphanumeric());
            parts.filter(|part| !part.is_empty())
        });
        parts.collect::<Vec<_>>().join("-")
    }

    /// Fidelity in dB, where there is a drawing.
    pub fn psnr_db(&self) -> Option<f64> {
        self.fidelity.map(|quality| quality.psnr_db)
    }

    /// Strokes that were asked for, in words.
    fn asked_strokes(&self) -> Option<&str> {
        let mut words = self
            .label
            .split(' ')
            .skip_while(|word| *word != "--strokes");
        words.nth(1)
    }

    /// The settings but the number of strokes.
    fn preset(&self) -> String {
        let strokes = self.asked_strokes().map(|n| format!("--strokes {n}"));
        let rest = self.label.replace(&strokes.unwrap_or_default(), "");
        rest.trim().to_owned()
    }

    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let start = format!("{}, {} {}", self.picture, self.family, self.label);
        match (&self.failure, self.fidelity) {
            (Some(why), _) => format!("{start}: {why}: FAIL"),
            (None, None) => format!("{start}: pass"),
            (None, Some(quality)) => format!(
                "{start}: {:.2} dB, SSIM {:.4}, SSIMULACRA2 {:.1}, {} s of CPU, {} bytes, {} after gzip: pass",
                quality.psnr_db,
                quality.ssim,
                quality.ssimulacra2,
                optional(self.cpu_s, 2),
                self.svg_bytes,
                self.gzip_bytes
            ),
        }
    }

    /// Fidelity and CPU time.
    fn cost_and_error(&self) -> String {
        let psnr_db = self.psnr_db().unwrap_or(f64::NAN);
        format!("{psnr_db:.1} dB, {} s", optional(self.cpu_s, 2))
    }
}

/// A claim, and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The picture.
    pub picture: String,
    /// Claim in words.
    pub claim: String,
    /// Figure that was found.
    pub figure: String,
    /// Verdict on the claim.
    pub holds: Holds,
}

/// Verdict on a claim: whether it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Holds {
    /// It does.
    Holds,
    /// It does not, which is a finding.
    Not,
    /// It does not, which is a failure.
    Refuted,
}

impl Holds {
    /// The words that a line ends in.
    fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Not => "does not hold",
            Self::Refuted => "FAIL",
        }
    }
}

impl Comparison {
    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let (picture, claim, figure) = (&self.picture, &self.claim, &self.figure);
        format!("{picture}, {claim}: {figure}: {}", self.holds.word())
    }
}

impl ParetoReport {
    /// The report of these drawings.
    pub fn new(entries: Vec<ParetoEntry>) -> Self {
        Self {
            schema: SCHEMA,
            comparisons: comparisons(&entries),
            entries,
        }
    }

    /// Number of drawings that failed, and of claims that do not hold.
    pub fn failures(&self) -> usize {
        let failed = self.entries.iter().filter(|e| e.failure.is_some());
        let comparisons = self.comparisons.iter();
        let refuted = comparisons.filter(|c| c.holds == Holds::Refuted);
        failed.count() + refuted.count()
    }

    /// One row per drawing.
    pub fn table(&self) -> Table {
        let columns: [Column<ParetoEntry>; 12] = [
            ("picture", |e| e.picture.clone()),
            ("family", |e| e.family.clone()),
            ("settings", |e| e.label.clone()),
            ("psnr_db", |e| optional(e.psnr_db(), 2)),
            ("ssim", |e| optional(e.fidelity.map(|q| q.ssim), 4)),
            ("ssimulacra2", |e| {
                optional(e.fidelity.map(|q| q.ssimulacra2), 1)
            }),
            ("cpu_s", |e| optional(e.cpu_s, 2)),
            ("wall_s", |e| optional(e.wall_s, 2)),
            ("peak_mib", |e| {
                optional(e.peak_rss_bytes.map(|bytes| (bytes >> 20) as f64), 0)
            }),
            ("svg_bytes", |e| e.svg_bytes.to_string()),
            ("gzip_bytes", |e| e.gzip_bytes.to_string()),
            ("failure", |e| e.failure.clone().unwrap_or_default()),
        ];
        Table::of(&columns, &self.entries)
    }

    /// Our fits: a row for each of the settings, a column for each picture.
    fn fits(&self) -> Table {
        let own = self.entries.iter().filter(|e| e.family == OWN);
        let own: Vec<&ParetoEntry> = own.collect();
        let pictures = distinct(own.iter().map(|e| e.picture.as_str()));
        let mut table = Table::new(&[&["options"], &pictures[..]].concat());
        for label in distinct(own.iter().map(|e| e.label.as_str())) {
            let cell = |picture: &&str| {
                let is_it = |e: &&&ParetoEntry| e.picture == *picture && e.label == label;
                let fit = own.iter().find(is_it)?;
                let (db, wall_s) = (fit.psnr_db()?, optional(fit.wall_s, 2));
                let kilobytes = fit.svg_bytes as f64 / 1000.0;
                Some(format!("{db:.1} dB, {wall_s} s, {kilobytes:.0} kB"))
            };
            let cells = pictures
                .iter()
                .map(|picture| cell(picture).unwrap_or_default());
            table.row(std::iter::once(label.to_owned()).chain(cells));
        }
        table
    }

    /// Everything as Markdown, from tables to quote to those that they rest on.
    pub fn markdown(&self) -> String {
        let columns: [Column<Comparison>; 4] = [
            ("picture", |c| c.picture.clone()),
            ("comparison", |c| c.claim.clone()),
            ("figure", |c| c.figure.clone()),
            ("verdict", |c| c.holds.word().to_owned()),
        ];
        let (fits, drawings) = (self.fits().markdown(), self.table().markdown());
        let comparisons = Table::of(&columns, &self.comparisons).markdown();
        format!(
            "# Cost against error\n\n{NOTE}\n\n## Fits\n\n{fits}\n## Comparisons\n\n{comparisons}\n## Drawings\n\n{drawings}"
        )
    }

    /// Name and SVG of each plot of `picture`: `time` and `bytes` against PSNR, and `seen`, bytes against SSIMULACRA2. Marks are
    /// drawings, lines their fronts.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when one cannot be drawn.
    pub fn charts(&self, picture: &str) -> Result<Vec<(&'static str, String)>> {
        let here = self.entries.iter().filter(|e| e.picture == picture);
        let here: Vec<&ParetoEntry> = here.collect();
        let time: Axis = ("CPU time, s", |e| e.cpu_s);
        let bytes: Axis = ("bytes after gzip", |e| Some(e.gzip_bytes as f64));
        let psnr: Axis = ("PSNR of the file, dB", |e| {
            e.psnr_db().filter(|db| db.is_finite())
        });
        let seen: Axis = ("SSIMULACRA2 of the file", |e| {
            e.fidelity.map(|quality| quality.ssimulacra2)
        });
        let plots = [
            ("time", [time, psnr]),
            ("bytes", [bytes, psnr]),
            ("seen", [bytes, seen]),
        ];
        let svg = |(name, axes): (_, [Axis; 2])| Ok((name, scatter(picture, &here, axes).svg()?));
        plots.into_iter().map(svg).collect()
    }
}

/// A name and what it is of a drawing.
type Axis = (&'static str, fn(&ParetoEntry) -> Option<f64>);

fn scatter(picture: &str, here: &[&ParetoEntry], [(x, cost), (y, gain)]: [Axis; 2]) -> Chart {
    // Whose line a drawing is on: ours by preset, others by family.
    let line = |e: &ParetoEntry| match e.family.as_str() {
        OWN => format!("{OWN} {}", e.preset().replace("--preset ", "")),
        family => family.to_owned(),
    };
    let point = |e: &&ParetoEntry| Some([cost(e)?, gain(e)?]);
    let mut chart = Chart {
        title: format!("{picture}: {x} against {y}"),
        axes: [x.into(), y.into()],
        logarithmic_x: true,
        ..Chart::default()
    };
    for name in distinct(here.iter().map(|e| line(e))) {
        let members = here.iter().copied().filter(|e| line(e) == name);
        let members: Vec<&ParetoEntry> = members.collect();
        let marks: Vec<[f64; 2]> = members.iter().filter_map(point).collect();
        if !marks.is_empty() {
            let best = front(members, cost, gain);
            let best = best.iter().filter_map(point).collect();
            chart.series.push((name, best));
            chart.marks.push(marks);
        }
    }
    chart
}

/// The entries that no other of `entries` beats in both `cost` (less is better) and `gain` (more is
/// better), by rising cost. Entries without either are left out.
pub fn front<'a>(
    entries: impl IntoIterator<Item = &'a ParetoEntry>,
    cost: impl Fn(&ParetoEntry) -> Option<f64>,
    gain: impl Fn(&ParetoEntry) -> Option<f64>,
) -> Vec<&'a ParetoEntry> {
    let known = entries.into_iter();
    let mut known: Vec<_> = known
        .filter_map(|e| Some((cost(e)?, gain(e)?, e)))
        .collect();
    known.sort_by(|(a, x, _), (b, y, _)| a.total_cmp(b).then(y.total_cmp(x)));
    let mut best = f64::NEG_INFINITY;
    known.retain(|&(_, gain, _)| {
        let better = gain > best;
        best = best.max(gain);
        better
    });
    known.into_iter().map(|(.., entry)| entry).collect()
}

/// Comparisons that follow from `entries`. That fits beat the article's own run by so much is a claim, and a failure
/// where it does not hold; all other comparisons are findings.
fn comparisons(entries: &[ParetoEntry]) -> Vec<Comparison> {
    let mut all = Vec::new();
    let made = || entries.iter().filter(|e| e.fidelity.is_some());
    for picture in distinct(made().map(|e| e.picture.as_str())) {
        let here: Vec<&ParetoEntry> = made().filter(|e| e.picture == picture).collect();
        for recipe in here.iter().filter(|e| e.family == ARTICLE) {
            if recipe.label == ARTICLE_RUN {
                all.push(at_equal_strokes(recipe, &here));
            } else {
                all.extend(at_equal_time(recipe, &here));
            }
        }
        let others = here.iter().map(|e| e.family.as_str());
        for peer in distinct(others.filter(|family| ![OWN, ARTICLE].contains(family))) {
            all.push(at_equal_bytes(peer, &here));
        }
    }
    all
}

fn gain_db(fit: &ParetoEntry, other: &ParetoEntry) -> f64 {
    fit.psnr_db().unwrap_or(f64::NAN) - other.psnr_db().unwrap_or(f64::NAN)
}

/// Compares the article's own run with the best fit of as many strokes that took at most a quarter of its time.
fn at_equal_strokes(recipe: &ParetoEntry, here: &[&ParetoEntry]) -> Comparison {
    let time = recipe.cpu_s.unwrap_or(f64::NAN);
    let quick = here.iter().filter(|e| {
        let is_alike = e.family == OWN && e.asked_strokes() == recipe.asked_strokes();
        is_alike && e.cpu_s.is_some_and(|cpu_s| cpu_s <= MAX_TIME * time)
    });
    let best = quick.max_by(|a, b| gain_db(a, recipe).total_cmp(&gain_db(b, recipe)));
    let gain = best.map_or(f64::NEG_INFINITY, |fit| gain_db(fit, recipe));
    let figure = best.map(|fit| {
        let share = fit.cpu_s.unwrap_or(f64::NAN) / time.max(TICK_S);
        let (ours, theirs) = (fit.cost_and_error(), recipe.cost_and_error());
        let preset = fit.preset();
        format!("{theirs} against {ours} ({preset}): {gain:+.1} dB in {share:.2} of its CPU time")
    });
    let has_room = recipe.width * recipe.height >= MIN_ROOM * 5000;
    Comparison {
        picture: recipe.picture.clone(),
        claim: format!(
            "at least {MIN_GAIN_DB} dB above the article's recipe ({}) in at most {MAX_TIME} of its CPU time",
            recipe.label
        ),
        figure: figure.unwrap_or_else(|| {
            format!("no fit of as many strokes took at most {MAX_TIME} of its {time:.2} s")
        }),
        holds: match gain >= MIN_GAIN_DB {
            true => Holds::Holds,
            false if has_room => Holds::Refuted,
            false => Holds::Not,
        },
    }
}

/// Compares a shorter run of the recipe with the draft whose time it was given.
fn at_equal_time(recipe: &ParetoEntry, here: &[&ParetoEntry]) -> Option<Comparison> {
    let draft = here
        .iter()
        .find(|e| e.family == OWN && e.label == DRAFTS[0])?;
    let gain = gain_db(draft, recipe);
    Some(Comparison {
        picture: recipe.picture.clone(),
        claim: format!(
            "better than the article's recipe at equal CPU time ({})",
            recipe.label
        ),
        figure: format!(
            "{} against {}: {gain:+.2} dB",
            recipe.cost_and_error(),
            draft.cost_and_error()
        ),
        holds: if gain > 0.0 { Holds::Holds } else { Holds::Not },
    })
}

/// Compares a peer's front with our best drawings of no more bytes after gzip.
fn at_equal_bytes(peer: &str, here: &[&ParetoEntry]) -> Comparison {
    let theirs = here.iter().copied().filter(|e| e.family == peer);
    let front = front(theirs, |e| Some(e.gzip_bytes as f64), ParetoEntry::psnr_db);
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for other in &front {
        let own = here.iter().filter(|e| e.family == OWN);
        let small = own.filter(|e| e.gzip_bytes <= other.gzip_bytes);
        let gain = small.map(|e| gain_db(e, other)).reduce(f64::max);
        let kilobytes = other.gzip_bytes as f64 / 1000.0;
        match gain {
            Some(db) if db >= 0.0 => above.push(db),
            Some(db) => below.push(format!("{kilobytes:.1} kB ({db:.2} dB)")),
            None => below.push(format!("{kilobytes:.1} kB (none of ours is as small)")),
        }
    }
    above.sort_by(f64::total_cmp);
    let range = above.first().zip(above.last());
    let range = range.map(|(least, most)| format!(" by {least:.2} to {most:.2} dB"));
    let points = format!("{} of {}", above.len(), front.len());
    let but = (!below.is_empty()).then(|| format!("; not at {}", below.join(", ")));
    Comparison {
        picture: here.first().map_or_else(String::new, |e| e.picture.clone()),
        claim: format!("as faithful as {peer} at equal bytes after gzip"),
        figure: format!(
            "above it at {points} points of its front{}{}",
            range.unwrap_or_default(),
            but.unwrap_or_default()
        ),
        holds: if below.is_empty() {
            Holds::Holds
        } else {
            Holds::Not
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(family: &str, label: &str, cpu_s: f64, gzip_bytes: usize, db: f64) -> ParetoEntry {
        ParetoEntry {
            picture: "cat".into(),
            width: 300,
            height: 300,
            family: family.into(),
            label: label.into(),
            cpu_s: Some(cpu_s),
            gzip_bytes,
            fidelity: Some(Quality {
                details_kept: None,
                psnr_db: db,
                ssim: 0.9,
                mse: strokefit::math::powf(10.0, -db / 10.0),
                l1: 0.01,
                ssimulacra2: 40.0 + db,
            }),
            ..ParetoEntry::default()
        }
    }

    #[test]
    fn lines_end_in_verdicts_and_names_of_files_are_plain() {
        let mut entry = drawing("a/b", "x > y", 1.0, 1, 20.0);
        assert!(entry.line().ends_with(": pass"), "{}", entry.line());
        entry.failure = Some("killed".into());
        assert!(entry.line().ends_with("killed: FAIL"), "{}", entry.line());
        assert_eq!(entry.file_name(), "cat-a-b-x-y");
    }

    #[test]
    fn a_front_has_what_nothing_beats() {
        let own = |label, cpu_s, psnr_db| drawing(OWN, label, cpu_s, 900, psnr_db);
        let entries = [
            own("a", 3.0, 31.0),
            own("b", 1.0, 30.0),
            own("c", 2.0, 29.0),
            own("d", 1.0, 28.0),
        ];
        let front = front(&entries, |e| e.cpu_s, ParetoEntry::psnr_db);
        let labels: Vec<_> = front.iter().map(|e| e.label.as_str()).collect();
        assert_eq!(labels, ["b", "a"]);
    }

    #[test]
    fn only_quick_fits_count_against_the_article_where_there_is_room() {
        let holds = |side, cpu_s, db| {
            let recipe = ParetoEntry {
                width: side,
                height: side,
                ..drawing(ARTICLE, ARTICLE_RUN, 4.0, 900, 24.0)
            };
            let slow = drawing(OWN, "--strokes 5000 --preset best", 2.0, 900, 35.0);
            let quick = drawing(OWN, DRAFTS[0], cpu_s, 900, db);
            comparisons(&[recipe, slow, quick])[0].holds
        };
        assert_eq!(holds(300, 0.8, 29.0), Holds::Refuted, "only 5 dB");
        assert_eq!(holds(300, 1.2, 31.0), Holds::Refuted, "too slow");
        assert_eq!(holds(300, 1.0, 30.0), Holds::Holds);
        assert_eq!(holds(100, 0.8, 29.0), Holds::Not, "2 px per stroke");
    }

    #[test]
    fn an_equal_time_is_that_of_the_draft() {
        let entries = [
            drawing(ARTICLE, "--strokes 5000 --iterations 90", 0.8, 900, 20.0),
            drawing(OWN, "--strokes 5000 --preset best", 9.0, 900, 35.0),
            drawing(OWN, DRAFTS[0], 0.8, 900, 29.0),
        ];
        let comparison = &comparisons(&entries)[0];
        assert!(comparison.figure.ends_with("+9.00 dB"), "{comparison:?}");
    }

    #[test]
    fn where_a_peer_is_better_is_said() {
        let own = |gzip, db| drawing(OWN, DRAFTS[0], 1.0, gzip, db);
        let peer = |gzip, db| drawing("vtracer", "x", 0.1, gzip, db);
        let entries = [
            own(1000, 25.0),
            own(9000, 31.0),
            peer(500, 22.0),
            peer(1500, 26.0),
            peer(9500, 30.0),
        ];
        let comparison = &comparisons(&entries)[0];
        assert_eq!(comparison.holds, Holds::Not);
        for words in [
            "at 1 of 3",
            "by 1.00 to 1.00 dB",
            "0.5 kB (none",
            "1.5 kB (-1.00 dB)",
        ] {
            assert!(comparison.figure.contains(words), "{comparison:?}");
        }
    }

    #[test]
    fn fits_are_quoted_by_settings_and_every_family_has_its_line() {
        let report = ParetoReport::new(vec![
            drawing(OWN, "--strokes 9 --preset draft", 0.5, 900, 23.0),
            drawing(ARTICLE, "--strokes 9 --iterations 9", 4.0, 900, 24.0),
            drawing("vtracer", "x", 0.2, 700, 23.0),
        ]);
        let expected = "options,cat\n--strokes 9 --preset draft,\"23.0 dB,  s, 0 kB\"\n";
        assert_eq!(report.fits().csv(), expected);
        let charts = report.charts("cat").unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["time", "bytes", "seen"]);
        for family in ["strokefit draft", "article", "vtracer"] {
            assert!(charts[0].1.contains(family), "{family}");
        }
    }
}
