//! Charts of numbers and sheets of pictures, drawn into pictures. The one door of `plotters`.
//!
//! Text is set in a font that is part of the program, so plots look the same on every machine.

use std::fmt::Display;
use std::sync::OnceLock;

use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::picture;
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;

const FONT: &str = "lab";

/// Colours that are told apart with any kind of colour vision: Okabe & Ito, "Color universal
/// design", 2008, and a brown.
const SERIES: [RGBColor; 9] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(150, 150, 150),
    RGBColor(110, 60, 20),
];

/// Numbers over numbers, as lines.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// Above the chart.
    pub title: String,
    /// Below the horizontal axis, and beside the vertical one.
    pub axes: [String; 2],
    /// Whether the vertical axis is logarithmic; values ≤ 0 are then left out.
    pub logarithmic: bool,
    /// The lines, with their legends.
    pub series: Vec<(String, Vec<[f64; 2]>)>,
}

impl Chart {
    /// The courses of several descents, on a logarithmic axis: names, and the loss at each step.
    pub fn of_losses<'a>(
        title: &str,
        descents: impl IntoIterator<Item = (String, &'a [f64])>,
    ) -> Self {
        let points = |losses: &[f64]| {
            let steps = losses.iter().enumerate();
            steps.map(|(step, &loss)| [step as f64, loss]).collect()
        };
        let series = descents.into_iter();
        Self {
            title: title.into(),
            axes: ["step".into(), "loss".into()],
            logarithmic: true,
            series: series
                .map(|(name, losses)| (name, points(losses)))
                .collect(),
        }
    }

    /// The chart as a picture of 760 × 460 px.
    ///
    /// # Errors
    /// As [`draw_sized`](Self::draw_sized).
    pub fn draw(&self) -> Result<Image> {
        self.draw_sized(760, 460)
    }

    /// The chart as a picture of `width × height` px.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there is no room for it.
    pub fn draw_sized(&self, width: usize, height: usize) -> Result<Image> {
        let series = self.points();
        let all = || series.iter().flat_map(|(_, points)| points.iter());
        let [x, y] = [0, 1].map(|k| span(all().map(|p| p[k])));
        draw(Image::filled(width, height, [1.0; 3])?, |root| {
            let mut chart = ChartBuilder::on(root)
                .caption(&self.title, (FONT, 16))
                .margin(10)
                .margin_right(24)
                .x_label_area_size(40)
                .y_label_area_size(70)
                .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
            let label = |v: &f64| self.label(*v);
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .x_desc(&self.axes[0])
                .y_desc(&self.axes[1])
                .x_label_formatter(&|x| format!("{x}"))
                .y_label_formatter(&label)
                .label_style((FONT, 13))
                .draw()?;
            for ((name, points), color) in series.iter().zip(SERIES.iter().cycle()) {
                let points = points.iter().map(|&[x, y]| (x, y));
                chart
                    .draw_series(LineSeries::new(points, color.stroke_width(2)))?
                    .label(*name)
                    .legend(move |(x, y)| {
                        PathElement::new([(x, y), (x + 18, y)], color.stroke_width(3))
                    });
            }
            chart
                .configure_series_labels()
                .position(if self.logarithmic {
                    SeriesLabelPosition::UpperRight // the corner that falling losses leave free
                } else {
                    SeriesLabelPosition::MiddleRight
                })
                .background_style(WHITE.mix(0.85))
                .border_style(BLACK.mix(0.3))
                .label_font((FONT, 13))
                .draw()?;
            Ok(())
        })
    }

    /// The series as they are drawn: on a logarithmic axis as logarithms.
    fn points(&self) -> Vec<(&str, Vec<[f64; 2]>)> {
        let drawn = |&[x, y]: &[f64; 2]| {
            let y = if self.logarithmic { y.log10() } else { y };
            (x.is_finite() && y.is_finite()).then_some([x, y])
        };
        let series = self.series.iter();
        series
            .map(|(name, points)| (name.as_str(), points.iter().filter_map(drawn).collect()))
            .collect()
    }

    fn label(&self, v: f64) -> String {
        if self.logarithmic {
            format!("{:.1e}", 10_f64.powf(v))
        } else {
            format!("{v:.3}")
        }
    }
}

/// Least and greatest of `values`, apart by something.
fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let around = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), around);
    match high - low {
        width if width > 0.0 && width.is_finite() => (low, high),
        _ if low.is_finite() => (low - 0.5, low + 0.5),
        _ => (0.0, 1.0),
    }
}

/// A line over a picture.
#[derive(Debug, Clone)]
pub struct Path {
    /// In px of the picture; its first pixel's centre is (½, ½).
    pub points: Vec<[f64; 2]>,
    /// 8-bit RGB.
    pub color: [u8; 3],
    /// Whether it ends in an arrow's head.
    pub arrow: bool,
}

