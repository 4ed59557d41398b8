//! Numbers in SVG syntax: adjacent without a space, with units, in transforms.

/// px per unit of length, for absolute units.
const UNITS: [(&str, f64); 7] = [
    ("", 1.0),
    ("px", 1.0),
    ("pt", 4.0 / 3.0),
    ("pc", 16.0),
    ("mm", 96.0 / 25.4),
    ("cm", 96.0 / 2.54),
    ("in", 96.0),
];

/// The number at the start of `text`, and the rest. `.5` and `1e3` are numbers; in `1.5.5` and `1-5` a second
/// number begins at its dot or sign.
pub(super) fn leading(text: &str) -> Option<(f64, &str)> {
    let end = length(text.as_bytes());
    let (number, rest) = text.split_at(end);
    Some((number.parse().ok()?, rest))
}

/// Bytes of the number at the start, 0 if there is none.
fn length(text: &[u8]) -> usize {
    let digits = |from: usize| {
        text[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let sign = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let whole = digits(sign);
    let mut at = sign + whole;
    let mut fraction = 0;
    if text.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(text.get(at), Some(b'e' | b'E')) {
        let signed = at + 1 + usize::from(matches!(text.get(at + 1), Some(b'+' | b'-')));
        let exponent = text.get(signed..).map_or(0, |_| digits(signed));
        if exponent > 0 {
            at = signed + exponent;
        }
    }
    at
}

/// All numbers in a text, with any separators.
pub(super) fn all(text: &str) -> Vec<f64> {
    let mut numbers = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        if let Some((number, after)) = leading(rest) {
            numbers.push(number);
            rest = after;
        } else {
            rest = &rest[first.len_utf8()..];
        }
    }
    numbers
}

/// True if a number in the text begins with a dot.
pub(super) fn has_leading_dot(text: &str) -> bool {
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        match leading(rest) {
            Some((_, after)) => {
                if rest.trim_start_matches(['+', '-']).starts_with('.') {
                    return true;
                }
                rest = after;
            }
            None => rest = &rest[first.len_utf8()..],
        }
    }
    false
}

/// A length in px; `None` for percentages, font units, and text that is not a length.
pub(super) fn length_px(text: &str) -> Option<f64> {
    let (number, unit) = leading(text.trim())?;
    let px = UNITS.iter().find(|(name, _)| *name == unit.trim())?.1;
    Some(number * px)
}

/// The unit of a length, empty if it has none; `None` for text that is not a length.
pub(super) fn unit(text: &str) -> Option<&str> {
    length_px(text)?;
    Some(leading(text.trim())?.1.trim())
}

/// The factor by which a `transform` widens strokes: the root of the factor for areas. Only matrices and
/// scales count; the factors of several transforms multiply.
pub(super) fn transform_scale(transform: &str) -> f64 {
    let area: f64 = transform
        .split(')')
        .filter_map(|function| function.split_once('('))
        .map(|(name, arguments)| area_scale(name, &all(arguments)))
        .product();
    area.abs().sqrt()
}

fn area_scale(name: &str, arguments: &[f64]) -> f64 {
    match (name.trim_matches([' ', ',', '\n', '\t']), arguments) {
        ("matrix", &[a, b, c, d, ..]) => a * d - b * c,
        ("scale", &[x, y]) => x * y,
        ("scale", &[both]) => both * both,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_need_no_space_between() {
        assert_eq!(all("M1.5.5-3e1L.5,+2 e"), [1.5, 0.5, -30.0, 0.5, 2.0]);
        assert_eq!(all("1e"), [1.0]);
        assert!(all("é. - ,").is_empty());
    }

    #[test]
    fn leading_dots_are_seen_wherever_a_number_begins() {
        for text in [".5", "M1 1L.5 2", "M1.5.5", "l-.5 0", "scale(.5)"] {
            assert!(has_leading_dot(text), "{text}");
        }
        for text in ["0.5", "M1.5 0.5", "1.", "a.b", ""] {
            assert!(!has_leading_dot(text), "{text}");
        }
    }

    #[test]
    fn lengths_are_in_px() {
        assert_eq!(length_px("2"), Some(2.0));
        assert_eq!(length_px(" 1in "), Some(96.0));
        assert_eq!(length_px("3pt"), Some(4.0));
        for text in ["50%", "1em", "auto", ""] {
            assert_eq!(length_px(text), None, "{text}");
        }
    }

    #[test]
    fn transforms_widen_strokes_by_the_root_of_the_area() {
        for (transform, scale) in [
            ("", 1.0),
            ("translate(5) rotate(30)", 1.0),
            ("scale(2)", 2.0),
            ("scale(4,1), scale(.5 2)", 2.0),
            ("matrix(0 3 -3 0 1 1)", 3.0),
            ("scale(-2)", 2.0),
        ] {
            assert!(
                (transform_scale(transform) - scale).abs() < 1e-12,
                "{transform}"
            );
        }
    }
}
