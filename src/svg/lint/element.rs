//! An element of an SVG: its name, attributes and properties.

use quick_xml::events::BytesStart;

use crate::svg::sheet::Rules;

/// An element with its attributes in order and their values unchanged.
pub(super) struct Element {
    pub(super) name: String,
    attributes: Vec<(String, String)>,
    /// The properties of its classes.
    classed: Vec<(String, String)>,
}

impl Element {
    /// The element that a tag opens, or why the tag is not well-formed.
    pub(super) fn new(tag: &BytesStart<'_>, rules: &Rules) -> Result<Self, String> {
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| e.to_string())?;
            attributes.push((
                attribute.key.as_ref().to_owned(),
                attribute.value.into_owned(),
            ));
        }
        let mut element = Self {
            name: tag.local_name().as_ref().to_owned(),
            attributes,
            classed: Vec::new(),
        };
        let classes = element.get("class").unwrap_or_default();
        let own = classes.split_ascii_whitespace();
        element.classed = own
            .filter_map(|class| rules.get(class))
            .flatten()
            .cloned()
            .collect();
        Ok(element)
    }

    /// Names and values.
    pub(super) fn attributes(&self) -> impl Iterator<Item = (&str, &str)> {
        self.attributes
            .iter()
            .map(|(key, value)| (key.as_str(), value.as_str()))
    }

    pub(super) fn get(&self, key: &str) -> Option<&str> {
        self.attributes()
            .find(|(k, _)| *k == key)
            .map(|(_, value)| value.trim())
    }

    /// A property. As in CSS, `style="…"` overrides classes, and these override the attribute.
    pub(super) fn property(&self, key: &str) -> Option<&str> {
        let mut styled = self
            .styles()
            .filter(|(k, _)| *k == key)
            .map(|(_, value)| value);
        styled.next_back().or_else(|| self.get(key))
    }

    /// The properties of its classes and in `style="…"`.
    pub(super) fn styles(&self) -> impl DoubleEndedIterator<Item = (&str, &str)> {
        let style = self.get("style").unwrap_or_default();
        let own = style.split(';').filter_map(|pair| pair.split_once(':'));
        let classed = self.classed.iter();
        let classed = classed.map(|(key, value)| (key.as_str(), value.as_str()));
        classed.chain(own).map(|(key, value)| {
            (
                key.trim(),
                value.trim().trim_end_matches("!important").trim_end(),
            )
        })
    }

    /// `key="value"`, shortened, for a message.
    pub(super) fn quote(&self, key: &str) -> String {
        format!(
            "<{}> with {key}=\"{}\"",
            self.name,
            short(self.property(key).unwrap_or_default())
        )
    }
}

/// The element with the attribute that holds its geometry, for a message.
pub(super) fn quote_shape(element: &Element) -> String {
    match element.name.as_str() {
        "path" => element.quote("d"),
        "line" => element.quote("x1"),
        _ => element.quote("points"),
    }
}

/// The beginning of a text, for a message.
pub(super) fn short(text: &str) -> String {
    let mut start: String = text.chars().take(40).collect();
    if start.len() < text.len() {
        start.push('…');
    }
    start
}
