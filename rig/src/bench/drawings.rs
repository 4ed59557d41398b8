//! Known drawings, and the pictures that are made of them.
//!
//! The picture of a drawing is rendered at four times its size and averaged, so that it has the drawing's true edges
//! rather than those of the judge.

use super::elements::{Element, elements};
use crate::report::Damage;
use strokefit::image::Image;
use strokefit::verify::{self, Size};
use strokefit::{Error, ErrorKind, Result};

/// A drawing, and so what is to be found again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// Name in lines of the report. What comes before `__` is that of its family.
    pub name: String,
    /// SVG text.
    pub svg: String,
}

/// Kind of a drawing, and so of what is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Strokes alone, whose centre lines are to be found again.
    Strokes,
    /// Anything else: filled shapes, with strokes or without.
    Shapes,
}

impl Drawing {
    /// The kind of the drawing.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`] when it is no SVG, or nothing is painted; the message names it.
    pub fn kind(&self) -> Result<Kind> {
        let painted = elements(&self.svg, 1.0).map_err(|error| error.within(&self.name))?;
        if painted.is_empty() {
            let message =
                "nothing is painted, so that nothing could be found again: give another drawing";
            return Err(Error::new(ErrorKind::Svg, message).within(&self.name));
        }
        let is_stroke = |element: &Element| element.width_px.is_some() && !element.filled;
        Ok(if painted.iter().all(is_stroke) {
            Kind::Strokes
        } else {
            Kind::Shapes
        })
    }

    /// The beginning of its name that it shares with others, or nothing.
    pub(super) fn family(&self) -> &str {
        self.name.split_once("__").map_or("", |(family, _)| family)
    }
}

/// Pictures that are made of each drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pictures {
    /// Their longer sides, px.
    pub sides: Vec<u16>,
    /// Their damages.
    pub damages: Vec<Damage>,
}

impl Pictures {
    /// All pictures of drawings of a kind, from small to large, clean and damaged.
    pub fn full(kind: Kind) -> Self {
        match kind {
            Kind::Strokes => Self {
                sides: vec![48, 96, 192, 384],
                damages: vec![Damage::Clean, Damage::Jpeg(75)],
            },
            Kind::Shapes => Self {
                sides: vec![128, 256, 512],
                damages: vec![Damage::Clean, Damage::Jpeg(75), Damage::Noise(8)],
            },
        }
    }

    /// Clean ones of one size.
    pub fn short(kind: Kind) -> Self {
        Self {
            sides: match kind {
                Kind::Strokes => vec![96],
                Kind::Shapes => vec![128],
            },
            damages: vec![Damage::Clean],
        }
    }
}

/// The picture of a drawing on white, its longer side as many px.
pub(super) fn picture(svg: &str, side: u16) -> Result<Image> {
    let own = verify::render(svg, Size::Scale(1.0), None)?;
    let scale = f64::from(side) / own.width().max(own.height()) as f64;
    let large = verify::render(svg, Size::Scale(4.0 * scale), Some([1.0; 3]))?;
    Ok(large.halved().halved())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(body: &str) -> Drawing {
        Drawing {
            name: "a__b".into(),
            svg: format!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24">{body}</svg>"#
            ),
        }
    }

    const LINE: &str = r#"<path d="M2 2L20 8" fill="none" stroke="red"/>"#;

    #[test]
    fn strokes_are_told_from_shapes() {
        let area = r#"<path d="M2 2h9v9"/>"#;
        assert_eq!(drawing(LINE).kind().unwrap(), Kind::Strokes);
        assert_eq!(drawing(area).kind().unwrap(), Kind::Shapes);
        let both = format!("{LINE}{area}");
        assert_eq!(drawing(&both).kind().unwrap(), Kind::Shapes);
        let outlined = r#"<path d="M2 2h9v9" stroke="red"/>"#;
        assert_eq!(drawing(outlined).kind().unwrap(), Kind::Shapes);
    }

    #[test]
    fn a_drawing_of_nothing_is_refused_by_name() {
        let words = drawing("").kind().unwrap_err().to_string();
        assert!(words.starts_with("a__b: nothing is painted"), "{words}");
    }

    #[test]
    fn pictures_have_the_size_asked_for() {
        let picture = picture(&drawing(LINE).svg, 48).unwrap();
        assert_eq!((picture.width(), picture.height()), (48, 48));
    }
}
