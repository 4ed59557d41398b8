//! Plots: elements found against elements drawn, and dB and bytes against the size of the picture.

use super::{InverseEntry, InverseReport, distinct, mean, median};
use crate::report::Damage;
use crate::report::plot::Chart;
use strokefit::Result;

/// Name and SVG of each plot of a report: `elements`, `db` and `bytes`.
///
/// # Errors
/// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when one cannot be drawn.
pub fn charts(report: &InverseReport) -> Result<Vec<(&'static str, String)>> {
    let made = report.made();
    let by_size = |title, axis: &str, logarithmic, value: fn(&[&InverseEntry]) -> Option<f64>| {
        let chart = against_size(&made, value);
        Chart {
            title,
            axes: ["longer side of the picture, px".into(), axis.into()],
            logarithmic,
            ..chart
        }
    };
    let db = |cases: &[&InverseEntry]| {
        let finite = cases.iter().filter_map(|e| e.psnr_db);
        mean(&finite.filter(|db| db.is_finite()).collect::<Vec<_>>())
    };
    let bytes = |cases: &[&InverseEntry]| {
        Some(median(cases.iter().map(|e| e.found.bytes as f64).collect()))
    };
    let size = "against the size of the picture";
    Ok(vec![
        ("elements", elements(&made).svg()?),
        (
            "db",
            by_size(format!("mean PSNR {size}"), "dB", false, db).svg()?,
        ),
        (
            "bytes",
            by_size(format!("median bytes {size}"), "bytes", true, bytes).svg()?,
        ),
    ])
}

/// Elements found against those drawn, in clean pictures: a mark for each case, a line through the medians.
fn elements(made: &[&InverseEntry]) -> Chart {
    let clean: Vec<&InverseEntry> = made
        .iter()
        .copied()
        .filter(|e| e.damage() == Damage::Clean)
        .collect();
    let mut chart = Chart {
        title: "elements found in clean pictures".into(),
        axes: ["elements drawn".into(), "elements found".into()],
        logarithmic: true,
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    let drawn = numbers(clean.iter().map(|e| e.original.elements));
    for by in distinct(clean.iter().map(|e| e.by.clone())) {
        let here: Vec<&InverseEntry> = clean.iter().copied().filter(|e| e.by == by).collect();
        let point = |e: &&InverseEntry| [e.original.elements as f64, e.found.elements as f64];
        chart.marks.push(here.iter().map(point).collect());
        let middle = |&number: &usize| {
            let same = here.iter().filter(|e| e.original.elements == number);
            let found = same.map(|e| e.found.elements as f64).collect();
            [number as f64, median(found)]
        };
        chart.series.push((by, drawn.iter().map(middle).collect()));
    }
    let equal = drawn.iter().map(|&number| [number as f64; 2]).collect();
    chart.series.push(("as drawn".into(), equal));
    chart
}

/// A line for each who found drawings, and for each quality.
fn against_size(made: &[&InverseEntry], value: fn(&[&InverseEntry]) -> Option<f64>) -> Chart {
    let mut chart = Chart {
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    for name in distinct(made.iter().map(|e| legend(e))) {
        let here: Vec<&InverseEntry> = made.iter().copied().filter(|e| legend(e) == name).collect();
        let point = |&side: &usize| {
            let same = here.iter().copied().filter(|e| e.side_px == side);
            Some([side as f64, value(&same.collect::<Vec<_>>())?])
        };
        let sides = numbers(here.iter().map(|e| e.side_px));
        let points: Vec<[f64; 2]> = sides.iter().filter_map(point).collect();
        chart.marks.push(points.clone());
        chart.series.push((name, points));
    }
    chart
}

fn legend(entry: &InverseEntry) -> String {
    entry.damage().after(&entry.by)
}

/// Each once, rising.
fn numbers(all: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut all: Vec<usize> = all.collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::super::Inventory;
    use super::*;
    use crate::report::cases::OWN;

    fn found(by: &str, side_px: usize, jpeg: Option<u8>, elements: usize) -> InverseEntry {
        InverseEntry {
            by: by.into(),
            side_px,
            jpeg,
            original: Inventory {
                elements: 2,
                ..Inventory::default()
            },
            found: Inventory {
                elements,
                bytes: 700,
                ..Inventory::default()
            },
            psnr_db: Some(40.0),
            ..InverseEntry::default()
        }
    }

    #[test]
    fn all_who_found_drawings_have_their_lines() {
        let report = InverseReport::new(vec![
            found(OWN, 48, None, 2),
            found(OWN, 96, None, 3),
            found(OWN, 48, Some(75), 9),
            found("potrace", 48, None, 6),
        ]);
        let charts = charts(&report).unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["elements", "db", "bytes"]);
        let has = |chart: usize, word| charts[chart].1.contains(word);
        assert!(has(0, "as drawn") && has(0, "potrace") && !has(0, "JPEG"));
        assert!(has(1, "strokefit JPEG 75") && has(2, "potrace"));
        let marks = |chart: usize| charts[chart].1.matches("<circle").count();
        assert_eq!([marks(0), marks(1)], [3, 4]);
    }

    #[test]
    fn elements_are_compared_at_their_medians() {
        let entries = [2, 4, 3].map(|elements| found(OWN, 48, None, elements));
        let chart = elements(&entries.iter().collect::<Vec<_>>());
        assert_eq!(chart.series[0].1, [[2.0, 3.0]]);
        assert_eq!(chart.marks[0].len(), 3);
    }
}
