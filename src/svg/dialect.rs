//! The words of the dialect that reader and writer share: names, numbers, colours.

use crate::scene::UNITS_PER_PX;

/// The namespace of SVG; with `http`, or nothing draws it.
pub(crate) const SVG_NAMESPACE: &str = "http://www.w3.org/2000/svg";

/// The namespace that makes a group a layer in Inkscape.
pub(super) const INKSCAPE_NAMESPACE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// Largest number that may be read, in units: the way between the two farthest points of a scene.
/// All decimals up to here are exact in `f64`.
pub(super) const MAX_UNITS: i64 = 2_000_000_000 * UNITS_PER_PX;

/// Appends `units` as a decimal of px: no exponent, no leading dot, no trailing zeros.
pub(super) fn push_number(out: &mut String, units: i64) {
    if units < 0 {
        out.push('-');
    }
    let units = units.unsigned_abs();
    let per_px = UNITS_PER_PX.unsigned_abs();
    out.push_str(&(units / per_px).to_string());
    let fraction = units % per_px;
    if fraction > 0 {
        let digits = format!("{:0width$}", fraction, width = per_px.ilog10() as usize);
        out.push('.');
        out.push_str(digits.trim_end_matches('0'));
    }
}

/// The units of a decimal of px, or `None` if it is no plain decimal, has more places than a unit
/// can hold, or is beyond ±2·10⁹ px.
pub(super) fn number(text: &str) -> Option<i64> {
    let (negative, magnitude) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text),
    };
    let (whole, fraction) = magnitude.split_once('.').unwrap_or((magnitude, "0"));
    let places = UNITS_PER_PX.ilog10() as usize;
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    if !digits(whole) || !digits(fraction) || fraction.len() > places {
        return None;
    }
    let units = whole.parse::<i64>().ok()?.checked_mul(UNITS_PER_PX)?;
    let units = units.checked_add(format!("{fraction:0<places$}").parse().ok()?)?;
    (units <= MAX_UNITS).then_some(if negative { -units } else { units })
}

/// `#rrggbb`.
pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// `#rgb` where that says the same as `#rrggbb`, which is written otherwise.
pub(super) fn short_hex(channels: [u8; 3]) -> String {
    let twice = |c: u8| c.is_multiple_of(0x11);
    if channels.into_iter().all(twice) {
        let [r, g, b] = channels.map(|c| c / 0x11);
        format!("#{r:x}{g:x}{b:x}")
    } else {
        hex(channels)
    }
}

/// The channels of `#rrggbb` or `#rgb`.
pub(super) fn channels(hex: &str) -> Option<[u8; 3]> {
    let digits = hex
        .strip_prefix('#')
        .filter(|h| h.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let bits = u32::from_str_radix(digits, 16).ok()?;
    let [_, r, g, b] = bits.to_be_bytes();
    match digits.len() {
        6 => Some([r, g, b]),
        3 => Some([8, 4, 0].map(|shift| (bits >> shift & 0xf) as u8 * 0x11)),
        _ => None,
    }
}

/// Opacity k/255 with 3 decimals, enough to find k again.
pub(super) fn opacity(k: u8) -> String {
    let mut out = String::new();
    let thousandths = (i64::from(k) * 1000 + 127) / 255;
    push_number(&mut out, thousandths * (UNITS_PER_PX / 1000));
    out
}

/// The k in 1..=255 of an opacity.
pub(super) fn opacity_quantum(text: &str) -> Option<u8> {
    let units = number(text).filter(|&units| (0..=UNITS_PER_PX).contains(&units))?;
    let k = (units * 255 + UNITS_PER_PX / 2) / UNITS_PER_PX;
    u8::try_from(k).ok().filter(|&k| k > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(units: i64) -> String {
        let mut out = String::new();
        push_number(&mut out, units);
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
            assert_eq!(written(units), text);
            assert_eq!(number(text), Some(units));
        }
    }

    #[test]
    fn what_is_no_plain_decimal_is_refused() {
        for text in [
            "",
            "-",
            ".5",
            "5.",
            "1e3",
            "+1",
            "1.2.3",
            "NaN",
            "inf",
            "0.0000001",
            "2000000001",
            "99999999999999999999",
        ] {
            assert_eq!(number(text), None, "{text}");
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
        for text in ["#ff", "ffffff", "#ffff", "#ffffff00", "#+12345", "#ééé"] {
            assert_eq!(channels(text), None, "{text}");
        }
    }
}
