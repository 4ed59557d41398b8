//! The files of a drawing: as it was fitted, or made for a machine from that, and pictures and animations of it. The file name
//! selects the format.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use anyhow::Result;
use strokefit::animation::{Film, Legend, Step};
use strokefit::fit::Widths;
use strokefit::image::{AnimationFormat, Image};
use strokefit::machine::{self, Hatch, Sheet};
use strokefit::report::Judged;
use strokefit::scene::{MIN_WIDTH, Scene};
use strokefit::svg::{self, Form, Group, WriteOptions};
use strokefit::verify::{self, Size};

use super::misuse;
use super::output::Output;

/// Placeholder for the number of a frame.
const NUMBER: &str = "{n}";

/// Endings of formats that one might expect, and that are not written.
const NOT_WRITTEN: [&str; 9] = [
    "jpg", "jpeg", "bmp", "tif", "tiff", "avif", "eps", "ps", "svgz",
];

/// Decimals of cut-outs. Rounded corners on the border of another area leave slivers, in whose width the border's length counts.
const CUTOUT_PRECISION: u8 = 4;

/// Options of a film of a drawing.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Animation (.gif, .webp, .apng, .animated.svg and {n}.png)")]
pub(super) struct FilmOptions {
    /// Add a stage, or N strokes, with each frame [default: as many as give about 50 frames]
    #[arg(long, value_name = "stage|N")]
    frames: Option<Step>,
    /// Write the number of strokes below each frame and, in fit, the PSNR
    #[arg(long)]
    legend: bool,
}

/// What is made of a drawing before it is written.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct Made {
    /// Write filled outlines instead of strokes, one for each, for programs that ignore strokes
    #[arg(long, conflicts_with_all = ["cutout", "hatch"])]
    pub(super) outline: bool,
    /// Write what is seen of each colour as one path, for cutters: areas do not overlap, share their borders, and end at the
    /// page. All is opaque; the background is one of the areas unless it is none
    #[arg(long, conflicts_with = "hatch")]
    pub(super) cutout: bool,
    /// Fill areas with lines for a plotter, so far apart, such as 0.5mm, at an angle, 45 degrees if none is given. The lines
    /// are as wide as the thinnest pen, or as they are far apart
    #[arg(long, value_name = "DISTANCE[:ANGLE]", allow_hyphen_values = true)]
    pub(super) hatch: Option<Hatch>,
}

/// Content of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    /// The drawing.
    Svg,
    /// The drawing for print.
    Pdf,
    /// The drawing for cutters and CAD.
    Dxf,
    /// A PNG of the drawing.
    Picture,
    /// The drawing as it draws itself.
    AnimatedSvg,
    /// An animation.
    Animation(AnimationFormat),
    /// A PNG of each frame.
    Frames,
}

impl Format {
    /// Format that the name of a file asks for, or `None` when it says nothing.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?.to_ascii_lowercase();
        let numbered = name.contains(NUMBER);
        Some(match name.rsplit_once('.')?.1 {
            "png" if numbered => Self::Frames,
            "png" => Self::Picture,
            "gif" => Self::Animation(AnimationFormat::Gif),
            "apng" => Self::Animation(AnimationFormat::Apng),
            "webp" => Self::Animation(AnimationFormat::Webp),
            "svg" if name.ends_with(".animated.svg") => Self::AnimatedSvg,
            "svg" => Self::Svg,
            "pdf" => Self::Pdf,
            "dxf" => Self::Dxf,
            _ => return None,
        })
    }

    fn moves(self) -> bool {
        !self.is_drawing() && self != Self::Picture
    }

    /// True if the file holds the drawing itself, and not pictures of it.
    fn is_drawing(self) -> bool {
        matches!(self, Self::Svg | Self::Pdf | Self::Dxf)
    }

    /// True if the file holds the marks one by one, so that these have to be known.
    fn needs_marks(self) -> bool {
        !matches!(self, Self::Svg | Self::Picture)
    }
}

/// A drawing to be written, and what is known of it.
pub(super) struct Subject<'a> {
    /// The marks; `None` if they lie on another SVG and are only a part of the drawing. Needed for what moves, PDF and DXF.
    scene: Option<Cow<'a, Scene>>,
    /// The SVG.
    text: Cow<'a, str>,
    /// Picture that the drawing is to look like.
    target: Option<&'a Image>,
    /// Pixels per px of the drawing.
    pub(super) scale: f64,
}

impl<'a> Subject<'a> {
    pub(super) fn new(scene: Option<Cow<'a, Scene>>, text: Cow<'a, str>) -> Self {
        Self {
            scene,
            text,
            target: None,
            scale: 1.0,
        }
    }

    fn like(self, target: &'a Image) -> Self {
        let target = Some(target);
        Self { target, ..self }
    }

