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

mod process;

use std::env;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, Limits};
use crate::metrics::Agreement;
use crate::svg::{self, Finding};
use process::Exit;

/// All engines besides resvg. Each runs in a private folder and finds its files there.
pub static ENGINES: [Engine; 4] = [
    // Draws with Cairo.
    Engine {
        name: "inkscape",
        install: "apt-get install inkscape, or https://inkscape.org",
        programs: &["inkscape"],
        arguments: &[
            "--export-type=png",
            "--export-filename=drawing.png",
            "--export-area-page",
            "--export-width={width}",
            "--export-height={height}",
            "--export-background=#ffffff",
            "--export-background-opacity=1",
            SVG,
        ],
        ..PLAIN
    },
    // Draws with Cairo for GNOME, Wikipedia and ImageMagick.
    Engine {
        name: "rsvg",
        install: "apt-get install librsvg2-bin, or https://gitlab.gnome.org/GNOME/librsvg",
        programs: &["rsvg-convert"],
        arguments: &[
            "--width={width}",
            "--height={height}",
            "--background-color=white",
            "--output=drawing.png",
            SVG,
        ],
        ..PLAIN
    },
    // Chromium and browsers made of it, which draw with Skia.
    Engine {
        name: "chromium",
        install: "apt-get install chromium, or https://www.google.com/chrome",
        programs: &[
            "chromium-headless-shell",
            "chromium",
            "chromium-browser",
            "google-chrome",
            "google-chrome-stable",
        ],
        arguments: &[
            "--headless",
            "--screenshot={folder}/drawing.png",
            "--user-data-dir={folder}/profile",
            "--window-size={wide},{high}",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--hide-scrollbars",
            "--force-device-scale-factor=1",
            "--force-color-profile=srgb",
            "--no-first-run",
            "--no-default-browser-check",
            "--disable-extensions",
            "--disable-background-networking",
            "--disable-sync",
            "--host-resolver-rules=MAP * ~NOTFOUND",
            "--enable-logging=stderr",
            "--log-level=0",
            "file://{folder}/page.html",
        ],
        is_browser: true,
        ..PLAIN
    },
    // The usual converter of Python programs. `pip install --user` installs into the home.
    Engine {
        name: "cairosvg",
        install: "pip install cairosvg, or apt-get install cairosvg",
        programs: &["cairosvg"],
        arguments: &[
            "--output-width={width}",
            "--output-height={height}",
            "--output=drawing.png",
            SVG,
        ],
        keeps_home: true,
        ..PLAIN
    },
];

/// Names of the files in the private folder.
const SVG: &str = "drawing.svg";
const PNG: &str = "drawing.png";

/// The line that the page of a browser writes to its log when the drawing cannot be shown.
const UNREADABLE: &str = "strokefit: the drawing cannot be shown";

/// Margin by which a browser's window is made larger than the picture, px. Windows cannot be narrower than 500 px, and some
/// versions count the invisible window's frame as part of its size.
const MARGIN: usize = 500;

/// Largest shortfall of an engine's fidelity from resvg's, dB.
const MAX_SHORTFALL_DB: f64 = 0.6;

/// PSNR of an engine's render against resvg's, dB, that is good enough whatever the fidelity. Engines round
/// colours and edges differently: on drawings that all of them draw right they are 39 to 56 dB apart, and no
/// file can be more faithful than that in all of them. Below this bound, a difference of 4 levels in every
/// pixel, something is missing or in another place.
pub const MIN_DB_AGAINST_RESVG: f64 = 36.0;

/// By how much differences are amplified: to the picture, and to resvg's render.
const DIFFERENCE_GAIN: [f32; 2] = [4.0, 16.0];

/// px between two pictures, white.
const GAP: usize = 8;

/// A program that draws SVG.
#[derive(Debug)]
pub struct Engine {
    /// Its name in options and reports.
    pub name: &'static str,
    /// Way to get it, in one line.
    pub install: &'static str,
    /// Names of the program, the best first.
    programs: &'static [&'static str],
    /// The arguments that make it draw a request, with {width}, {height} and {folder} for what they have of that; {wide} and
    /// {high} are the sides of a window.
    arguments: &'static [&'static str],
    /// True if the program may be installed in the user's home, so that `HOME` has to stay.
    keeps_home: bool,
    /// True if it shows the drawing on a page, in a window with a margin to the right and below.
    is_browser: bool,
}

const PLAIN: Engine = Engine {
    name: "",
    install: "",
    programs: &[],
    arguments: &[],
    keeps_home: false,
    is_browser: false,
};

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

