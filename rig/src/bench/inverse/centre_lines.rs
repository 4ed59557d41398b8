//! Centre lines of a drawing, as an editor shows them.

use std::fmt::Write as _;

use crate::bench::elements::{Element, elements};
use crate::bench::gallery::{fitted, size, zoom};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::verify;

/// Share of a picture that is left below its centre lines.
const FADED: f32 = 0.25;

/// Colours of centre lines, one for each element in turn: Okabe & Ito, "Color universal design", 2008.
const COLORS: [&str; 5] = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00"];

/// The centre lines of strokes over what is left of the picture, a colour for each element, with its nodes.
pub(super) fn centre_lines(svg: &str, picture: &Image) -> Result<Image> {
    let side = picture.width().max(picture.height());
    let found = elements(svg, side as f32)?;
    let strokes = found.iter().filter(|element| element.width_px.is_some());
    let px = 1.0 / zoom(picture) as f32;
    let marked = strokes.zip(COLORS.iter().cycle());
    let marked: String = marked.map(|(e, color)| marked_up(e, color, px)).collect();
    let (width, height) = (picture.width(), picture.height());
    let svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{marked}</svg>"#
    );
    over(
        &verify::render(&svg, size(picture), None)?,
        &fitted(picture)?,
    )
}

/// An element's centre lines and nodes as SVG; `px` is a px of the panel.
fn marked_up(element: &Element, color: &str, px: f32) -> String {
    let mut data = String::new();
    for line in &element.lines {
        for (i, p) in line.iter().enumerate() {
            let word = if i == 0 { 'M' } else { 'L' };
            let _ = write!(data, "{word}{:.2} {:.2}", p.x, p.y);
        }
    }
    let mut svg = format!(
        r#"<path d="{data}" fill="none" stroke="{color}" stroke-width="{:.2}"/>"#,
        1.5 * px
    );
    for p in &element.nodes {
        let _ = write!(
            svg,
            r##"<rect x="{:.2}" y="{:.2}" width="{side:.2}" height="{side:.2}" fill="#ffffff" stroke="{color}" stroke-width="{px:.2}"/>"##,
            p.x - 2.0 * f64::from(px),
            p.y - 2.0 * f64::from(px),
            side = 4.0 * px
        );
    }
    svg
}

/// A transparent picture over what is left of another.
fn over(above: &Image, below: &Image) -> Result<Image> {
    let clear = vec![0.0; above.width() * above.height()];
    let alpha = above.alpha().unwrap_or(&clear);
    let plane = |c: usize| {
        let pixels = above.planes()[c].iter().zip(&below.planes()[c]).zip(alpha);
        let faded = |below: f32| 1.0 + FADED * (below - 1.0);
        pixels
            .map(|((above, below), a)| a * above + (1.0 - a) * faded(*below))
            .collect()
    };
    Image::new(above.width(), above.height(), [0, 1, 2].map(plane))
}

#[cfg(test)]
mod tests {
    use super::*;
    use strokefit::verify::Size;

    #[test]
    fn lines_have_a_colour_over_what_is_left_of_the_picture() {
        let line = r##"<svg xmlns="http://www.w3.org/2000/svg" width="48" height="24"><path d="M8 12H40" stroke="#000000" stroke-width="8"/></svg>"##;
        let picture = verify::render(line, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let shown = centre_lines(line, &picture).unwrap();
        let middle = shown.height() / 2 * shown.width() + shown.width() / 2;
        let [red, _, blue] = shown.planes().each_ref().map(|plane| plane[middle]);
        assert!(red > 0.7 && blue < 0.3, "{red} {blue}");
    }
}
