//! Sums over drawings.

use super::super::statistics::{distinct, mean, median, optional};
use super::super::{Column, Damage, Table};
use super::{CaseEntry, Contents};

/// Cases that are summed up in one row.
struct Group<'a> {
    kind: String,
    /// Who drew them, or their family.
    name: String,
    /// Each with the case of the same drawing before it was damaged.
    cases: Vec<(&'a CaseEntry, Option<&'a CaseEntry>)>,
}

/// A number of a case.
type Figure = fn(&CaseEntry) -> Option<f64>;

impl Group<'_> {
    fn values(&self, value: Figure) -> Vec<f64> {
        let values = self.cases.iter().filter_map(|(entry, _)| value(entry));
        values.filter(|value| !value.is_nan()).collect()
    }

    fn median(&self, value: Figure, digits: usize) -> String {
        middle(self.values(value), digits)
    }

    fn mean(&self, value: Figure, digits: usize) -> String {
        let mean = mean(&self.values(value));
        optional(mean.filter(|mean| mean.is_finite()), digits)
    }

    fn count(&self, is: fn(&CaseEntry) -> bool) -> usize {
        self.cases.iter().filter(|(entry, _)| is(entry)).count()
    }

    /// Contents of files for damaged pictures, as shares of those for the clean ones.
    fn growth(&self, of: fn(&Contents) -> usize) -> Vec<f64> {
        let ratio = |&(entry, clean): &(&CaseEntry, Option<&CaseEntry>)| {
            let damaged = entry.damage != Damage::Clean;
            let clean = clean.filter(|_| damaged)?;
            Some(of(&entry.found) as f64 / of(&clean.found).max(1) as f64)
        };
        self.cases.iter().filter_map(ratio).collect()
    }
}

fn middle(values: Vec<f64>, digits: usize) -> String {
    optional(Some(median(values)).filter(|m| m.is_finite()), digits)
}

