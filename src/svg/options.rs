//! Options that say how a scene is written.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;

use super::dialect::Unit;
use crate::error::{Error, ErrorKind};
use crate::scene::UNITS_PER_PX;
use crate::words::{from_text, words};

/// Options of writing a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(default)]
#[cfg_attr(
    feature = "cli",
    derive(clap::Args),
    command(next_help_heading = "File")
)]
pub struct WriteOptions {
    /// Decimals of coordinates and widths, 0 to 6
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = 2))]
    pub precision: u8,
    /// What one element of the SVG holds
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub form: Form,
    /// What one layer of the SVG holds
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub group: Group,
    /// In which order the strokes of a layer come
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub order: Order,
    /// Width of the page in mm, cm, in, pt or px, such as 120mm (default: one px per pixel of the picture)
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "LENGTH", allow_hyphen_values = true)
    )]
    pub width: Option<Length>,
}

impl WriteOptions {
    /// The unit that makes the numbers of the file shortest.
    pub(super) fn unit(&self) -> Unit {
        match self.form {
            Form::Smallest => Unit::decimal(self.precision),
            Form::Plain | Form::Css | Form::Powerstroke | Form::Outlines => Unit::PX,
        }
    }
}

impl Default for WriteOptions {
    /// Two decimals: a hundredth of a px is finer than any rasteriser's grid.
    fn default() -> Self {
        Self {
            precision: 2,
            form: Form::default(),
            group: Group::default(),
            order: Order::default(),
            width: None,
        }
    }
}

/// Content of an element of the file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Form {
    /// One stroke
    #[default]
    Plain,
    /// As many strokes as possible: fewest bytes, hardest to edit
    ///
    /// Groups hold the attributes that neighbours share. Strokes that do not touch may swap places, and a stroke may swap
    /// its ends. Numbers are whole: they count units of the last decimal.
    Smallest,
    /// One stroke; its colour and its width are in classes of a style sheet, the one place to change them
    ///
    /// Layers that are laid on another SVG are in the plain form, as its own style sheets may have the same classes.
    Css,
    /// One stroke; lines whose width varies are PowerStrokes, whose middle and widths Inkscape edits
    Powerstroke,
    /// The filled outline of one stroke, for programs that ignore strokes. It is read back as an area
    #[cfg_attr(feature = "cli", value(skip))]
    Outlines,
}

/// Content of a layer of the file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Group {
    /// The strokes of one stage
    #[default]
    Stage,
    /// Strokes of one colour. With --colors or --palette each colour has one layer
    ///
    /// Without these, a colour has several layers if its strokes lie below another colour in one place and above it in another.
    Color,
    /// A thing: an area with what lies on it, or touching strokes of one colour. Marks have names and keep the order that they
    /// were fitted in
    Object,
}

/// In which order the strokes of a layer come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Order {
    /// The order that they were fitted in
    #[default]
    Fitted,
    /// With short ways between them, for a plotter; the picture stays the same
    ///
    /// Strokes are drawn from either end, and closed paths begin at any of their points. In the smallest form this applies
    /// to the strokes of each style.
    Travel,
}

words!(Form, "a form": Plain = "plain", Smallest = "smallest", Css = "css", Powerstroke = "powerstroke", Outlines = "outlines");

words!(Group, "a grouping": Stage = "stage", Color = "color", Object = "object");

words!(Order, "an order": Fitted = "fitted", Travel = "travel");

from_text!(Length);

/// A length with its unit, exact to 4 decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Length {
    /// In 1/[`UNITS_PER_PX`] of the unit.
    value: i64,
    unit: &'static str,
}

/// Names of units and how many px of 1/96 inch they have.
const UNITS: [(&str, f64); 5] = [
    ("mm", 96.0 / 25.4),
    ("cm", 96.0 / 2.54),
    ("in", 96.0),
    ("pt", 96.0 / 72.0),
    ("px", 1.0),
];

/// Widest page in px of 1/96 inch, so that a raster of it stays within the limits of renderers.
const MAX_PAGE_PX: f64 = 100_000.0;

/// 4 decimals of a unit: a ten-thousandth of a mm is finer than any plotter's grid.
const STEP: i64 = UNITS_PER_PX / 10_000;

