//! PDF: one page with a layer for each stage of the drawing (ISO 32000-1; layers are its optional content).

mod file;
mod shade;
mod shadow;

use std::fmt::Write;

use super::sheet::Sheet;
use crate::scene::{Mark, Path, Piece, Rgb, Scene, quantum};
use file::File;

/// The bytes of a PDF of the drawing. Colours are those of the screen (`DeviceRGB`), curves are exact, and lengths are those
/// of the page.
pub fn pdf(sheet: &Sheet<'_>) -> Vec<u8> {
    let scene = sheet.scene;
    let mut file = File::new();
    let [catalog, pages, page] = [file.reserve(), file.reserve(), file.reserve()];
    let layers: Vec<usize> = (1..=scene.stages.len())
        .map(|number| file.add(&format!("<</Type/OCG/Name(Layer {number})>>")))
        .collect();
    // The page's shade comes first, and then those of areas in their order.
    let [mut shadings, mut masks] = [const { String::new() }; 2];
    let shades = scene.marks().filter_map(Mark::shade);
    for (number, shade) in scene.shade.iter().chain(shades).enumerate() {
        let [shading, mask] = shade::add(&mut file, shade, number, scene);
        shadings += &shading;
        masks += &mask;
    }
    let size = [scene.width, scene.height];
    for (number, shadow) in scene.shadows.iter().enumerate() {
        masks += &shadow::add(&mut file, shadow, number, size);
    }
    let content = file.stream("", content(sheet).as_bytes());
    let (states, layers_named) = (states(scene), names(&layers));
    let resources =
        format!("/ExtGState<<{states}{masks}>>/Properties<<{layers_named}>>/Shading<<{shadings}>>");
    let [width, height] =
        [scene.width, scene.height].map(|side| number(f64::from(side) * sheet.pt()));
    file.set(
        page,
        &format!(
            "<</Type/Page/Parent {pages} 0 R/MediaBox[0 0 {width} {height}]\
             /Group<</S/Transparency/CS/DeviceRGB>>/Contents {content} 0 R/Resources<<{resources}>>>>"
        ),
    );
    file.set(pages, &format!("<</Type/Pages/Kids[{page} 0 R]/Count 1>>"));
    let groups = list(&layers);
    file.set(
        catalog,
        &format!(
            "<</Type/Catalog/Pages {pages} 0 R/OCProperties<</OCGs[{groups}]/D<</Order[{groups}]/ON[{groups}]>>>>>>"
        ),
    );
    file.finish(catalog)
}

/// References to objects.
fn list(objects: &[usize]) -> String {
    let references: Vec<_> = objects.iter().map(|id| format!("{id} 0 R")).collect();
    references.join(" ")
}

/// The opacities by the names that the content has for them.
fn states(scene: &Scene) -> String {
    let is_used = |k: &u8| scene.marks().any(|mark| quantum(mark.opacity()) == *k);
    let state = |k: u8| {
        let opacity = number(f64::from(k) / 255.0);
        format!("/O{k}<</ca {opacity}/CA {opacity}>>")
    };
    (0..=u8::MAX).filter(is_used).map(state).collect()
}

/// The layers by the names that the content has for them.
fn names(layers: &[usize]) -> String {
    let name = |(id, number): (&usize, usize)| format!("/L{number} {id} 0 R");
    layers.iter().zip(1..).map(name).collect()
}

/// The operators that draw the page.
fn content(sheet: &Sheet<'_>) -> String {
    let scene = sheet.scene;
    let (scale, height) = (sheet.pt(), f64::from(scene.height) * sheet.pt());
    // PDF's y axis goes up.
    let mut out = format!(
        "{} 0 0 {} 0 {} cm\n1 J 1 j\n",
        number(scale),
        number(-scale),
        number(height)
    );
    if let Some(color) = scene.background {
        let _ = writeln!(
            out,
            "{} rg 0 0 {} {} re f",
            rgb(color),
            scene.width,
            scene.height
        );
    }
    let mut shades = 0..;
    if scene.shade.is_some() {
        let _ = writeln!(out, "q {} Q", shade::operators(shades.next().unwrap_or(0)));
    }
    for (number, shadow) in scene.shadows.iter().enumerate() {
        let size = [scene.width, scene.height];
        let _ = writeln!(out, "q {} Q", shadow::operators(shadow, number, size));
    }
    for (stage, number) in scene.stages.iter().zip(1..) {
        let _ = writeln!(out, "/OC/L{number} BDC");
        for mark in &stage.marks {
            let shade = mark.shade().and_then(|_| shades.next());
            push(&mut out, mark, shade);
        }
        out += "EMC\n";
    }
    out
}

/// Appends the operators of a mark, which has the shade of this number.
fn push(out: &mut String, mark: &Mark, shade: Option<usize>) {
    let _ = write!(
        out,
        "/O{} gs {} ",
        quantum(mark.opacity()),
        rgb(mark.color())
    );
    match mark {
        Mark::Stroke(stroke) => {
            let _ = writeln!(out, "RG {} w", number(2.0 * f64::from(stroke.radius)));
            push_path(out, &stroke.path);
            *out += "S\n";
        }
        Mark::Area(area) if let Some(band) = area.band() => {
            // Square ends and mitred corners, which do not reach farther than in SVG.
            let _ = writeln!(out, "RG q 0 J 0 j 4 M {} w", number(band.width.into()));
            push_path(out, &band.line);
            *out += if band.line.is_closed() {
                "s Q\n"
            } else {
                "S Q\n"
            };
        }
        Mark::Area(area) => {
            *out += "rg\n";
            *out += if shade.is_some() { "q " } else { "" };
            area.rings.iter().for_each(|ring| push_path(out, ring));
            match shade {
                Some(shade) => {
                    let _ = writeln!(out, "W n {} Q", shade::operators(shade));
                }
                None => *out += "f\n",
            }
        }
    }
}

/// Appends the operators of a path.
fn push_path(out: &mut String, path: &Path) {
    let mut pieces = path.pieces().peekable();
    let start = pieces.peek().map(|piece| piece.start());
    let start = start.or_else(|| path.points().first().map(|dot| dot.at));
    let at = |x: f32, y: f32| format!("{} {}", number(x.into()), number(y.into()));
    if let Some(start) = start {
        let _ = writeln!(out, "{} m", at(start.x, start.y));
    }
    if let [dot] = path.points() {
        // A subpath of no length with round caps is a disc.
        let _ = writeln!(out, "{} l", at(dot.at.x, dot.at.y));
    }
    for piece in pieces {
        let _ = match piece {
            Piece::Line([_, b]) => writeln!(out, "{} l", at(b.x, b.y)),
            Piece::Curve([a, c, b]) => {
                // A quadratic curve as a cubic one.
                let third = |end: f32, knee: f32| end + (knee - end) * 2.0 / 3.0;
                let first = at(third(a.x, c.x), third(a.y, c.y));
                let second = at(third(b.x, c.x), third(b.y, c.y));
                writeln!(out, "{first} {second} {} c", at(b.x, b.y))
            }
        };
    }
    if path.is_closed() {
        *out += "h\n";
    }
}

/// The channels of a colour.
fn rgb(color: Rgb) -> String {
    channels(color.map(quantum))
}

/// Channels of 8 bits as PDF counts them.
fn channels(color: [u8; 3]) -> String {
    let parts = color.map(|c| number(f64::from(c) / 255.0));
    parts.join(" ")
}

/// A number with at most 4 decimals.
#[inline(never)]
fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}
