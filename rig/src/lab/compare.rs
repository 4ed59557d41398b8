//! Compares coverage functions on real pictures, in the soft render and in the file.
//!
//! The article's recipe ([`article`]) with each coverage function and with mixes, and the staged pipeline with as many strokes,
//! without and with polish. The table has the fidelity of the soft render, which the article reports, beside that of the SVG as
//! resvg draws it, which the user gets.

use std::time::Instant;

use super::ResultFolder;
use super::article::{self, Capsules, Reproduction};
use crate::report::Table;
use strokefit::Result;
use strokefit::coverage::{Coverage, CoverageSchedule};
use strokefit::fit::{Budget, Config, Execution, Fitter};
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::scene::Scene;
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, Size};

const WHITE: [f32; 3] = [1.0; 3];

/// The functions and mixes of the table.
fn schedules() -> Vec<CoverageSchedule> {
    let atan = |k| Coverage::Atan { k };
    let single = [
        Coverage::Smoothstep,
        Coverage::Raw,
        Coverage::Tanh,
        Coverage::Sigmoid,
        atan(1.0),
        atan(1.5),
        atan(2.0),
        atan(3.0),
        atan(4.0),
    ];
    let late = Coverage::Smoothstep;
    let mixes = [Coverage::Sigmoid, Coverage::Tanh, atan(4.0)];
    let mixes = mixes.map(|early| CoverageSchedule { early, late });
    single
        .map(CoverageSchedule::from)
        .into_iter()
        .chain(mixes)
        .collect()
}

/// One row: a recipe and how it did.
struct Row {
    recipe: String,
    strokes: usize,
    wall_s: f64,
    soft: Quality,
    svg: Quality,
    svg_bytes: usize,
}

/// Compares on one picture; `name` heads the files: `NAME.csv` and `NAME.md`, worst first.
///
/// # Errors
/// When a file cannot be written or `execution` asks for what this machine does not have.
pub fn run(
    output: &mut ResultFolder,
    name: &str,
    target: &Image,
    config: &article::ArticleRun,
    execution: Execution,
) -> Result<()> {
    let target = target.flattened(WHITE);
    let schedules = schedules();
    let mut rows = Vec::new();
    for (i, coverage) in schedules.iter().enumerate() {
        let done = i as f64 / (schedules.len() + 1) as f64;
        output.doing(done, &format!("{name}: the article's recipe, {coverage}"));
        let config = article::ArticleRun {
            coverage: *coverage,
            ..config.clone()
        };
        rows.push(at_once(&target, &config, execution)?);
    }
    output.doing(0.95, &format!("{name}: the staged pipeline"));
    for (recipe, polish) in [("staged, no polish", false), ("staged, polished", true)] {
        rows.push(staged(recipe, polish, &target, config, execution)?);
    }
    rows.sort_by(|x, y| y.soft.l1.total_cmp(&x.soft.l1));
    output.text(&format!("{name}.csv"), &table(&rows).csv())?;
    let title = format!(
        "# {name}: {} strokes, {} iterations, worst soft render first",
        config.strokes, config.iterations
    );
    let text = format!("{title}\n\n{}", table(&rows).markdown());
    output.text(&format!("{name}.md"), &text)
}

/// The article's recipe.
fn at_once(target: &Image, config: &article::ArticleRun, execution: Execution) -> Result<Row> {
    let begin = Instant::now();
    let start = Capsules::random(target.width(), target.height(), config.strokes, config.seed);
    let mut descent = Reproduction::new(target, start, execution)?;
    for step in 0..config.iterations {
        descent.step(config.coverage_at(step));
    }
    let soft = descent.render(config.coverage.late);
    let wall_s = begin.elapsed().as_secs_f64();
    let scene = descent.drawing().scene();
    let recipe = format!("at once, {}", config.coverage);
    Row::new(recipe, target, &soft, &scene, wall_s)
}

/// The staged pipeline with as many strokes.
fn staged(
    recipe: &str,
    polish: bool,
    target: &Image,
    config: &article::ArticleRun,
    execution: Execution,
) -> Result<Row> {
    let begin = Instant::now();
    let config = Config {
        budget: Budget {
            strokes: Some(config.strokes),
            ..Budget::default()
        },
        polish,
        seed: config.seed,
        ..Config::default()
    };
    let fit = Fitter::new(config).execution(execution).fit(target)?;
    let wall_s = begin.elapsed().as_secs_f64();
    Row::new(recipe.into(), target, &fit.soft, &fit.scene, wall_s)
}

impl Row {
    fn new(
        recipe: String,
        target: &Image,
        soft: &Image,
        scene: &Scene,
        wall_s: f64,
    ) -> Result<Self> {
        let text = svg::write(scene, &WriteOptions::default());
        let drawn = verify::render(&text, Size::Scale(1.0), Some(WHITE))?;
        Ok(Self {
            recipe,
            strokes: scene.len(),
            wall_s,
            soft: Quality::between(target, soft)?,
            svg: Quality::between(target, &drawn)?,
            svg_bytes: text.len(),
        })
    }

    fn cells(&self) -> [String; 8] {
        [
            self.recipe.clone(),
            self.strokes.to_string(),
            format!("{:.2}", self.wall_s),
            format!("{:.5}", self.soft.l1),
            format!("{:.2}", self.soft.psnr_db),
            format!("{:.2}", self.svg.psnr_db),
            format!("{:.4}", self.svg.ssim),
            self.svg_bytes.to_string(),
        ]
    }
}

const HEAD: [&str; 8] = [
    "recipe",
    "strokes",
    "wall_s",
    "soft_l1",
    "soft_psnr_db",
    "svg_psnr_db",
    "svg_ssim",
    "svg_bytes",
];

fn table(rows: &[Row]) -> Table {
    let mut table = Table::new(&HEAD);
    for row in rows {
        table.row(row.cells());
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recipe_has_its_row() {
        let folder = tempfile::tempdir().unwrap();
        let mut output = ResultFolder::new(folder.path(), true).unwrap();
        let ramp: Vec<f32> = (0..32 * 32).map(|i| (i % 32) as f32 / 31.0).collect();
        let target = Image::new(32, 32, [ramp.clone(), ramp.clone(), ramp]).unwrap();
        let config = article::ArticleRun {
            strokes: 10,
            iterations: 3,
            ..article::ArticleRun::default()
        };
        run(&mut output, "ramp", &target, &config, Execution::default()).unwrap();
        let csv = std::fs::read_to_string(folder.path().join("ramp.csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + schedules().len() + 2);
        assert!(csv.contains("\"at once, sigmoid>smoothstep\""), "{csv}");
    }
}
