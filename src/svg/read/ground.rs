//! Reads gradients, and shadows: filters that blur, with the areas that they are for.

use super::element::Element;
use super::{Reader, elements, painted, unexpected};
use crate::error::Result;
use crate::math::Point;
use crate::scene::{Area, Axis, Mark, Scene, Shade, ShadeStop, color, px};
use crate::svg::dialect::{self, BLUR_ID, SHADE_ID, SHADOW_ID, SURFACE_ID, Unit};
use crate::svg::dom::Node;
use crate::svg::gradient::place;

/// True if the element is a gradient.
pub(super) fn is_gradient(node: &Node<'_>) -> bool {
    [dialect::LINEAR, dialect::RADIAL].contains(&node.name())
}

/// True if the element is the gradient of a page.
pub(super) fn is_of_page(node: &Node<'_>) -> bool {
    is_gradient(node) && node.get("id") == Some(SHADE_ID)
}

/// True if the element is one of the ground, or comes before one.
pub(super) fn is_in_ground(node: &Node<'_>) -> bool {
    let is_surface = |id: &str| id.starts_with(SURFACE_ID);
    node.name() == "filter" || is_gradient(node) || node.get("id").is_some_and(is_surface)
}

/// The element after a gradient or a filter.
pub(super) fn filled<'r>(definition: Node<'_>, next: Option<Node<'r>>) -> Result<Node<'r>> {
    let why = "nothing follows a gradient or a filter: give a file that strokefit wrote";
    next.ok_or_else(|| definition.refused(why))
}

/// The number of an attribute in units of `step` each, if it is whole.
fn whole(text: &str, step: i64) -> Option<i64> {
    let units = Unit::PX.parse(text)?;
    (units % step == 0).then_some(units / step)
}

impl Reader {
    /// The gradient of a page, and the rectangle after it.
    pub(super) fn page_gradient(
        &self,
        gradient: Node<'_>,
        next: Option<Node<'_>>,
        page: &Scene,
    ) -> Result<Area> {
        self.element(gradient)?.expect("id", SHADE_ID)?;
        let rect = filled(gradient, next)?;
        if rect.name() != "rect" {
            return Err(unexpected(rect));
        }
        let rect = self.leaf(rect)?;
        rect.expect_page(page)?;
        rect.expect("fill", &format!("url(#{SHADE_ID})"))?;
        let (_, shade) = self.gradient(gradient)?;
        Ok(Area::page(shade, [page.width, page.height]))
    }

    /// The id of a gradient, and its colours.
    pub(super) fn gradient<'r>(&'r self, node: Node<'r>) -> Result<(String, Shade)> {
        let gradient = self.element(node)?;
        let axis = axis(&gradient)?;
        let stop = |node: Node<'_>| match node.name() {
            "stop" => stop(&self.leaf(node)?),
            _ => Err(unexpected(node)),
        };
        let stops = elements(node)?.into_iter().map(stop);
        let stops = stops.collect::<Result<Vec<_>>>()?;
        let why =
            "is shorter than a px, or has less than two stops, too many, or stops out of order";
        let shade = Shade::new(axis, &stops).map_err(|_| gradient.refused(why))?;
        Ok((gradient.get("id", |id| Some(id.to_owned()))?, shade))
    }

    /// The thing below shadows of an element, the `number`-th of its file, with its gradient.
    pub(super) fn surface(
        &self,
        gradient: Option<Node<'_>>,
        node: Node<'_>,
        group: &Element<'_>,
        number: usize,
    ) -> Result<Area> {
        let shade = gradient.map(|node| self.gradient(node)).transpose()?;
        let area = self.mark(node, group, &[])?;
        area.expect("id", &format!("{SURFACE_ID}-{number}"))?;
        match &painted(&area, Unit::PX, shade)?[..] {
            [Mark::Area(area)] => Ok(area.clone()),
            _ => Err(area.refused("is below shadows and a stroke: make it an area")),
        }
    }

    /// The shadow of a filter, the `number`-th of its file, and the area after it.
    pub(super) fn shadow(
        &self,
        node: Node<'_>,
        next: Option<Node<'_>>,
        number: usize,
    ) -> Result<Area> {
        let filter = self.element(node)?;
        let known = dialect::FILTER.map(|(name, _)| name);
        filter.only(&[&["id"], &known[..], &dialect::FILTER_PLACE].concat())?;
        let id = format!("{BLUR_ID}-{number}");
        for (name, value) in dialect::FILTER.into_iter().chain([("id", id.as_str())]) {
            filter.expect(name, value)?;
        }
        let (gaussian, deviation) = dialect::GAUSSIAN;
        let steps = elements(node)?;
        let [blur] = steps[..] else {
            return Err(filter.refused("has not one step: give a file that strokefit wrote"));
        };
        if blur.name() != gaussian {
            return Err(unexpected(blur));
        }
        let blur = self.leaf(blur)?;
        blur.only(&[deviation])?;
        let hundredths = blur.get(deviation, |text| whole(text, dialect::HUNDREDTH))?;

        let area = self.mark(filled(node, next)?, &filter, &["filter"])?;
        area.expect("id", &format!("{SHADOW_ID}-{number}"))?;
        area.expect("filter", &format!("url(#{id})"))?;
        let [Mark::Area(shape)] = &painted(&area, Unit::PX, None)?[..] else {
            return Err(area.refused("is a shadow and a stroke: make it an area"));
        };
        let shadow = shape.clone().blurred(hundredths as f32 / 100.0);
        let shadow = shadow.map_err(|error| area.refused(error))?;
        for (name, px) in dialect::FILTER_PLACE.iter().zip(place(&shadow)) {
            filter.expect(name, &px.to_string())?;
        }
        Ok(shadow)
    }
}

fn axis(gradient: &Element<'_>) -> Result<Axis> {
    let is_linear = gradient.node.name() == dialect::LINEAR;
    let names = if is_linear {
        &dialect::LINEAR_AXIS[..]
    } else {
        &dialect::RADIAL_AXIS
    };
    gradient.only(&[&["id", "gradientUnits"], names].concat())?;
    gradient.expect("gradientUnits", "userSpaceOnUse")?;
    let hundredths = |text: &str| Some(px(whole(text, dialect::HUNDREDTH)? * dialect::HUNDREDTH));
    let number = |name: &&str| gradient.get(name, hundredths);
    match names.iter().map(number).collect::<Result<Vec<_>>>()?[..] {
        [x, y, radius] => Ok(Axis::Radial {
            center: Point::new(x, y),
            radius,
        }),
        [ax, ay, bx, by] => Ok(Axis::Linear {
            from: Point::new(ax, ay),
            to: Point::new(bx, by),
        }),
        _ => Err(unexpected(gradient.node)),
    }
}

fn stop(element: &Element<'_>) -> Result<ShadeStop> {
    element.only(&["offset", "stop-color", "stop-opacity"])?;
    let thousandths = |text: &str| {
        let thousandths = u16::try_from(whole(text, dialect::THOUSANDTH)?).ok()?;
        (thousandths <= 1000).then_some(thousandths)
    };
    let opacity = |text: &str| match text {
        "0" => Some(0),
        text => dialect::opacity_quantum(text),
    };
    let opacity = element.either("stop-opacity", opacity)?;
    Ok(ShadeStop {
        offset: f32::from(element.get("offset", thousandths)?) / 1000.0,
        color: color(element.get("stop-color", dialect::channels)?),
        opacity: f32::from(opacity.unwrap_or(u8::MAX)) / 255.0,
    })
}