/// A picture with a title and lines over it.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Above the picture.
    pub title: String,
    /// The picture.
    pub image: Image,
    /// Lines over it.
    pub paths: Vec<Path>,
}

impl Panel {
    /// A picture without lines.
    pub fn new(title: impl Display, image: Image) -> Self {
        Self {
            title: title.to_string(),
            image,
            paths: Vec::new(),
        }
    }
}

/// Pictures side by side, enlarged.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Above all of them; nothing when empty.
    pub title: String,
    /// How many in a row.
    pub columns: usize,
    /// Px of the sheet per px of a picture.
    pub zoom: usize,
    /// Row by row; all pictures are as large as the first.
    pub panels: Vec<Panel>,
}

const MARGIN: usize = 8;
/// Least width of a picture with a caption, px: some 46 letters.
const CAPTION: usize = 380;
const LINE: usize = 20;

impl Sheet {
    /// The sheet as a picture.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there is no panel, or memory for no such picture.
    pub fn draw(&self) -> Result<Image> {
        let Some(first) = self.panels.first() else {
            return Err(Error::new(ErrorKind::Picture, "a sheet needs a picture"));
        };
        let (width, height) = (
            first.image.width() * self.zoom,
            first.image.height() * self.zoom,
        );
        let columns = self.columns.clamp(1, self.panels.len());
        let rows = self.panels.len().div_ceil(columns);
        let head = if self.title.is_empty() { 0 } else { LINE };
        let origin = |i: usize| {
            let (column, row) = (i % columns, i / columns);
            let x = MARGIN + column * (width + MARGIN);
            (x, MARGIN + head + row * (height + LINE + MARGIN) + LINE)
        };
        let whole = Image::filled(
            MARGIN + columns * (width + MARGIN),
            MARGIN + head + rows * (height + LINE + MARGIN),
            [1.0; 3],
        )?;
        let mut planes = whole.planes().clone();
        for (i, panel) in self.panels.iter().enumerate() {
            blit(
                &mut planes,
                whole.width(),
                origin(i),
                &panel.image,
                self.zoom,
            );
        }
        let whole = Image::new(whole.width(), whole.height(), planes)?;
        draw(whole, |root| {
            label(root, &self.title, (MARGIN, MARGIN), 15)?;
            for (i, panel) in self.panels.iter().enumerate() {
                let (x, y) = origin(i);
                label(root, &panel.title, (x, y - LINE + 4), 13)?;
                for path in &panel.paths {
                    draw_path(root, path, (x, y), self.zoom)?;
                }
            }
            Ok(())
        })
    }
}

/// Copies `image`, enlarged, into `planes` of rows of `width`.
fn blit(
    planes: &mut [Vec<f32>; 3],
    width: usize,
    (x0, y0): (usize, usize),
    image: &Image,
    zoom: usize,
) {
    for (to, from) in planes.iter_mut().zip(image.planes()) {
        for y in 0..image.height() * zoom {
            let row = &from[y / zoom * image.width()..][..image.width()];
            let start = (y0 + y) * width + x0;
            for (x, to) in to[start..][..image.width() * zoom].iter_mut().enumerate() {
                *to = row[x / zoom];
            }
        }
    }
}

/// The picture with lines of text beneath it.
///
/// # Errors
/// [`ErrorKind::Picture`] when there is no memory for it.
pub fn captioned(image: &Image, lines: &[String]) -> Result<Image> {
    let (width, height) = (image.width().max(CAPTION), image.height());
    let whole = Image::filled(width, height + lines.len() * LINE, [1.0; 3])?;
    let mut planes = whole.planes().clone();
    blit(&mut planes, width, (0, 0), image, 1);
    let whole = Image::new(width, whole.height(), planes)?;
    draw(whole, |root| {
        for (i, line) in lines.iter().enumerate() {
            label(root, line, (4, height + i * LINE + 3), 13)?;
        }
        Ok(())
    })
}

type Root<'a> = DrawingArea<BitMapBackend<'a>, plotters::coord::Shift>;
type Drawn = std::result::Result<(), Box<dyn std::error::Error + Send + Sync>>;

fn label(root: &Root<'_>, text: &str, (x, y): (usize, usize), size: i32) -> Drawn {
    let at = (x as i32, y as i32);
    root.draw(&Text::new(text, at, (FONT, size)))?;
    Ok(())
}