    /// The drawing of a fit with these pens, made into what was asked for.
    pub(super) fn of(judged: &'a Judged, made: &Made, pens: Option<&Widths>) -> Result<Self> {
        let page = svg::page_width(&judged.svg);
        let radii = pens.map(|pens| pens.radii(page, &judged.fit.target));
        let radii = radii.transpose()?.unwrap_or_default();
        let pen = radii.first().map(|radius| 2.0 * radius);
        let file = WriteOptions {
            width: page,
            ..judged.fit.file
        };
        if !made.is_for_machines() {
            let outlines = |scene: &'a Scene| match file.form {
                Form::Outlines => Cow::Owned(machine::outlined(scene)),
                _ => Cow::Borrowed(scene),
            };
            let scene = judged.whole().map(outlines);
            return Ok(Self::new(scene, Cow::Borrowed(&judged.svg)).like(&judged.fit.target));
        }
        let whole = judged.whole().ok_or_else(|| {
            misuse("the SVG is not made of strokes and areas only: leave out --cutout and --hatch")
        })?;
        Ok(made.subject(whole, &file, pen)?.like(&judged.fit.target))
    }

    /// The bytes of the drawing as a file of this name.
    pub(super) fn drawing(&self, path: &Path) -> Result<Vec<u8>> {
        let format = Format::of(path).filter(|format| format.needs_marks());
        let Some(format) = format else {
            return Ok(self.text.as_bytes().to_vec());
        };
        let sheet = Sheet {
            scene: self.scene.as_deref().ok_or_else(|| unknown_marks(path))?,
            width: svg::page_width(&self.text),
        };
        Ok(match format {
            Format::Dxf => machine::dxf(&sheet).into_bytes(),
            _ => machine::pdf(&sheet),
        })
    }
}

impl Made {
    /// True if a cutter or a plotter reads the file.
    pub(super) fn is_for_machines(&self) -> bool {
        self.cutout || self.hatch.is_some()
    }

    /// The drawing that is made of a scene, in a file with these options; `pen` is the width of the pen that hatches, px of the
    /// picture.
    pub(super) fn subject(
        &self,
        scene: &Scene,
        file: &WriteOptions,
        pen: Option<f32>,
    ) -> Result<Subject<'static>> {
        let (made, text) = if let Some(hatch) = self.hatch {
            let made = hatched(scene, hatch, pen, file)?;
            let text = svg::write(&made, file);
            (made, text)
        } else if self.cutout {
            let made = machine::cut_out(scene)?;
            let options = WriteOptions {
                precision: file.precision.max(CUTOUT_PRECISION),
                group: Group::Color,
                ..*file
            };
            let text = svg::write(&made, &options);
            (made, text)
        } else {
            // Straight outlines and dots have elements of their own.
            (machine::outlined(scene), svg::write(scene, file))
        };
        Ok(Subject::new(Some(Cow::Owned(made)), Cow::Owned(text)))
    }
}

/// The drawing with its areas filled by the lines of a pen; without one, lines are as wide as they are far apart.
fn hatched(scene: &Scene, hatch: Hatch, pen: Option<f32>, file: &WriteOptions) -> Result<Scene> {
    let sheet = Sheet {
        scene,
        width: file.width,
    };
    let spacing = hatch.spacing.px() / sheet.px();
    if spacing < MIN_WIDTH {
        return Err(misuse(format!(
            "the lines of --hatch are {spacing:.2} px of the picture apart, and a stroke is {MIN_WIDTH} px or more wide: \
             enlarge the picture, or give a larger distance"
        )));
    }
    let pen = pen.map_or(spacing, f64::from);
    Ok(machine::hatched(scene, spacing, pen, hatch.degrees)?)
}

/// Pictures and animations, known to be writable.
#[derive(Debug)]
pub(super) struct Pictures {
    files: Vec<(Format, Output, PathBuf)>,
    options: FilmOptions,
}

impl Pictures {
    /// The files at `paths`, all of them pictures or animations; a name that says nothing is a picture.
    pub(super) fn open(paths: &[impl AsRef<Path>], options: FilmOptions) -> Result<Self> {
        let open = |path: &Path| {
            expect_written(path)?;
            let format = Format::of(path).unwrap_or(Format::Picture);
            let output = Output::open(&numbered(path, format, "1"))?;
            Ok((format, output, path.to_owned()))
        };
        let paths = paths.iter().map(AsRef::as_ref);
        let files = paths.map(open).collect::<Result<Vec<_>>>()?;
        let outputs = Self { files, options };
        outputs.check()?;
        Ok(outputs)
    }

    fn check(&self) -> Result<()> {
        for (i, (_, output, path)) in self.files.iter().enumerate() {
            if self.files[..i].iter().any(|(_, other, _)| other == output) {
                let path = path.display();
                return Err(misuse(format!("{path}: named twice: name another output")));
            }
        }
        let FilmOptions { frames, legend } = self.options;
        if !self.moves() && (frames.is_some() || legend) {
            let message =
                "--frames and --legend apply to animations only: add one, such as -o out.gif";
            return Err(misuse(message));
        }
        Ok(())
    }

    fn moves(&self) -> bool {
        self.files.iter().any(|(format, ..)| format.moves())
    }

    /// True if any of the files needs the marks.
    pub(super) fn needs_marks(&self) -> bool {
        self.files.iter().any(|(format, ..)| format.needs_marks())
    }

