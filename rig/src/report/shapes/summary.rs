//! Medians over drawings.

use super::super::cases::{Case, grouped};
use super::super::statistics::{distinct, mean, median, optional};
use super::super::{Damage, Table};
use super::{Belonging, Contents, ShapesEntry};

/// The columns of numbers, after those that name a row.
const HEAD: [&str; 16] = [
    "drawings",
    "elements ÷ artist's, median",
    "share ≤ 2",
    "rings ÷",
    "points ÷",
    "parameters ÷",
    "numbers ÷",
    "bytes ÷",
    "dB, median",
    "dB − artist's, median",
    "ΔE00, mean of families",
    "edges off by, px, median",
    "purity, mean",
    "coverage, mean",
    "locality, mean",
    "s, median",
];

/// One row for each size and damage, and who found the drawings, with the growth of numbers by the damage.
pub(super) fn by_picture(made: &[&ShapesEntry]) -> Table {
    let mut table = Table::new(&[&["pictures", "by"][..], &HEAD, &["growth, median"]].concat());
    for (kind, by, cases) in grouped(made, Case::kind, |e| e.by.clone()) {
        let growth: Vec<f64> = cases.iter().filter_map(|e| growth(e, made)).collect();
        let growth = Some(median(growth)).filter(|growth| growth.is_finite());
        let mut row = vec![kind, by];
        row.extend(summed_up(&cases));
        row.push(optional(growth, 2));
        table.row(row);
    }
    table
}

/// One row for each family, size and damage: what we made.
pub(super) fn by_family(made: &[&ShapesEntry]) -> Table {
    let mut table = Table::new(&[&["family", "pictures"][..], &HEAD].concat());
    let own: Vec<&ShapesEntry> = made.iter().copied().filter(|e| e.is_own()).collect();
    for (kind, family, cases) in grouped(&own, Case::kind, |e| e.family.clone()) {
        let mut row = vec![family, kind];
        row.extend(summed_up(&cases));
        table.row(row);
    }
    table
}

fn summed_up(cases: &[&ShapesEntry]) -> Vec<String> {
    let ratios = |of: fn(&Contents) -> usize| cases.iter().map(move |entry| entry.ratio(of));
    let ratio = |of| format!("{:.2}", median(ratios(of).collect()));
    let middle = |value: fn(&ShapesEntry) -> Option<f64>, digits| {
        let values: Vec<f64> = cases.iter().filter_map(|entry| value(entry)).collect();
        optional(Some(median(values)).filter(|m| !m.is_nan()), digits)
    };
    let usual = |value: fn(&Belonging) -> f64| {
        let values = cases.iter().filter_map(|entry| entry.belonging.as_ref());
        optional(mean(&values.map(value).collect::<Vec<_>>()), 2)
    };
    let few = ratios(|c| c.elements).filter(|ratio| *ratio <= 2.0);
    let share = few.count() as f64 / cases.len() as f64;
    vec![
        cases.len().to_string(),
        ratio(|c| c.elements),
        format!("{:.0} %", 100.0 * share),
        ratio(|c| c.rings),
        ratio(|c| c.points),
        ratio(|c| c.parameters),
        ratio(|c| c.numbers),
        ratio(|c| c.bytes),
        middle(|e| e.truth_db, 1),
        middle(ShapesEntry::beyond_artist_db, 1),
        optional(mean_of_families(cases), 2),
        middle(|e| e.displacement_px, 3),
        usual(|b| b.purity),
        usual(|b| b.coverage),
        usual(|b| b.locality),
        middle(|e| e.wall_s, 2),
    ]
}

/// The mean of the means of families, so that none counts for more than another.
pub(super) fn mean_of_families(cases: &[&ShapesEntry]) -> Option<f64> {
    let families = distinct(cases.iter().map(|e| e.family.clone())).into_iter();
    let means = families.filter_map(|family| {
        let here = cases.iter().filter(|e| e.family == family);
        mean(&here.filter_map(|e| e.delta_e).collect::<Vec<_>>())
    });
    mean(&means.collect::<Vec<_>>())
}

/// Numbers in the file for a damaged picture, a share of those for the clean one.
fn growth(entry: &ShapesEntry, made: &[&ShapesEntry]) -> Option<f64> {
    let clean = made.iter().find(|e| {
        let same = e.drawing == entry.drawing && e.side_px == entry.side_px && e.by == entry.by;
        same && e.damage == Damage::Clean
    })?;
    let damaged = entry.damage != Damage::Clean;
    damaged.then(|| entry.found.numbers as f64 / clean.found.numbers.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::super::super::cases::OWN;
    use super::super::tests::found;
    use super::*;

    fn rows(table: &Table) -> Vec<Vec<String>> {
        let csv = table.csv().replace("px, ", "px ");
        let rows = csv.lines().map(|row| row.split(',').map(str::to_owned));
        rows.map(Iterator::collect).collect()
    }

    #[test]
    fn the_summary_has_a_row_for_each_kind_of_picture_and_finder() {
        let damaged = ShapesEntry {
            damage: Damage::Jpeg(75),
            ..found(OWN, 128, 12)
        };
        let entries = [
            found(OWN, 128, 4),
            found(OWN, 128, 8),
            found("potrace", 128, 2),
            damaged,
        ];
        let table = by_picture(&entries.iter().collect::<Vec<_>>());
        let rows = rows(&table);
        let starts = rows.iter().map(|row| row[..5].join(" "));
        assert_eq!(
            starts.skip(1).collect::<Vec<_>>(),
            [
                "128 px strokefit 2 3.00 50 %",
                "128 px potrace 1 1.00 100 %",
                "\"128 px JPEG 75\" strokefit 1 6.00 0 %"
            ]
        );
        assert_eq!(rows[1].last().unwrap(), "", "clean pictures do not grow");
        assert_eq!(rows[3].last().unwrap(), "3.00");
        let expected = [
            "42.0", "3.0", "0.50", "0.125", "0.75", "1.00", "0.50", "0.20",
        ];
        assert_eq!(rows[1][10..18], expected);
    }

    #[test]
    fn families_count_alike() {
        let other = ShapesEntry {
            family: "carbon".into(),
            delta_e: Some(1.5),
            ..found(OWN, 128, 2)
        };
        let entries = [found(OWN, 128, 2), found(OWN, 128, 2), other];
        let cases: Vec<_> = entries.iter().collect();
        assert_eq!(mean_of_families(&cases), Some(1.0));
        let rows = rows(&by_family(&cases));
        let starts: Vec<_> = rows.iter().map(|row| row[..3].join(" ")).collect();
        assert_eq!(starts[1..], ["noto 128 px 2", "carbon 128 px 1"]);
    }
}