impl Engine {
    /// The program, if it is on the `PATH`.
    pub fn locate(&self) -> Option<PathBuf> {
        self.programs.iter().find_map(|name| program(name))
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
        let folder = tempfile::Builder::new().prefix("strokefit-").tempdir();
        let folder = folder.map_err(|e| unusable(&e))?;
        let folder = folder.path();
        let arguments = self.prepare(request, folder).map_err(|e| unusable(&e))?;
        let version = self.version(program, folder, timeout)?;
        let start = Instant::now();
        let exit = self.run(program, &arguments, folder, timeout)?;
        let wall = start.elapsed();
        let image = self
            .picture(request, folder)
            .map_err(|error| explain(&error, &exit))?;
        if exit.messages.contains(UNREADABLE) {
            return Err(fault("the program could not read the drawing"));
        }
        Ok(Rendering {
            image,
            version,
            wall,
        })
    }

    /// Writes what the program needs to its folder, and makes its arguments.
    fn prepare(&self, request: DrawRequest<'_>, folder: &Path) -> io::Result<Vec<OsString>> {
        let DrawRequest { svg, width, height } = request;
        fs::write(folder.join(SVG), svg)?;
        let mut arguments = Vec::new();
        if self.is_browser {
            fs::write(folder.join("page.html"), page(width, height))?;
            // Chromium refuses to start as root with its sandbox.
            arguments.extend(process::is_root().then(|| "--no-sandbox".into()));
        }
        arguments.extend(self.arguments.iter().map(|argument| {
            let text = argument
                .replace("{width}", &width.to_string())
                .replace("{height}", &height.to_string())
                .replace("{wide}", &(width + MARGIN).to_string())
                .replace("{high}", &(height + MARGIN).to_string());
            // The name of the folder need not be text.
            match text.split_once("{folder}") {
                Some((before, after)) => [before.as_ref(), folder.as_os_str(), after.as_ref()]
                    .into_iter()
                    .collect(),
                None => text.into(),
            }
        }));
        Ok(arguments)
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
    fn picture(&self, request: DrawRequest<'_>, folder: &Path) -> Result<Image> {
        let DrawRequest { width, height, .. } = request;
        let bytes = fs::read(folder.join(PNG)).map_err(|_| fault("the program left no picture"))?;
        let image = Image::decode(&bytes, "its picture", Limits::default())?.flattened([1.0; 3]);
        let found = (image.width(), image.height());
        let fits = self.is_browser || found == (width, height);
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
}

/// Adds the program's last message to the error, since it says why there is no picture.
fn explain(error: &Error, exit: &Exit) -> Error {
    let mut lines = exit.messages.lines().rev().map(str::trim);
    let last = lines.find(|line| !line.is_empty());
    let said = last.map(|line| format!(", and its last message is: {line}"));
    fault(format!(
        "{error} ({}{})",
        exit.status,
        said.unwrap_or_default()
    ))
}

/// The page of a browser. The drawing is an `<img>`: it is scaled to the picture, and scripts and references in it are dead.
fn page(width: usize, height: usize) -> String {
    format!(
        "<!doctype html><meta charset=\"utf-8\"><title>drawing</title>\
         <style>html,body{{margin:0;background:#fff}}\
         img{{display:block;width:{width}px;height:{height}px}}</style>\
         <img src=\"{SVG}\" onerror=\"console.error('{UNREADABLE}')\">\n"
    )
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

fn fault(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Engine, message)
}

fn unusable(error: &io::Error) -> Error {
    let place = env::temp_dir();
    fault(format!(
        "the folder for temporary files, {}, cannot be used ({error}): set TMPDIR to one that can",
        place.display()
    ))
}

/// The first program of this name on the `PATH` that can be run.
#[doc(hidden)]
pub fn program(name: &str) -> Option<PathBuf> {
    let file = format!("{name}{}", env::consts::EXE_SUFFIX);
    let path = env::var_os("PATH")?;
    let mut places = env::split_paths(&path).map(|folder| folder.join(&file));
    places.find(|place| is_program(place))
}

#[cfg(unix)]
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    const ANYONE_RUNS: u32 = 0o111;
    fs::metadata(path).is_ok_and(|m| m.is_file() && m.permissions().mode() & ANYONE_RUNS != 0)
}

#[cfg(not(unix))]
fn is_program(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| m.is_file())
}

