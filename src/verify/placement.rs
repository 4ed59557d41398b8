//! The places where strokes appended to an SVG are drawn, and changes to them. resvg draws a probe, so that
//! units, `viewBox`, style sheets and inheritance are resolved by the renderer itself.

use resvg::usvg::{BlendMode, Color, Group, LineCap, Node, Opacity, Paint, Path, Stroke};

use super::painting::parse;
use super::{check_aspect, side};
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;

/// Where px of `target` lie in the coordinates at the end of an SVG's root element, from the transform of the stroke
/// with the id `probe` there, which is of width 2, colour #010203 and untransformed.
///
/// # Errors
/// As [`fidelity`]; also [`ErrorKind::Svg`] when the SVG changes how such a stroke is drawn.
pub(crate) fn placement(svg: &str, probe: &str, target: &Image) -> Result<[f64; 6]> {
    let tree = parse(svg)?;
    check_aspect(&tree, side(target.width()), side(target.height()))?;
    let path = untouched(tree.root(), probe).filter(|path| is_as_written(path));
    let placed = path.and_then(|path| path.abs_transform().invert());
    let Some(t) = placed else {
        let message = "strokes added to this SVG would look wrong, because its root element or its style sheet \
                       hides, repaints or filters them: move its contents into a group, and the style \
                       to that group";
        return Err(Error::new(ErrorKind::Svg, message));
    };
    // First from px of the target to px of the tree, then by the inverse of the probe's transform to the coordinates in which it
    // is written.
    let scale = |size: f32, px: usize| f64::from(size) / px as f64;
    let (x, y) = (
        scale(tree.size().width(), target.width()),
        scale(tree.size().height(), target.height()),
    );
    let [a, b, c, d, e, f] = [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from);
    Ok([a * x, b * x, c * y, d * y, e, f])
}

/// The path with this id, if no group around it changes how it looks.
fn untouched<'a>(group: &'a Group, id: &str) -> Option<&'a Path> {
    let is_plain = group.opacity() == Opacity::ONE
        && group.blend_mode() == BlendMode::Normal
        && group.clip_path().is_none()
        && group.mask().is_none()
        && group.filters().is_empty();
    // The probe is the last of its document.
    let mut children = group.children().iter().rev().filter(|_| is_plain);
    children.find_map(|child| match child {
        Node::Group(group) => untouched(group, id),
        Node::Path(path) if path.id() == id => Some(&**path),
        _ => None,
    })
}

/// True if the probe is drawn as it says.
fn is_as_written(path: &Path) -> bool {
    let color = Paint::Color(Color::new_rgb(1, 2, 3));
    let is_plain = |stroke: &Stroke| {
        *stroke.paint() == color
            && stroke.width().get() == 2.0
            && stroke.opacity() == Opacity::ONE
            && stroke.linecap() == LineCap::Round
            && stroke.dasharray().is_none()
    };
    path.is_visible()
        && path.fill().is_none()
        && path.rendering_mode().use_shape_antialiasing()
        && path.stroke().is_some_and(is_plain)
}
