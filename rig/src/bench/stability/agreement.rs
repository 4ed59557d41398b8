//! Distance of our render of one stroke from resvg's, as a map over its width and angle.
//!
//! The stroke is black on white, 40 px long, at four places within a pixel. The error is the root mean
//! square over the pixels that either render touches, in 8-bit levels. Widths of 1 px and less take
//! another path in resvg, a hairline, which is why no drawing has them: see
//! [`MIN_WIDTH`](strokefit::scene::MIN_WIDTH).

use super::{Check, Extent, Observation};
use crate::report::Table;
use crate::report::picture::{self, heat};
use crate::report::plot::{Panel, Sheet, captioned};
use strokefit::coverage::Coverage;
use strokefit::fit::{Simd, final_softness};
use strokefit::image::Image;
use strokefit::math::{self, Point};
use strokefit::render::{Backdrop, Canvas, Grid, Renderer, Strokes};
use strokefit::scene::{Cap, MIN_WIDTH, Path, Scene, Stage, Stroke};
use strokefit::verify;
use strokefit::{Error, ErrorKind, Result};

const SIDE: usize = 56;
const LENGTH: f64 = 40.0;

/// Largest error, in levels, of a stroke that is drawn as it was fitted. resvg samples four rows per px, so an
/// edge along an axis may be off by half of such a step.
const MOST: f64 = 255.0 / 8.0;

/// Px of the picture per cell of the map.
const ZOOM: usize = 28;

/// The map: rows of widths, columns of angles.
#[derive(Debug, Clone)]
pub struct AgreementMap {
    widths: Vec<f64>,
    angles: Vec<f64>,
    /// At the very width, whatever resvg makes of it.
    raw: Vec<f64>,
    /// As a file of ours has it, which keeps widths at the least that is drawn well.
    written: Vec<f64>,
}

pub(super) fn checks(map: &AgreementMap) -> Vec<Check<'_>> {
    let check = |name: &'static str, what: &'static str, worst: f64, note: &'static str| {
        Check::new("agreement", name, what, move || {
            let figure = format!("at most {worst:.1} levels root mean square, bound {MOST:.1}");
            Ok(Observation::new(figure, worst <= MOST).excepting(note))
        })
    };
    let thin = |width: f64| width < MIN_WIDTH;
    vec![
        check(
            "widths",
            "soft render and resvg, widths from 1.02 to 5 px, angles 0 to 90°",
            map.worst(&map.raw, |width| !thin(width)),
            "",
        ),
        check(
            "thin-as-written",
            "widths below 1.02 px, widened as in a file",
            map.worst(&map.written, thin),
            "",
        ),
        check(
            "thin-as-they-are",
            "widths from 0.1 to 1 px, not widened",
            map.worst(&map.raw, thin),
            "resvg draws widths up to 1 px as a hairline with other ink; our files use at least 1.02 px",
        ),
    ]
}

impl AgreementMap {
    pub(super) fn new(extent: Extent) -> Result<Self> {
        let (widths, step): (&[f64], f64) = match extent {
            Extent::Short => (&[0.1, 0.5, 1.0, 1.02, 1.25, 1.5, 2.0, 3.0, 5.0], 15.0),
            Extent::Full => (
                &[
                    0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.02, 1.1, 1.25, 1.5, 1.75,
                    2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0,
                ],
                3.0,
            ),
        };
        let angles: Vec<f64> = (0..=(90.0 / step) as usize)
            .map(|i| i as f64 * step)
            .collect();
        let mut bench = Bench::new()?;
        let (mut raw, mut written) = (Vec::new(), Vec::new());
        for &width in widths {
            for &angle in &angles {
                raw.push(bench.error(width, angle, false)?);
                written.push(bench.error(width, angle, true)?);
            }
        }
        Ok(Self {
            widths: widths.to_vec(),
            angles,
            raw,
            written,
        })
    }

    fn worst(&self, errors: &[f64], of_width: impl Fn(f64) -> bool) -> f64 {
        let rows = self.widths.iter().zip(errors.chunks(self.angles.len()));
        let of_interest = rows.filter(|&(&width, _)| of_width(width));
        of_interest
            .flat_map(|(_, row)| row)
            .fold(0.0, |most, &e| e.max(most))
    }

    /// The map in numbers.
    pub fn table(&self) -> Table {
        let mut head = vec!["width_px".to_owned()];
        head.extend(
            self.angles
                .iter()
                .map(|angle| format!("rms_levels_at_{angle}_degrees")),
        );
        let mut table = Table::new(&head);
        for (width, row) in self.widths.iter().zip(self.raw.chunks(self.angles.len())) {
            let cells = std::iter::once(*width).chain(row.iter().copied());
            table.row(cells.map(|v| format!("{v:.2}")));
        }
        table
    }

