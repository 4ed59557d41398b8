//! An element of a drawing: its name and attributes.

use quick_xml::events::BytesStart;

use super::Parsed;
use crate::svg::shape;
use crate::svg::sheet::Rules;

/// The attributes of a path with square ends and mitred corners.
pub(super) const ENDS: [&str; 2] = ["stroke-linecap", "stroke-linejoin"];

/// An element without the attributes that have a prefix.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) attributes: Vec<(String, String)>,
}

impl Element {
    /// The element that a tag opens, with the properties of its classes as attributes.
    pub(super) fn new(tag: &BytesStart<'_>, rules: &Rules) -> Parsed<Self> {
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| format!("not well-formed XML: {e}"))?;
            let key = attribute.key.as_ref();
            if key != "xmlns" && !key.contains(':') {
                attributes.push((key.to_owned(), attribute.value.into_owned()));
            }
        }
        let element = Self {
            name: tag.local_name().as_ref().to_owned(),
            attributes,
        };
        element.classed(rules)
    }

    /// The element with the properties of its classes in the place of the attribute `class`.
    fn classed(mut self, rules: &Rules) -> Parsed<Self> {
        let Some(at) = self.attributes.iter().position(|(key, _)| key == "class") else {
            return Ok(self);
        };
        let (_, classes) = self.attributes.remove(at);
        for class in classes.split_ascii_whitespace() {
            let properties = rules.get(class).ok_or_else(|| {
                let (name, class) = (&self.name, short(class));
                format!("<{name}> has the class {class}, which the style sheet does not have")
            })?;
            for (key, value) in properties {
                if self.find(key).is_some() {
                    return Err(format!("<{}> has {key} twice: remove one", self.name));
                }
                self.attributes.push((key.clone(), value.clone()));
            }
        }
        Ok(self)
    }

    /// The attributes that say where a mark is, how a path ends, and its name; `None` if the element is no mark.
    pub(super) fn places(&self) -> Option<Vec<&'static str>> {
        let path = (self.name == "path").then_some(&["d", ENDS[0], ENDS[1]][..]);
        let places = path.or_else(|| shape::attributes(&self.name))?;
        Some([places, &["id"]].concat())
    }

    pub(super) fn get(&self, key: &str) -> Parsed<&str> {
        self.find(key)
            .ok_or_else(|| format!("<{}> has no {key}", self.name))
    }

    pub(super) fn find(&self, key: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(k, _)| k == key)
            .map(|(_, v)| v.as_str())
    }

    /// The value of the attribute, read by `parse`.
    pub(super) fn parsed<T>(&self, key: &str, parse: impl Fn(&str) -> Option<T>) -> Parsed<T> {
        let text = self.get(key)?;
        parse(text).ok_or_else(|| {
            format!(
                "<{}> has {key}=\"{}\", which is not part of the dialect that strokefit reads",
                self.name,
                short(text)
            )
        })
    }

    /// The value of the attribute, read by `parse`, or `known` if it is absent.
    pub(super) fn either<T>(
        &self,
        key: &str,
        known: Option<T>,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Parsed<Option<T>> {
        match self.find(key) {
            Some(_) => self.parsed(key, parse).map(Some),
            None => Ok(known),
        }
    }

    pub(super) fn expect(&self, key: &str, value: &str) -> Parsed<()> {
        self.parsed(key, |text| (text == value).then_some(()))
            .map_err(|e| format!("{e} (expected \"{value}\")"))
    }

    /// Refuses attributes that would change the drawing in ways that a scene cannot represent.
    pub(super) fn only(&self, keys: &[&str]) -> Parsed<()> {
        match self
            .attributes
            .iter()
            .find(|(key, _)| !keys.contains(&key.as_str()))
        {
            Some((key, _)) => Err(format!(
                "<{}> has the attribute {key}, which is not part of the dialect that strokefit reads",
                self.name
            )),
            None => Ok(()),
        }
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
