//! SVG that draws itself, by SMIL animation. Browsers play it, even in `<img>`; other programs ignore the
//! animation and show the finished drawing.

use std::ops::Range;

use kurbo::Shape;

use super::dialect::{self, Unit};
use super::path::{self, Kind};
use super::{Form, WriteOptions, write};
use crate::scene::{Area, Cap, Mark, Scene, Stroke, quantum};

/// Durations in an animated drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// From one part to the next, ms.
    pub part_ms: u32,
    /// Time for which the finished drawing is shown before it starts again, ms.
    pub last_ms: u32,
}

/// The scene with `precision` decimals and an element for each mark. The marks of each of `parts` are in
/// a group that appears at its time; the first group is visible from the start. Parts are consecutive ranges
/// of the marks, back to front. Until the next part appears, a stroke of several pieces, or of a curve, is drawn along
/// its length, one whose width varies below a mask, and an area fades in. The animation repeats for ever.
///
/// A part that crosses the end of a stage is in two groups, which appear together.
pub fn write_animated(
    scene: &Scene,
    parts: &[Range<usize>],
    timing: Timing,
    precision: u8,
) -> String {
    let scene = scene.quantized(precision).scene;
    let options = WriteOptions {
        precision,
        form: Form::Plain,
        ..WriteOptions::default()
    };
    let clock = Clock {
        whole_ms: timing.part_ms * parts.len() as u32 + timing.last_ms,
        part_ms: timing.part_ms,
    };
    let mut groups = Groups {
        out: String::new(),
        open: false,
    };
    let mut shapes = scene.marks().peekable();
    let mut marks = 0;
    let mut part = 0;
    // The writer puts each element on its own line.
    for line in write(&scene, &options).lines() {
        if !is_mark(line) {
            groups.close();
        } else {
            // A part may be empty, so several may end at this mark.
            while parts.get(part).is_some_and(|range| marks >= range.end) {
                part += 1;
                groups.close();
            }
            groups.ensure(|| clock.entrance(part));
            marks += 1;
        }
        match shapes.next_if(|_| is_mark(line)) {
            Some(Mark::Stroke(stroke)) if stroke.is_varying() => {
                groups.push(&clock.growing(line, stroke, marks, part));
            }
            Some(Mark::Stroke(stroke)) if is_long(stroke) => {
                groups.push(&clock.along(line, part));
            }
            Some(Mark::Area(area)) => groups.push(&clock.fading(line, area, part)),
            _ => groups.push(line),
        }
    }
    groups.out
}

/// True if a line of the writer is a mark. All other lines are groups, their titles, the background, the shade and shadows.
fn is_mark(line: &str) -> bool {
    ![
        "<g",
        "</",
        "<title",
        "<svg",
        "<rect width",
        "<linear",
        "<radial",
        "<filter",
    ]
    .iter()
    .any(|other| line.starts_with(other))
}

/// The start tag of an element, open, and its end tag.
fn tags(element: &str) -> (&str, String) {
    let open = element.strip_suffix("/>").unwrap_or(element);
    let name = open.trim_start_matches('<').split(' ').next();
    (open, format!("</{}>", name.unwrap_or_default()))
}

/// True if the stroke is worth drawing along its length; a dot or a line just appears.
fn is_long(stroke: &Stroke) -> bool {
    stroke.cap == Cap::Butt || stroke.path.points().len() > 2 || stroke.path.is_closed()
}

struct Clock {
    whole_ms: u32,
    part_ms: u32,
}

impl Clock {
    /// The animation of the attribute `name` through `values` at `times`.
    fn animation(&self, name: &str, values: &str, times: &str) -> String {
        let ms = self.whole_ms;
        format!(
            "<animate attributeName=\"{name}\" {values} keyTimes=\"{times}\" dur=\"{ms}ms\" repeatCount=\"indefinite\"/>"
        )
    }

    /// The animation that makes the group around it appear with part `part`, from 0.
    fn entrance(&self, part: usize) -> String {
        if part == 0 {
            return String::new();
        }
        let values = "calcMode=\"discrete\" values=\"hidden;visible\"";
        let times = format!("0;{:.4}", self.start(part));
        self.animation("visibility", values, &times) + "\n"
    }

