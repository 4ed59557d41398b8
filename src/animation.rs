//! Replays a finished drawing mark by mark: frames, animations, and SVG that draws itself.
//!
//! ```
//! use strokefit::animation::{self, Film, Legend, Step};
//! use strokefit::image::AnimationFormat;
//! use strokefit::scene::{Cap, Scene, Path, Stage, Stroke};
//!
//! let (cap, color) = (Cap::Round, [0.1; 3]);
//! let stroke = |x| Stroke { path: Path::dot((x, 4.0).into()), radius: 2.0, radii: Vec::new(), cap, color, opacity: 1.0 };
//! let scene = Scene {
//!     stages: vec![Stage::from_iter([3.0, 8.0, 13.0].map(stroke))],
//!     ..Scene::empty(16, 8, Some([1.0; 3]))
//! };
//! let film = Film { step: Some(Step::Strokes(2)), legend: Legend::None, scale: 1.0 };
//! let counts: Vec<usize> = film.parts(&scene).iter().map(|part| part.end).collect();
//! assert_eq!(counts, [2, 3]);
//! let gif = film.encode(&scene, AnimationFormat::Gif)?;
//! assert!(gif.starts_with(b"GIF89a"));
//! # Ok::<(), strokefit::Error>(())
//! ```

#[cfg(feature = "animation")]
mod caption;

use std::ops::Range;
use std::str::FromStr;

use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::scene::{MAX_PRECISION, Scene};
use crate::svg::{self, Timing};
#[cfg(feature = "animation")]
use crate::{
    image::{AnimationFormat, animated},
    metrics,
    scene::{Mark, Rgb, counted},
    svg::{Form, WriteOptions},
    verify::{Painting, Size},
};

/// Approximate number of frames by default.
const USUAL_FRAMES: usize = 48;
/// Duration of a whole film, as far as the bounds of its frames allow, ms.
const FILM_MS: u32 = 6000;
/// Shortest and longest time of a frame, ms. Browsers slow down GIFs with less than 20 ms.
const FRAME_MS: [u32; 2] = [30, 800];
/// Time for which the finished drawing is shown, ms.
const LAST_MS: u32 = 2500;

#[cfg(feature = "animation")]
/// Smallest width of a frame with a legend, px: some 30 letters.
const LEGEND: usize = 210;
#[cfg(feature = "animation")]
/// Likewise for a drawing with areas, whose number comes first: some 42 letters.
const LEGEND_OF_AREAS: usize = 290;

#[cfg(feature = "animation")]
const WHITE: Rgb = [1.0; 3];

/// Increment from one frame to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// A stage.
    Stage,
    /// This many strokes and areas.
    Strokes(usize),
}

impl FromStr for Step {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let strokes = text.parse().ok().filter(|&n| n > 0).map(Self::Strokes);
        let step = strokes.or((text == "stage").then_some(Self::Stage));
        step.ok_or_else(|| {
            let message =
                format!("frames \"{text}\": give stage, or a number of strokes, 1 or more");
            Error::new(ErrorKind::Config, message)
        })
    }
}

/// The text below each frame.
#[derive(Debug, Clone, Copy)]
pub enum Legend<'a> {
    /// Nothing.
    None,
    /// The number of strokes and areas.
    Strokes,
    /// The number of strokes and areas, and their PSNR against this picture, dB.
    Fidelity(&'a Image),
}

#[cfg(feature = "animation")]
impl Legend<'_> {
    /// The `frame` with its legend, where it shows the first `count` marks of `scene`.
    fn lay(&self, frame: Image, scene: &Scene, count: usize) -> Result<Image> {
        let areas = scene.marks().take(count).filter_map(Mark::as_area).count();
        let counted = counted(areas, count - areas);
        let text = match self {
            Self::None => return Ok(frame),
            Self::Strokes => counted,
            Self::Fidelity(target) => {
                format!("{counted}, {:.1} dB", metrics::psnr(target, &frame)?)
            }
        };
        let has_areas = scene.areas().next().is_some();
        let width = if has_areas { LEGEND_OF_AREAS } else { LEGEND };
        caption::captioned(&frame, &text, width)
    }
}

/// Options of a film of a drawing.
#[derive(Debug, Clone, Copy)]
pub struct Film<'a> {
    /// Increment of each frame; `None` for about 50 frames.
    pub step: Option<Step>,
    /// The text below each frame.
    pub legend: Legend<'a>,
    /// Pixels per px of the drawing; 1 for a legend with fidelity.
    pub scale: f64,
}

