//! The figures that README and docs quote: a few rows for all pictures.

use super::recipe::{AtEqualStrokes, AtEqualTime};
use super::{ARTICLE, ParetoEntry, ParetoReport, pictures};
use crate::report::Table;
use crate::report::statistics::distinct;

impl ParetoReport {
    /// Fits of one number of strokes, that which most fits have: a row for each preset, a column for each
    /// picture.
    pub fn preset_table(&self) -> Table {
        let strokes = usual_strokes(&self.entries);
        let mut head = vec![format!("{strokes} strokes")];
        head.extend(pictures(&self.entries).into_iter().map(str::to_owned));
        let mut table = Table::new(&head);
        let of_strokes = |e: &&ParetoEntry| e.asked_strokes() == Some(strokes);
        let fits: Vec<&ParetoEntry> = self.entries.iter().filter(of_strokes).collect();
        for preset in distinct(fits.iter().filter_map(|e| e.preset.as_deref())) {
            let mut cells = vec![option(preset)];
            for picture in pictures(&self.entries) {
                // The first is that of the first coverage function and seed.
                let mut same = fits.iter().filter(|e| e.picture == picture);
                let fit = same.find(|e| e.preset.as_deref() == Some(preset));
                cells.push(fit.map_or_else(String::new, |e| figures(e)));
            }
            table.row(cells);
        }
        table
    }

    /// The article's recipe: a row for each of its runs.
    pub fn recipe_table(&self) -> Table {
        let mut table = Table::new(&[
            "picture",
            "the article's recipe",
            "a fit of as many strokes",
            "gain",
            "share of the recipe's CPU time",
            "gain of a draft at equal CPU time",
        ]);
        for picture in pictures(&self.entries) {
            let here = self.of(picture);
            let equal_time = AtEqualTime::all(&here);
            let at_equal_time = equal_time.first().map(|c| decibels(c.gain_db()));
            for equal in AtEqualStrokes::all(&here) {
                let [gain, share] = equal.gain().map_or_else(Default::default, |[db, share]| {
                    [decibels(db), format!("{share:.2}")]
                });
                table.row([
                    picture.to_owned(),
                    cost_and_error(equal.recipe),
                    equal.fit.map_or_else(|| "none".into(), cost_and_error),
                    gain,
                    share,
                    at_equal_time.clone().unwrap_or_default(),
                ]);
            }
        }
        table
    }

    fn of(&self, picture: &str) -> Vec<&ParetoEntry> {
        self.entries
            .iter()
            .filter(|e| e.picture == picture)
            .collect()
    }
}

/// The number of strokes that most fits were given.
fn usual_strokes(entries: &[ParetoEntry]) -> &str {
    let asked = || entries.iter().filter_map(ParetoEntry::asked_strokes);
    let count = |word: &&str| asked().filter(|other| other == word).count();
    distinct(asked())
        .into_iter()
        .max_by_key(count)
        .unwrap_or("no")
}

/// The options of `strokefit fit` that a preset's word stands for.
fn option(preset: &str) -> String {
    match preset {
        "stages" => "--preset draft --no-polish".into(),
        preset => format!("--preset {preset}"),
    }
}

fn figures(entry: &ParetoEntry) -> String {
    let kilobytes = entry.svg_bytes as f64 / 1000.0;
    let psnr_db = entry.psnr_db().unwrap_or(f64::NAN);
    format!(
        "{psnr_db:.1} dB, {} s, {kilobytes:.0} kB",
        seconds(entry.wall_s)
    )
}

fn cost_and_error(entry: &ParetoEntry) -> String {
    let by = match &entry.preset {
        Some(preset) if entry.family != ARTICLE => format!(" ({preset})"),
        _ => String::new(),
    };
    let psnr_db = entry.psnr_db().unwrap_or(f64::NAN);
    format!("{psnr_db:.1} dB, {} s{by}", seconds(entry.cpu_s))
}

/// Two digits or more.
fn seconds(value: Option<f64>) -> String {
    match value {
        Some(s) if s < 1.0 => format!("{s:.2}"),
        Some(s) => format!("{s:.1}"),
        None => "?".into(),
    }
}

fn decibels(gain: f64) -> String {
    format!("{gain:+.1} dB")
}

#[cfg(test)]
mod tests {
    use super::super::{OWN, drawing};
    use super::*;

    fn fit(picture: &str, preset: &str, label: &str, psnr_db: f64) -> ParetoEntry {
        ParetoEntry {
            picture: picture.into(),
            preset: Some(preset.into()),
            wall_s: Some(0.25),
            svg_bytes: 4000,
            ..drawing(OWN, label, 0.5, 900, psnr_db)
        }
    }

    #[test]
    fn presets_are_quoted_at_the_number_of_strokes_that_most_fits_have() {
        let report = ParetoReport::new(vec![
            fit("cat", "draft", "draft 50 smoothstep seed 0", 21.0),
            fit("cat", "draft", "draft 100 smoothstep seed 0", 23.0),
            fit("cat", "draft", "draft 100 smoothstep seed 1", 24.0),
            fit("dog", "stages", "stages 100 smoothstep seed 0", 22.0),
        ]);
        let expected = "100 strokes,cat,dog\n\
                        --preset draft,\"23.0 dB, 0.25 s, 4 kB\",\n\
                        --preset draft --no-polish,,\"22.0 dB, 0.25 s, 4 kB\"\n";
        assert_eq!(report.preset_table().csv(), expected);
    }

    #[test]
    fn others_are_quoted_beside_us() {
        let report = ParetoReport::new(vec![
            fit("cat", "draft", "draft 100 smoothstep seed 0", 30.0),
            drawing(
                ARTICLE,
                "100 strokes, 1500 iterations, seed 0",
                4.0,
                900,
                22.0,
            ),
            drawing(
                ARTICLE,
                "100 strokes, time of draft, seed 0",
                0.5,
                900,
                20.0,
            ),
        ]);
        let recipe = report.recipe_table().csv();
        let row = "cat,\"22.0 dB, 4.0 s\",\"30.0 dB, 0.50 s (draft)\",+8.0 dB,0.12,+10.0 dB\n";
        assert!(recipe.ends_with(row), "{recipe}");
    }
}
