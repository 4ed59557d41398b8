//! Programs that turn pictures into SVG: our own at any settings, the article's recipe, and others where they are installed, with
//! the command lines of their manuals.

use std::fmt::Display;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde::Deserialize;

use super::drawings::Kind;
use crate::report::OWN;
use crate::report::pareto::ARTICLE;
use strokefit::engines;
use strokefit::image::Image;
use strokefit::report::Usage;
use strokefit::{Error, ErrorKind, Result};

/// Time between two readings of the memory of a running program.
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// A program that takes longer counts as hanging, and is ended.
const LONGEST: Duration = Duration::from_secs(600);

/// A drawing that a program made.
#[derive(Debug, Clone, PartialEq)]
pub struct Traced {
    /// The SVG.
    pub svg: String,
    /// What it took.
    pub cost: Cost,
}

/// What the process of a drawing takes; of our fits as they report it, with judging the file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
pub struct Cost {
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time of all threads, s; to a hundredth.
    pub cpu_s: Option<f64>,
    /// Peak memory, bytes. Another program is sampled every 2 ms, so a peak just before its end may be missed.
    pub peak_rss_bytes: Option<u64>,
}

/// A program.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// Name in plots and tables, and on the path.
    pub name: &'static str,
    /// True for this program, which hands `fit` over to strokefit.
    is_this: bool,
    /// The files of picture and drawing: PNG, or PPM where it reads nothing else.
    files: [&'static str; 2],
    /// The settings that are run, rough to fine.
    pub settings: &'static [&'static str],
    /// The arguments; `{in}`, `{out}` and `{report}` stand for the files, `{folder}` for that of all files, `{settings}` for the
    /// words of the settings.
    args: &'static [&'static str],
    /// An argument, and the text that the answer contains if the program is able to trace at all.
    can: Option<[&'static str; 2]>,
    /// True if it crashes without a display.
    needs_display: bool,
}

/// A program on the path that reads PNG.
const OTHER: Program = Program {
    name: "",
    is_this: false,
    files: ["in.png", "out.svg"],
    settings: &[],
    args: &[],
    can: None,
    needs_display: false,
};

/// strokefit, as this program has it.
pub const STROKEFIT: Program = Program {
    name: OWN,
    is_this: true,
    args: &[
        "fit",
        "{in}",
        "-o",
        "{out}",
        "--report",
        "{report}",
        "--quiet",
        "{settings}",
    ],
    ..OTHER
};

/// The article's recipe, as this program has it.
pub const RECIPE: Program = Program {
    name: ARTICLE,
    is_this: true,
    files: ["in.png", "article.svg"],
    args: &["lab", "article", "{in}", "-o", "{folder}", "{settings}"],
    ..OTHER
};

const VTRACER: Program = Program {
    name: "vtracer",
    settings: &[
        "-f 16 -p 4 -g 96",
        "-f 16 -p 4 -g 64",
        "-f 10 -p 8 -g 48",
        "-f 8 -p 6 -g 32",
        "-f 4 -p 6 -g 16",
        "-f 3 -p 7 -g 12",
        "-f 4 -p 8 -g 8",
        "-f 1 -p 8 -g 4",
    ],
    args: &[
        "--input",
        "{in}",
        "--output",
        "{out}",
        "--path_precision",
        "1",
        "{settings}",
    ],
    ..OTHER
};

const PRIMITIVE: Program = Program {
    name: "primitive",
    // A seventh of a second of CPU each, and the program has no seed: no two drawings are equal.
    settings: &["-n 20 -m 0", "-n 50 -m 0", "-n 100 -m 0", "-n 300 -m 0"],
    args: &["-i", "{in}", "-o", "{out}", "{settings}"],
    ..OTHER
};

const POTRACE: Program = Program {
    name: "potrace",
    files: ["in.ppm", "out.svg"],
    settings: &["--turdsize 10", "--turdsize 2"],
    args: &["--svg", "{settings}", "--output", "{out}", "{in}"],
    ..OTHER
};

const INKSCAPE: Program = Program {
    name: "inkscape",
    settings: &["4", "8", "16", "32"],
    args: &[
        "{in}",
        // Without the picture itself, which is below the drawing.
        "--actions=select-all;object-trace:{settings},false,true,false,4,1.0,0.2;select-clear;\
         select-by-element:image;delete;export-filename:{out};export-plain-svg;export-do",
    ],
    // From version 1.3 on.
    can: Some(["--action-list", "object-trace"]),
    needs_display: true,
    ..OTHER
};

