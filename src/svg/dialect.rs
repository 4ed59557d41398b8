//! The words of the dialect that reader and writer share: names, numbers, path data, colours.

use crate::scene::UNITS_PER_PX;

/// The namespace of SVG; with `http`, or nothing draws it.
pub(super) const SVG_NAMESPACE: &str = "http://www.w3.org/2000/svg";

/// The namespace that makes a group a layer in Inkscape.
pub(super) const INKSCAPE_NAMESPACE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// The way from a dot to the end of its segment.
const DOT: &str = "h0.01";

/// Largest number that may be read, in units: the way between the two farthest points of a scene.
/// All decimals up to here are exact in `f64`.
const MAX_UNITS: i64 = 2_000_000_000 * UNITS_PER_PX;

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

/// The `d` of a path through `points`: absolute or relative, whichever is shorter.
pub(super) fn path_data(points: &[[i64; 2]]) -> String {
    let Some((&start, rest)) = points.split_first() else {
        return String::new();
    };
    let mut head = String::from("M");
    push_pair(&mut head, start);
    if rest.is_empty() {
        return head + DOT;
    }
    let (mut absolute, mut relative) = (String::from("L"), String::from("l"));
    let mut last = start;
    for &[x, y] in rest {
        push_pair(&mut absolute, [x, y]);
        push_pair(&mut relative, [x - last[0], y - last[1]]);
        last = [x, y];
    }
    head + if relative.len() < absolute.len() {
        &relative
    } else {
        &absolute
    }
}

fn push_pair(out: &mut String, pair: [i64; 2]) {
    for units in pair {
        let follows_number = out.ends_with(|c: char| c.is_ascii_digit());
        // A minus sign separates by itself.
        if follows_number && units >= 0 {
            out.push(' ');
        }
        push_number(out, units);
    }
}

/// The points of the `d` of a path, neighbours different, or `None` if it is not of the dialect.
pub(super) fn points(d: &str) -> Option<Vec<[i64; 2]>> {
    let body = d.strip_prefix('M')?;
    if let Some(start) = body.strip_suffix(DOT) {
        return pairs(start).filter(|p| p.len() == 1);
    }
    let at = body.find(['L', 'l'])?;
    let mut points = pairs(&body[..at]).filter(|p| p.len() == 1)?;
    let relative = body[at..].starts_with('l');
    for [x, y] in pairs(&body[at + 1..]).filter(|p| p.len() == 1)? {
        let [from_x, from_y] = if relative { *points.last()? } else { [0, 0] };
        points.push([from_x + x, from_y + y]);
    }
    points.dedup();
    Some(points)
}

/// Numbers two by two, separated by spaces or their own minus signs.
fn pairs(text: &str) -> Option<Vec<[i64; 2]>> {
    let mut numbers = Vec::new();
    for word in text.split_ascii_whitespace() {
        let mut rest = word;
        while !rest.is_empty() {
            let minus = rest.bytes().skip(1).position(|b| b == b'-');
            let end = minus.map_or(rest.len(), |at| at + 1);
            numbers.push(number(&rest[..end])?);
            rest = &rest[end..];
        }
    }
    let (pairs, left) = numbers.as_chunks();
    left.is_empty().then(|| pairs.to_vec())
}

/// `#rrggbb`.
pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The channels of `#rrggbb`.
pub(super) fn channels(hex: &str) -> Option<[u8; 3]> {
    let digits = hex
        .strip_prefix('#')
        .filter(|h| h.len() == 6 && h.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let [_, r, g, b] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some([r, g, b])
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
    fn a_path_is_absolute_or_relative_whichever_is_shorter() {
        let px = |x: i64, y: i64| [x * UNITS_PER_PX, y * UNITS_PER_PX];
        assert_eq!(path_data(&[px(1, 2), px(3, 4)]), "M1 2L3 4");
        assert_eq!(path_data(&[px(100, 200), px(103, 199)]), "M100 200l3-1");
        assert_eq!(path_data(&[px(-1, -2), px(-3, 4)]), "M-1-2L-3 4");
        assert_eq!(path_data(&[px(5, 6)]), "M5 6h0.01");
    }

    #[test]
    fn path_data_outside_the_dialect_is_refused() {
        let refused = [
            "",
            "M",
            "M1 2",
            "M1 2L3",
            "M1 2L3 4 5",
            "M1 2L3 4L5 6",
            "m1 2l3 4",
            "M1 2h1",
            "M1 2 3 4",
            "M1,2L3,4",
            "M1 2L--3 4",
            "Mé 2L3 4",
        ];
        for d in refused {
            assert_eq!(points(d), None, "{d}");
        }
    }

    #[test]
    fn every_opacity_and_channel_survives() {
        for k in 1..=255 {
            assert_eq!(opacity_quantum(&opacity(k)), Some(k));
            assert_eq!(channels(&hex([k, 0, 255 - k])), Some([k, 0, 255 - k]));
        }
        for text in ["0", "0.001", "1.1", "-0.5", "x"] {
            assert_eq!(opacity_quantum(text), None, "{text}");
        }
        for text in ["#fff", "ffffff", "#ffffff00", "#+12345", "#ééé"] {
            assert_eq!(channels(text), None, "{text}");
        }
    }
}
