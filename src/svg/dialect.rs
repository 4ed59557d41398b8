//! The vocabulary that reader and writer of the dialect share: names, numbers, colours.

use svgtypes::{Color, Length, LengthUnit, Number};

use crate::scene::{MAX_PRECISION, UNITS_PER_PX};

/// The namespace of SVG. It must have `http`; otherwise no program draws the file.
pub(crate) const SVG_NAMESPACE: &str = "http://www.w3.org/2000/svg";

/// The namespace that makes a group a layer in Inkscape.
pub(super) const INKSCAPE_NAMESPACE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// The namespace of the attributes that say which line an outline belongs to, and how wide it is.
pub(super) const LINE_NAMESPACE: &str = "urn:strokefit:line";
/// The attributes: path data, and the full width at each of its vertices.
pub(super) const LINE: &str = "strokefit:line";
pub(super) const WIDTHS: &str = "strokefit:widths";

/// The beginnings of the ids of shadows and of their filters, which their numbers follow.
pub(super) const SHADOW_ID: &str = "shadow";
pub(super) const BLUR_ID: &str = "blur";
/// The attributes of a filter, besides its id, and those with its place.
pub(super) const FILTER: [(&str, &str); 2] = [
    ("filterUnits", "userSpaceOnUse"),
    ("color-interpolation-filters", "sRGB"),
];
pub(super) const FILTER_PLACE: [&str; 4] = ["x", "y", "width", "height"];
/// The element of a filter that blurs, and its standard deviation.
pub(super) const GAUSSIAN: (&str, &str) = ("feGaussianBlur", "stdDeviation");
/// The beginning of the ids of the things below shadows, which their numbers follow.
pub(super) const SURFACE_ID: &str = "surface";
/// The id of the shade's gradient.
pub(super) const SHADE_ID: &str = "shade";

/// The elements of the two kinds of gradients, and the attributes of their axes.
pub(super) const LINEAR: &str = "linearGradient";
pub(super) const LINEAR_AXIS: [&str; 4] = ["x1", "y1", "x2", "y2"];
pub(super) const RADIAL: &str = "radialGradient";
pub(super) const RADIAL_AXIS: [&str; 3] = ["cx", "cy", "r"];

/// The properties that make a mark a stroke or an area.
pub(super) const PAINT: [&str; 5] = [
    "stroke",
    "stroke-width",
    "stroke-opacity",
    "fill",
    "fill-opacity",
];

/// Units of the axes and of the offsets of gradients: 0.01 px and 0.001.
pub(super) const HUNDREDTH: i64 = UNITS_PER_PX / 100;
pub(super) const THOUSANDTH: i64 = UNITS_PER_PX / 1000;

/// Largest number that may be read, in units: the distance of the two farthest points of a scene. All
/// decimals up to here are exact in `f64`.
pub(super) const MAX_UNITS: i64 = 2_000_000_000 * UNITS_PER_PX;

/// The unit of the numbers in a text: a px or a decimal fraction of it, in 1/[`UNITS_PER_PX`] px.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Unit(i64);

impl Unit {
    pub(super) const PX: Self = Self(UNITS_PER_PX);

    /// 10^−precision px, at least 10^−6 px.
    pub(super) fn decimal(precision: u8) -> Self {
        Self(UNITS_PER_PX / 10_i64.pow(precision.min(MAX_PRECISION).into()))
    }

    /// The attribute of a group whose elements have numbers in this unit.
    pub(super) fn transform(self) -> String {
        let mut out = String::from("scale(");
        Self::PX.push(&mut out, self.0);
        out + ")"
    }

    /// The unit that such an attribute of a group means.
    pub(super) fn of_transform(text: &str) -> Option<Self> {
        let mut units = (1..=MAX_PRECISION).map(Self::decimal);
        units.find(|unit| unit.transform() == text)
    }

    /// Appends `units` as a decimal: no exponent, no leading dot, no trailing zeros.
    pub(super) fn push(self, out: &mut String, units: i64) {
        if units < 0 {
            out.push('-');
        }
        let (units, one) = (units.unsigned_abs(), self.0.unsigned_abs());
        out.push_str(&(units / one).to_string());
        let fraction = units % one;
        if fraction > 0 {
            let digits = format!("{fraction:0width$}", width = self.places());
            out.push('.');
            out.push_str(digits.trim_end_matches('0'));
        }
    }

    /// The value of a number in 1/[`UNITS_PER_PX`] px. `None` if the text is no number, or as [`Self::units`].
    pub(super) fn parse(self, text: &str) -> Option<i64> {
        self.units(text.parse::<Number>().ok()?.0)
    }

    /// The value of `number` in 1/[`UNITS_PER_PX`] px. `None` if it has too many decimals for this unit, or is beyond ±2·10⁹ px.
    pub(super) fn units(self, number: f64) -> Option<i64> {
        let one = self.0 as f64;
        let units = (number * one).round();
        // Both are whole and below 2⁵³. So the quotient is the number nearest to the decimal, as is what a parser returns.
        let is_exact = units / one == number && units.abs() <= MAX_UNITS as f64;
        is_exact.then_some(units as i64)
    }

    /// Number of decimals.
    fn places(self) -> usize {
        self.0.ilog10() as usize
    }
}

