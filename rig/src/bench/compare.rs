//! Two programs draw the same pictures, and both drawings of each are judged alike.
//!
//! Files and reports of a program are kept in a folder of the digest of its bytes, so that each program draws each picture once.

mod sets;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;
use serde_json::Value;

use super::files::digest;
use super::inverse::{contents, delta_e, large};
use crate::report::compare::{CompareEntry, CompareReport, Drawn, MOST_DB};
pub use sets::{Case, Wanted, cases};
use sets::{Subject, refuse};
use strokefit::image::Image;
use strokefit::verify;
use strokefit::{Error, ErrorKind, Result};

/// A `strokefit` of any version.
#[derive(Debug)]
pub struct Program {
    path: PathBuf,
    digest: String,
}

impl Program {
    /// The program in a file.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the file cannot be read.
    pub fn new(path: &Path) -> Result<Self> {
        let unread = |e| format!("{}: cannot be read ({e}): give a program", path.display());
        let bytes = fs::read(path).map_err(|e| Error::new(ErrorKind::Io, unread(e)))?;
        // Without a folder, a name would be looked for in PATH.
        let path = std::path::absolute(path)
            .map_err(|e| Error::new(ErrorKind::Io, e.to_string()).caused_by(e))?;
        let digest = digest(&[&bytes]);
        Ok(Self { path, digest })
    }

    /// The digest of its bytes.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Draws the picture of a case into `folder`, unless it did so before; the SVG, and seconds of CPU time.
    fn draw(&self, case: &Case, picture: &Path, folder: &Path) -> Result<(String, f64)> {
        let stem = folder.join(&self.digest).join(case.file_name());
        let files = [stem.with_extension("svg"), stem.with_extension("json")];
        if let Some(drawn) = kept(&files) {
            return Ok(drawn);
        }
        create(stem.parent().unwrap_or(folder))?;
        let mut command = Command::new(&self.path);
        // One thread each, so that the seconds are those of the work and not of waiting for each other.
        command.args(&case.command).arg(picture).args(&case.options);
        command.args(["--quiet", "--threads", "1", "-o"]);
        command.arg(&files[0]).arg("--report").arg(&files[1]);
        let output = command
            .output()
            .map_err(|e| refuse(format!("cannot start {}: {e}", self.path.display())))?;
        kept(&files).ok_or_else(|| {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().last().unwrap_or("nothing was said");
            refuse(format!(
                "{}: {last} ({})",
                self.path.display(),
                output.status
            ))
        })
    }
}

/// A drawing and the CPU time in its report, if both were written.
fn kept([svg, report]: &[PathBuf; 2]) -> Option<(String, f64)> {
    let report: Value = serde_json::from_slice(&fs::read(report).ok()?).ok()?;
    let cpu_s = report.get("cpu_s").and_then(Value::as_f64);
    Some((fs::read_to_string(svg).ok()?, cpu_s.unwrap_or(f64::NAN)))
}

fn create(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder)
        .map_err(|e| refuse(format!("{}: cannot be made: {e}", folder.display())))
}

/// Has both programs draw the pictures of all cases, as many at once as there are cores, and tells each case as it comes.
///
/// # Errors
/// When `folder` cannot be written to. A drawing that a program did not make is a failure in the report.
pub fn run(
    programs: [&Program; 2],
    cases: &[Case],
    folder: &Path,
    tell: &(dyn Fn(&CompareEntry) + Sync),
) -> Result<CompareReport> {
    create(&folder.join("pictures"))?;
    let compared = cases.par_iter().with_max_len(1).map(|case| {
        let entry = compared(programs, case, folder).unwrap_or_else(|error| CompareEntry {
            failure: Some(error.to_string()),
            ..case.entry()
        });
        tell(&entry);
        entry
    });
    Ok(CompareReport::new(
        programs.map(|program| program.digest.clone()),
        compared.collect(),
    ))
}

fn compared(programs: [&Program; 2], case: &Case, folder: &Path) -> Result<CompareEntry> {
    let subject = case.subject(&folder.join("pictures"))?;
    let draw = |program: &Program| program.draw(case, &subject.file, folder);
    let [old, new] = programs.map(draw);
    let ((old, old_s), (new, new_s)) = (old?, new?);
    Ok(CompareEntry {
        has_same_bytes: old == new,
        old: Some(judged(&old, old_s, &subject)?),
        new: Some(judged(&new, new_s, &subject)?),
        ..case.entry()
    })
}

fn judged(svg: &str, cpu_s: f64, subject: &Subject) -> Result<Drawn> {
    let quality = verify::fidelity(svg, &subject.reference)?;
    let contents = contents(svg)?;
    let artist = subject.artist.as_deref();
    let apart = |artist: &str| delta_e(&large(artist)?, svg);
    Ok(Drawn {
        psnr_db: psnr_db(svg, &subject.reference, quality.psnr_db)?.min(MOST_DB),
        ssimulacra2: quality.ssimulacra2,
        details_kept: quality.details_kept,
        delta_e: artist.map(apart).transpose()?,
        elements: contents.elements,
        parameters: contents.parameters,
        bytes: contents.bytes,
        cpu_s,
    })
}

/// Fidelity, which is `white_db` on white; on the worse of black and white where a picture has alpha.
fn psnr_db(svg: &str, reference: &Image, white_db: f64) -> Result<f64> {
    if reference.alpha().is_none() {
        return Ok(white_db);
    }
    let black = [0.0; 3];
    let drawn = verify::render_like(svg, reference, black)?;
    let black_db = strokefit::metrics::psnr(&reference.flattened(black), &drawn)?;
    Ok(white_db.min(black_db))
}
