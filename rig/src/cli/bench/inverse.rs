//! `inverse`: known drawings, found again in their pictures.

use std::path::PathBuf;

use crate::bench::drawings::{Drawing, Kind, Pictures};
use crate::bench::files::{named, stem};
use crate::bench::gallery::Gallery;
use crate::bench::peers::{installed_for, missing_for_drawings};
use crate::bench::{inverse, shapes};
use crate::lab::ResultFolder;
use crate::report::Damage;
use anyhow::Result;
use strokefit::cli::{Verbosity, input};
use strokefit::fit::Config;
use strokefit::report::json;

use super::super::domain;
use super::{Extents, publish, say_missing, told};

/// Drawings of shapes that a short run takes, at most.
const FEW: usize = 6;

/// Find known drawings again in pictures of them, beside other programs that are installed (pyautotrace, potrace,
/// vtracer, Inkscape)
///
/// Of drawings of strokes alone the centre lines are compared, of all others colours and edges.
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Inverse {
    /// SVGs, and folders of them [default: drawings of strokes that are built in]
    drawings: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) extents: Extents,
    /// Longer sides of the pictures, px [default: 48 to 384 of strokes, 128 to 512 of other drawings]
    #[arg(long, value_name = "PX", value_delimiter = ',', value_parser = domain::side)]
    sides: Vec<u16>,
    /// Damage of the pictures: clean, jpegQUALITY, noiseLEVELS, aliased, dithered, enlarged, photographed [default: clean,jpeg75; noise8 of other drawings
    /// than of strokes, too]
    #[arg(long, value_name = "DAMAGE", value_delimiter = ',')]
    damage: Vec<Damage>,
}

impl Inverse {
    /// Runs it; how many cases failed.
    pub(super) fn run(&self, files: &mut ResultFolder<'_>, verbosity: Verbosity) -> Result<usize> {
        let (strokes, shapes) = self.drawings(verbosity)?;
        let mut failures = 0;
        if !strokes.is_empty() {
            failures += self.find_strokes(&strokes, files)?;
        }
        if !shapes.is_empty() {
            failures += self.find_shapes(shapes, files)?;
        }
        say_missing(&missing_for_drawings(), verbosity);
        Ok(failures)
    }

    fn find_strokes(&self, drawings: &[Drawing], files: &mut ResultFolder<'_>) -> Result<usize> {
        let pictures = self.pictures(Kind::Strokes);
        let peers = installed_for(Kind::Strokes);
        let config = Config::default();
        let mut gallery = Gallery::default();
        let report = inverse::run(drawings, &pictures, &peers, &config, &mut |outcome| {
            inverse::show(&mut gallery, outcome, &pictures.sides)?;
            told(files, outcome)
        })?;
        let tables = [report.table().csv(), report.markdown(), json(&report)?];
        publish(files, "inverse", &tables, &report.charts()?, gallery)?;
        Ok(report.failures())
    }

    fn find_shapes(&self, all: Vec<Drawing>, files: &mut ResultFolder<'_>) -> Result<usize> {
        let drawings = if self.extents.short {
            shapes::few(all, FEW)
        } else {
            all
        };
        let pictures = self.pictures(Kind::Shapes);
        let (ours, peers) = (shapes::drawers(), installed_for(Kind::Shapes));
        let mut gallery = Gallery::default();
        let report = shapes::run(&drawings, &pictures, &ours, &peers, &mut |outcome| {
            shapes::show(&mut gallery, outcome, &pictures.sides)?;
            told(files, outcome)
        })?;
        let tables = [report.table().csv(), report.markdown(), json(&report)?];
        publish(files, "shapes", &tables, &report.charts()?, gallery)?;
        Ok(report.failures())
    }

    /// The drawings of strokes, with those that are built in, and all others.
    fn drawings(&self, verbosity: Verbosity) -> Result<(Vec<Drawing>, Vec<Drawing>)> {
        let (mut strokes, mut shapes) = (Vec::new(), Vec::new());
        for (path, is_listed) in named(&self.drawings, &["svg"])? {
            let svg = input::svg(&path)?;
            let name = stem(&path);
            let drawing = Drawing { name, svg };
            match drawing.kind() {
                Ok(Kind::Strokes) => strokes.push(drawing),
                Ok(Kind::Shapes) => shapes.push(drawing),
                Err(error) if is_listed => verbosity.say(format_args!("not measured: {error}")),
                Err(error) => return Err(error.into()),
            }
        }
        if shapes.is_empty() || !strokes.is_empty() {
            strokes.splice(0..0, inverse::own());
        }
        Ok((strokes, shapes))
    }

    fn pictures(&self, kind: Kind) -> Pictures {
        let mut pictures = if self.extents.short {
            Pictures::short(kind)
        } else {
            Pictures::full(kind)
        };
        if !self.sides.is_empty() {
            pictures.sides.clone_from(&self.sides);
        }
        if !self.damage.is_empty() {
            pictures.damages.clone_from(&self.damage);
        }
        pictures
    }
}