    /// The map as a picture: widths downwards, angles to the right, left as they are, right as written.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there is no memory for it.
    pub fn picture(&self) -> Result<Image> {
        let most = self.raw.iter().fold(1.0_f64, |most, &e| most.max(e));
        let panel = |title: &str, errors: &[f64]| -> Result<Panel> {
            let image = picture::map(self.angles.len(), errors, |e| heat(e / most))?;
            Ok(Panel::new(title, image))
        };
        let sheet = Sheet {
            title: String::new(),
            columns: 2,
            zoom: ZOOM.min(14 * ZOOM / self.angles.len()).max(6),
            panels: vec![
                panel("as they are", &self.raw)?,
                panel("as written", &self.written)?,
            ],
        };
        let widths: Vec<String> = self.widths.iter().map(|w| w.to_string()).collect();
        captioned(
            &sheet.draw()?,
            &[
                format!("soft render against resvg, dark 0, yellow {most:.0} levels rms"),
                "across: angle, 0 to 90 degrees; down: width in px:".into(),
                widths.join(" "),
            ],
            CAPTION,
        )
    }
}

/// Least width of the picture, px, so that its caption fits.
const CAPTION: usize = 460;

/// Draws one stroke in both ways.
struct Bench {
    renderer: Renderer,
    canvas: Canvas,
}

impl Bench {
    fn new() -> Result<Self> {
        let level = Simd::Auto.level().ok_or_else(|| {
            Error::new(
                ErrorKind::Config,
                "this machine has no instruction set: use another",
            )
        })?;
        let grid = Grid::new(SIDE, SIDE);
        Ok(Self {
            renderer: Renderer::new(grid, level),
            canvas: Canvas::flat(grid, [1.0; 3]),
        })
    }

    /// The root mean square error over four places, levels.
    fn error(&mut self, width: f64, angle: f64, as_written: bool) -> Result<f64> {
        let (mut sum, mut touched) = (0.0, 0.0);
        for (dx, dy) in [(0.0, 0.0), (0.3, 0.1), (0.5, 0.5), (0.8, 0.6)] {
            let mut stroke = stroke(
                [SIDE as f64 / 2.0 + dx, SIDE as f64 / 2.0 + dy],
                width,
                angle,
            );
            if as_written {
                stroke = rounded(&stroke);
            }
            let ours = self.soft(&stroke);
            let theirs = verify::render(&text(&stroke), verify::Size::Scale(1.0), Some([1.0; 3]))?;
            for (&a, &b) in ours.planes()[0].iter().zip(&theirs.planes()[0]) {
                if a < 1.0 || b < 1.0 {
                    sum += math::powi(f64::from(a - b), 2);
                    touched += 1.0;
                }
            }
        }
        Ok(255.0 * (sum / f64::max(touched, 1.0)).sqrt())
    }

    fn soft(&mut self, stroke: &Stroke) -> Image {
        let edge = final_softness(Coverage::Smoothstep);
        let backdrop = Backdrop::Color([1.0; 3]);
        let strokes = Strokes::from_iter([stroke]);
        self.renderer
            .forward(&strokes, edge, backdrop, &mut self.canvas);
        self.canvas.to_image()
    }
}

/// A black stroke about a centre.
fn stroke([x, y]: [f64; 2], width: f64, angle: f64) -> Stroke {
    let (sin, cos) = math::sin_cos(angle.to_radians());
    let (dx, dy) = (cos * LENGTH / 2.0, sin * LENGTH / 2.0);
    Stroke {
        path: Path::line(Point::new(x - dx, y - dy), Point::new(x + dx, y + dy)),
        radius: width / 2.0,
        cap: Cap::Round,
        color: [0.0; 3],
        opacity: 1.0,
    }
}

/// The stroke as a file of ours says it.
fn rounded(stroke: &Stroke) -> Stroke {
    let stage = Stage::from_iter([stroke.clone()]);
    let scene = Scene {
        stages: vec![stage],
        ..Scene::empty(SIDE as u32, SIDE as u32, None)
    };
    let written = scene.quantized(2).scene;
    written.strokes().next().unwrap_or(stroke).clone()
}

/// The stroke as SVG, at its very width.
fn text(stroke: &Stroke) -> String {
    let (a, b) = stroke.path.ends();
    let width = 2.0 * stroke.radius;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{SIDE}\" height=\"{SIDE}\">\
         <path d=\"M{} {}L{} {}\" fill=\"none\" stroke=\"#000000\" stroke-width=\"{width}\" \
         stroke-linecap=\"round\"/></svg>",
        a.x, a.y, b.x, b.y
    )
}