fn draw_path(root: &Root<'_>, path: &Path, (x0, y0): (usize, usize), zoom: usize) -> Drawn {
    let [r, g, b] = path.color;
    let style = RGBColor(r, g, b).stroke_width(1);
    let zoom = zoom as f64;
    let at = |p: &[f64; 2]| {
        (
            x0 as i32 + (p[0] * zoom) as i32,
            y0 as i32 + (p[1] * zoom) as i32,
        )
    };
    let points: Vec<_> = path.points.iter().map(at).collect();
    root.draw(&PathElement::new(points, style))?;
    if let (true, [.., from, tip]) = (path.arrow, path.points.as_slice()) {
        let wings = wings(*from, *tip, 5.0 / zoom);
        root.draw(&PathElement::new(wings.map(|p| at(&p)).to_vec(), style))?;
    }
    Ok(())
}

/// The head of an arrow: two wings of `size` px with the tip between them.
fn wings(from: [f64; 2], tip: [f64; 2], size: f64) -> [[f64; 2]; 3] {
    let (dx, dy) = (tip[0] - from[0], tip[1] - from[1]);
    let length = dx.hypot(dy).max(1e-9);
    let (ux, uy) = (dx / length * size, dy / length * size);
    let wing = |side: f64| [tip[0] - ux + side * uy / 2.0, tip[1] - uy - side * ux / 2.0];
    [wing(1.0), tip, wing(-1.0)]
}

/// Runs `f` on a drawing area that is the picture.
fn draw(image: Image, f: impl FnOnce(&Root<'_>) -> Drawn) -> Result<Image> {
    register()?;
    let (width, height) = (image.width(), image.height());
    let mut rgb = image.to_rgb8();
    {
        let backend = BitMapBackend::with_buffer(&mut rgb, (width as u32, height as u32));
        let root = backend.into_drawing_area();
        f(&root)
            .and_then(|()| Ok(root.present()?))
            .map_err(|cause| {
                let message = format!("cannot draw a plot of {width}×{height} px: {cause}");
                Error::new(ErrorKind::Picture, message).caused_by(cause)
            })?;
    }
    let (pixels, _) = rgb.as_chunks::<3>();
    picture::map(width, pixels, |pixel| {
        pixel.map(|byte| f64::from(byte) / 255.0)
    })
}

/// Makes the font known, once.
fn register() -> Result<()> {
    static KNOWN: OnceLock<bool> = OnceLock::new();
    let known = KNOWN.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, epaint_default_fonts::HACK_REGULAR).is_ok()
    });
    if *known {
        Ok(())
    } else {
        Err(Error::new(
            ErrorKind::Picture,
            "the font of the plots cannot be read",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_dark(image: &Image, x: std::ops::Range<usize>, y: std::ops::Range<usize>) -> bool {
        let dark = |x, y| image.planes()[0][y * image.width() + x] < 0.5;
        y.into_iter().any(|y| x.clone().any(|x| dark(x, y)))
    }

    #[test]
    fn charts_have_text_and_lines_on_any_machine() {
        let chart = Chart {
            title: "loss".into(),
            axes: ["step".into(), "loss".into()],
            logarithmic: true,
            series: vec![("a".into(), vec![[0.0, 1.0], [1.0, 0.1], [2.0, 0.0]])],
        };
        let image = chart.draw_sized(400, 300).unwrap();
        assert!(is_dark(&image, 0..400, 0..35), "no title");
        assert!(is_dark(&image, 80..390, 60..240), "no lines");
    }

    #[test]
    fn a_chart_of_nothing_is_empty_axes() {
        assert!(Chart::default().draw_sized(300, 200).is_ok());
        assert!(Chart::default().draw_sized(0, 200).is_err());
    }

    #[test]
    fn sheets_show_their_panels_enlarged() {
        let black = Image::filled(4, 3, [0.0; 3]).unwrap();
        let white = Image::filled(4, 3, [1.0; 3]).unwrap();
        let mut panel = Panel::new("", black);
        panel.paths.push(Path {
            points: vec![[0.5, 0.5], [3.5, 2.5]],
            color: [255, 0, 0],
            arrow: true,
        });
        let sheet = Sheet {
            title: String::new(),
            columns: 2,
            zoom: 5,
            panels: vec![panel, Panel::new("", white)],
        };
        let image = sheet.draw().unwrap();
        assert_eq!((image.width(), image.height()), (8 + 2 * 28, 8 + 15 + 28));
        assert!(is_dark(&image, 8..28, 28..43));
        assert!(!is_dark(&image, 36..56, 28..43));
        let red = image.planes()[0].iter().zip(&image.planes()[1]);
        assert!(red.clone().any(|(&r, &g)| r > 0.9 && g < 0.1), "no arrow");
    }

    #[test]
    fn captions_are_written_beneath() {
        let white = Image::filled(60, 30, [1.0; 3]).unwrap();
        let image = captioned(&white, &["step 1".into()]).unwrap();
        assert_eq!((image.width(), image.height()), (CAPTION, 50));
        assert!(is_dark(&image, 0..60, 30..50));
    }
}