impl Length {
    /// This length times `numerator` / `denominator`, rounded to 4 decimals and never below 0.0001.
    pub(super) fn scaled(self, numerator: u32, denominator: u32) -> Self {
        let exact = i128::from(self.value) * i128::from(numerator) / i128::from(STEP);
        let steps = (2 * exact + i128::from(denominator)) / (2 * i128::from(denominator));
        let value = i64::try_from(steps).unwrap_or(i64::MAX / STEP).max(1) * STEP;
        Self { value, ..self }
    }

    /// The length that an attribute says.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let &(unit, _) = UNITS.iter().find(|(unit, _)| text.ends_with(unit))?;
        let number = text.strip_suffix(unit)?;
        let is_plain = number.starts_with(|c: char| c.is_ascii_digit())
            && number.bytes().all(|b| b.is_ascii_digit() || b == b'.');
        let value = Unit::PX.parse(number).filter(|_| is_plain)?;
        (value > 0 && value % STEP == 0).then_some(Self { value, unit })
    }

    /// In px of 1/96 inch.
    pub fn px(self) -> f64 {
        let per_unit = UNITS.iter().find(|(unit, _)| *unit == self.unit);
        self.value as f64 / UNITS_PER_PX as f64 * per_unit.map_or(1.0, |&(_, px)| px)
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut number = String::new();
        Unit::PX.push(&mut number, self.value);
        write!(f, "{number}{}", self.unit)
    }
}

impl FromStr for Length {
    type Err = Error;

    /// A number of 1 px to 100,000 px with a unit of mm, cm, in, pt or px, such as `120mm`.
    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text)
            .filter(|length| (1.0..=MAX_PAGE_PX).contains(&length.px()))
            .ok_or_else(|| {
                let message = format!(
                    "'{text}' is not a length of 1 px to 100000 px: give one with mm, cm, in, pt or px, such as 120mm"
                );
                Error::new(ErrorKind::Config, message)
            })
    }
}

/// The channels of an opaque colour: `#rrggbb`, `#rgb`, or what else CSS has for one, such as `white`.
pub(crate) fn opaque_color(text: &str) -> Option<[u8; 3]> {
    let color: svgtypes::Color = text.parse().ok()?;
    // With four or eight digits it has an opacity, even if that is 1.
    let is_hex = matches!(text.len(), 4 | 7) || !text.starts_with('#');
    (is_hex && color.alpha == 255).then_some([color.red, color.green, color.blue])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_keep_their_unit_and_their_decimals() {
        for text in ["120mm", "12.5cm", "4.75in", "1pt", "600px", "0.5in"] {
            assert_eq!(text.parse::<Length>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn forms_and_groupings_are_read_as_they_are_written() {
        for form in Form::ALL {
            assert_eq!(form.to_string().parse::<Form>().unwrap(), form);
        }
        for group in Group::ALL {
            assert_eq!(group.to_string().parse::<Group>().unwrap(), group);
        }
        for order in Order::ALL {
            assert_eq!(order.to_string().parse::<Order>().unwrap(), order);
        }
        let error = "small".parse::<Form>().unwrap_err().to_string();
        assert!(
            error.contains("'small'") && error.contains("smallest"),
            "{error}"
        );
        let error = "".parse::<Group>().unwrap_err().to_string();
        assert!(
            error.contains("''") && error.contains("color or object"),
            "{error}"
        );
        let error = "short".parse::<Order>().unwrap_err().to_string();
        assert!(
            error.contains("'short'") && error.contains("fitted or travel"),
            "{error}"
        );
    }

    #[test]
    fn what_is_no_length_is_refused() {
        let refused = [
            "",
            "120",
            "mm",
            "-3mm",
            "0mm",
            ".5in",
            "1e3mm",
            "12 mm",
            "12em",
            "50%",
            "0.1mm",
            "99999cm",
            "1.23456in",
        ];
        for text in refused {
            assert!(text.parse::<Length>().is_err(), "{text}");
        }
    }

    #[test]
    fn the_height_follows_the_width() {
        let width: Length = "120mm".parse().unwrap();
        assert_eq!(width.scaled(225, 300).to_string(), "90mm");
        assert_eq!(width.scaled(1, 7).to_string(), "17.1429mm");
    }
}
