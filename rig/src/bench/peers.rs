//! Peers: other programs and libraries that turn pictures into SVG. Programs are run where they are installed,
//! with the command lines of their manuals. Libraries are passed in by the program that links them.

use std::fmt::Display;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::drawings::Kind;
use strokefit::engines;
use strokefit::image::Image;
use strokefit::report::Usage;
use strokefit::{Error, ErrorKind, Result};

/// Time between two readings of the memory of a running program.
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// A program that takes longer counts as hanging, and is ended.
const LONGEST: Duration = Duration::from_secs(600);

/// Somebody else who turns pictures into SVG.
pub trait Peer {
    /// Name in plots and tables.
    fn name(&self) -> &str;

    /// The settings that are run, rough to fine.
    fn settings(&self) -> Vec<String>;

    /// The drawing of an opaque `picture` at one of its settings.
    ///
    /// # Errors
    /// When the peer makes none.
    fn trace(&self, picture: &Image, settings: &str) -> Result<Traced>;
}

/// Drawing that a peer made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Traced {
    /// The SVG.
    pub svg: String,
    /// Peak memory, bytes. Another program is sampled every 2 ms, so a peak just before its end may be
    /// missed.
    pub peak_rss_bytes: Option<u64>,
}

/// A program on the path.
#[derive(Debug, Clone, Copy)]
struct Program {
    name: &'static str,
    /// The picture's file: PNG, or PPM where it reads nothing else.
    input: &'static str,
    settings: &'static [&'static str],
    /// The arguments; `{in}` and `{out}` stand for the files, `{settings}` for the words of
    /// the settings.
    args: &'static [&'static str],
    /// An argument, and the text that the answer contains if the program is able to trace at all.
    can: Option<[&'static str; 2]>,
    /// True if it crashes without a display.
    needs_display: bool,
}

const VTRACER: Program = Program {
    name: "vtracer",
    input: "in.png",
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
    can: None,
    needs_display: false,
};

const PRIMITIVE: Program = Program {
    name: "primitive",
    input: "in.png",
    // A seventh of a second of CPU each, and the program has no seed: no two drawings are equal.
    settings: &["-n 20 -m 0", "-n 50 -m 0", "-n 100 -m 0", "-n 300 -m 0"],
    args: &["-i", "{in}", "-o", "{out}", "{settings}"],
    can: None,
    needs_display: false,
};

const POTRACE: Program = Program {
    name: "potrace",
    input: "in.ppm",
    settings: &["--turdsize 10", "--turdsize 2"],
    args: &["--svg", "{settings}", "--output", "{out}", "{in}"],
    can: None,
    needs_display: false,
};

const INKSCAPE: Program = Program {
    name: "inkscape",
    input: "in.png",
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
};

/// Needs numpy and Pillow, without which it cannot even tell its version.
const PYAUTOTRACE: Program = Program {
    name: "pyautotrace",
    input: "in.png",
    settings: &[],
    args: &[
        "{in}",
        "{out}",
        "--background-color",
        "#ffffff",
        "{settings}",
    ],
    can: Some(["--version", "pyautotrace"]),
    needs_display: false,
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

/// The programs that are known, installed or not.
pub fn known() -> Vec<Box<dyn Peer>> {
    boxed(PROGRAMS.into_iter())
}

/// The known programs that are installed.
pub fn installed() -> Vec<Box<dyn Peer>> {
    boxed(PROGRAMS.into_iter().filter(Program::is_here))
}

/// Names of the known programs that are not, are too old, or have no display to work on.
pub fn missing() -> Vec<&'static str> {
    names_of_missing(PROGRAMS.into_iter())
}

/// A peer at the setting for drawings of one kind.
pub struct TunedPeer {
    peer: Box<dyn Peer>,
    settings: &'static str,
}

impl TunedPeer {
    /// Name in tables.
    pub fn name(&self) -> &str {
        self.peer.name()
    }

    /// The drawing of a picture of so many `colors`, with that of the page.
    ///
    /// # Errors
    /// When the peer makes none.
    pub fn trace(&self, picture: &Image, colors: usize) -> Result<Traced> {
        let settings = self.settings.replace("{colors}", &colors.to_string());
        self.peer.trace(picture, &settings)
    }
}