impl Film<'_> {
    /// The strokes and areas that each frame adds, back to front. A scene without any has one empty frame.
    pub fn parts(&self, scene: &Scene) -> Vec<Range<usize>> {
        let total = scene.len();
        let usual = Step::Strokes(total.div_ceil(USUAL_FRAMES));
        let ends = match self.step.unwrap_or(usual) {
            Step::Stage => stage_ends(scene),
            Step::Strokes(n) => {
                let frames = total.div_ceil(n.max(1));
                (1..=frames)
                    .map(|k| total.min(k.saturating_mul(n)))
                    .collect()
            }
        };
        let ends = if ends.is_empty() { vec![0] } else { ends };
        let starts = [0].into_iter().chain(ends.iter().copied());
        starts.zip(&ends).map(|(start, &end)| start..end).collect()
    }

    #[cfg(feature = "animation")]
    /// The frames, rendered by resvg on white when they are requested.
    ///
    /// # Errors
    /// Each as [`verify::render`](crate::verify::render); [`ErrorKind::Picture`] when a legend's
    /// picture is of another size.
    pub fn frames(&self, scene: &Scene) -> impl ExactSizeIterator<Item = Result<Image>> {
        let mut marks = scene.marks();
        let mut painting = None;
        self.parts(scene).into_iter().map(move |part| {
            let text = part_svg(scene, part.start == 0, marks.by_ref().take(part.len()));
            let painting = match &mut painting {
                Some(painting) => painting,
                none => none.insert(Painting::new(&text, Size::Scale(self.scale), WHITE)?),
            };
            if part.start > 0 {
                painting.add(&text)?;
            }
            self.legend.lay(painting.image()?, scene, part.end)
        })
    }

    #[cfg(feature = "animation")]
    /// An animation of the frames. It repeats for ever and shows the last frame longer.
    ///
    /// # Errors
    /// As [`frames`](Self::frames), and [`animated`].
    pub fn encode(&self, scene: &Scene, format: AnimationFormat) -> Result<Vec<u8>> {
        let frames = self.frames(scene);
        let last = frames.len() - 1;
        let timing = timing(frames.len());
        let shown = frames.enumerate().map(|(i, frame)| {
            let rest = if i == last { timing.last_ms } else { 0 };
            Ok((frame?, timing.part_ms + rest))
        });
        animated(format, shown)
    }

    /// SVG that draws itself in the same steps, with as many decimals as `scene` was rounded to; it has
    /// no legend and no scale.
    pub fn svg(&self, scene: &Scene) -> String {
        let parts = self.parts(scene);
        svg::write_animated(scene, &parts, timing(parts.len()), precision(scene))
    }
}

fn timing(frames: usize) -> Timing {
    let frames = u32::try_from(frames).unwrap_or(u32::MAX).max(1);
    Timing {
        part_ms: (FILM_MS / frames).clamp(FRAME_MS[0], FRAME_MS[1]),
        last_ms: LAST_MS,
    }
}

/// The number of marks after each stage that has any.
fn stage_ends(scene: &Scene) -> Vec<usize> {
    let counts = scene.stages.iter().map(|stage| stage.marks.len());
    let ends = counts.filter(|&count| count > 0).scan(0, |end, count| {
        *end += count;
        Some(*end)
    });
    ends.collect()
}

#[cfg(feature = "animation")]
/// Some marks of `scene` as SVG, not rounded any further; on its background and ground if they are its first.
fn part_svg<'a>(scene: &Scene, is_first: bool, marks: impl Iterator<Item = &'a Mark>) -> String {
    let stage = marks.cloned().collect();
    let part = Scene {
        stages: vec![stage],
        background: scene.background.filter(|_| is_first),
        ground: match is_first {
            true => scene.ground.clone(),
            false => Vec::new(),
        },
        ..*scene
    };
    let exactly = WriteOptions {
        precision: MAX_PRECISION,
        form: Form::Plain,
        ..WriteOptions::default()
    };
    svg::write(&part, &exactly)
}

/// The fewest decimals that represent `scene` exactly.
fn precision(scene: &Scene) -> u8 {
    let says_all = |precision: &u8| scene.quantized(*precision).scene == *scene;
    (0..MAX_PRECISION).find(says_all).unwrap_or(MAX_PRECISION)
}

#[cfg(test)]
#[cfg(feature = "animation")]
mod tests {
    use super::*;
    use crate::scene::{Area, Cap, Path, PathPoint, Stroke};
    use crate::verify;

    fn scene(stages: &[usize]) -> Scene {
        let stroke = |k: usize| Stroke {
            path: Path::line(
                ((k * 7 % 30) as f32, 3.0).into(),
                (20.0, (k * 5 % 24) as f32).into(),
            ),
            radius: 1.5,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [k as f32 / 20.0, 0.3, 0.8 - k as f32 / 40.0],
            opacity: 0.6,
        };
        let mut next = 0..;
        let stage = |&count: &usize| next.by_ref().take(count).map(stroke).collect();
        let stages = stages.iter().map(stage).collect();
        let scene = Scene {
            stages,
            ..Scene::empty(32, 24, Some([0.9, 1.0, 0.8]))
        };
        scene.quantized(2).scene
    }

