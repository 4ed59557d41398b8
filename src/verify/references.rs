//! The size of an SVG once every reference is replaced by its target.
//!
//! Ten patterns that each draw the one before ten times are a dozen lines, and ten thousand million parts.
//! resvg follows some of these references without counting, so they are counted beforehand: in the tree that resvg draws, whose
//! entities are expanded. The tree of `svg` has the text as it is.

use std::collections::HashMap;

use resvg::usvg::roxmltree::{Document, Node, NodeId};

/// Most parts of an unfolded SVG.
const MAX_PARTS: f64 = 4e6;
/// Deepest nesting of elements in an unfolded SVG; resvg's own bound is 1024.
const MAX_DEPTH: usize = 1000;

/// Result of a check, or the reason for a refusal.
type Checked<T> = Result<T, String>;

/// Fails when the unfolded document would be too large or too deep.
pub(super) fn check(document: &Document<'_>) -> Checked<()> {
    let elements = || document.descendants().filter(Node::is_element);
    let mut by_id = HashMap::new();
    for node in elements() {
        if node.attribute("d").is_some_and(is_vast) {
            return Err("a path has numbers beyond 10^12".into());
        }
        if let Some(id) = node.attribute("id") {
            by_id.entry(id).or_insert(node);
        }
    }
    let sheets = elements().filter(|node| node.tag_name().name() == "style");
    let styled = sheets.filter_map(|node| node.text()).flat_map(rules);
    let styled = styled.collect();
    let mut unfolding = Unfolding {
        by_id,
        styled,
        parts: HashMap::new(),
    };
    let parts = unfolding.parts(document.root_element(), 0)?;
    if parts > MAX_PARTS {
        return Err(format!("its parts refer to each other {parts:.0} times"));
    }
    Ok(())
}

struct Unfolding<'a, 'input> {
    by_id: HashMap<&'a str, Node<'a, 'input>>,
    /// Selectors of style sheets, each with an id that its rule refers to.
    styled: Vec<(&'a str, &'a str)>,
    /// Parts of the elements that were counted; `None` while that is under way.
    parts: HashMap<NodeId, Option<f64>>,
}

impl<'a, 'input: 'a> Unfolding<'a, 'input> {
    /// Number of parts that an element is made of, itself included.
    fn parts(&mut self, node: Node<'a, 'input>, depth: usize) -> Checked<f64> {
        if depth > MAX_DEPTH {
            return Err(format!(
                "its parts are nested more than {MAX_DEPTH} levels deep"
            ));
        }
        if let Some(known) = self.parts.get(&node.id()) {
            // resvg does not follow an element that refers to itself.
            return Ok(known.unwrap_or(0.0));
        }
        // Mark the element as under way, so that a cycle of references ends here.
        self.parts.insert(node.id(), None);
        let mut parts = 1.0;
        for child in node.children().filter(Node::is_element) {
            parts += self.parts(child, depth + 1)?;
        }
        let styled = self
            .styled
            .iter()
            .filter(|(selector, _)| selects(selector, node));
        let styled: Vec<&str> = styled.map(|(_, id)| *id).collect();
        let named = references(node).chain(styled);
        for id in named {
            if let Some(target) = self.by_id.get(id).copied().filter(|n| unfolds(*n)) {
                parts += self.parts(target, depth + 1)?;
            }
        }
        // Kept: each element is counted once, however many references lead to it. So the count takes linear time for a document
        // that unfolds to 10¹⁰ parts.
        self.parts.insert(node.id(), Some(parts));
        Ok(parts)
    }
}

/// True if a reference to the element draws all that is in it.
fn unfolds(node: Node<'_, '_>) -> bool {
    !matches!(node.tag_name().name(), "linearGradient" | "radialGradient")
}

/// True if path data has numbers beyond 10¹²: arcs of such radii are cut in millions of pieces, which takes hours.
fn is_vast(d: &str) -> bool {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let wholes = d.split(|c: char| !c.is_ascii_digit() && c != '.');
    let exponents = d.split(['e', 'E']).skip(1).filter(|rest| {
        let rest = rest.strip_prefix('+').unwrap_or(rest);
        let rest = rest.trim_start_matches('0');
        // Digits of an exponent above 11, or so many that they don't fit a u32.
        let exponent = rest.get(..digits(rest)).unwrap_or_default();
        !exponent.is_empty() && exponent.parse().is_ok_and(|n: u32| n > 11) || exponent.len() > 9
    });
    exponents.count() > 0 || wholes.into_iter().any(|number| digits(number) > 12)
}

