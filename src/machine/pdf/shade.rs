//! The shade in PDF: a shading, and one of grey in a soft mask that is its opacity.

use super::file::File;
use super::{channels, number};
use crate::scene::{Scene, Shade, UNITS_PER_PX, WrittenAxis, WrittenStop};

/// Operators that draw the shade of this number on all that is not clipped away.
pub(super) fn operators(number: usize) -> String {
    format!("/Mask{number} gs /Shade{number} sh")
}

/// Length of a sudden change of colour, as a share of the axis.
const STEP: f64 = 1e-4;

/// Adds the objects of the shade of this number, and returns its shading and its mask as the page's resources name them.
pub(super) fn add(file: &mut File, shade: &Shade, number_of: usize, scene: &Scene) -> [String; 2] {
    let colors = shading(shade, "DeviceRGB", &|stop| channels(stop.color));
    let opacities = shading(shade, "DeviceGray", &|stop| {
        number(f64::from(stop.opacity) / 255.0)
    });
    let form = format!(
        "/Type/XObject/Subtype/Form/BBox[0 0 {} {}]/Group<</S/Transparency/CS/DeviceGray>>\
         /Resources<</Shading<</Mask {opacities}>>>>",
        scene.width, scene.height
    );
    let group = file.stream(&form, b"/Mask sh");
    [
        format!("/Shade{number_of} {colors}"),
        format!("/Mask{number_of}<</SMask<</S/Luminosity/G {group} 0 R>>>>"),
    ]
}

/// The shading with a value for each stop.
fn shading(shade: &Shade, space: &str, value: &dyn Fn(&WrittenStop) -> String) -> String {
    let px = |units: i64| number(units as f64 / UNITS_PER_PX as f64);
    let (kind, coords) = match shade.axis {
        WrittenAxis::Linear(ends) => (2, ends.map(px).join(" ")),
        WrittenAxis::Radial([x, y, r]) => {
            let [x, y, r] = [x, y, r].map(px);
            (3, format!("{x} {y} 0 {x} {y} {r}"))
        }
    };
    format!(
        "<</ShadingType {kind}/ColorSpace/{space}/Coords[{coords}]/Extend[true true]/Function {}>>",
        function(&shade.stops, value)
    )
}

/// The values between stops, which change linearly.
fn function(stops: &[WrittenStop], value: &dyn Fn(&WrittenStop) -> String) -> String {
    let offset = |stop: &WrittenStop| f64::from(stop.offset) / 1000.0;
    let first = stops.first().map(|stop| (0.0, value(stop)));
    let last = stops.last().map(|stop| (1.0, value(stop)));
    let between = stops.iter().map(|stop| (offset(stop), value(stop)));
    let mut knots: Vec<(f64, String)> = first.into_iter().chain(between).chain(last).collect();
    knots.dedup_by(|next, kept| next.0 <= kept.0 && next.1 == kept.1);
    // Every step of a stitching function has a length.
    for i in 1..knots.len() {
        knots[i].0 = knots[i].0.max(knots[i - 1].0 + STEP);
    }
    let steps: String = knots
        .windows(2)
        .map(|ends| {
            let [from, to] = [&ends[0].1, &ends[1].1];
            format!("<</FunctionType 2/Domain[0 1]/N 1/C0[{from}]/C1[{to}]>>")
        })
        .collect();
    let inner = knots.len().saturating_sub(2);
    let bounds: Vec<_> = knots
        .iter()
        .skip(1)
        .take(inner)
        .map(|knot| number(knot.0))
        .collect();
    format!(
        "<</FunctionType 3/Domain[0 1]/Functions[{steps}]/Bounds[{}]/Encode[{}]>>",
        bounds.join(" "),
        "0 1 ".repeat(inner + 1).trim_end()
    )
}