    fn film(step: Option<Step>) -> Film<'static> {
        Film {
            step,
            legend: Legend::None,
            scale: 1.0,
        }
    }

    fn ends(step: Option<Step>, stages: &[usize]) -> Vec<usize> {
        film(step)
            .parts(&scene(stages))
            .iter()
            .map(|part| part.end)
            .collect()
    }

    #[test]
    fn frames_follow_stages_or_strokes() {
        assert_eq!(ends(Some(Step::Stage), &[2, 0, 5]), [2, 7]);
        assert_eq!(ends(Some(Step::Strokes(3)), &[2, 5]), [3, 6, 7]);
        assert_eq!(ends(Some(Step::Strokes(usize::MAX)), &[2, 5]), [7]);
        assert_eq!(ends(None, &[2, 5]).len(), 7);
        assert_eq!(ends(None, &[500]).len(), 46);
        assert_eq!(ends(None, &[]), [0]);
    }

    #[test]
    fn the_last_frame_is_the_picture_of_the_file_to_the_bit() {
        let scene = scene(&[3, 9]);
        let text = svg::write(&scene, &WriteOptions::default());
        let whole = verify::render(&text, Size::Scale(2.0), Some(WHITE)).unwrap();
        for step in [Step::Stage, Step::Strokes(1), Step::Strokes(5)] {
            let film = Film {
                scale: 2.0,
                ..film(Some(step))
            };
            let last = film.frames(&scene).last().unwrap().unwrap();
            assert!(last == whole, "{step:?}");
        }
    }

    #[test]
    fn each_frame_is_what_its_strokes_draw() {
        let whole = scene(&[3, 9]);
        let frames: Vec<_> = film(Some(Step::Stage)).frames(&whole).collect();
        assert_eq!(frames.len(), 2);
        let mut first = whole;
        first.stages.truncate(1);
        let text = svg::write(&first, &WriteOptions::default());
        let drawn = verify::render(&text, Size::Scale(1.0), Some(WHITE)).unwrap();
        assert!(*frames[0].as_ref().unwrap() == drawn);
    }

    #[test]
    fn a_drawing_without_strokes_is_one_frame_of_its_background() {
        let frames: Vec<_> = film(None).frames(&scene(&[])).collect();
        assert_eq!(frames.len(), 1);
        let [r, g, b] = frames[0].as_ref().unwrap().planes();
        assert!(r[0] < g[0] && b[0] < r[0]);
    }

    #[test]
    fn a_drawing_of_areas_plays_and_says_how_many_there_are() {
        let corners = [[2.0, 2.0], [30.0, 4.0], [16.0, 22.0]]
            .map(|[x, y]: [f64; 2]| PathPoint::on((x, y).into()));
        let ring = Path::new(corners.into(), true).unwrap();
        let area = Area::plain(vec![ring], [0.2, 0.4, 0.8], 0.7);
        let mut scene = scene(&[2]);
        let below = [Mark::from(area.clone()), Mark::from(area)];
        scene.stages[0].marks.splice(1..1, below);
        let scene = scene.quantized(2).scene;
        let text = svg::write(&scene, &WriteOptions::default());
        let whole = verify::render(&text, Size::Scale(1.0), Some(WHITE)).unwrap();
        let each = film(Some(Step::Strokes(1)));
        let frames: Vec<_> = each.frames(&scene).map(Result::unwrap).collect();
        assert_eq!(frames.len(), 4);
        assert!(frames[0] != frames[1] && frames[1] != frames[2] && frames[3] == whole);
        let alone = verify::render(&each.svg(&scene), Size::Scale(1.0), Some(WHITE)).unwrap();
        assert!(alone == whole);
        let legend = Legend::Strokes;
        let film = Film { legend, ..each };
        let with = film.frames(&scene).map(Result::unwrap);
        assert!(with.map(|frame| frame.width()).eq([LEGEND_OF_AREAS; 4]));
    }

    #[test]
    fn a_legend_is_beneath_and_measures() {
        let scene = scene(&[4]);
        let plain = film(None).frames(&scene).last().unwrap().unwrap();
        let legend = Legend::Fidelity(&plain);
        let film = Film {
            legend,
            ..film(None)
        };
        let with = film.frames(&scene).last().unwrap().unwrap();
        assert!(with.height() > plain.height());
        let other = Image::filled(3, 3, WHITE).unwrap();
        let legend = Legend::Fidelity(&other);
        assert!(
            Film { legend, ..film }
                .frames(&scene)
                .any(|frame| frame.is_err())
        );
    }

    #[test]
    fn animated_svg_has_the_numbers_of_the_file() {
        let scene = scene(&[3, 4]);
        let form = Form::Plain;
        let file = svg::write(
            &scene,
            &WriteOptions {
                form,
                ..WriteOptions::default()
            },
        );
        let animated = film(None).svg(&scene);
        let strokes = |text: &str| {
            text.lines()
                .filter(|l| l.starts_with("<path"))
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(strokes(&animated), strokes(&file));
    }

    #[test]
    fn steps_are_read_or_refused() {
        assert_eq!("stage".parse::<Step>().unwrap(), Step::Stage);
        assert_eq!("12".parse::<Step>().unwrap(), Step::Strokes(12));
        for text in ["", "0", "-1", "stages", "1.5"] {
            assert!(text.parse::<Step>().is_err(), "{text}");
        }
    }
}