/// `#rrggbb`.
pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// `#rgb` if it means the same colour, else `#rrggbb`.
pub(super) fn short_hex(channels: [u8; 3]) -> String {
    let twice = |c: u8| c.is_multiple_of(0x11);
    if channels.into_iter().all(twice) {
        let [r, g, b] = channels.map(|c| c / 0x11);
        format!("#{r:x}{g:x}{b:x}")
    } else {
        hex(channels)
    }
}

/// The channels of an opaque colour.
pub(super) fn channels(text: &str) -> Option<[u8; 3]> {
    let color: Color = text.parse().ok()?;
    (color.alpha == u8::MAX).then_some([color.red, color.green, color.blue])
}

/// A length in px; `None` for percentages, font units, and text that is not a length.
pub(super) fn length_px(text: &str) -> Option<f64> {
    let Length { number, unit } = text.trim().parse().ok()?;
    let px = match unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::Pt => 4.0 / 3.0,
        LengthUnit::Pc => 16.0,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::In => 96.0,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return None,
    };
    Some(number * px)
}

/// Opacity k/255 with 3 decimals, enough to recover k.
pub(super) fn opacity(k: u8) -> String {
    let mut out = String::new();
    let thousandths = (i64::from(k) * 1000 + 127) / 255;
    Unit::PX.push(&mut out, thousandths * (UNITS_PER_PX / 1000));
    out
}

/// The k in 1..=255 of an opacity.
pub(super) fn opacity_quantum(text: &str) -> Option<u8> {
    let units = Unit::PX
        .parse(text)
        .filter(|&units| (0..=UNITS_PER_PX).contains(&units))?;
    let k = (units * 255 + UNITS_PER_PX / 2) / UNITS_PER_PX;
    u8::try_from(k).ok().filter(|&k| k > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(unit: Unit, units: i64) -> String {
        let mut out = String::new();
        unit.push(&mut out, units);
        out
    }

    #[test]
    fn numbers_have_a_leading_digit_and_no_trailing_zero() {
        let cases = [
            (0, "0"),
            (500_000, "0.5"),
            (-20_000, "-0.02"),
            (12_000_000, "12"),
            (-1_230_001, "-1.230001"),
        ];
        for (units, text) in cases {
            assert_eq!(written(Unit::PX, units), text);
            assert_eq!(Unit::PX.parse(text), Some(units));
        }
    }

    #[test]
    fn numbers_count_decimals_of_a_px() {
        for (precision, text) in [(0, "-12.3"), (1, "-123"), (2, "-1230"), (6, "-12300000")] {
            let unit = Unit::decimal(precision);
            assert_eq!(written(unit, -12_300_000), text);
            assert_eq!(unit.parse(text), Some(-12_300_000));
        }
        assert_eq!(Unit::decimal(6).parse("1.5"), None);
        assert_eq!(Unit::decimal(9), Unit::decimal(6));
    }

    #[test]
    fn a_unit_is_known_by_its_transform() {
        assert_eq!(Unit::decimal(2).transform(), "scale(0.01)");
        for precision in 1..=6 {
            let unit = Unit::decimal(precision);
            assert_eq!(Unit::of_transform(&unit.transform()), Some(unit));
        }
        for text in ["scale(1)", "scale(2)", "scale(.1)", "scale(0.1 0.1)", ""] {
            assert_eq!(Unit::of_transform(text), None, "{text}");
        }
    }

    #[test]
    fn numbers_that_no_unit_counts_are_refused() {
        for text in [
            "",
            "-",
            "1.2.3",
            "1 2",
            "NaN",
            "inf",
            "0.0000001",
            "1e-7",
            "2000000001",
            "99999999999999999999",
        ] {
            assert_eq!(Unit::PX.parse(text), None, "{text}");
        }
        for (text, units) in [
            ("-2000000000", -MAX_UNITS),
            ("1999999999.999999", MAX_UNITS - 1),
            ("5e-1", 500_000),
        ] {
            assert_eq!(Unit::PX.parse(text), Some(units), "{text}");
        }
    }

    #[test]
    fn lengths_are_in_px() {
        for (text, px) in [("2", 2.0), (" 1in ", 96.0), ("3pt", 4.0)] {
            assert_eq!(length_px(text), Some(px), "{text}");
        }
        for text in ["50%", "1em", "auto", ""] {
            assert_eq!(length_px(text), None, "{text}");
        }
    }

    #[test]
    fn every_opacity_and_channel_survives() {
        for k in 1..=255 {
            assert_eq!(opacity_quantum(&opacity(k)), Some(k));
            for hex in [hex([k, 0, 255 - k]), short_hex([k, 0, 255 - k])] {
                assert_eq!(channels(&hex), Some([k, 0, 255 - k]));
            }
        }
        assert_eq!(short_hex([0x11, 0xff, 0]), "#1f0");
        assert_eq!(short_hex([0x11, 0xf1, 0]), "#11f100");
        for text in ["0", "0.001", "1.1", "-0.5", "x"] {
            assert_eq!(opacity_quantum(text), None, "{text}");
        }
        for text in ["#ff", "ffffff", "#ffff00e", "#ffffff00", "#+12345", "#ééé"] {
            assert_eq!(channels(text), None, "{text}");
        }
    }
}
