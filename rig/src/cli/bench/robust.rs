//! `robust`: clean pictures, damaged and drawn.

use std::path::{Path, PathBuf};

use crate::bench::drawings::Kind;
use crate::bench::files::{has_ending, named, stem};
use crate::bench::gallery::Gallery;
use crate::bench::peers::{installed_for, missing_for_drawings};
use crate::bench::robust::{self, Truth};
use crate::bench::shapes::few;
use crate::lab::ResultFolder;
use crate::report::Damage;
use anyhow::Result;
use strokefit::cli::{Verbosity, input};
use strokefit::report::json;

use super::super::domain;
use super::{Extents, publish, say_missing, told};

/// Endings of the files that a folder stands for.
const ENDINGS: [&str; 4] = ["svg", "png", "jpg", "jpeg"];

/// Longer side of the pictures of SVGs, px: usual, and of short runs.
const SIDE: u16 = 256;
const SHORT_SIDE: u16 = 96;

/// Pictures that are shown, at most; each has a dozen damages.
const SHOWN: usize = 6;

/// Pictures that a short run takes, at most.
const FEW: usize = 2;

/// Damage clean pictures and draw them, beside other programs that are installed (pyautotrace, potrace, vtracer, Inkscape):
/// growth of elements, numbers and bytes, and fidelity to the clean pictures
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Robust {
    /// Clean pictures, SVGs, and folders of them
    #[arg(required = true)]
    pictures: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) extents: Extents,
    /// Longer side of the pictures of SVGs, px [default: 256; with --short: 96]
    #[arg(long, value_name = "PX", value_parser = domain::side)]
    side: Option<u16>,
    /// Damage: clean, jpegQUALITY, noiseLEVELS, aliased, dithered, enlarged, photographed [default: clean and all others,
    /// JPEG of quality 90, 75, 50, 30, noise of 4, 8, 16 levels]
    #[arg(long, value_name = "DAMAGE", value_delimiter = ',')]
    damage: Vec<Damage>,
}

impl Robust {
    /// Runs it; how many cases failed.
    pub(super) fn run(&self, files: &mut ResultFolder<'_>, verbosity: Verbosity) -> Result<usize> {
        let truths = self.truths()?;
        let damages = match self.damage.as_slice() {
            [] => &Damage::ALL,
            chosen => chosen,
        };
        let peers = installed_for(Kind::Shapes);
        let mut gallery = Gallery::default();
        let report = robust::run(&truths, damages, &peers, &mut |outcome| {
            let is_shown = |truth: &Truth| truth.name == outcome.entry.picture;
            if truths.iter().take(SHOWN).any(is_shown) {
                robust::show(&mut gallery, outcome)?;
            }
            told(files, outcome)
        })?;
        let tables = [report.table().csv(), report.markdown(), json(&report)?];
        publish(files, "robust", &tables, &[], gallery)?;
        say_missing(&missing_for_drawings(), verbosity);
        Ok(report.failures())
    }

    /// The clean pictures.
    fn truths(&self) -> Result<Vec<Truth>> {
        let paths = named(&self.pictures, &ENDINGS)?.into_iter();
        let mut paths: Vec<PathBuf> = paths.map(|(path, _)| path).collect();
        if self.extents.short {
            paths = few(paths, FEW);
        }
        paths.iter().map(|path| self.truth(path)).collect()
    }

    fn truth(&self, path: &Path) -> Result<Truth> {
        if !has_ending(path, "svg") {
            return Ok(Truth::of_picture(stem(path), &input::picture(path)?));
        }
        let usual = if self.extents.short { SHORT_SIDE } else { SIDE };
        let svg = input::svg(path)?;
        Ok(Truth::of_svg(stem(path), &svg, self.side.unwrap_or(usual))?)
    }
}