/// True if an engine draws what resvg draws: it leaves no gap, and its render is close to resvg's, or its fidelity, where that
/// is known, falls short of resvg's by no more than `MAX_SHORTFALL_DB`.
pub fn passes(against_resvg: &Agreement, shortfall_db: Option<f64>) -> bool {
    let is_close = against_resvg.psnr_db >= MIN_DB_AGAINST_RESVG;
    let is_as_faithful = shortfall_db.is_some_and(|db| db <= MAX_SHORTFALL_DB);
    !against_resvg.has_gap() && (is_close || is_as_faithful)
}

/// From left to right: the picture, if there is one; the engine's render; its difference from the
/// picture and from resvg's render, absolute and amplified by `DIFFERENCE_GAIN`, black where
/// there is none.
///
/// # Errors
/// [`ErrorKind::Picture`](crate::ErrorKind::Picture) when sizes differ.
pub fn compared(target: Option<&Image>, resvg: &Image, drawn: &Image) -> Result<Image> {
    let [to_target, to_resvg] = DIFFERENCE_GAIN;
    let mut panels = Vec::new();
    if let Some(target) = target {
        panels.push(target.flattened([1.0; 3]));
    }
    panels.push(drawn.clone());
    if let Some(target) = target {
        panels.push(difference(&panels[0], drawn, to_target)?);
        debug_assert_eq!(panels[0].width(), target.width());
    }
    panels.push(difference(resvg, drawn, to_resvg)?);
    beside(&panels)
}

fn difference(a: &Image, b: &Image, gain: f32) -> Result<Image> {
    let plane = |c: usize| {
        let pairs = a.planes()[c].iter().zip(&b.planes()[c]);
        pairs
            .map(|(a, b)| ((a - b).abs() * gain).min(1.0))
            .collect()
    };
    Image::new(a.width(), b.height(), [plane(0), plane(1), plane(2)])
}

fn beside(panels: &[Image]) -> Result<Image> {
    let height = panels.iter().map(Image::height).max().unwrap_or(0);
    let width =
        panels.iter().map(Image::width).sum::<usize>() + GAP * panels.len().saturating_sub(1);
    let plane = |c: usize| {
        let row = |y: usize| {
            let rows = panels
                .iter()
                .map(move |p| &p.planes()[c][y * p.width()..][..p.width()]);
            rows.collect::<Vec<_>>().join(&[1.0; GAP][..])
        };
        (0..height).flat_map(row).collect()
    };
    Image::new(width, height, [plane(0), plane(1), plane(2)])
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
        ENGINES[1]
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
    fn differences_are_amplified_and_stand_beside_the_pictures() {
        let gray = |level| Image::filled(2, 1, [level; 3]).unwrap();
        let sheet = compared(Some(&gray(0.5)), &gray(0.25), &gray(0.375)).unwrap();
        assert_eq!((sheet.width(), sheet.height()), (4 * 2 + 3 * GAP, 1));
        let row = &sheet.planes()[1];
        let panel = |i: usize| row[i * (2 + GAP)];
        assert_eq!([0, 1, 2, 3].map(panel), [0.5, 0.375, 0.5, 1.0]);
        assert_eq!(row[2..2 + GAP], [1.0; GAP]);
    }

    #[test]
    fn without_a_picture_there_are_two_panels() {
        let gray = Image::filled(3, 2, [0.5; 3]).unwrap();
        assert_eq!(compared(None, &gray, &gray).unwrap().width(), 2 * 3 + GAP);
    }

    #[test]
    fn an_engine_that_leaves_a_gap_fails() {
        let gap = Agreement {
            psnr_db: 50.0,
            max_abs: 255,
            patch_abs: 200,
        };
        assert!(!passes(&gap, Some(0.0)));
    }

    #[test]
    fn an_engine_must_be_as_faithful_or_agree() {
        for (against_resvg_db, shortfall_db, verdict) in [
            (f64::INFINITY, None, true),
            (36.0, None, true),
            (35.9, None, false),
            (35.9, Some(0.6), true),
            (35.9, Some(-3.0), true),
            (35.9, Some(0.7), false),
            (41.0, Some(5.0), true),
            (f64::NAN, Some(f64::NAN), false),
        ] {
            let against_resvg = Agreement {
                psnr_db: against_resvg_db,
                max_abs: 90,
                patch_abs: 9,
            };
            assert_eq!(
                passes(&against_resvg, shortfall_db),
                verdict,
                "{against_resvg_db} {shortfall_db:?}"
            );
        }
    }

    #[test]
    fn engines_have_different_names() {
        let mut names = ENGINES.each_ref().map(|e| e.name);
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
