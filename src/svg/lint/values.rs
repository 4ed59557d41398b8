//! Values of attributes, as rules need them.

use svgtypes::{Color, SimplePathSegment, SimplifyingPathParser, Transform};

/// True if a number in the text begins with a dot, as the second one in `1.5.5` does.
pub(super) fn has_leading_dot(text: &str) -> bool {
    let (mut has_digit, mut has_dot) = (false, false);
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '.' if !has_digit || has_dot => {
                if rest.peek().is_some_and(char::is_ascii_digit) {
                    return true;
                }
            }
            '.' => has_dot = true,
            _ if c.is_ascii_digit() => has_digit = true,
            _ => (has_digit, has_dot) = (false, false),
        }
    }
    false
}

/// True if a value is a colour with alpha.
pub(super) fn has_alpha(value: &str) -> bool {
    let is_translucent = |color: Color| color.alpha < u8::MAX;
    value != "transparent" && value.trim().parse().is_ok_and(is_translucent)
}

/// The factor by which a `transform` widens strokes: the root of the factor for areas.
pub(super) fn transform_scale(transform: &str) -> f64 {
    let area = |t: Transform| (t.a * t.d - t.b * t.c).abs();
    transform.parse().map_or(1.0, area).sqrt()
}

/// True if a subpath has a segment and all its points coincide. A lone `M` draws nothing in any program, so
/// it does not count.
pub(super) fn has_zero_length(d: &str) -> bool {
    use SimplePathSegment as S;
    let (mut start, mut is_drawn, mut is_moved) = ([0.0; 2], false, false);
    for segment in SimplifyingPathParser::from(d).map_while(Result::ok) {
        let points = match segment {
            S::MoveTo { x, y } => {
                if is_drawn && !is_moved {
                    return true;
                }
                (start, is_drawn, is_moved) = ([x, y], false, false);
                continue;
            }
            S::ClosePath => [start; 3],
            S::LineTo { x, y } => [[x, y]; 3],
            S::Quadratic { x1, y1, x, y } => [[x1, y1], [x, y], [x, y]],
            S::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => [[x1, y1], [x2, y2], [x, y]],
        };
        is_drawn = true;
        is_moved |= points.iter().any(|point| *point != start);
    }
    is_drawn && !is_moved
}

/// True if the target of a reference is in the file and is not itself an SVG, which could refer to something else.
pub(super) fn is_embedded(target: &str) -> bool {
    let data = target.strip_prefix("data:");
    let kind = data.and_then(|data| data.split([',', ';']).next());
    kind.is_some_and(|kind| {
        !kind.contains(['+', '&']) && !kind.to_ascii_lowercase().ends_with("xml")
    })
}

/// The targets of every `url(…)`.
pub(super) fn urls(value: &str) -> impl Iterator<Item = String> {
    let calls = value.split("url(").skip(1);
    calls
        .filter_map(|rest| rest.split_once(')'))
        .map(|(inner, _)| {
            let target = inner.replace("&quot;", "").replace("&apos;", "");
            target.trim().trim_matches(['"', '\'']).to_owned()
        })
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn transforms_widen_strokes_by_the_root_of_the_area() {
        for (transform, scale) in [
            ("", 1.0),
            ("translate(5) rotate(30)", 1.0),
            ("scale(2)", 2.0),
            ("scale(4,1), scale(.5 2)", 2.0),
            ("matrix(0 3 -3 0 1 1)", 3.0),
            ("scale(-2)", 2.0),
        ] {
            let found = transform_scale(transform);
            assert!((found - scale).abs() < 1e-12, "{transform}: {found}");
        }
    }

    #[test]
    fn strokes_without_length_are_found() {
        for d in [
            "M5 5L5 5",
            "M5 5l0 0",
            "M5 5h0",
            "M5,5z",
            "m5 5 0 0",
            "M5 5C5 5 5 5 5 5",
            "M1 1h3M5 5v0",
            "M5 5A2 2 0 0 1 5 5",
            "M5 5l0 0z",
        ] {
            assert!(has_zero_length(d), "{d}");
        }
        for d in [
            "",
            "M5 5",
            "M5 5h0.01",
            "M5 5L5 6",
            "M1 1 2 2z",
            "M5 5C5 5 6 6 5 5",
            "M5 5l1 0l-1 0",
            "M5 5h1e-3",
            "M1 1M2 2h1",
            "nonsense é",
        ] {
            assert!(!has_zero_length(d), "{d}");
        }
    }

    #[test]
    fn a_drawing_in_a_drawing_is_not_taken_as_embedded() {
        assert!(is_embedded("data:image/png;base64,AA") && is_embedded("data:,"));
        for target in [
            "data:image/svg+xml,x",
            "data:image/SVG+XML;base64,x",
            "data:text/xml,x",
            "a.png",
        ] {
            assert!(!is_embedded(target), "{target}");
        }
    }

    #[test]
    fn urls_are_found_with_any_quotes() {
        let css = "fill:url(#a);mask: url('b.svg#m') ; x:url(&quot;c&quot;)";
        assert_eq!(urls(css).collect::<Vec<_>>(), ["#a", "b.svg#m", "c"]);
        assert_eq!(urls("url(").count(), 0);
    }
}
