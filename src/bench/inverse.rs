//! Drawings of known strokes, and what is found of them in their pictures.
//!
//! The picture of a drawing is rendered at four times its size and averaged, so that it has the drawing's true edges
//! rather than those of the judge.

use crate::error::{Error, ErrorKind, Result};
use crate::fit::{Config, Fitter};
use crate::image::{Image, Limits};
use crate::math::Point;
use crate::report::inverse::{Inventory, InverseEntry, InverseReport};
use crate::verify::{self, CentreLines, Size, centre_lines};

/// A drawing of known strokes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// What lines of the report call it.
    pub name: String,
    /// SVG text.
    pub svg: String,
}

/// What pictures are made of each drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pictures {
    /// Their longer sides, px.
    pub sides: Vec<u16>,
    /// The qualities of the JPEG that they go through; `None` for clean ones.
    pub qualities: Vec<Option<u8>>,
}

impl Pictures {
    /// From small to large, clean and as JPEG of quality 75.
    pub fn full() -> Self {
        Self {
            sides: vec![48, 96, 192, 384],
            qualities: vec![None, Some(75)],
        }
    }

    /// Clean ones of one size.
    pub fn short() -> Self {
        Self {
            sides: vec![96],
            qualities: vec![None],
        }
    }
}

/// Lines that cross, loops, colours over each other, and translucent strokes.
pub fn own() -> Vec<Drawing> {
    let drawing = |name: &str, strokes: &str| Drawing {
        name: name.to_owned(),
        svg: format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24" fill="none" stroke-linecap="round" stroke-linejoin="round">{strokes}</svg>"#
        ),
    };
    vec![
        drawing(
            "crossings",
            r##"<g stroke="#203040" stroke-width="1.5"><path d="M2 5L22 19"/><path d="M3 20L21 4"/><path d="M12 2V22"/></g>"##,
        ),
        drawing(
            "loops",
            r##"<path d="M2 18C8 2 16 2 12 10S4 14 10 18S22 14 22 6" stroke="#803020" stroke-width="1.6"/>"##,
        ),
        drawing(
            "colours",
            r##"<path d="M3 12C8 2 16 22 21 12" stroke="#d03020" stroke-width="2"/><path d="M4 4L20 20" stroke="#2060c0" stroke-width="2.4"/><circle cx="12" cy="12" r="8" stroke="#20a050" stroke-width="1.6"/>"##,
        ),
        drawing(
            "translucent",
            r##"<path d="M3 8H21" stroke="#c02080" stroke-opacity="0.6" stroke-width="4"/><path d="M8 3V21" stroke="#2080c0" stroke-opacity="0.6" stroke-width="4"/>"##,
        ),
    ]
}

/// Fits the pictures of all drawings, telling each entry as it comes, and each found file.
///
/// # Errors
/// - [`ErrorKind::Svg`] when a drawing is no SVG or has no stroke; the message names it.
/// - As [`Fitter::fit`].
pub fn run(
    drawings: &[Drawing],
    pictures: &Pictures,
    config: &Config,
    tell: &mut dyn FnMut(&InverseEntry, &str),
) -> Result<InverseReport> {
    let mut entries = Vec::new();
    for &quality in &pictures.qualities {
        for &side in &pictures.sides {
            for drawing in drawings {
                let (entry, svg) = measure(drawing, side, quality, config)
                    .map_err(|error| error.within(&drawing.name))?;
                tell(&entry, &svg);
                entries.push(entry);
            }
        }
    }
    Ok(InverseReport::new(entries))
}

fn measure(
    drawing: &Drawing,
    side: u16,
    jpeg: Option<u8>,
    config: &Config,
) -> Result<(InverseEntry, String)> {
    let own = verify::render(&drawing.svg, Size::Scale(1.0), None)?;
    let scale = f32::from(side) / own.width().max(own.height()) as f32;
    let original = centre_lines(&drawing.svg, scale)?;
    if original.is_empty() {
        let message = "no element has a stroke, so that nothing could be found again: give drawings of strokes";
        return Err(Error::new(ErrorKind::Svg, message));
    }
    let picture = picture(&drawing.svg, scale, jpeg)?;
    let began = std::time::Instant::now();
    let fit = Fitter::new(config.clone()).fit(&picture)?;
    let wall_s = began.elapsed().as_secs_f64();
    let svg = fit.svg();
    let found = centre_lines(&svg, 1.0)?;
    let distances = Distances::between(&original, &found);
    let inventory = |lines: &[CentreLines], bytes: usize| Inventory {
        elements: lines.len(),
        points: lines.iter().map(|lines| lines.points).sum(),
        bytes,
    };
    let entry = InverseEntry {
        drawing: drawing.name.clone(),
        side_px: usize::from(side),
        jpeg,
        original: inventory(&original, drawing.svg.len()),
        found: inventory(&found, svg.len()),
        psnr_db: verify::fidelity(&svg, &picture)?.psnr_db,
        mean_px: distances.mean,
        largest_px: distances.largest,
        wall_s,
    };
    Ok((entry, svg))
}