fn columns<'a>() -> [Column<Group<'a>>; 31] {
    [
        ("drawings", |g| g.cases.len().to_string()),
        ("recognised", |g| {
            match g.count(|e| e.recognised.is_some()) {
                0 => String::new(),
                count => count.to_string(),
            }
        }),
        ("elements ÷ artist's, median", |g| {
            g.median(|e| e.ratio(|c| c.elements), 2)
        }),
        ("share ≤ 2", |g| {
            let ratios = g.values(|e| e.ratio(|c| c.elements));
            let few = ratios.iter().filter(|ratio| **ratio <= 2.0).count();
            let share = (!ratios.is_empty()).then(|| 100.0 * few as f64 / ratios.len() as f64);
            share.map_or_else(String::new, |share| format!("{share:.0} %"))
        }),
        ("rings ÷", |g| g.median(|e| e.ratio(|c| c.rings), 2)),
        ("points ÷", |g| g.median(|e| e.ratio(|c| c.points), 2)),
        ("parameters ÷", |g| {
            g.median(|e| e.ratio(|c| c.parameters), 2)
        }),
        ("numbers ÷", |g| g.median(|e| e.ratio(|c| c.numbers), 2)),
        ("bytes ÷", |g| g.median(|e| e.ratio(|c| c.bytes), 2)),
        ("points, median", |g| {
            g.median(|e| Some(e.found.points as f64), 0)
        }),
        ("bytes, median", |g| {
            g.median(|e| Some(e.found.bytes as f64), 0)
        }),
        ("elements ÷ clean, median", |g| {
            middle(g.growth(|c| c.elements), 2)
        }),
        ("numbers ÷ clean, median", |g| {
            middle(g.growth(|c| c.numbers), 2)
        }),
        ("numbers ÷ clean, mean", |g| {
            optional(mean(&g.growth(|c| c.numbers)), 2)
        }),
        ("bytes ÷ clean, median", |g| {
            middle(g.growth(|c| c.bytes), 2)
        }),
        ("dB, median", |g| g.median(|e| e.truth_db, 1)),
        ("dB, mean", |g| g.mean(|e| e.truth_db, 1)),
        ("SSIMULACRA2, median", |g| g.median(|e| e.ssimulacra2, 1)),
        ("SSIMULACRA2, least", |g| {
            optional(g.values(|e| e.ssimulacra2).into_iter().reduce(f64::min), 1)
        }),
        ("details kept, median", |g| g.median(|e| e.details_kept, 2)),
        ("page off by, levels, most", |g| {
            optional(g.values(|e| e.page_levels).into_iter().reduce(f64::max), 1)
        }),
        ("dB − artist's, median", |g| {
            g.median(CaseEntry::beyond_artist_db, 1)
        }),
        ("dB of the input, mean", |g| g.mean(|e| e.input_db, 1)),
        ("nearer than the input", |g| {
            let damaged = g.count(|e| e.damage != Damage::Clean) > 0;
            let nearer = damaged.then(|| g.count(|e| e.truth_db > e.input_db));
            nearer.map_or_else(String::new, |nearer| nearer.to_string())
        }),
        ("ΔE00, mean of families", |g| {
            let cases: Vec<&CaseEntry> = g.cases.iter().map(|(entry, _)| *entry).collect();
            optional(mean_of_families(&cases), 2)
        }),
        ("edges off by, px, median", |g| {
            g.median(|e| e.displacement_px, 3)
        }),
        ("centre lines off by, px, mean", |g| {
            g.mean(|e| e.mean_px, 2)
        }),
        ("purity, coverage, locality, means", |g| {
            let means: [String; 3] = [
                g.mean(|e| e.belonging.map(|b| b.purity), 2),
                g.mean(|e| e.belonging.map(|b| b.coverage), 2),
                g.mean(|e| e.belonging.map(|b| b.locality), 2),
            ];
            means.join(" ").trim().to_owned()
        }),
        ("hidden parts apart, median", |g| {
            g.median(|e| e.hidden.map(|h| h.apart()), 2)
        }),
        ("s, median", |g| g.median(|e| e.wall_s, 2)),
        ("s, most", |g| {
            optional(g.values(|e| e.wall_s).into_iter().reduce(f64::max), 2)
        }),
    ]
}

/// One row for each kind of picture, and who found the drawings, with the growth by the damage.
pub(super) fn by_picture(made: &[&CaseEntry], kind: fn(&CaseEntry) -> String) -> Table {
    let groups = grouped(made, made, kind, |e| e.by.clone());
    let names: [Column<Group<'_>>; 2] =
        [("pictures", |g| g.kind.clone()), ("by", |g| g.name.clone())];
    table(names, &groups)
}

/// One row for each family, size and damage: what we made.
pub(super) fn by_family(made: &[&CaseEntry]) -> Table {
    let own: Vec<&CaseEntry> = made.iter().copied().filter(|e| e.is_own()).collect();
    let groups = grouped(&own, made, CaseEntry::kind, |e| e.family.clone());
    let names: [Column<Group<'_>>; 2] = [
        ("family", |g| g.name.clone()),
        ("pictures", |g| g.kind.clone()),
    ];
    table(names, &groups)
}

fn table<'a>(names: [Column<Group<'a>>; 2], groups: &[Group<'a>]) -> Table {
    Table::of(&[&names[..], &columns()].concat(), groups).without_empty_columns()
}

/// The cases of each kind and of each name, in the order in which they come first.
fn grouped<'a>(
    cases: &[&'a CaseEntry],
    made: &[&'a CaseEntry],
    kind: fn(&CaseEntry) -> String,
    name: fn(&CaseEntry) -> String,
) -> Vec<Group<'a>> {
    let clean = |entry: &CaseEntry| {
        made.iter().copied().find(|e| {
            let same = e.drawing == entry.drawing && e.side_px == entry.side_px && e.by == entry.by;
            same && e.damage == Damage::Clean
        })
    };
    let mut groups: Vec<Group<'a>> = Vec::new();
    for kind_of in distinct(cases.iter().map(|e| kind(e))) {
        for name_of in distinct(cases.iter().map(|e| name(e))) {
            let here = cases
                .iter()
                .filter(|e| kind(e) == kind_of && name(e) == name_of);
            groups.push(Group {
                cases: here.map(|&entry| (entry, clean(entry))).collect(),
                kind: kind_of.clone(),
                name: name_of,
            });
        }
    }
    groups.retain(|group| !group.cases.is_empty());
    groups
}