/// Needs numpy and Pillow, without which it cannot even tell its version.
const PYAUTOTRACE: Program = Program {
    name: "pyautotrace",
    args: &[
        "{in}",
        "{out}",
        "--background-color",
        "#ffffff",
        "{settings}",
    ],
    can: Some(["--version", "pyautotrace"]),
    ..OTHER
};

/// The programs that draw any picture.
const PROGRAMS: [Program; 4] = [VTRACER, PRIMITIVE, POTRACE, INKSCAPE];

/// The programs that draw known drawings again, each at the setting for few colours; `{colors}` is how many, with the
/// page's. First that for lines, then that for anything else.
const FOR_DRAWINGS: [(Program, [&str; 2]); 4] = [
    (
        PYAUTOTRACE,
        [
            "--centerline --color-count {colors}",
            "--color-count {colors}",
        ],
    ),
    (POTRACE, ["--turdsize 2"; 2]),
    (VTRACER, ["-f 4 -p 6 -g 16"; 2]),
    (INKSCAPE, ["{colors}"; 2]),
];

/// The programs that draw any picture and are installed, and the names of those that are not, are too old, or have no display to
/// work on.
pub fn installed() -> (Vec<Program>, Vec<&'static str>) {
    split(PROGRAMS.into_iter(), |program| *program)
}

/// A program at the setting for drawings of one kind.
#[derive(Debug)]
pub struct TunedProgram {
    /// The program.
    pub program: Program,
    settings: &'static str,
}

impl TunedProgram {
    /// The SVG of a picture of so many `colors`, with that of the page.
    ///
    /// # Errors
    /// As [`Program::trace`].
    pub fn trace(&self, picture: &Image, colors: usize) -> Result<String> {
        let settings = self.settings.replace("{colors}", &colors.to_string());
        Ok(self.program.trace(picture, &settings)?.svg)
    }
}

/// The programs that draw drawings of a kind again and are installed, and the names of those that are not.
pub fn installed_for(kind: Kind) -> (Vec<TunedProgram>, Vec<&'static str>) {
    let tuned = FOR_DRAWINGS.map(|(program, [for_lines, for_shapes])| TunedProgram {
        program,
        settings: match kind {
            Kind::Strokes => for_lines,
            Kind::Shapes => for_shapes,
        },
    });
    split(tuned.into_iter(), |tuned| tuned.program)
}

/// Those whose program is installed, and the names of the others.
fn split<T>(
    all: impl Iterator<Item = T>,
    program: impl Fn(&T) -> Program,
) -> (Vec<T>, Vec<&'static str>) {
    let (here, missing): (Vec<T>, Vec<T>) = all.partition(|one| program(one).is_here());
    (here, missing.iter().map(|one| program(one).name).collect())
}

impl Program {
    /// The drawing of an opaque `picture` at some settings.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the program makes none; the message is the last line that it printed.
    pub fn trace(&self, picture: &Image, settings: &str) -> Result<Traced> {
        let folder = tempfile::tempdir().map_err(|e| self.failed(e))?;
        let folder = folder.path();
        let [from, to] = self.files.map(|name| folder.join(name));
        let bytes = if self.files[0].ends_with("ppm") {
            ppm(picture)
        } else {
            picture.encode_png()?
        };
        fs::write(&from, bytes).map_err(|e| self.failed(e))?;
        let program = if self.is_this {
            std::env::current_exe().map_err(|e| self.failed(e))?
        } else {
            self.name.into()
        };
        let mut command = Command::new(program);
        command.args(self.arguments(folder, settings));
        let (ended, cost) = run(command, folder).map_err(|e| self.failed(e))?;
        if let Some(why) = ended {
            return Err(self.failed(format!("{why} with {settings}")));
        }
        let svg = fs::read_to_string(&to)
            .map_err(|_| self.failed(format!("made no SVG with {settings}")))?;
        let reported = fs::read(folder.join(REPORT)).ok();
        let reported = reported.and_then(|json| serde_json::from_slice(&json).ok());
        Ok(Traced {
            svg,
            cost: reported.unwrap_or(cost),
        })
    }