    /// Every file that is written.
    pub(super) fn all(&self) -> impl Iterator<Item = (&Path, &Output)> {
        let files = self.files.iter();
        files.map(|(_, output, path)| (path.as_path(), output))
    }

    /// Writes all files.
    pub(super) fn write(&self, subject: &Subject<'_>) -> Result<()> {
        for (format, output, path) in &self.files {
            match (format, subject.scene.as_deref()) {
                (Format::Frames, Some(scene)) => self.write_frames(path, subject, scene)?,
                (Format::AnimatedSvg, Some(scene)) => {
                    output.write(self.film(subject).svg(scene).as_bytes())?;
                }
                (Format::Animation(format), Some(scene)) => {
                    output.write(&self.film(subject).encode(scene, *format)?)?;
                }
                (format, _) if format.is_drawing() => output.write(&subject.drawing(path)?)?,
                (format, None) if format.moves() => return Err(unknown_marks(path)),
                _ => {
                    let picture = verify::render(&subject.text, Size::Scale(subject.scale), None)?;
                    output.write(&picture.encode_png()?)?;
                }
            }
        }
        Ok(())
    }

    fn write_frames(&self, path: &Path, subject: &Subject<'_>, scene: &Scene) -> Result<()> {
        let film = self.film(subject);
        let digits = film.parts(scene).len().to_string().len();
        for (i, frame) in film.frames(scene).enumerate() {
            let number = format!("{:0digits$}", i + 1);
            let output = Output::open(&numbered(path, Format::Frames, &number))?;
            output.write(&frame?.encode_png()?)?;
        }
        Ok(())
    }

    fn film<'d>(&self, subject: &Subject<'d>) -> Film<'d> {
        let legend = match subject.target {
            _ if !self.options.legend => Legend::None,
            None => Legend::Strokes,
            Some(target) => Legend::Fidelity(target),
        };
        Film {
            step: self.options.frames,
            legend,
            scale: subject.scale,
        }
    }
}

/// The error of a file of marks of a drawing that has others.
fn unknown_marks(path: &Path) -> anyhow::Error {
    misuse(format!(
        "{}: the SVG is not made of strokes and areas only, so they cannot be written one by one: leave this output out",
        path.display()
    ))
}

/// The SVG among the outputs of a fit, or without one the first PDF or DXF, and the others.
pub(super) fn split(paths: &[PathBuf]) -> Result<(&Path, Vec<&Path>)> {
    paths.iter().try_for_each(|path| expect_written(path))?;
    let is_svg = |path: &Path| matches!(Format::of(path), None | Some(Format::Svg));
    let (svgs, others): (Vec<&Path>, Vec<&Path>) = paths
        .iter()
        .map(PathBuf::as_path)
        .partition(|path| is_svg(path));
    match svgs.as_slice() {
        [svg] => Ok((svg, others)),
        [] => {
            let is_drawing = |path: &&&Path| Format::of(path).is_some_and(Format::is_drawing);
            let drawing = others.iter().find(is_drawing).copied().ok_or_else(|| {
                misuse("no output is an SVG, a PDF or a DXF: add one, such as -o out.svg")
            })?;
            let rest = others.into_iter().filter(|path| *path != drawing);
            Ok((drawing, rest.collect()))
        }
        [_, second, ..] => Err(misuse(format!(
            "{}: is a second SVG: give one SVG, and any number of pictures and animations",
            second.display()
        ))),
    }
}

/// Refuses a name that would tell of another format than the file has.
fn expect_written(path: &Path) -> Result<()> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let Some(other) = NOT_WRITTEN.iter().find(|o| ending.eq_ignore_ascii_case(o)) else {
        return Ok(());
    };
    Err(misuse(format!(
        "{}: strokefit does not write .{other} files: use .svg, .pdf, .dxf, .png, .gif, .webp or .apng",
        path.display()
    )))
}

/// The path of the frame `number`; others have none.
fn numbered(path: &Path, format: Format, number: &str) -> PathBuf {
    match path.to_str() {
        Some(text) if format == Format::Frames => PathBuf::from(text.replace(NUMBER, number)),
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_formats() {
        let of = |name: &str| Format::of(Path::new(name));
        assert_eq!(of("a/b.svg"), Some(Format::Svg));
        assert_eq!(of("a.ANIMATED.svg"), Some(Format::AnimatedSvg));
        assert_eq!(
            of("a.animated.GIF"),
            Some(Format::Animation(AnimationFormat::Gif))
        );
        assert_eq!(of("f/{n}.png"), Some(Format::Frames));
        assert_eq!(of("{n}/a.png"), Some(Format::Picture));
        for name in ["-", "a", "svg", "a.xml", "/dev/stdout"] {
            assert_eq!(of(name), None, "{name}");
        }
    }

    #[test]
    fn a_fit_has_one_svg() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let given = paths(&["a.gif", "-", "b.png"]);
        let (svg, others) = split(&given).unwrap();
        assert_eq!((svg, others.len()), (Path::new("-"), 2));
        for names in [
            &["a.gif"][..],
            &["a.svg", "b.svg"],
            &["a.svg", "-"],
            &["a.jpg"],
        ] {
            assert!(split(&paths(names)).is_err(), "{names:?}");
        }
    }
}