/// The mean of the means of families, so that none counts for more than another.
pub(super) fn mean_of_families(cases: &[&CaseEntry]) -> Option<f64> {
    let families = distinct(cases.iter().map(|e| e.family.clone())).into_iter();
    let means = families.filter_map(|family| {
        let here = cases.iter().filter(|e| e.family == family);
        mean(&here.filter_map(|e| e.delta_e).collect::<Vec<_>>())
    });
    mean(&means.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::super::OWN;
    use super::super::tests::found;
    use super::*;

    /// The cell of a row, both from 0, under a head.
    fn cell(table: &Table, row: usize, head: &str) -> String {
        let csv = table
            .csv()
            .replace("px, ", "px ")
            .replace("median,", "median")
            .replace(", ", " ");
        let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        let at = lines[0]
            .iter()
            .position(|cell| cell.trim_start_matches('"').starts_with(head));
        lines[1 + row][at.unwrap_or_else(|| panic!("{head}: {csv}"))].replace('"', "")
    }

    #[test]
    fn the_summary_has_a_row_for_each_kind_of_picture_and_finder() {
        let damaged = CaseEntry {
            damage: Damage::Jpeg(75),
            truth_db: Some(38.0),
            input_db: Some(36.0),
            ..found(OWN, 128, 12)
        };
        let clean = [
            found(OWN, 128, 4),
            found(OWN, 128, 8),
            found("potrace", 128, 2),
        ];
        let all: Vec<&CaseEntry> = clean.iter().chain([&damaged]).collect();
        let table = by_picture(&all, CaseEntry::kind);
        let rows: Vec<String> = (0..3)
            .map(|row| {
                ["pictures", "by", "drawings", "elements ÷ artist's", "share"]
                    .map(|head| cell(&table, row, head))
                    .join("; ")
            })
            .collect();
        assert_eq!(
            rows,
            [
                "128 px; strokefit; 2; 3.00; 50 %",
                "128 px; potrace; 1; 1.00; 100 %",
                "128 px JPEG 75; strokefit; 1; 6.00; 0 %"
            ]
        );
        assert_eq!(
            cell(&table, 0, "numbers ÷ clean"),
            "",
            "clean pictures do not grow"
        );
        assert_eq!(cell(&table, 2, "numbers ÷ clean"), "3.00");
        assert_eq!(cell(&table, 2, "nearer"), "1");
        for (head, expected) in [
            ("dB", "42.0"),
            ("SSIMULACRA2 least", "80.0"),
            ("details kept", "0.90"),
            ("page off by", "1.0"),
            ("dB − artist's", "3.0"),
            ("ΔE00", "0.50"),
            ("edges", "0.125"),
            ("purity", "0.75 1.00 0.50"),
            ("s median", "0.20"),
        ] {
            assert_eq!(cell(&table, 0, head), expected, "{head}");
        }
        assert!(!table.csv().contains("centre lines"), "nobody has any");
    }

    #[test]
    fn families_count_alike() {
        let other = CaseEntry {
            family: "carbon".into(),
            delta_e: Some(1.5),
            ..found(OWN, 128, 2)
        };
        let entries = [found(OWN, 128, 2), found(OWN, 128, 2), other];
        let cases: Vec<_> = entries.iter().collect();
        assert_eq!(mean_of_families(&cases), Some(1.0));
        let table = by_family(&cases);
        assert!(
            table.csv().contains("\nnoto,128 px,2,") && table.csv().contains("\ncarbon,128 px,1,")
        );
    }
}
