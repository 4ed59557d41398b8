//! Reads a shade: a gradient, and the rectangle or the area that it fills.

use super::super::dialect::{self, SHADE_ID, Unit};
use super::{Element, Parsed, Parser, Style, Tag, sides, unexpected};
use crate::scene::{MAX_STOPS, Mark, Shade, WrittenAxis, WrittenStop};

/// True if the element begins a shade.
pub(super) fn begins_with(element: &Element) -> bool {
    [dialect::LINEAR, dialect::RADIAL].contains(&element.name.as_str())
}

impl Parser<'_> {
    /// The shade of the page that begins with the open element `gradient`, up to the end of the rectangle that it fills.
    pub(super) fn shade(&mut self, gradient: &Element, width: u32, height: u32) -> Parsed<Shade> {
        gradient.expect("id", SHADE_ID)?;
        let shade = self.gradient(gradient)?;
        let rect = self.filled(|e| e.name == "rect")?;
        sides(&rect, width, height)?;
        rect.expect("fill", &format!("url(#{SHADE_ID})"))?;
        self.close(&rect)?;
        Ok(shade)
    }

    /// The area that begins with the open element `gradient`, up to the end of its path.
    pub(super) fn shaded_area(&mut self, gradient: &Element, style: &Style) -> Parsed<Mark> {
        let id = gradient.get("id")?;
        let fill = format!("url(#{id})");
        let shade = self.gradient(gradient)?;
        let mut path = self.filled(|e| e.places().is_some())?;
        path.expect("fill", &fill)?;
        path.attributes.retain(|(key, _)| key != "fill");
        let style = style.of(&path, &path.places().unwrap_or_default())?;
        if style.is_painted() {
            return Err(
                "<path> has a gradient and another colour: give a file that strokefit wrote".into(),
            );
        }
        let area = style.area(&path, shade.mean(), Some(shade))?;
        self.close(&path)?;
        Ok(area)
    }

    /// The gradient that begins with this open element.
    fn gradient(&mut self, gradient: &Element) -> Parsed<Shade> {
        let axis = axis(gradient)?;
        let mut stops = Vec::new();
        loop {
            match self.next()? {
                Tag::Open(e) if e.name == "stop" && stops.len() < MAX_STOPS => {
                    stops.push(stop(&e)?);
                    self.close(&e)?;
                }
                Tag::Open(e) => return Err(unexpected(&e)),
                Tag::Close => break,
                Tag::End => {
                    return Err("the file ends within a gradient: get a complete copy".into());
                }
            }
        }
        Shade::written(axis, stops).ok_or_else(|| {
            "the gradient is shorter than a px, or has less than two stops or stops out of order".into()
        })
    }

    /// The element that has to follow a gradient or a filter.
    pub(super) fn filled(&mut self, is_it: impl Fn(&Element) -> bool) -> Parsed<Element> {
        match self.next()? {
            Tag::Open(e) if is_it(&e) => Ok(e),
            Tag::Open(e) => Err(unexpected(&e)),
            Tag::Close | Tag::End => Err(
                "nothing follows a gradient or a filter: give a file that strokefit wrote".into(),
            ),
        }
    }
}

fn axis(gradient: &Element) -> Parsed<WrittenAxis> {
    gradient.expect("gradientUnits", "userSpaceOnUse")?;
    let numbers = |names: &[&str]| -> Parsed<Vec<i64>> {
        gradient.only(&[&["id", "gradientUnits"], names].concat())?;
        let parse = |text: &str| {
            Unit::PX
                .parse(text)
                .filter(|units| units % dialect::HUNDREDTH == 0)
        };
        names
            .iter()
            .map(|name| gradient.parsed(name, parse))
            .collect()
    };
    Ok(if gradient.name == dialect::LINEAR {
        let [ax, ay, bx, by] = numbers(&dialect::LINEAR_AXIS)?[..] else {
            return Err(unexpected(gradient));
        };
        WrittenAxis::Linear([ax, ay, bx, by])
    } else {
        let [x, y, radius] = numbers(&dialect::RADIAL_AXIS)?[..] else {
            return Err(unexpected(gradient));
        };
        WrittenAxis::Radial([x, y, radius])
    })
}

fn stop(element: &Element) -> Parsed<WrittenStop> {
    element.only(&["offset", "stop-color", "stop-opacity"])?;
    let thousandths = |text: &str| {
        let units = Unit::PX.parse(text)?;
        let whole = units % dialect::THOUSANDTH == 0;
        let thousandths = u16::try_from(units / dialect::THOUSANDTH).ok()?;
        (whole && thousandths <= 1000).then_some(thousandths)
    };
    let opacity = |text: &str| match text {
        "0" => Some(0),
        text => dialect::opacity_quantum(text),
    };
    Ok(WrittenStop {
        offset: element.parsed("offset", thousandths)?,
        color: element.parsed("stop-color", dialect::channels)?,
        opacity: element
            .either("stop-opacity", Some(u8::MAX), opacity)?
            .unwrap_or(u8::MAX),
    })
}