    /// The `element` of a stroke of part `part`, with an animation that draws it: a single dash that grows. Only
    /// the animation says so, so that other programs draw no dash.
    fn along(&self, element: &str, part: usize) -> String {
        let (open, close) = tags(element);
        let values = "values=\"0 1;0 1;1 0;1 0\"";
        let animation = self.animation("stroke-dasharray", values, &self.times(part));
        format!("{open} pathLength=\"1\">{animation}{close}")
    }

    /// The `element` of a line whose width varies, mark `number`, of part `part`, with an animation that draws it: a pen that is wider
    /// than the line anywhere uncovers it along its middle.
    fn growing(&self, element: &str, line: &Stroke, number: usize, part: usize) -> String {
        let (open, _) = tags(element);
        let d = path::data([&line.path], Kind::Line, Unit::PX);
        let width = (2.0 * line.radius).ceil() + 2.0;
        let pen = format!(
            "<path d=\"{d}\" fill=\"none\" stroke=\"#fff\" stroke-width=\"{width}\" stroke-linecap=\"round\" \
             stroke-linejoin=\"round\"/>"
        );
        let page = line
            .path
            .bezier()
            .bounding_box()
            .inflate(width, width)
            .expand();
        format!(
            "<mask id=\"line-{number}\" maskUnits=\"userSpaceOnUse\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\">{}</mask>\
             {open} mask=\"url(#line-{number})\"/>",
            page.x0,
            page.y0,
            page.width(),
            page.height(),
            self.along(&pen, part)
        )
    }

    /// The `element` of an area of part `part`, with an animation that fades it in.
    fn fading(&self, element: &str, area: &Area, part: usize) -> String {
        let (open, close) = tags(element);
        let opacity = dialect::opacity(quantum(area.opacity));
        let values = format!("values=\"0;0;{opacity};{opacity}\"");
        let animation = self.animation("fill-opacity", &values, &self.times(part));
        format!("{open}>{animation}{close}")
    }

    /// Before, when a part begins and ends to appear, and after.
    fn times(&self, part: usize) -> String {
        format!("0;{:.4};{:.4};1", self.start(part), self.start(part + 1))
    }

    /// When a part appears, of the whole.
    fn start(&self, part: usize) -> f64 {
        part as f64 * f64::from(self.part_ms) / f64::from(self.whole_ms)
    }
}

/// Text with groups that open and close.
struct Groups {
    out: String,
    open: bool,
}

impl Groups {
    fn push(&mut self, line: &str) {
        self.out.push_str(line);
        self.out.push('\n');
    }

    /// Opens a group that starts with `head`, unless one is open.
    fn ensure(&mut self, head: impl FnOnce() -> String) {
        if !self.open {
            self.push("<g>");
            self.out.push_str(&head());
            self.open = true;
        }
    }

