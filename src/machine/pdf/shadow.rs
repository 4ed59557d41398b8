//! The shadow in PDF: its outline has no blur there, so that its coverage is an image, which masks its colour.

use super::file::File;
use super::rgb;
use crate::render;
use crate::scene::Shadow;

/// Adds the soft mask of the shadow of this number, and returns it as the page's resources name it.
pub(super) fn add(
    file: &mut File,
    shadow: &Shadow,
    number: usize,
    [width, height]: [u32; 2],
) -> String {
    let coverage = render::coverage(shadow, width as usize, height as usize);
    let opacity = shadow.area().opacity;
    let levels: Vec<u8> = coverage
        .into_iter()
        .map(|covered| (255.0 * opacity * covered + 0.5) as u8)
        .collect();
    let image = format!(
        "/Type/XObject/Subtype/Image/Width {width}/Height {height}/ColorSpace/DeviceGray/BitsPerComponent 8/Interpolate true"
    );
    let image = file.stream(&image, &levels);
    let form = format!(
        "/Type/XObject/Subtype/Form/BBox[0 0 {width} {height}]/Group<</S/Transparency/CS/DeviceGray>>\
         /Resources<</XObject<</Image {image} 0 R>>>>"
    );
    // An image fills a square whose y axis goes up.
    let group = file.stream(
        &form,
        format!("{width} 0 0 -{height} 0 {height} cm /Image Do").as_bytes(),
    );
    format!("/Blur{number}<</SMask<</S/Luminosity/G {group} 0 R>>>>")
}

/// Operators that draw the shadow of this number on a page of this size.
pub(super) fn operators(shadow: &Shadow, number: usize, [width, height]: [u32; 2]) -> String {
    let color = rgb(shadow.area().color);
    format!("/Blur{number} gs {color} rg 0 0 {width} {height} re f")
}
