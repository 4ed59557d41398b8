//! Cost against error: our fits at many settings, the article's recipe, and other programs draw the same
//! pictures. All are judged by the file as resvg draws it.
//!
//! Each result is written at once, as an SVG and a JSON of the same name. A run that was stopped continues
//! where it was, since what is in the folder is not measured again.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::files::{digest, few, stem};
use super::gallery::Gallery;
use super::programs::{Program, RECIPE, STROKEFIT};
use crate::lab::{ResultFolder, unread, unwritten};
use crate::report::pareto::{ARTICLE, ARTICLE_RUN, DRAFTS, OWN, ParetoEntry, ParetoReport, front};
use strokefit::image::Image;
use strokefit::report::{gzip_bytes, json};
use strokefit::{Error, ErrorKind, Result, verify};

/// Most drawings of ours on the sheet.
const SHOWN: usize = 6;

/// Most settings of other programs in a short run, spread over all that each has.
const FEW_SETTINGS: usize = 3;

/// Settings of our fits: the article's number of strokes is always among them.
pub fn settings(is_short: bool) -> Vec<String> {
    let (strokes, presets): (&[usize], &[&str]) = if is_short {
        (&[10, 100, 400], &["draft", "balanced"])
    } else {
        (
            &[10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000],
            &["draft --no-polish", "draft", "balanced", "best"],
        )
    };
    let of = |preset: &&str| -> Vec<String> {
        let settings = strokes
            .iter()
            .map(|n| format!("--strokes {n} --preset {preset}"));
        settings.collect()
    };
    presets.iter().flat_map(of).collect()
}

/// Measures our fits at `settings`, the article's recipe and all settings of `peers` on `pictures`, writes to the folder and tells
/// a line per case.
///
/// # Errors
/// When a picture cannot be read, two have one name, or the folder cannot be written. A case that cannot
/// be measured is a failure in the report.
pub fn run(
    output: &mut ResultFolder,
    pictures: &[PathBuf],
    settings: &[String],
    is_short: bool,
    peers: &[Program],
    say: &mut dyn FnMut(&str),
) -> Result<ParetoReport> {
    check_names(pictures)?;
    let folder = output.path().join("svg");
    fs::create_dir_all(&folder).map_err(|e| unwritten(&folder, e))?;
    let mut entries = Vec::new();
    for path in pictures {
        let subject = Subject {
            name: stem(path),
            picture: open(path)?,
        };
        let mut measure = |program: &Program, settings: &str| {
            let entry = subject.measured(program, settings, &folder)?;
            say(&entry.line());
            entries.push(entry.clone());
            Ok::<_, Error>(entry)
        };
        let [draft, _] = [
            measure(&STROKEFIT, DRAFTS[0])?,
            measure(&STROKEFIT, DRAFTS[1])?,
        ];
        for settings in settings.iter().filter(|s| !DRAFTS.contains(&s.as_str())) {
            measure(&STROKEFIT, settings)?;
        }
        let recipe = measure(&RECIPE, ARTICLE_RUN)?;
        // The recipe again, for as long as the draft took.
        if let Some((draft_s, recipe_s)) = draft.cpu_s.zip(recipe.cpu_s) {
            let iterations = (1500.0 * draft_s / recipe_s.max(0.01)).max(1.0);
            let iterations = iterations as usize;
            measure(
                &RECIPE,
                &format!("--strokes 5000 --iterations {iterations}"),
            )?;
        }
        for peer in peers {
            let most = if is_short { FEW_SETTINGS } else { usize::MAX };
            for settings in few(peer.settings.to_vec(), most) {
                measure(peer, settings)?;
            }
        }
    }
    let report = ParetoReport::new(entries);
    for comparison in &report.comparisons {
        say(&comparison.line());
    }
    publish(output, pictures, &report)?;
    Ok(report)
}

/// A picture that is drawn.
struct Subject {
    name: String,
    /// On white.
    picture: Image,
}

