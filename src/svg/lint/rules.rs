//! The rules of the lint: what each finding leads to, and the remedy.

use super::Severity::{self, Error, Note, Warning};

/// One kind of problem that a file can have.
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
    "correct the XML, or get a complete copy",
);
pub(super) const NAMESPACE: Rule = rule(
    "namespace",
    Error,
    "programs draw nothing of it",
    "write xmlns=\"http://www.w3.org/2000/svg\" on the root, with http",
);
pub(super) const EXTERNAL: Rule = rule(
    "external-reference",
    Error,
    "it is drawn only where that file or address can be reached",
    "embed it as data:, or remove it",
);
pub(super) const MISSING_ID: Rule = rule(
    "missing-id",
    Error,
    "no element has this id; some programs then draw nothing, others ignore the reference",
    "give this id to the intended element",
);
pub(super) const DUPLICATE_ID: Rule = rule(
    "duplicate-id",
    Warning,
    "programs differ in which of these elements they use",
    "make every id unique",
);
pub(super) const LAYER_ID: Rule = rule(
    "layer-id",
    Note,
    "editors give the layer a new id at every save",
    "give the group an id that starts with a letter",
);
pub(super) const ID_START: Rule = rule(
    "id-start",
    Note,
    "style sheets and some programs cannot name such an id",
    "start ids with a letter",
);
pub(super) const PAGE_SIZE: Rule = rule(
    "page-size",
    Warning,
    "programs differ in the size of the page",
    "give a width and height, and a viewBox=\"0 0 W H\" of the same aspect ratio",
);
pub(super) const PAGE_SCALE: Rule = rule(
    "page-scale",
    Note,
    "one unit of the file is not one px of the page",
    "nothing, if this is intended; otherwise use the same numbers in width, height and viewBox=\"0 0 W H\"",
);
pub(super) const ZERO_LENGTH: Rule = rule(
    "zero-length",
    Warning,
    "many programs drop it, although the specification makes it a dot if it has round caps",
    "use a segment of length 0.01, or a circle",
);
pub(super) const THIN_STROKE: Rule = rule(
    "thin-stroke",
    Warning,
    "at widths up to 1 px, resvg and browsers draw a tenth less ink than Cairo",
    "use a width of at least 1.02 px and a lower opacity",
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
    "it needs a picture of its own for blending, which is slow, and some importers ignore it",
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
    "only browsers run it, and only if the file is opened directly",
    "remove it",
);
pub(super) const FEATURE: Rule = rule(
    "feature",
    Warning,
    "programs draw it differently, or not at all",
    "draw it with paths, or expect differences",
);
pub(super) const TEXT: Rule = rule(
    "text",
    Warning,
    "it looks different with the fonts of each machine, and resvg loads no fonts here",
    "convert it to paths",
);
pub(super) const STYLE_SHEET: Rule = rule(
    "style-sheet",
    Warning,
    "many importers ignore style sheets, and so does this lint",
    "put the properties on the elements",
);
pub(super) const STYLE_CLASSES: Rule = rule(
    "style-classes",
    Note,
    "editors and browsers draw it alike, but many importers ignore style sheets and fill all black",
    "nothing, unless such a program is to read the file; then put the properties on the elements",
);
pub(super) const DOCTYPE: Rule = rule(
    "doctype",
    Note,
    "strict readers refuse document types and their entities",
    "remove it and expand the entities",
);
pub(super) const DIALECT: Rule = rule(
    "dialect",
    Note,
    "all programs draw it alike, but strokefit never writes such an element",
    "nothing, unless strokefit should read the file as strokes",
);
pub(super) const LARGE_FILE: Rule = rule(
    "large-file",
    Error,
    "programs built on libxml2 stop at 10 MB",
    "use fewer strokes or decimals",
);
pub(super) const DEEP: Rule = rule(
    "deep",
    Error,
    "programs built on libxml2 stop at 256 levels",
    "remove levels of groups",
);