/// The picture of a drawing on white.
fn picture(svg: &str, scale: f32, jpeg: Option<u8>) -> Result<Image> {
    let large = verify::render(svg, Size::Scale(f64::from(4.0 * scale)), Some([1.0; 3]))?;
    let picture = large.halved().halved();
    match jpeg {
        None => Ok(picture),
        Some(quality) => Image::decode(&picture.encode_jpeg(quality)?, "JPEG", Limits::default()),
    }
}

/// Distances between two sets of centre lines, px: of places on either to the nearest place on the other.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Distances {
    mean: f64,
    largest: f64,
}

impl Distances {
    fn between(a: &[CentreLines], b: &[CentreLines]) -> Self {
        let (a, b) = (chords(a), chords(b));
        let mut all: Vec<f64> = Vec::new();
        for (from, to) in [(&a, &b), (&b, &a)] {
            all.extend(from.iter().flat_map(places).map(|p| nearest(p, to)));
        }
        Self {
            mean: all.iter().sum::<f64>() / all.len().max(1) as f64,
            largest: all.iter().copied().fold(0.0, f64::max),
        }
    }
}

fn chords(elements: &[CentreLines]) -> Vec<[Point; 2]> {
    let lines = elements.iter().flat_map(|element| &element.lines);
    let chords = lines.flat_map(|line| match line[..] {
        [dot] => vec![[dot, dot]],
        _ => line.windows(2).map(|w| [w[0], w[1]]).collect(),
    });
    chords.collect()
}

/// Places half a px apart.
fn places([a, b]: &[Point; 2]) -> impl Iterator<Item = Point> {
    let (a, way) = (*a, b - a);
    let count = (2.0 * way.norm()).ceil().max(1.0);
    (0..count as usize).map(move |i| a + way * (i as f32 / count))
}

fn nearest(p: Point, chords: &[[Point; 2]]) -> f64 {
    let to = |[a, b]: &[Point; 2]| {
        let way = b - a;
        let h = (p - a).dot(&way) / way.norm_squared().max(f32::MIN_POSITIVE);
        (a + way * h.clamp(0.0, 1.0) - p).norm()
    };
    f64::from(chords.iter().map(to).fold(f32::INFINITY, f32::min))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f32; 2]]) -> CentreLines {
        CentreLines {
            lines: vec![points.iter().map(|&[x, y]| Point::new(x, y)).collect()],
            points: points.len(),
        }
    }

    #[test]
    fn distances_are_both_ways() {
        let a = [line(&[[0.0, 0.0], [10.0, 0.0]])];
        let b = [line(&[[0.0, 3.0], [10.0, 3.0]])];
        let apart = Distances::between(&a, &b);
        assert_eq!((apart.mean, apart.largest), (3.0, 3.0));
        // All of the longer one is far from the shorter one, though not the other way round.
        let longer = [line(&[[0.0, 0.0], [20.0, 0.0]])];
        for apart in [
            Distances::between(&a, &longer),
            Distances::between(&longer, &a),
        ] {
            assert!(apart.largest > 9.0 && apart.mean < 5.0, "{apart:?}");
        }
    }

    #[test]
    fn pictures_have_the_size_asked_for() {
        for drawing in own() {
            let picture = picture(&drawing.svg, 2.0, Some(75)).unwrap();
            assert_eq!((picture.width(), picture.height()), (48, 48));
        }
    }

    #[test]
    fn a_drawing_without_strokes_is_refused_by_name() {
        let drawing = Drawing {
            name: "blank".into(),
            svg: r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>"#.into(),
        };
        let error = run(
            &[drawing],
            &Pictures::short(),
            &Config::default(),
            &mut |_, _| (),
        );
        let words = error.unwrap_err().to_string();
        assert!(
            words.starts_with("blank: ") && words.contains("stroke"),
            "{words}"
        );
    }
}
