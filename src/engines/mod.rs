//! Other programs that draw SVG: a file as Inkscape, librsvg, Chromium and CairoSVG render it.
//!
//! resvg is the judge ([`verify`](crate::verify)); the engines tell whether people who use another program see
//! the same. Each engine runs as a child process without a window. A temporary folder serves as its home,
//! profile and place for temporary files. A program that takes too long is ended, with all processes that it
//! started. An SVG that refers to anything outside itself is refused, so no engine has a reason to open a
//! connection; see [`Engine::draw`].
//!
//! ```no_run
//! use std::time::Duration;
//! use strokefit::engines::{ENGINES, DrawRequest};
//!
//! let svg = std::fs::read_to_string("photo.svg")?;
//! let request = DrawRequest { svg: &svg, width: 640, height: 480 };
//! for engine in &ENGINES {
//!     match engine.locate() {
//!         Some(program) => {
//!             let drawn = engine.draw(&program, request, Duration::from_secs(60))?;
//!             std::fs::write(format!("{}.png", engine.name), drawn.image.encode_png()?)?;
//!         }
//!         None => eprintln!("{} is not installed: {}", engine.name, engine.install),
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cairosvg;
mod chromium;
mod inkscape;
#[doc(hidden)]
pub mod locate;
mod process;
mod rsvg;
mod sheet;
mod verdict;

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, Limits};
use crate::svg::{self, Finding};
use process::Exit;

pub use sheet::{DIFFERENCE_GAIN, compared};
pub use verdict::{MAX_SHORTFALL_DB, MIN_DB_AGAINST_RESVG, passes};

/// All engines besides resvg.
pub static ENGINES: [Engine; 4] = [
    inkscape::ENGINE,
    rsvg::ENGINE,
    chromium::ENGINE,
    cairosvg::ENGINE,
];

/// Names of the files in the private folder.
const SVG: &str = "drawing.svg";
const PNG: &str = "drawing.png";

/// A program that draws SVG.
#[derive(Debug)]
pub struct Engine {
    /// Its name in options and reports.
    pub name: &'static str,
    /// Way to get it, in one line.
    pub install: &'static str,
    /// Names of the program, the best first.
    programs: &'static [&'static str],
    /// The arguments that make it draw a request.
    arguments: fn(&Job<'_>) -> io::Result<Vec<OsString>>,
    /// Text in its messages that means that nothing was drawn, whatever the exit status.
    failure: Option<&'static str>,
    /// True if the program may be installed in the user's home, so that `HOME` has to stay.
    keeps_home: bool,
    /// True if its picture has a margin to the right and below, to be cut off.
    has_margin: bool,
}

/// An SVG, and the size to draw it at.
#[derive(Debug, Clone, Copy)]
pub struct DrawRequest<'a> {
    /// The SVG text.
    pub svg: &'a str,
    /// Width of the picture, px; the page is scaled to it.
    pub width: usize,
    /// Height of the picture, px; the page is scaled to it.
    pub height: usize,
}

/// The picture that an engine drew.
#[derive(Debug)]
pub struct Rendering {
    /// The picture, opaque, on white.
    pub image: Image,
    /// Version of the program, such as `1.2.2`.
    pub version: String,
    /// Time that the program ran, its start included.
    pub wall: Duration,
}

/// A request, and the folder in which it is carried out.
struct Job<'a> {
    folder: &'a Path,
    request: DrawRequest<'a>,
}

impl Job<'_> {
    fn svg(&self) -> PathBuf {
        self.folder.join(SVG)
    }

    fn png(&self) -> PathBuf {
        self.folder.join(PNG)
    }
}

impl Engine {
    /// The program, if it is on the `PATH`.
    pub fn locate(&self) -> Option<PathBuf> {
        self.programs.iter().find_map(|name| locate::program(name))
    }

    /// Draws the SVG of `request` on white with `program`, which is ended after `timeout`.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`] when the SVG refers to anything outside itself; [`ErrorKind::Engine`]
    /// when the program cannot be started, fails, takes too long, or leaves no picture of the
    /// size that was asked for.
    pub fn draw(
        &self,
        program: &Path,
        request: DrawRequest<'_>,
        timeout: Duration,
    ) -> Result<Rendering> {
        self.attempt(program, request, timeout)
            .map_err(|e| e.within(self.name))
    }