    fn failed(&self, why: impl Display) -> Error {
        Error::new(ErrorKind::Io, format!("{}: {why}", self.name))
    }

    fn is_here(&self) -> bool {
        let able = |[arg, word]: [&str; 2]| {
            let output = Command::new(self.name).arg(arg).output();
            output.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(word))
        };
        let can_show = !self.needs_display || has_display();
        can_show && engines::program(self.name).is_some() && self.can.is_none_or(able)
    }

    fn arguments(&self, folder: &Path, settings: &str) -> Vec<String> {
        let file = |name: &str| folder.join(name).display().to_string();
        let [from, to] = self.files.map(file);
        let words = self.args.iter().flat_map(|&arg| match arg {
            "{settings}" => settings.split_whitespace().map(str::to_owned).collect(),
            arg => vec![arg.to_owned()],
        });
        let named = words.map(|word| {
            let word = word.replace("{settings}", settings).replace("{out}", &to);
            let word = word.replace("{report}", &file(REPORT));
            word.replace("{in}", &from).replace("{folder}", &file(""))
        });
        named.collect()
    }
}

/// The file of our report.
const REPORT: &str = "report.json";

/// True if a window can be opened.
fn has_display() -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

/// Runs a program, which may leave files in `folder`: why it failed, if it did, and what it took.
fn run(mut command: Command, folder: &Path) -> io::Result<(Option<String>, Cost)> {
    // Not a pipe, which could fill up.
    let said = folder.join("said");
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&said)?);
    let (start, before) = (Instant::now(), Usage::now().children_cpu_s);
    let mut child = command.spawn()?;
    let (status, peak_rss_bytes) = watched(&mut child)?;
    let after = Usage::now().children_cpu_s;
    let cost = Cost {
        wall_s: start.elapsed().as_secs_f64(),
        cpu_s: after.zip(before).map(|(after, before)| after - before),
        peak_rss_bytes,
    };
    let why = match status {
        None => Some(format!("ended after {} s", LONGEST.as_secs())),
        Some(status) if !status.success() => {
            let said = String::from_utf8_lossy(&fs::read(&said)?).into_owned();
            // A hint may come after our own errors.
            let error = said.lines().find_map(|line| line.strip_prefix("error: "));
            let last = error.or_else(|| said.lines().rfind(|line| !line.trim().is_empty()));
            Some(last.map_or_else(
                || status.to_string(),
                |line| format!("{} ({status})", line.trim()),
            ))
        }
        Some(_) => None,
    };
    Ok((why, cost))
}

/// Waits for the end of a program, and ends it where there is none: how it ended, and the most memory that
/// it was seen to hold.
fn watched(child: &mut Child) -> io::Result<(Option<ExitStatus>, Option<u64>)> {
    let (start, mut peak) = (Instant::now(), None);
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok((Some(status), peak));
        }
        if start.elapsed() > LONGEST {
            child.kill()?;
            child.wait()?;
            return Ok((None, peak));
        }
        peak = Usage::peak_of(child.id()).max(peak);
        std::thread::sleep(LOOK_EVERY);
    }
}

/// A picture as a portable pixmap.
fn ppm(picture: &Image) -> Vec<u8> {
    let mut bytes = format!("P6 {} {} 255\n", picture.width(), picture.height()).into_bytes();
    bytes.extend(picture.to_rgb8());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_become_words_or_part_of_one() {
        let folder = Path::new("f");
        let [from, to] = ["in.png", "out.svg"].map(|name| folder.join(name).display().to_string());
        let words = PRIMITIVE.arguments(folder, "-n 5 -m 1");
        assert_eq!(words, ["-i", &from, "-o", &to, "-n", "5", "-m", "1"]);
        let words = INKSCAPE.arguments(folder, "8");
        let is_told =
            words[1].contains("trace:8,") && words[1].contains(&format!("filename:{to};"));
        assert!(is_told, "{words:?}");
    }

    #[test]
    fn a_pixmap_has_its_size_and_pixels() {
        let picture = Image::filled(2, 1, [1.0, 0.0, 0.0]).unwrap();
        assert_eq!(ppm(&picture), b"P6 2 1 255\n\xff\0\0\xff\0\0");
    }
}
