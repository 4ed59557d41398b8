//! Names for marks and colours that a person can look for.

use super::layer::Written;
use crate::math::Vec2;
use crate::scene::{Shape, units};

/// A mark in words, such as `dark-red-area`.
pub(super) fn of_mark(mark: &Written) -> String {
    let kind = match mark.paths() {
        _ if let Some(shape) = mark.shape() => of_shape(shape),
        _ if mark.line().is_some() => "line",
        _ if mark.is_filled() => "area",
        [path] if path.points().len() == 1 => "dot",
        [path] if path.is_closed() => "loop",
        [path] if path.points().len() == 2 => "line",
        _ => "curve",
    };
    format!("{}-{kind}", of_color(mark.color()).replace(' ', "-"))
}

fn of_shape(shape: Shape) -> &'static str {
    let is_square = |side: Vec2| units(side.x) == units(side.y);
    match shape {
        Shape::Circle { .. } => "circle",
        Shape::Ellipse { .. } => "ellipse",
        Shape::Rect { low, high, .. } if is_square(high - low) => "square",
        Shape::Rect { .. } => "rectangle",
    }
}

/// An 8-bit colour in words, such as `dark red`.
pub(super) fn of_color(color: [u8; 3]) -> String {
    let [high, low] = [color.iter().max(), color.iter().min()].map(|v| v.copied().unwrap_or(0));
    let chroma = high - low;
    if chroma < 24 {
        return grey(high).to_owned();
    }
    let hue = hue(color, high, chroma);
    let is_pale = u16::from(chroma) * 5 < u16::from(high) * 2;
    let name = match hue {
        15..45 if high < 160 => return "brown".to_owned(),
        0..15 | 345.. if is_pale => return "pink".to_owned(),
        15..45 => "orange",
        45..70 => "yellow",
        70..165 => "green",
        165..195 => "cyan",
        195..255 => "blue",
        255..290 => "purple",
        290..345 => "magenta",
        _ => "red",
    };
    match high {
        ..128 => format!("dark {name}"),
        _ if is_pale => format!("light {name}"),
        _ => name.to_owned(),
    }
}

fn grey(level: u8) -> &'static str {
    match level {
        ..32 => "black",
        32..100 => "dark grey",
        100..180 => "grey",
        180..240 => "light grey",
        240.. => "white",
    }
}

/// The hue of a colour, in degrees.
fn hue([red, green, blue]: [u8; 3], high: u8, chroma: u8) -> i32 {
    let [red, green, blue] = [red, green, blue].map(i32::from);
    let (from, difference) = if i32::from(high) == red {
        (0, green - blue)
    } else if i32::from(high) == green {
        (120, blue - red)
    } else {
        (240, red - green)
    };
    (from + 60 * difference / i32::from(chroma)).rem_euclid(360)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_names_that_people_give_them() {
        let named = [
            ([0, 0, 0], "black"),
            ([250, 250, 250], "white"),
            ([128, 128, 130], "grey"),
            ([220, 30, 30], "red"),
            ([100, 10, 10], "dark red"),
            ([250, 190, 195], "pink"),
            ([240, 140, 20], "orange"),
            ([120, 80, 40], "brown"),
            ([250, 220, 40], "yellow"),
            ([40, 160, 60], "green"),
            ([160, 200, 250], "light blue"),
            ([20, 40, 110], "dark blue"),
            ([130, 60, 200], "purple"),
        ];
        for (color, name) in named {
            assert_eq!(of_color(color), name, "{color:?}");
        }
    }
}