    fn attempt(
        &self,
        program: &Path,
        request: DrawRequest<'_>,
        timeout: Duration,
    ) -> Result<Rendering> {
        refuse_external(request.svg)?;
        let folder = private_folder().map_err(|e| unusable(&e))?;
        let job = Job {
            folder: folder.path(),
            request,
        };
        fs::write(job.svg(), request.svg).map_err(|e| unusable(&e))?;
        let arguments = (self.arguments)(&job).map_err(|e| unusable(&e))?;
        let version = self.version(program, folder.path(), timeout)?;
        let start = Instant::now();
        let exit = self.run(program, &arguments, folder.path(), timeout)?;
        let wall = start.elapsed();
        let image = self
            .picture(&job)
            .map_err(|error| self.explain(error, &exit))?;
        match self.failure {
            Some(words) if exit.messages.contains(words) => {
                Err(fault("the program could not read the drawing"))
            }
            _ => Ok(Rendering {
                image,
                version,
                wall,
            }),
        }
    }

    fn version(&self, program: &Path, folder: &Path, timeout: Duration) -> Result<String> {
        let exit = self.run(program, &["--version".into()], folder, timeout)?;
        let mut words = exit.output.split_whitespace();
        let number = words.find(|word| word.starts_with(|c: char| c.is_ascii_digit()));
        Ok(number.unwrap_or("unknown").to_owned())
    }

    fn run(
        &self,
        program: &Path,
        arguments: &[OsString],
        folder: &Path,
        timeout: Duration,
    ) -> Result<Exit> {
        let mut command = Command::new(program);
        command.args(arguments);
        process::isolate(&mut command, folder, self.keeps_home);
        process::run(command, folder, timeout).map_err(|e| e.within(program.display()))
    }

    /// The picture that the program left, on white.
    fn picture(&self, job: &Job<'_>) -> Result<Image> {
        let DrawRequest { width, height, .. } = job.request;
        let bytes = fs::read(job.png()).map_err(|_| fault("the program left no picture"))?;
        let image = Image::decode(&bytes, "its picture", Limits::default())?.flattened([1.0; 3]);
        let found = (image.width(), image.height());
        let fits = self.has_margin || found == (width, height);
        let image = fits
            .then_some(image)
            .and_then(|image| image.cropped(width, height));
        image.ok_or_else(|| {
            fault(format!(
                "its picture has {}×{} px instead of {width}×{height}",
                found.0, found.1
            ))
        })
    }

    /// Adds the program's last message to the error, since it says why there is no picture.
    fn explain(&self, error: Error, exit: &Exit) -> Error {
        let mut lines = exit.messages.lines().rev().map(str::trim);
        let last = lines.find(|line| !line.is_empty());
        let said = last.map(|line| format!(", and its last message is: {line}"));
        fault(format!(
            "{error} ({}{})",
            exit.status,
            said.unwrap_or_default()
        ))
    }
}

/// Refuses an SVG that names files or addresses, which a program would open.
fn refuse_external(svg: &str) -> Result<()> {
    let findings = svg::lint(svg);
    let Some(Finding { lines, found, .. }) = findings.iter().find(|f| f.is_external()) else {
        return Ok(());
    };
    let line = lines.first().copied().unwrap_or(1);
    let message = format!(
        "not run, because line {line} refers to {found}, outside the file: embed or remove it"
    );
    Err(Error::new(ErrorKind::Svg, message))
}

fn private_folder() -> io::Result<tempfile::TempDir> {
    tempfile::Builder::new().prefix("strokefit-").tempdir()
}

fn fault(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Engine, message)
}

fn unusable(error: &io::Error) -> Error {
    let place = std::env::temp_dir();
    fault(format!(
        "the folder for temporary files, {}, cannot be used ({error}): set TMPDIR to one that can",
        place.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"4\" height=\"2\" viewBox=\"0 0 4 2\"/>";

    fn draw(svg: &str, program: &str) -> Error {
        let request = DrawRequest {
            svg,
            width: 4,
            height: 2,
        };
        rsvg::ENGINE
            .draw(Path::new(program), request, Duration::from_secs(20))
            .unwrap_err()
    }

    #[test]
    fn a_program_that_is_not_there_or_draws_nothing_is_an_error_that_names_it() {
        let error = draw(PAGE, "/nonexistent/rsvg-convert");
        assert_eq!(error.kind(), ErrorKind::Engine);
        assert!(
            error
                .to_string()
                .starts_with("rsvg: /nonexistent/rsvg-convert: "),
            "{error}"
        );
        #[cfg(unix)]
        {
            let error = draw(PAGE, "/bin/true").to_string();
            assert!(
                error.contains("rsvg: the program left no picture"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_drawing_that_refers_to_other_files_is_not_passed_on() {
        let svg = PAGE.replace("/>", ">\n<image href=\"file:///etc/hostname\"/></svg>");
        let error = draw(&svg, "/nonexistent/rsvg-convert");
        assert_eq!(error.kind(), ErrorKind::Svg);
        assert!(error.to_string().contains("line 2"), "{error}");
    }

    #[test]
    fn engines_have_different_names() {
        let mut names = ENGINES.each_ref().map(|e| e.name);
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
