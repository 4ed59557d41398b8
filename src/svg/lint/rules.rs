//! The rules, in one table: what comes of each, and what to do.

use super::Severity::{self, Error, Note, Warning};

/// What may be wrong with a file.
pub(super) struct Rule {
    pub(super) name: &'static str,
    pub(super) severity: Severity,
    pub(super) why: &'static str,
    pub(super) remedy: &'static str,
}

const fn rule(
    name: &'static str,
    severity: Severity,
    why: &'static str,
    remedy: &'static str,
) -> Rule {
    Rule {
        name,
        severity,
        why,
        remedy,
    }
}

pub(super) const NOT_XML: Rule = rule(
    "not-xml",
    Error,
    "no program reads beyond this place",
    "correct it, or get a complete copy",
);
pub(super) const NAMESPACE: Rule = rule(
    "namespace",
    Error,
    "nothing of it is drawn",
    "write xmlns=\"http://www.w3.org/2000/svg\" on the root, with http",
);
pub(super) const EXTERNAL: Rule = rule(
    "external-reference",
    Error,
    "it is drawn only where that file or address is at hand",
    "embed it as data:, or remove it",
);
pub(super) const MISSING_ID: Rule = rule(
    "missing-id",
    Error,
    "no element has this id, so that some programs draw nothing and others the element as it is",
    "give the id to the element that is meant",
);
pub(super) const DUPLICATE_ID: Rule = rule(
    "duplicate-id",
    Warning,
    "programs differ in which of the elements they take",
    "make every id unique",
);
pub(super) const LAYER_ID: Rule = rule(
    "layer-id",
    Note,
    "editors give the layer a new name each time",
    "give the group an id that starts with a letter",
);
pub(super) const ID_START: Rule = rule(
    "id-start",
    Note,
    "style sheets and some programs cannot name such an id",
    "let ids start with a letter",
);
pub(super) const PAGE_SIZE: Rule = rule(
    "page-size",
    Warning,
    "programs differ in the size that the page gets",
    "give a width and height, and a viewBox=\"0 0 W H\" of the same aspect ratio",
);
pub(super) const PAGE_SCALE: Rule = rule(
    "page-scale",
    Note,
    "a unit of the file is not a px of the page",
    "nothing, if it is meant so; else give the width, height and viewBox=\"0 0 W H\" the same numbers",
);
pub(super) const ZERO_LENGTH: Rule = rule(
    "zero-length",
    Warning,
    "many programs drop it, though with round caps it is a dot by the specification",
    "make it a segment of 0.01, or a circle",
);
pub(super) const THIN_STROKE: Rule = rule(
    "thin-stroke",
    Warning,
    "at a width of 1 px or less, resvg and browsers draw a tenth less ink than Cairo",
    "make it at least 1.02 px wide, and less opaque",
);
pub(super) const COLOR_ALPHA: Rule = rule(
    "color-alpha",
    Warning,
    "Inkscape draws it opaque, and CairoSVG #rrggbbaa",
    "write #rrggbb and stroke-opacity or fill-opacity",
);
pub(super) const GROUP_OPACITY: Rule = rule(
    "group-opacity",
    Warning,
    "it takes a picture of its own to mix, which is slow, and some importers drop it",
    "write stroke-opacity or fill-opacity on each element",
);
pub(super) const LEADING_DOT: Rule = rule(
    "leading-dot",
    Note,
    "some readers, Android's among them, fail on a number without a leading digit",
    "write 0.5, not .5",
);
pub(super) const SCRIPT: Rule = rule(
    "script",
    Warning,
    "only browsers run it, and only in files that are opened by themselves",
    "remove it",
);
pub(super) const FEATURE: Rule = rule(
    "feature",
    Warning,
    "programs differ in how, or whether, they draw it",
    "draw it with paths, or expect differences",
);
pub(super) const TEXT: Rule = rule(
    "text",
    Warning,
    "it looks as the fonts of each machine make it, and resvg draws none here",
    "convert it to paths",
);
pub(super) const STYLE_SHEET: Rule = rule(
    "style-sheet",
    Warning,
    "many importers pass over style sheets, and so does this lint",
    "write the properties on the elements",
);
pub(super) const DOCTYPE: Rule = rule(
    "doctype",
    Note,
    "strict readers refuse document types and their entities",
    "remove it and write the entities out",
);
pub(super) const DIALECT: Rule = rule(
    "dialect",
    Note,
    "it is drawn alike, but strokefit writes no such element",
    "nothing, unless the file should be edited as strokes",
);
pub(super) const LARGE_FILE: Rule = rule(
    "large-file",
    Error,
    "programs built on libxml2 stop at 10 MB",
    "write fewer strokes or decimals",
);
pub(super) const DEEP: Rule = rule(
    "deep",
    Error,
    "programs built on libxml2 stop at 256 levels",
    "ungroup",
);
