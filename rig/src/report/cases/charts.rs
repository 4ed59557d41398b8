//! Plots of cases: elements found against elements drawn, and what was found against the size of the picture.

use super::super::plot::Chart;
use super::super::statistics::{distinct, median};
use super::summary::mean_of_families;
use super::{CaseEntry, Damage};
use strokefit::Result;

/// A number of cases of one size.
type Value = fn(&[&CaseEntry]) -> Option<f64>;

/// Each plot against the size: its name, what is plotted in words, the axis, whether that is logarithmic, and the value.
const BY_SIZE: [(&str, &str, &str, bool, Value); 4] = [
    (
        "parameters",
        "parameters",
        "median ÷ artist's",
        true,
        |cases| middle(cases, |e| e.ratio(|c| c.parameters)),
    ),
    ("bytes", "bytes", "median ÷ artist's", true, |cases| {
        middle(cases, |e| e.ratio(|c| c.bytes))
    }),
    ("db", "median PSNR", "dB", false, |cases| {
        middle(cases, |e| e.truth_db)
    }),
    (
        "delta",
        "ΔE00 at 1,024 px",
        "mean of families",
        false,
        mean_of_families,
    ),
];

fn middle(cases: &[&CaseEntry], value: fn(&CaseEntry) -> Option<f64>) -> Option<f64> {
    let values = cases.iter().filter_map(|e| value(e));
    Some(median(values.filter(|value| value.is_finite()).collect()))
}

pub(super) fn all(made: &[&CaseEntry]) -> Result<Vec<(&'static str, String)>> {
    let known = made.iter().copied().filter(|e| e.original.is_some());
    let known: Vec<&CaseEntry> = known.collect();
    if known.is_empty() {
        return Ok(Vec::new());
    }
    let mut plots = vec![("elements", elements(&known).svg()?)];
    for (name, what, axis, logarithmic, value) in BY_SIZE {
        let chart = Chart {
            title: format!("{what} against the size of the picture"),
            axes: ["longer side of the picture, px".into(), axis.into()],
            logarithmic,
            ..against_size(&known, value)
        };
        plots.push((name, chart.svg()?));
    }
    Ok(plots)
}

/// Elements found against those drawn, in clean pictures: a mark for each case, and a line where both are equal.
fn elements(made: &[&CaseEntry]) -> Chart {
    let clean = || made.iter().filter(|e| e.damage == Damage::Clean);
    let pair = |e: &&CaseEntry| {
        let drawn = e.original.unwrap_or_default().elements;
        [drawn as f64, e.found.elements as f64]
    };
    let mut chart = Chart {
        title: "elements found in clean pictures".into(),
        axes: ["elements drawn".into(), "elements found".into()],
        logarithmic: true,
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    for by in distinct(clean().map(|e| e.by.clone())) {
        let marks = clean().filter(|e| e.by == by).map(pair);
        chart.marks.push(marks.collect());
        // Marks have the colour of a line, which has the legend.
        chart.series.push((by, Vec::new()));
    }
    let mut equal: Vec<[f64; 2]> = clean().map(|e| [pair(e)[0]; 2]).collect();
    equal.sort_by(|a, b| a[0].total_cmp(&b[0]));
    chart.series.push(("as drawn".into(), equal));
    chart
}

/// A line for each who found drawings, and for each damage.
fn against_size(made: &[&CaseEntry], value: Value) -> Chart {
    let mut chart = Chart {
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    let legend = |e: &CaseEntry| e.damage.after(&e.by);
    for name in distinct(made.iter().map(|e| legend(e))) {
        let here: Vec<&CaseEntry> = made.iter().copied().filter(|e| legend(e) == name).collect();
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
        let noisy = CaseEntry {
            damage: Damage::Noise(8),
            ..found("strokefit", 128, 9)
        };
        let clean = [
            ("strokefit", 128, 2),
            ("strokefit", 256, 3),
            ("potrace", 128, 4),
        ];
        let clean = clean.map(|(by, side_px, elements)| found(by, side_px, elements));
        let made: Vec<&CaseEntry> = clean.iter().chain([&noisy]).collect();
        let charts = all(&made).unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["elements", "parameters", "bytes", "db", "delta"]);
        let has = |chart: usize, word| charts[chart].1.contains(word);
        assert!(has(0, "as drawn") && has(0, "potrace") && !has(0, "noise"));
        assert!(has(1, "strokefit noise 8") && has(2, "potrace"));
        let marks = |chart: usize| charts[chart].1.matches("<circle").count();
        assert_eq!([marks(0), marks(1)], [3, 4]);
        assert!(
            all(&[&CaseEntry::default()]).unwrap().is_empty(),
            "no artist"
        );
    }
}
