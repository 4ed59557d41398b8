//! Sheets: pictures side by side, with titles, captions and overlaid lines.

use std::fmt::Display;

use plotters::prelude::*;

use super::{Drawn, FONT, Root, draw};
use strokefit::image::Image;
use strokefit::math;
use strokefit::{Error, ErrorKind, Result};

/// A line over a picture.
#[derive(Debug, Clone)]
pub struct Path {
    /// In px of the picture; its first pixel's centre is (½, ½).
    pub points: Vec<[f64; 2]>,
    /// 8-bit RGB.
    pub color: [u8; 3],
    /// True if it ends in an arrow's head.
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
    /// Number of panels in a row.
    pub columns: usize,
    /// Px of the sheet per px of a picture.
    pub zoom: usize,
    /// Row by row; all pictures are as large as the first.
    pub panels: Vec<Panel>,
}

const MARGIN: usize = 8;
const LINE: usize = 20;

impl Sheet {
    /// Rows of panels of one size, several beside each other while there are at most `columns` panels. A short row ends in
    /// gaps.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there is no panel.
    pub fn of_rows(rows: Vec<Vec<Panel>>, columns: usize) -> Result<Self> {
        let widest = rows.iter().map(Vec::len).max().unwrap_or_default();
        let Some(first) = rows.iter().flatten().next() else {
            return Err(Error::new(ErrorKind::Picture, "a sheet needs a picture"));
        };
        let blank = Image::filled(first.image.width(), first.image.height(), [1.0; 3])?;
        let mut panels = Vec::new();
        for mut row in rows {
            row.resize_with(widest, || Panel::new("", blank.clone()));
            panels.append(&mut row);
        }
        Ok(Self {
            title: String::new(),
            columns: (columns / widest).max(1) * widest,
            zoom: 1,
            panels,
        })
    }

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

/// The picture in the middle of a white square, cut to its size.
///
/// # Errors
/// [`ErrorKind::Picture`] when there is no memory for it.
pub fn framed(picture: &Image, side_px: usize) -> Result<Image> {
    let (width, height) = (picture.width(), picture.height());
    let (left, top) = (
        side_px.saturating_sub(width) / 2,
        side_px.saturating_sub(height) / 2,
    );
    let plane = |c: usize| {
        let at = |i: usize| {
            let (x, y) = (
                (i % side_px).checked_sub(left),
                (i / side_px).checked_sub(top),
            );
            match (x.filter(|x| *x < width), y.filter(|y| *y < height)) {
                (Some(x), Some(y)) => picture.planes()[c][y * width + x],
                _ => 1.0,
            }
        };
        (0..side_px * side_px).map(at).collect()
    };
    Image::new(side_px, side_px, [0, 1, 2].map(plane))
}

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
    let length = math::hypot(dx, dy).max(1e-9);
    let (ux, uy) = (dx / length * size, dy / length * size);
    let wing = |side: f64| [tip[0] - ux + side * uy / 2.0, tip[1] - uy - side * ux / 2.0];
    [wing(1.0), tip, wing(-1.0)]
}

#[cfg(test)]
mod tests {
    use strokefit::animation::{Film, Legend, Step};
    use strokefit::scene::{self, Scene, Stroke};

    use super::super::is_dark;
    use super::*;

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

    /// The letters of the captions of animations, 8 px each.
    #[test]
    fn letters_of_captions_are_those_of_the_font() {
        let letters = "0123456789.,strokedBinfa";
        let blank = Image::filled(8 * letters.len(), LINE, [1.0; 3]).unwrap();
        let drawn = draw(blank, |root| {
            for (i, letter) in letters.char_indices() {
                label(root, &letter.to_string(), (8 * i, 3), 13)?;
            }
            Ok(())
        });
        let drawn = drawn.unwrap();
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../src/animation/letters.png");
        if std::env::var_os("STROKEFIT_WRITE_LETTERS").is_some() {
            std::fs::write(path, drawn.encode_png().unwrap()).unwrap();
        }
        assert!(Image::open(path).unwrap() == drawn);
    }

    #[test]
    fn captions_of_animations_are_set_as_labels_are() {
        for count in [0, 1, 26, 345, 1789] {
            let scene = dots(count);
            let film = Film {
                step: Some(Step::Stage),
                legend: Legend::Strokes,
                scale: 1.0,
            };
            let frame = film.frames(&scene).last().unwrap().unwrap();
            let picture = frame.cropped(12, 9).unwrap();
            // The same words under the picture.
            let blank = Image::filled(frame.width(), 9 + LINE, [1.0; 3]).unwrap();
            let mut planes = blank.planes().clone();
            blit(&mut planes, frame.width(), (0, 0), &picture, 1);
            let expected = Image::new(frame.width(), 9 + LINE, planes).unwrap();
            let words = scene.counted();
            let expected = draw(expected, |root| label(root, &words, (4, 9 + 3), 13));
            // Where letters touch, one rounds down what the other rounds to the nearest.
            let (drawn, expected) = (frame.to_rgb8(), expected.unwrap().to_rgb8());
            let mut levels = drawn.iter().zip(&expected);
            assert!(levels.all(|(a, b)| a.abs_diff(*b) <= 1), "{count}");
        }
    }

    fn dots(count: usize) -> Scene {
        let stroke = |i: usize| Stroke {
            path: scene::Path::dot(((i % 12) as f64, (i % 9) as f64).into()),
            radius: 0.8,
            radii: Vec::new(),
            cap: scene::Cap::Round,
            color: [0.4; 3],
            opacity: 0.5,
        };
        let stage = (0..count).map(stroke).collect();
        Scene {
            stages: vec![stage],
            ..Scene::empty(12, 9, Some([1.0; 3]))
        }
    }
}
