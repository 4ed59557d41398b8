//! Plots of cases: elements found against elements drawn, and what was found against the size of the picture.

use super::Damage;
use super::cases::Case;
use super::plot::Chart;
use super::statistics::{distinct, median};

/// What is plotted against the size, in words; the axis; and whether that is logarithmic.
pub(super) type Axis = (&'static str, &'static str, bool);

/// A number of cases of one size.
pub(super) type Value<Entry> = fn(&[&Entry]) -> Option<f64>;

/// Elements found against those drawn, in clean pictures: a mark for each case, a line where both are equal, and, if asked for,
/// lines through the medians.
pub(super) fn elements<Entry: Case>(made: &[&Entry], with_medians: bool) -> Chart {
    let clean = made.iter().copied().filter(|e| e.damage() == Damage::Clean);
    let clean: Vec<&Entry> = clean.collect();
    let mut chart = Chart {
        title: "elements found in clean pictures".into(),
        axes: ["elements drawn".into(), "elements found".into()],
        logarithmic: true,
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    let drawn = numbers(clean.iter().map(|e| e.elements()[1]));
    for by in distinct(clean.iter().map(|e| e.by().to_owned())) {
        let here: Vec<[usize; 2]> = clean
            .iter()
            .filter(|e| e.by() == by)
            .map(|e| e.elements())
            .collect();
        let marks = here
            .iter()
            .map(|&[found, drawn]| [drawn as f64, found as f64]);
        chart.marks.push(marks.collect());
        let middle = |&number: &usize| {
            let same = here.iter().filter(|[_, drawn]| *drawn == number);
            let found = same.map(|[found, _]| *found as f64).collect();
            [number as f64, median(found)]
        };
        // Marks have the colour of a line, which has the legend.
        let medians = if with_medians { &drawn[..] } else { &[] };
        chart
            .series
            .push((by, medians.iter().map(middle).collect()));
    }
    let equal = drawn.iter().map(|&number| [number as f64; 2]).collect();
    chart.series.push(("as drawn".into(), equal));
    chart
}

/// A line for each who found drawings, and for each damage.
pub(super) fn against_size<Entry: Case>(
    made: &[&Entry],
    (what, axis, logarithmic): Axis,
    value: Value<Entry>,
) -> Chart {
    let mut chart = Chart {
        title: format!("{what} against the size of the picture"),
        axes: ["longer side of the picture, px".into(), axis.into()],
        logarithmic,
        logarithmic_x: true,
        legend_beside: true,
        ..Chart::default()
    };
    let legend = |e: &Entry| e.damage().after(e.by());
    for name in distinct(made.iter().map(|e| legend(e))) {
        let here: Vec<&Entry> = made.iter().copied().filter(|e| legend(e) == name).collect();
        let point = |&side: &usize| {
            let same = here.iter().copied().filter(|e| e.side_px() == side);
            Some([side as f64, value(&same.collect::<Vec<_>>())?])
        };
        let sides = numbers(here.iter().map(|e| e.side_px()));
        let points: Vec<[f64; 2]> = sides.iter().filter_map(point).collect();
        chart.marks.push(points.clone());
        chart.series.push((name, points));
    }
    chart
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
    use super::super::inverse::{Inventory, InverseEntry};
    use super::*;

    #[test]
    fn elements_are_compared_at_their_medians() {
        let found = |elements| Inventory {
            elements,
            ..Inventory::default()
        };
        let entries = [2, 4, 3].map(|elements| InverseEntry {
            original: found(2),
            found: found(elements),
            ..InverseEntry::default()
        });
        let chart = elements(&entries.iter().collect::<Vec<_>>(), true);
        assert_eq!(chart.series[0].1, [[2.0, 3.0]]);
        assert_eq!(chart.marks[0].len(), 3);
    }
}
