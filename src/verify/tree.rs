//! Parses SVG text into the tree that resvg draws.

use resvg::usvg::roxmltree::{self, Document, ParsingOptions};
use resvg::usvg::{Options, Tree};

use super::limits::{self, Embedded};
use super::{guarded, references};
use crate::error::{Error, ErrorKind, Result};
use crate::svg::SVG_NAMESPACE;

/// Reads SVG text.
pub(super) fn parse(svg: &str) -> Result<Tree> {
    let embedded = Embedded::default();
    let options = Options {
        image_href_resolver: embedded.resolver(),
        ..Options::default()
    };
    let unreadable = |e: &dyn std::fmt::Display| {
        Error::new(
            ErrorKind::Svg,
            format!("not an SVG that resvg can read: {e}"),
        )
    };
    let allow_dtd = ParsingOptions {
        allow_dtd: true,
        nodes_limit: limits::MAX_NODES,
        ..ParsingOptions::default()
    };
    let document =
        Document::parse_with_options(svg, allow_dtd).map_err(|e| unreadable(&e).caused_by(e))?;
    check_namespace(&document)?;
    references::check(&document).map_err(limits::refusal)?;
    let tree = guarded(|| Tree::from_xmltree(&document, &options))?;
    let tree = tree.map_err(|e| match e {
        resvg::usvg::Error::ElementsLimitReached
        | resvg::usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => too_much(e),
        e => unreadable(&e).caused_by(e),
    })?;
    embedded.check()?;
    Ok(tree)
}

fn too_much(error: resvg::usvg::Error) -> Error {
    let message = "the SVG has more than a million elements, with <use> expanded, or more than 1,024 levels of \
                   nesting, and resvg cannot read it: simplify it";
    Error::new(ErrorKind::Svg, message).caused_by(error)
}

/// resvg ignores elements of other namespaces, and would call the empty page a success.
fn check_namespace(document: &Document<'_>) -> Result<()> {
    let root = document.root_element().tag_name();
    if root.name() == "svg" && root.namespace() == Some(SVG_NAMESPACE) {
        return Ok(());
    }
    let (name, namespace) = (root.name(), root.namespace().unwrap_or_default());
    let message = format!(
        "the root element is <{name}> of the namespace \"{namespace}\", so nothing would be drawn: \
         start the SVG with <svg xmlns=\"{SVG_NAMESPACE}\">"
    );
    Err(Error::new(ErrorKind::Svg, message))
}
