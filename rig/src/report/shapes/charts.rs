//! Plots: elements found against elements drawn, and what was found against the size of the picture.

use super::summary::mean_of_families;
use super::{Contents, ShapesEntry, ShapesReport};
use crate::report::Damage;
use crate::report::plot::Chart;
use crate::report::statistics::{distinct, median};
use strokefit::Result;

type Value = fn(&[&ShapesEntry]) -> Option<f64>;

/// Name and SVG of each plot of a report.
///
/// # Errors
/// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when one cannot be drawn.
pub fn charts(report: &ShapesReport) -> Result<Vec<(&'static str, String)>> {
    let made = report.made();
    let size = "against the size of the picture";
    let by_size: [(&str, String, &str, bool, Value); 4] = [
        (
            "parameters",
            format!("parameters {size}"),
            "median ÷ artist's",
            true,
            |cases| ratio(cases, |contents| contents.parameters),
        ),
        (
            "bytes",
            format!("bytes {size}"),
            "median ÷ artist's",
            true,
            |cases| ratio(cases, |contents| contents.bytes),
        ),
        ("db", format!("median PSNR {size}"), "dB", false, |cases| {
            let db = cases.iter().filter_map(|e| e.truth_db);
            Some(median(db.filter(|db| db.is_finite()).collect()))
        }),
        (
            "delta",
            format!("ΔE00 at 1,024 px {size}"),
            "mean of families",
            false,
            mean_of_families,
        ),
    ];
    let mut plots = vec![("elements", elements(&made).svg()?)];
    for (name, title, axis, logarithmic, value) in by_size {
        let chart = Chart {
            title,
            axes: ["longer side of the picture, px".into(), axis.into()],
            logarithmic,
            ..against_size(&made, value)
        };
        plots.push((name, chart.svg()?));
    }
    Ok(plots)
}

fn ratio(cases: &[&ShapesEntry], of: fn(&Contents) -> usize) -> Option<f64> {
    Some(median(cases.iter().map(|e| e.ratio(of)).collect()))
}

/// Elements found against those drawn, in clean pictures: a mark for each case, and a line where both are equal.
fn elements(made: &[&ShapesEntry]) -> Chart {
    let clean = made.iter().copied().filter(|e| e.damage == Damage::Clean);
    let clean: Vec<&ShapesEntry> = clean.collect();
    let mut chart = Chart {
        title: "elements found in clean pictures".into(),
        axes: ["elements drawn".into(), "elements found".into()],
        logarithmic: true,
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    for by in distinct(clean.iter().map(|e| e.by.clone())) {
        let here = clean.iter().filter(|e| e.by == by);
        let point = |e: &&ShapesEntry| [e.original.elements as f64, e.found.elements as f64];
        chart.marks.push(here.map(point).collect());
        // Marks have the colour of a line, which has the legend.
        chart.series.push((by, Vec::new()));
    }
    let mut drawn: Vec<usize> = clean.iter().map(|e| e.original.elements).collect();
    drawn.sort_unstable();
    drawn.dedup();
    let equal = drawn.iter().map(|&number| [number as f64; 2]).collect();
    chart.series.push(("as drawn".into(), equal));
    chart
}

/// A line for each who found drawings, and for each damage.
fn against_size(made: &[&ShapesEntry], value: Value) -> Chart {
    let mut chart = Chart {
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    let legend = |e: &ShapesEntry| e.damage.after(&e.by);
    for name in distinct(made.iter().map(|e| legend(e))) {
        let here: Vec<&ShapesEntry> = made.iter().copied().filter(|e| legend(e) == name).collect();
        let mut sides: Vec<usize> = here.iter().map(|e| e.side_px).collect();
        sides.sort_unstable();
        sides.dedup();
        let point = |&side: &usize| {
            let same = here.iter().copied().filter(|e| e.side_px == side);
            Some([side as f64, value(&same.collect::<Vec<_>>())?])
        };
        let points: Vec<[f64; 2]> = sides.iter().filter_map(point).collect();
        chart.marks.push(points.clone());
        chart.series.push((name, points));
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::super::tests::found;
    use super::*;

    #[test]
    fn all_who_found_drawings_have_their_lines() {
        let noisy = ShapesEntry {
            damage: Damage::Noise(8),
            ..found("strokefit", 128, 9)
        };
        let entries = vec![
            found("strokefit", 128, 2),
            found("strokefit", 256, 3),
            found("potrace", 128, 4),
            noisy,
        ];
        let charts = charts(&ShapesReport::new(entries)).unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["elements", "parameters", "bytes", "db", "delta"]);
        let has = |chart: usize, word| charts[chart].1.contains(word);
        assert!(has(0, "as drawn") && has(0, "potrace") && !has(0, "noise"));
        assert!(has(1, "strokefit noise 8") && has(2, "potrace"));
        let marks = |chart: usize| charts[chart].1.matches("<circle").count();
        assert_eq!([marks(0), marks(1)], [3, 4]);
    }
}