/// The programs that draw drawings of a kind again and are installed.
pub fn installed_for(kind: Kind) -> Vec<TunedPeer> {
    let here = FOR_DRAWINGS.into_iter();
    here.filter(|(program, _)| program.is_here())
        .map(|(program, [for_lines, for_shapes])| TunedPeer {
            peer: Box::new(program),
            settings: match kind {
                Kind::Strokes => for_lines,
                Kind::Shapes => for_shapes,
            },
        })
        .collect()
}

/// Names of those that are not installed, are too old, or have no display to work on.
pub fn missing_for_drawings() -> Vec<&'static str> {
    names_of_missing(FOR_DRAWINGS.into_iter().map(|(program, _)| program))
}

fn names_of_missing(programs: impl Iterator<Item = Program>) -> Vec<&'static str> {
    programs
        .filter(|program| !program.is_here())
        .map(|program| program.name)
        .collect()
}

fn boxed(programs: impl Iterator<Item = Program>) -> Vec<Box<dyn Peer>> {
    programs
        .map(|program| Box::new(program) as Box<dyn Peer>)
        .collect()
}

impl Peer for Program {
    fn name(&self) -> &str {
        self.name
    }

    fn settings(&self) -> Vec<String> {
        self.settings
            .iter()
            .map(|&words| words.to_owned())
            .collect()
    }

    fn trace(&self, picture: &Image, settings: &str) -> Result<Traced> {
        let folder = tempfile::tempdir().map_err(|e| self.failed(e))?;
        let (from, to) = (
            folder.path().join(self.input),
            folder.path().join("out.svg"),
        );
        let bytes = if self.input.ends_with("ppm") {
            ppm(picture)
        } else {
            picture.encode_png()?
        };
        fs::write(&from, bytes).map_err(|e| self.failed(e))?;
        let mut command = Command::new(self.name);
        command.args(self.arguments(&from, &to, settings));
        let (ended, peak_rss_bytes) = run(command, folder.path()).map_err(|e| self.failed(e))?;
        if let Some(why) = ended {
            return Err(self.failed(format!("{why} with {settings}")));
        }
        let svg = fs::read_to_string(&to)
            .map_err(|_| self.failed(format!("made no SVG with {settings}")))?;
        Ok(Traced {
            svg,
            peak_rss_bytes,
        })
    }
}

impl Program {
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

    fn arguments(&self, from: &Path, to: &Path, settings: &str) -> Vec<String> {
        let file = |path: &Path| path.display().to_string();
        let words = self.args.iter().flat_map(|&arg| {
            if arg == "{settings}" {
                settings.split_whitespace().map(str::to_owned).collect()
            } else {
                vec![arg.to_owned()]
            }
        });
        words
            .map(|word| {
                let word = word.replace("{settings}", settings);
                word.replace("{out}", &file(to))
                    .replace("{in}", &file(from))
            })
            .collect()
    }
}

/// True if a window can be opened.
fn has_display() -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

/// Runs a program, which may leave files in `folder`: why it failed, if it did, and the most memory that it
/// was seen to hold.
fn run(mut command: Command, folder: &Path) -> io::Result<(Option<String>, Option<u64>)> {
    // Not a pipe, which could fill up.
    let said = folder.join("said");
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&said)?);
    let mut child = command.spawn()?;
    let (status, peak) = watched(&mut child)?;
    let why = match status {
        None => Some(format!("ended after {} s", LONGEST.as_secs())),
        Some(status) if !status.success() => {
            let said = String::from_utf8_lossy(&fs::read(&said)?).into_owned();
            let last = said.lines().rfind(|line| !line.trim().is_empty());
            Some(last.map_or_else(
                || status.to_string(),
                |line| format!("{} ({status})", line.trim()),
            ))
        }
        Some(_) => None,
    };
    Ok((why, peak))
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
        let (from, to) = (Path::new("a.png"), Path::new("b.svg"));
        let words = PRIMITIVE.arguments(from, to, "-n 5 -m 1");
        assert_eq!(words, ["-i", "a.png", "-o", "b.svg", "-n", "5", "-m", "1"]);
        let words = INKSCAPE.arguments(from, to, "8");
        assert!(
            words[1].contains("trace:8,") && words[1].contains("filename:b.svg;"),
            "{words:?}"
        );
    }

    #[test]
    fn a_pixmap_has_its_size_and_pixels() {
        let picture = Image::filled(2, 1, [1.0, 0.0, 0.0]).unwrap();
        assert_eq!(ppm(&picture), b"P6 2 1 255\n\xff\0\0\xff\0\0");
    }
}