    fn close(&mut self) {
        if self.open {
            self.push("</g>");
            self.open = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cap, Path, PathPoint, Stage};
    use crate::verify::{Size, render};

    fn stroke(k: usize) -> Stroke {
        Stroke {
            path: Path::line((k as f32, 2.0).into(), (k as f32 + 3.0, 8.0).into()),
            radius: 1.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [k as f32 / 7.0, 0.5, 0.2],
            opacity: 0.8,
        }
    }

    fn scene() -> Scene {
        let stage = |range: Range<usize>| Stage::from_iter(range.map(stroke));
        Scene {
            stages: vec![stage(0..3), stage(3..7)],
            ..Scene::empty(12, 10, Some([1.0; 3]))
        }
    }

    const TIMING: Timing = Timing {
        part_ms: 100,
        last_ms: 600,
    };

    #[test]
    fn parts_appear_in_order() {
        let text = write_animated(&scene(), &[0..2, 2..5, 5..6, 6..7], TIMING, 2);
        let times: Vec<&str> = text
            .split("keyTimes=\"0;")
            .skip(1)
            .filter_map(|rest| rest.split('"').next())
            .collect();
        // The second part has a group in each of the two stages.
        assert_eq!(times, ["0.1000", "0.1000", "0.2000", "0.3000"]);
        assert_eq!(text.matches("dur=\"1000ms\"").count(), 4);
        assert_eq!(text.matches("<path").count(), 7);
    }

    #[test]
    fn a_line_whose_width_varies_is_drawn_along_its_middle() {
        let points = [[2.0, 2.0], [9.0, 1.0], [5.0, 9.0]]
            .map(|[x, y]: [f64; 2]| PathPoint::on((x, y).into()));
        let path = Path::new(points.into(), false).unwrap();
        let line = Stroke::varying(path, vec![0.0, 1.5, 1.0], [0.0; 3], 1.0).unwrap();
        let scene = Scene {
            stages: vec![[Mark::from(line), stroke(3).into()].into_iter().collect()],
            ..Scene::empty(12, 10, Some([1.0; 3]))
        };
        let text = write_animated(&scene, &[0..1, 1..2], TIMING, 2);
        assert_eq!(text.matches("stroke-dasharray").count(), 1);
        assert!(
            text.contains("d=\"M2 2L9 1 5 9\" fill=\"none\" stroke=\"#fff\" stroke-width=\"5\""),
            "{text}"
        );
        let draw = |text: &str| render(text, Size::Scale(3.0), None).unwrap();
        // A mask rounds once more, to 8 bits: about a level in most pixels of the line, which is 49.6 dB.
        let plain = draw(&write(&scene, &WriteOptions::default()));
        let db = crate::metrics::psnr(&draw(&text), &plain).unwrap();
        assert!(db > 49.0, "{db} dB");
    }

    #[test]
    fn a_long_path_is_drawn_along_its_length() {
        let mut scene = scene();
        let points = [[1.0, 1.0], [9.0, 1.0], [5.0, 9.0]]
            .map(|[x, y]: [f64; 2]| PathPoint::on((x, y).into()));
        scene.stages[1].marks[0] = Mark::from(Stroke {
            path: Path::new(points.into(), true).unwrap(),
            ..stroke(3)
        });
        let text = write_animated(&scene, &[0..2, 2..5, 5..6, 6..7], TIMING, 2);
        assert_eq!(text.matches("stroke-dasharray").count(), 1);
        assert!(text.contains("z\" stroke="), "{text}");
        assert!(text.contains("keyTimes=\"0;0.1000;0.2000;1\""), "{text}");
        let draw = |text: &str| render(text, Size::Scale(3.0), None).unwrap();
        assert!(draw(&text) == draw(&write(&scene, &WriteOptions::default())));
    }

    #[test]
    fn an_area_fades_in_with_its_part() {
        let mut scene = scene();
        let corners = [[1.0, 1.0], [9.0, 1.0], [5.0, 9.0]]
            .map(|[x, y]: [f64; 2]| PathPoint::on((x, y).into()));
        let ring = Path::new(corners.into(), true).unwrap();
        scene.stages[1].marks[0] = Area::plain(vec![ring], [0.2, 0.4, 0.6], 0.5).into();
        let text = write_animated(&scene, &[0..2, 2..5, 5..6, 6..7], TIMING, 2);
        let fade = "<animate attributeName=\"fill-opacity\" values=\"0;0;0.502;0.502\" \
                    keyTimes=\"0;0.1000;0.2000;1\"";
        assert_eq!(text.matches(fade).count(), 1, "{text}");
        let draw = |text: &str| render(text, Size::Scale(3.0), None).unwrap();
        assert!(draw(&text) == draw(&write(&scene, &WriteOptions::default())));
    }

    #[test]
    fn programs_without_animation_show_the_finished_drawing() {
        let options = WriteOptions::default();
        let draw = |text: &str| render(text, Size::Scale(3.0), None).unwrap();
        let animated = write_animated(&scene(), &[0..1, 1..4, 4..7], TIMING, 2);
        assert!(draw(&animated) == draw(&write(&scene(), &options)));
    }
}
