//! Reads a shadow: a filter that blurs, and the area that it is for.

use super::super::dialect::{self, BLUR_ID, SHADOW_ID, Unit};
use super::super::shadow::place;
use super::{Element, Parsed, Parser, Style, Tag, unexpected};
use crate::scene::{Mark, Shadow};

/// True if the element begins a shadow.
pub(super) fn begins_with(element: &Element) -> bool {
    element.name == "filter"
}

impl Parser<'_> {
    /// The shadow that begins with the open element `filter`, the `number`-th of its file, up to the end of its area.
    pub(super) fn shadow(&mut self, filter: &Element, number: usize) -> Parsed<Shadow> {
        let id = format!("{BLUR_ID}-{number}");
        filter.expect("id", &id)?;
        for (name, value) in dialect::FILTER {
            filter.expect(name, value)?;
        }
        let known = dialect::FILTER.map(|(name, _)| name);
        filter.only(&[&["id"], &known[..], &dialect::FILTER_PLACE].concat())?;
        let blur = self.blur()?;
        let mut path = self.filled(|e| e.places().is_some())?;
        path.expect("id", &format!("{SHADOW_ID}-{number}"))?;
        path.expect("filter", &format!("url(#{id})"))?;
        path.attributes.retain(|(key, _)| key != "filter");
        let style = Style::new(Unit::PX, [false; 3]);
        let style = style.of(&path, &path.places().unwrap_or_default())?;
        let marks = style.marks(&path)?;
        self.close(&path)?;
        let [Mark::Area(area)] = &marks[..] else {
            return Err("a shadow is a stroke: give an area".into());
        };
        let shadow = Shadow::new(area.clone(), blur).map_err(|error| error.to_string())?;
        for (name, px) in dialect::FILTER_PLACE.iter().zip(place(&shadow)) {
            filter.expect(name, &px.to_string())?;
        }
        Ok(shadow)
    }

    /// The standard deviation, px, of the blur that an open filter has, up to the filter's end.
    fn blur(&mut self) -> Parsed<f32> {
        let (gaussian, deviation) = dialect::GAUSSIAN;
        let blur = match self.next()? {
            Tag::Open(e) if e.name == gaussian => {
                e.only(&[deviation])?;
                let hundredths = |text: &str| {
                    let units = Unit::PX.parse(text)?;
                    (units % dialect::HUNDREDTH == 0).then_some(units / dialect::HUNDREDTH)
                };
                let hundredths = e.parsed(deviation, hundredths)?;
                self.close(&e)?;
                hundredths as f32 / 100.0
            }
            Tag::Open(e) => return Err(unexpected(&e)),
            Tag::Close | Tag::End => return Err("a filter is empty: remove it".into()),
        };
        match self.next()? {
            Tag::Close => Ok(blur),
            Tag::Open(e) => Err(unexpected(&e)),
            Tag::End => Err("the file ends within a filter: get a complete copy".into()),
        }
    }
}
