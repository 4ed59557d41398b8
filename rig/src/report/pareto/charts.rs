//! Plots of one picture's drawings: marks for drawings, lines for fronts.

use super::{ARTICLE, OWN, ParetoEntry, front};
use crate::report::plot::Chart;
use crate::report::statistics::distinct;
use strokefit::Result;

type Number = fn(&ParetoEntry) -> Option<f64>;

/// A name and what it is of a drawing.
type Axis = (&'static str, Number);

/// Name and SVG of each plot of `picture`: `time`, `bytes` and `strokes` against PSNR, `seen`, bytes against SSIMULACRA2, and
/// `stages`.
///
/// # Errors
/// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when one cannot be drawn.
pub fn charts(entries: &[ParetoEntry], picture: &str) -> Result<Vec<(&'static str, String)>> {
    let here: Vec<&ParetoEntry> = entries.iter().filter(|e| e.picture == picture).collect();
    let by = |name: &'static str, cost: Axis, gain: Axis| {
        let title = format!("{picture}: {} against {}", cost.0, gain.0);
        Ok((name, scatter(&title, &here, [cost, gain]).svg()?))
    };
    let bytes: Axis = ("bytes after gzip", |e| Some(e.gzip_bytes as f64));
    let strokes: Axis = ("strokes", |e| e.strokes.map(|n| n as f64));
    let psnr: Axis = ("PSNR of the file, dB", |e| {
        e.psnr_db().filter(|db| db.is_finite())
    });
    let seen: Axis = ("SSIMULACRA2 of the file", ParetoEntry::ssimulacra2);
    Ok(vec![
        by("time", ("CPU time, s", |e| e.cpu_s), psnr)?,
        by("bytes", bytes, psnr)?,
        by("strokes", strokes, psnr)?,
        by("seen", bytes, seen)?,
        ("stages", stages(picture, &here).svg()?),
    ])
}

/// Whose line a drawing is on: ours by preset, others by family.
fn line(entry: &ParetoEntry) -> String {
    match &entry.preset {
        Some(preset) => format!("{OWN} {preset}"),
        None if entry.family == ARTICLE => "article's recipe".into(),
        None => entry.family.clone(),
    }
}

fn scatter(title: &str, here: &[&ParetoEntry], [(x, cost), (y, gain)]: [Axis; 2]) -> Chart {
    let point = |e: &&ParetoEntry| Some([cost(e)?, gain(e)?]);
    let mut chart = Chart {
        title: title.into(),
        axes: [x.into(), y.into()],
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    for name in lines(here) {
        let members: Vec<&ParetoEntry> = here.iter().copied().filter(|e| line(e) == name).collect();
        let marks: Vec<[f64; 2]> = members.iter().filter_map(point).collect();
        if marks.is_empty() {
            continue;
        }
        let best = front(members, cost, gain);
        chart
            .series
            .push((name, best.iter().filter_map(point).collect()));
        chart.marks.push(marks);
    }
    chart
}

/// Names of lines in the order of their first drawings.
fn lines(here: &[&ParetoEntry]) -> Vec<String> {
    distinct(here.iter().map(|e| line(e)))
}

/// The error after each stage of the largest drawing of each preset, and of its file.
fn stages(picture: &str, here: &[&ParetoEntry]) -> Chart {
    let mut chart = Chart {
        title: format!("{picture}: error after each stage"),
        axes: ["stage, and at last the file".into(), "PSNR, dB".into()],
        legend_beside: true,
        ..Chart::default()
    };
    for name in lines(here) {
        let members = here
            .iter()
            .filter(|e| line(e) == name && !e.stages.is_empty());
        let Some(largest) =
            members.max_by_key(|e| (e.strokes, std::cmp::Reverse(e.label.as_str())))
        else {
            continue;
        };
        let stages = largest.stages.iter().map(|stage| Some(stage.psnr_db));
        let errors = stages.chain([largest.psnr_db()]);
        let points: Vec<[f64; 2]> = (1..)
            .zip(errors)
            .filter_map(|(index, db)| Some([f64::from(index), db.filter(|db| db.is_finite())?]))
            .collect();
        chart.marks.push(points.clone());
        let asked = largest.asked_strokes().unwrap_or_default();
        chart.series.push((
            format!("{} {asked}", name.trim_start_matches(OWN).trim()),
            points,
        ));
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::super::drawing;
    use super::*;

    #[test]
    fn every_family_has_its_line() {
        let entries = [
            drawing(ARTICLE, "100 strokes", 4.0, 900, 24.0),
            drawing("vtracer", "x", 0.2, 700, 23.0),
        ];
        let charts = charts(&entries, "cat").unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["time", "bytes", "strokes", "seen", "stages"]);
        assert!(
            charts[0].1.contains("article's recipe")
                || charts[0].1.contains("article&apos;s recipe")
        );
        assert!(charts[1].1.contains("vtracer"));
    }
}
