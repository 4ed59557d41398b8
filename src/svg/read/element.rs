//! An element of a drawing: its node, and its attributes with those of its classes.

use super::INHERITED;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::svg::dialect::SVG_NAMESPACE;
use crate::svg::dom::{Node, short};
use crate::svg::sheet::Rules;

/// An element without the attributes that have a prefix.
pub(super) struct Element<'r> {
    pub(super) node: Node<'r>,
    attributes: Vec<(&'r str, &'r str)>,
}

impl<'r> Element<'r> {
    /// The element of a node, with the properties of its classes in the place of the attribute `class`.
    pub(super) fn new(node: Node<'r>, rules: &'r Rules) -> Result<Self> {
        let is_plain = |key: &str| key != "xmlns" && key != "class" && !key.contains(':');
        let plain = node.attributes().iter().filter(|(key, _)| is_plain(key));
        let attributes = plain.copied().collect();
        let mut element = Self { node, attributes };
        if !node.is_svg() {
            let why =
                format!("is not in the namespace \"{SVG_NAMESPACE}\": give the root this xmlns");
            return Err(element.refused(why));
        }
        for class in node
            .get("class")
            .unwrap_or_default()
            .split_ascii_whitespace()
        {
            let missing = || {
                element.refused(format!(
                    "has the class {}, which is in no style sheet",
                    short(class)
                ))
            };
            for (key, value) in rules.get(class).ok_or_else(missing)? {
                if element.find(key).is_some() {
                    return Err(element.refused(format!("has {key} twice: remove one")));
                }
                element.attributes.push((key, value));
            }
        }
        Ok(element)
    }

    /// The element with the attributes `outer` that it inherits, if it has no others than inherited ones and `own`.
    pub(super) fn within(mut self, outer: &[(&'r str, &'r str)], own: &[&str]) -> Result<Self> {
        self.only(&[own, &INHERITED].concat())?;
        // The first value of a name counts.
        self.attributes.extend(outer);
        Ok(self)
    }

    /// The attributes that elements in this one inherit.
    pub(super) fn inherited(&self) -> Vec<(&'r str, &'r str)> {
        let all = self.attributes.iter();
        all.filter(|(key, _)| INHERITED.contains(key))
            .copied()
            .collect()
    }

    pub(super) fn refused(&self, why: impl std::fmt::Display) -> Error {
        self.node
            .refused(format!("<{}> {why}", short(self.node.name())))
    }

    pub(super) fn find(&self, key: &str) -> Option<&'r str> {
        let mut attributes = self.attributes.iter();
        attributes.find(|(k, _)| *k == key).map(|(_, value)| *value)
    }

    /// The value of the attribute, read by `parse`.
    pub(super) fn get<T>(&self, key: &str, parse: impl Fn(&str) -> Option<T>) -> Result<T> {
        let missing = || self.refused(format!("has no {key}"));
        self.either(key, parse)?.ok_or_else(missing)
    }

    /// The value of the attribute, if there is one.
    pub(super) fn either<T>(
        &self,
        key: &str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>> {
        let Some(text) = self.find(key) else {
            return Ok(None);
        };
        let refused = || {
            self.refused(format!(
                "has {key}=\"{}\", which is not part of the dialect",
                short(text)
            ))
        };
        parse(text).ok_or_else(refused).map(Some)
    }

    /// Refuses any other value of the attribute.
    pub(super) fn expect(&self, key: &str, value: &str) -> Result<()> {
        let found = self.find(key).unwrap_or_default();
        let why = || format!("has {key}=\"{}\": make it \"{value}\"", short(found));
        (found == value)
            .then_some(())
            .ok_or_else(|| self.refused(why()))
    }

    /// Refuses attributes that would change the drawing in ways that a scene cannot represent.
    pub(super) fn only(&self, keys: &[&str]) -> Result<()> {
        let mut given = self.attributes.iter().map(|(key, _)| key);
        let other = given.find(|key| !keys.contains(key));
        let refused = |key| {
            self.refused(format!(
                "has the attribute {key}, which is not part of the dialect: remove it"
            ))
        };
        other.map_or(Ok(()), |key| Err(refused(key)))
    }

    /// Refuses a rectangle that is not the page, or that has anything else but a fill.
    pub(super) fn expect_page(&self, page: &Scene) -> Result<()> {
        self.only(&["width", "height", "fill"])?;
        self.expect("width", &page.width.to_string())?;
        self.expect("height", &page.height.to_string())
    }
}
