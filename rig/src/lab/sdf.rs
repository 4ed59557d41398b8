//! Looks of distances, coverage functions and combinations.
//!
//! Pictures of the distance to a circle and to a capsule, of each coverage function applied to them,
//! and of their union, intersection and subtraction; charts and a table of the coverage functions
//! and their derivatives over the distance.

use super::shapes::{Capsule, Combination};
use super::{ResultFolder, SIZE};
use crate::report::Table;
use crate::report::picture::{self, distance, gray};
use crate::report::plot::{Chart, Panel, Sheet};
use strokefit::Result;
use strokefit::coverage::Coverage;

/// The functions on show.
const SHOWN: [Coverage; 9] = [
    Coverage::Raw,
    Coverage::Smoothstep,
    Coverage::Tanh,
    Coverage::Sigmoid,
    Coverage::Atan { k: 1.0 },
    Coverage::Atan { k: 1.5 },
    Coverage::Atan { k: 2.0 },
    Coverage::Atan { k: 3.0 },
    Coverage::Atan { k: 4.0 },
];

const EPS: f64 = 1e-4;
const SOFTNESS: f64 = 1.0;

/// Writes `sdf.csv` and the pictures `sdf-*.png`.
///
/// # Errors
/// When a file cannot be written.
pub fn run(output: &mut ResultFolder<'_>) -> Result<()> {
    output.text("sdf.csv", &table().csv())?;
    let derivative = |c: Coverage, d| c.derivative(d, SOFTNESS);
    let value = |c: Coverage, d| c.value(d, SOFTNESS);
    output.picture("sdf-coverage.png", &chart("coverage", value)?)?;
    output.picture(
        "sdf-derivative.png",
        &chart("derivative by the distance, 1/px", derivative)?,
    )?;
    output.picture(
        "sdf-shapes.png",
        &sheet("signed distance, a line every 4 px", shapes()?)?,
    )?;
    for (name, field) in [("circle", circle()), ("capsule", capsule())] {
        let title = format!("{name}: coverage with an edge of 1 px");
        let panels = SHOWN.map(|c| {
            let covered: Vec<f64> = field.iter().map(|&d| c.value(d, SOFTNESS)).collect();
            Ok(Panel::new(c, picture::map(SIZE, &covered, gray)?))
        });
        let panels = panels.into_iter().collect::<Result<_>>()?;
        output.picture(&format!("sdf-coverage-{name}.png"), &sheet(&title, panels)?)?;
    }
    Ok(())
}

fn distances() -> impl Iterator<Item = f64> {
    (-800..=800).map(|i| f64::from(i) / 100.0)
}

/// Each function and its derivative over the distance.
fn table() -> Table {
    let names = SHOWN
        .iter()
        .flat_map(|c| [c.to_string(), format!("{c} derivative")]);
    let head: Vec<String> = ["d".to_owned()].into_iter().chain(names).collect();
    let mut table = Table::new(&head);
    for d in distances() {
        let values = SHOWN
            .iter()
            .flat_map(|c| [c.value(d, SOFTNESS), c.derivative(d, SOFTNESS)]);
        table.row([d].into_iter().chain(values));
    }
    table
}

fn chart(what: &str, f: impl Fn(Coverage, f64) -> f64) -> Result<strokefit::image::Image> {
    let points = |c: Coverage| {
        let near = distances().filter(|d| d.abs() <= 4.0);
        near.map(|d| [d, f(c, d)]).collect()
    };
    let chart = Chart {
        title: format!("{what}, over the signed distance (px, positive inside)"),
        axes: ["signed distance, px".into(), what.into()],
        logarithmic: false,
        series: SHOWN.map(|c| (c.to_string(), points(c))).into(),
        ..Chart::default()
    };
    chart.draw()
}

fn sheet(title: &str, panels: Vec<Panel>) -> Result<strokefit::image::Image> {
    let sheet = Sheet {
        title: title.into(),
        columns: 3,
        zoom: 4,
        panels,
    };
    sheet.draw()
}

fn field(distance: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
    let at = |i: usize| [(i % SIZE) as f64, (i / SIZE) as f64];
    (0..SIZE * SIZE).map(|i| distance(at(i))).collect()
}

fn circle() -> Vec<f64> {
    let circle = Capsule {
        a: [26.0, 30.0],
        b: [26.0, 30.0],
        radius: 14.0,
    };
    field(|p| circle.distance(p, EPS))
}

fn capsule() -> Vec<f64> {
    let capsule = Capsule {
        a: [22.0, 48.0],
        b: [50.0, 18.0],
        radius: 8.0,
    };
    field(|p| capsule.distance(p, EPS))
}

/// The two shapes and their combinations.
fn shapes() -> Result<Vec<Panel>> {
    let (circle, capsule) = (circle(), capsule());
    let both = |combination: Combination| -> Vec<f64> {
        let pairs = circle.iter().zip(&capsule);
        pairs
            .map(|(&d1, &d2)| combination.distance(d1, d2))
            .collect()
    };
    let fields = [
        ("circle", circle.clone()),
        ("capsule", capsule.clone()),
        ("union: max", both(Combination::Union)),
        ("intersection: min", both(Combination::Intersection)),
        ("circle without capsule", both(Combination::Subtraction)),
    ];
    let panel = |(title, field): (&str, Vec<f64>)| {
        Ok(Panel::new(title, picture::map(SIZE, &field, distance)?))
    };
    fields.into_iter().map(panel).collect()
}
