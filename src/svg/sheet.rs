//! The style sheet of the form `css`: a class for each colour of areas, each colour of strokes, and each width.
//!
//! ```text
//! <style>
//! .background{fill:#ffffff}
//! .red{fill:#c03020}
//! .red-line{stroke:#c03020}
//! .width-1{stroke-width:2.5}
//! </style>
//! ```
//!
//! Selectors of a single class are what all programs with style sheets know; not all know custom properties. Colours have
//! the names that people give them, with a number where several have one name, in the order that they are drawn in. Widths
//! are numbered from the thinnest.

use std::collections::{BTreeMap, BTreeSet};

use super::dialect::{self, Unit};
use super::layer::Written;
use super::names;
use crate::scene::distinct_colors;

/// The class of the page.
pub(super) const BACKGROUND: &str = "background";

/// The properties of each class, in order.
pub(super) type Rules = BTreeMap<String, Vec<(String, String)>>;

/// The classes of a drawing.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    colors: BTreeMap<[u8; 3], String>,
    widths: BTreeMap<i64, String>,
    rules: String,
}

impl Sheet {
    /// The classes of these marks, back to front, on this background.
    pub(super) fn of<'a>(
        background: Option<[u8; 3]>,
        marks: impl Iterator<Item = &'a Written>,
    ) -> Self {
        let marks: Vec<&Written> = marks.filter(|mark| mark.mark.shade().is_none()).collect();
        let order = distinct_colors(marks.iter().map(|mark| mark.color()));
        let strokes = marks.iter().filter(|mark| !mark.is_filled());
        let mut widths: Vec<i64> = strokes.map(|stroke| stroke.width()).collect();
        widths.sort_unstable();
        widths.dedup();
        let widths = widths.into_iter().zip(1..);
        let mut sheet = Self {
            colors: named(&order),
            widths: widths
                .map(|(width, number)| (width, format!("width-{number}")))
                .collect(),
            rules: String::new(),
        };
        sheet.rules = sheet.written(background, &marks, &order);
        sheet
    }

    /// The element of the style sheet.
    pub(super) fn text(&self) -> String {
        format!("<style>\n{}</style>\n", self.rules)
    }

    /// The attribute that gives a mark its colour and width; nothing if it has a gradient.
    pub(super) fn class(&self, mark: &Written) -> String {
        match (
            self.colors.get(&mark.color()),
            self.widths.get(&mark.width()),
        ) {
            _ if mark.mark.shade().is_some() => String::new(),
            (Some(color), None) => format!(" class=\"{color}\""),
            (Some(color), Some(width)) => format!(" class=\"{color}-line {width}\""),
            (None, _) => String::new(),
        }
    }

    /// The rules as text, one a line.
    fn written(
        &self,
        background: Option<[u8; 3]>,
        marks: &[&Written],
        order: &[[u8; 3]],
    ) -> String {
        let has = |is_area: bool| {
            let own = marks.iter().filter(move |mark| mark.is_filled() == is_area);
            own.map(|mark| mark.color()).collect::<BTreeSet<_>>()
        };
        let (areas, strokes) = (has(true), has(false));
        let mut rules = background.map_or_else(String::new, |color| {
            format!(".{BACKGROUND}{{fill:{}}}\n", dialect::hex(color))
        });
        for color in order {
            let name = self.colors.get(color).map_or("", String::as_str);
            let hex = dialect::hex(*color);
            if areas.contains(color) {
                rules += &format!(".{name}{{fill:{hex}}}\n");
            }
            if strokes.contains(color) {
                rules += &format!(".{name}-line{{stroke:{hex}}}\n");
            }
        }
        for (&width, name) in &self.widths {
            rules += &format!(".{name}{{stroke-width:");
            Unit::PX.push(&mut rules, width);
            rules += "}\n";
        }
        rules
    }
}

/// The colours with their names, which have numbers where several colours have one name.
fn named(colors: &[[u8; 3]]) -> BTreeMap<[u8; 3], String> {
    let word = |color: &[u8; 3]| names::of_color(*color).replace(' ', "-");
    let mut alike: BTreeMap<String, Vec<[u8; 3]>> = BTreeMap::new();
    for color in colors {
        alike.entry(word(color)).or_default().push(*color);
    }
    let named = |(word, colors): (String, Vec<[u8; 3]>)| {
        let is_one = colors.len() == 1;
        let numbered = colors.into_iter().zip(1..);
        numbered.map(move |(color, number)| match is_one {
            true => (color, word.clone()),
            false => (color, format!("{word}-{number}")),
        })
    };
    alike.into_iter().flat_map(named).collect()
}

/// The rules of a style sheet; `None` if one is for anything else than a class.
pub(super) fn parse(text: &str) -> Option<Rules> {
    let mut rules = Rules::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (selector, after) = rest.split_once('{')?;
        let (declarations, after) = after.split_once('}')?;
        let properties = rules
            .entry(class_name(selector.trim())?.to_owned())
            .or_default();
        for declaration in declarations
            .split(';')
            .filter(|text| !text.trim().is_empty())
        {
            let (key, value) = declaration.split_once(':')?;
            properties.push((key.trim().to_owned(), value.trim().to_owned()));
        }
        rest = after.trim_start();
    }
    Some(rules)
}

/// The name of the class that a selector is for, and nothing else.
fn class_name(selector: &str) -> Option<&str> {
    let name = selector.strip_prefix('.')?;
    let is_plain = |b: u8| b.is_ascii_alphanumeric() || b == b'-' || b == b'_';
    (!name.is_empty() && name.bytes().all(is_plain)).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_one_name_are_numbered_in_the_order_of_the_drawing() {
        let colors = [[220, 30, 30], [20, 40, 110], [200, 20, 20]];
        let named = named(&colors);
        let names = colors.map(|color| named[&color].as_str());
        assert_eq!(names, ["red-1", "dark-blue", "red-2"]);
    }

    #[test]
    fn rules_of_classes_are_read_and_others_refused() {
        let rules = parse("\n.a-1{fill:#fff}\n .b { stroke : red; stroke-width:2 ; }").unwrap();
        let pair = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        assert_eq!(rules["a-1"], [pair("fill", "#fff")]);
        assert_eq!(
            rules["b"],
            [pair("stroke", "red"), pair("stroke-width", "2")]
        );
        for text in [
            "path{fill:red}",
            ".a.b{}",
            ".a,.b{}",
            ".a .b{}",
            "@import 'x';",
            ".a{fill}",
            ".a{fill:red",
            ".{}",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
        assert_eq!(parse(" "), Some(Rules::new()));
    }
}
