//! The widths of given pens, on a page and in px of the picture.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::image::Image;
use crate::scene::MIN_WIDTH;
use crate::svg::Length;
use crate::words::from_text;

/// The widths of a plotter's pens, one of which each stroke has.
#[derive(Debug, Clone, PartialEq)]
pub struct Widths(Vec<Width>);

/// The width of a pen.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Width {
    /// In px of the picture.
    Px(f64),
    /// On the page.
    OnPage(Length),
}

impl Widths {
    /// Most pens that can be given.
    pub const MAX: usize = 64;

    /// The radii of the pens, px of the picture, on a page of this width; the thinnest comes first.
    ///
    /// # Errors
    /// [`ErrorKind::Config`](crate::ErrorKind::Config) when a pen is too thin or too wide for the picture, or the page has no width.
    pub fn radii(&self, page: Option<Length>, picture: &Image) -> Result<Vec<f32>> {
        let radius = |width: &Width| width.px(page, picture).map(|px| (px / 2.0) as f32);
        let mut radii: Vec<f32> = self.0.iter().map(radius).collect::<Result<_>>()?;
        radii.sort_by(f32::total_cmp);
        radii.dedup();
        Ok(radii)
    }
}

impl Width {
    /// In px of the picture, if renderers agree on a stroke of this width and the picture has room for it.
    fn px(self, page: Option<Length>, picture: &Image) -> Result<f64> {
        let sides = [picture.width() as f64, picture.height() as f64];
        let px = match (self, page) {
            (Self::Px(px), _) => px,
            (Self::OnPage(length), Some(page)) => length.px() / page.px() * sides[0],
            (Self::OnPage(_), None) => {
                return Err(Error::config(format!(
                    "the pen {self} needs a page of known width: give that, such as 120mm, or pens in px of the picture"
                )));
            }
        };
        if px < MIN_WIDTH {
            let enough = (sides[0] * MIN_WIDTH / px).ceil();
            return Err(Error::config(match self {
                Self::Px(_) => {
                    format!("the pen {self} is thinner than a stroke: give {MIN_WIDTH} px or more")
                }
                Self::OnPage(_) => format!(
                    "the pen {self} is {px:.2} px of the picture wide, and a stroke {MIN_WIDTH} px or more: enlarge the \
                     picture to a width of {enough} px, or give a wider pen"
                ),
            }));
        }
        if px > sides[0].max(sides[1]) {
            return Err(Error::config(format!(
                "the pen {self} is wider than the picture, {px:.0} px: give a thinner one"
            )));
        }
        Ok(px)
    }
}

impl fmt::Display for Width {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Px(px) => write!(f, "{px}"),
            Self::OnPage(length) => write!(f, "{length}"),
        }
    }
}

impl FromStr for Width {
    type Err = Error;

    /// A length such as `0.3mm`, or a number of px of the picture.
    fn from_str(text: &str) -> Result<Self> {
        let px = text
            .parse()
            .ok()
            .filter(|px: &f64| px.is_finite() && *px > 0.0);
        // A px of the page would be another than one of the picture.
        let on_page = || Length::parse(text).filter(|_| !text.ends_with("px"));
        px.map(Self::Px)
            .or_else(|| on_page().map(Self::OnPage))
            .ok_or_else(|| {
                let short: String = text.chars().take(40).collect();
                Error::config(format!(
                    "'{short}' is not a width of a pen: give one such as 0.3mm, or a number above 0 in px of the picture"
                ))
            })
    }
}

impl fmt::Display for Widths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().enumerate().try_for_each(|(i, width)| {
            f.write_str(if i > 0 { "," } else { "" })?;
            write!(f, "{width}")
        })
    }
}

impl FromStr for Widths {
    type Err = Error;

    /// Widths with commas between, such as `0.3mm,0.8mm`. One that comes twice counts once.
    fn from_str(text: &str) -> Result<Self> {
        let mut widths = Vec::new();
        for word in text.split(',') {
            let width: Width = word.trim().parse()?;
            if !widths.contains(&width) {
                widths.push(width);
            }
            if widths.len() > Self::MAX {
                let message = format!("more than {} pens: give fewer", Self::MAX);
                return Err(Error::config(message));
            }
        }
        Ok(Self(widths))
    }
}

from_text!(Widths);

#[cfg(test)]
mod tests {
    use super::*;

    fn radii(text: &str, page: Option<&str>) -> Result<Vec<f32>> {
        let picture = Image::filled(400, 300, [1.0; 3]).unwrap();
        let page = page.map(|page| page.parse().unwrap());
        text.parse::<Widths>()?.radii(page, &picture)
    }

    #[test]
    fn widths_on_a_page_become_px_of_the_picture() {
        assert_eq!(radii("0.8mm,0.4mm", Some("100mm")).unwrap(), [0.8, 1.6]);
        assert_eq!(radii("0.08cm, 0.8mm", Some("10cm")).unwrap(), [1.6]);
        assert_eq!(radii("3,2,3", None).unwrap(), [1.0, 1.5]);
    }

    #[test]
    fn widths_are_read_as_they_are_written() {
        for text in ["0.3mm,0.8mm", "2,3.5", "0.02in"] {
            assert_eq!(text.parse::<Widths>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_is_no_pen_is_refused_with_the_remedy() {
        let many = (1..=65)
            .map(|i| i.to_string())
            .collect::<Vec<_>>()
            .join(",");
        for (text, page, words) in [
            ("", None, "'' is not a width"),
            ("0", None, "'0' is not a width"),
            ("-0.3mm", None, "'-0.3mm' is not a width"),
            ("3px", None, "px of the picture"),
            ("0.3mm,fine", None, "'fine' is not a width"),
            (&many, None, "more than 64 pens"),
            ("0.3mm", None, "such as 120mm"),
            ("0.2mm", Some("100mm"), "a width of 510 px"),
            ("0.5", None, "1.02 px or more"),
            ("120mm", Some("100mm"), "wider than the picture"),
        ] {
            let error = radii(text, page).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