/// The ids that an element's attributes refer to.
fn references<'a>(node: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    node.attributes().flat_map(|attribute| {
        let value = attribute.value();
        let href = (attribute.name() == "href")
            .then(|| value.trim().strip_prefix('#'))
            .flatten();
        href.into_iter().chain(urls(value))
    })
}

/// The selectors of a style sheet, each with an id that its rule refers to.
fn rules(sheet: &str) -> impl Iterator<Item = (&str, &str)> {
    let rules = sheet.split('}').filter_map(|rule| rule.split_once('{'));
    rules.flat_map(|(selector, body)| urls(body).map(move |id| (selector, id)))
}

/// True if a selector may mean the element: it names one of its classes, or no class at all.
fn selects(selector: &str, node: Node<'_, '_>) -> bool {
    let classes = node.attribute("class").unwrap_or_default();
    let mut named = classes.split_ascii_whitespace();
    !selector.contains('.') || named.any(|class| selector.contains(&format!(".{class}")))
}

/// The ids in all `url(#id)` of a text.
fn urls(text: &str) -> impl Iterator<Item = &str> {
    text.split("url(").skip(1).filter_map(|rest| {
        let id = rest.split(')').next()?.trim();
        let id = id.trim_matches(['"', '\'']).trim();
        id.strip_prefix('#')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(body: &str) -> Checked<()> {
        let text = format!("<svg>{body}</svg>");
        check(&Document::parse(&text).unwrap())
    }

    fn tower(levels: usize, times: usize, reference: &str) -> String {
        let part = |level: usize| {
            let below = reference.replace("ID", &format!("a{}", level.wrapping_sub(1)));
            format!("<g id=\"a{level}\">{}</g>", below.repeat(times))
        };
        (0..levels).map(part).collect()
    }

    #[test]
    fn towers_of_references_are_refused() {
        for reference in [
            "<use href=\"#ID\"/>",
            "<g fill=\"url(#ID)\"/>",
            "<g style=\"mask: url( '#ID' )\"/>",
        ] {
            assert!(checked(&tower(12, 10, reference)).is_err(), "{reference}");
            checked(&tower(5, 10, reference)).unwrap();
            assert!(checked(&tower(2000, 1, reference)).is_err(), "{reference}");
        }
    }

    #[test]
    fn vast_numbers_are_found_in_any_form() {
        for d in [
            "M1e38 0",
            "M0-2E+12z",
            "a1,1 0 0 0 .5e0013 2",
            "M1234567890123",
            "M0 1e99999999999",
        ] {
            assert!(is_vast(d), "{d}");
        }
        for d in [
            "M1e9 0",
            "M.12345678901234 1e-30",
            "M123456789012-3",
            "M0 0h.01z",
            "e",
        ] {
            assert!(!is_vast(d), "{d}");
        }
    }

    #[test]
    fn what_refers_to_itself_has_an_end() {
        checked("<g id=\"a\"><use href=\"#b\"/></g><g id=\"b\"><use href=\"#a\"/></g>").unwrap();
    }

    #[test]
    fn style_sheets_refer_too() {
        let inside = tower(6, 9, "<use href=\"#ID\"/>");
        let drawn = |class: &str| {
            let sheet = "<style>.x { fill: red; mask: url(#a5) } .y { fill: blue }</style>";
            format!(
                "{sheet}{inside}{}",
                format!("<g class=\"{class}\"/>").repeat(9)
            )
        };
        assert!(checked(&drawn("x")).is_err());
        checked(&drawn("y")).unwrap();
    }

    #[test]
    fn gradients_are_colours() {
        let gradient = format!(
            "<linearGradient id=\"a\">{}</linearGradient>",
            "<stop/>".repeat(500)
        );
        let drawn = "<path fill=\"url(#a)\"/>".repeat(20_000);
        checked(&(gradient + &drawn)).unwrap();
    }
}