impl Subject {
    /// The record of a drawing, which is made unless that was done before.
    fn measured(&self, program: &Program, settings: &str, folder: &Path) -> Result<ParetoEntry> {
        let picture = &self.picture;
        let size = picture.width().to_le_bytes();
        let blank = ParetoEntry {
            picture: self.name.clone(),
            digest: digest(&[&size, &picture.to_rgb8()]),
            width: picture.width(),
            height: picture.height(),
            family: program.name.into(),
            label: settings.into(),
            ..ParetoEntry::default()
        };
        let stem = folder.join(blank.file_name());
        let kept = fs::read(stem.with_extension("json")).ok();
        let kept = kept.and_then(|json| serde_json::from_slice::<ParetoEntry>(&json).ok());
        // What failed is tried again.
        if let Some(kept) = kept.filter(|entry| entry.failure.is_none()) {
            return Ok(kept);
        }
        let made = self.made(&blank, program, &stem.with_extension("svg"));
        let entry = made.unwrap_or_else(|error| ParetoEntry {
            failure: Some(error.to_string()),
            ..blank
        });
        let path = stem.with_extension("json");
        fs::write(&path, json(&entry)?).map_err(|e| unwritten(&path, e))?;
        Ok(entry)
    }

    fn made(&self, blank: &ParetoEntry, program: &Program, path: &Path) -> Result<ParetoEntry> {
        let drawn = program.trace(&self.picture, &blank.label)?;
        fs::write(path, &drawn.svg).map_err(|e| unwritten(path, e))?;
        Ok(ParetoEntry {
            wall_s: Some(drawn.cost.wall_s),
            cpu_s: drawn.cost.cpu_s,
            peak_rss_bytes: drawn.cost.peak_rss_bytes,
            svg_bytes: drawn.svg.len(),
            gzip_bytes: gzip_bytes(&drawn.svg),
            fidelity: Some(verify::fidelity(&drawn.svg, &self.picture)?),
            ..blank.clone()
        })
    }
}

/// Writes tables, plots and a sheet of the drawings.
fn publish(output: &mut ResultFolder, pictures: &[PathBuf], report: &ParetoReport) -> Result<()> {
    output.text("pareto.csv", &report.table().csv())?;
    output.text("pareto.md", &report.markdown())?;
    output.text("pareto.json", &json(report)?)?;
    let mut gallery = Gallery::default();
    for path in pictures {
        let name = stem(path);
        for (plot, svg) in report.charts(&name)? {
            output.text(&format!("{name}-{plot}.svg"), &svg)?;
        }
        let picture = open(path)?;
        gallery.row(&name, &picture)?;
        for entry in shown(&report.entries, &name) {
            let svg = output.path().join("svg").join(entry.file_name());
            let svg = svg.with_extension("svg");
            let svg = fs::read_to_string(&svg).map_err(|e| unread(&svg, e))?;
            let db = entry.psnr_db().unwrap_or(f64::NAN);
            let kilobytes = entry.gzip_bytes as f64 / 1000.0;
            let caption = format!("{}: {db:.1} dB, {kilobytes:.1} kB", entry.family);
            gallery.add_drawing(&caption, &svg, &picture)?;
        }
    }
    output.picture("pareto.png", &gallery.sheet()?)
}

/// Our front by bytes, what the article's recipe made, and the best of each peer.
fn shown<'a>(entries: &'a [ParetoEntry], name: &str) -> Vec<&'a ParetoEntry> {
    let here = || {
        let made = entries.iter().filter(|e| e.fidelity.is_some());
        made.filter(|e| e.picture == name)
    };
    let own = here().filter(|e| e.family == OWN);
    let own = front(own, |e| Some(e.gzip_bytes as f64), ParetoEntry::psnr_db);
    let mut shown = few(own, SHOWN);
    shown.extend(here().filter(|e| e.family == ARTICLE));
    let mut best: BTreeMap<&str, &ParetoEntry> = BTreeMap::new();
    for entry in here().filter(|e| e.family != OWN && e.family != ARTICLE) {
        let known = best.entry(&entry.family).or_insert(entry);
        if entry.psnr_db() > known.psnr_db() {
            *known = entry;
        }
    }
    shown.extend(best.into_values());
    shown
}

fn check_names(pictures: &[PathBuf]) -> Result<()> {
    for (i, path) in pictures.iter().enumerate() {
        let name = stem(path);
        if pictures[..i].iter().any(|other| stem(other) == name) {
            let message = format!("two pictures are called {name}: rename one of them");
            return Err(Error::new(ErrorKind::Config, message));
        }
    }
    Ok(())
}

/// The picture as every program gets it: transparency laid on white.
fn open(path: &Path) -> Result<Image> {
    Ok(Image::open(path)?.flattened([1.0; 3]))
}
