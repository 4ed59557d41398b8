//! Files that the general decoder refuses or reads wrong.

use std::cell::Cell;

use ::image::{DynamicImage, ImageFormat};

use super::{Limits, Supply, check_size, general};
use crate::error::Result;
use crate::image::decoded::{Coding, Decoded, Failure};
use crate::image::{Image, Remark, dds, ico, jpeg, profile, tiff};

/// The samples of such a file; `None` if the general decoder is right for it.
pub(super) fn samples(
    bytes: &[u8],
    ran_out: &Cell<bool>,
    format: ImageFormat,
    limits: Limits,
) -> Result<Option<Decoded>, Failure> {
    match format {
        ImageFormat::Jpeg => {
            jpeg::check(bytes)?;
            jpeg::is_ink(bytes).then(|| jpeg::inks(bytes)).transpose()
        }
        ImageFormat::Tiff => {
            let (file, is_palette) = tiff::unfolded(bytes);
            let check = |width, height| check_size(width, height, limits);
            let supply = Supply::new(&file, ran_out);
            tiff::read(supply, is_palette, limits.max_bytes, check).map(Some)
        }
        ImageFormat::Ico => icon(bytes, ran_out, limits).map(Some),
        ImageFormat::Dds => surface(bytes, ran_out, limits).map(Some),
        _ => Ok(None),
    }
}

/// The largest picture of an icon.
fn icon(bytes: &[u8], ran_out: &Cell<bool>, limits: Limits) -> Result<Decoded, Failure> {
    match ico::largest(bytes)? {
        ico::Largest::Png(file) => general(file, ran_out, ImageFormat::Png, limits),
        ico::Largest::Deep(file) => general(&file, ran_out, ImageFormat::Ico, limits),
        ico::Largest::Bitmap(bitmap) => {
            let (width, height) = bitmap.size;
            check_size(width, height, limits)?;
            Ok(plain(bitmap.picture()?))
        }
    }
}

/// The first picture of a DDS.
fn surface(bytes: &[u8], ran_out: &Cell<bool>, limits: Limits) -> Result<Decoded, Failure> {
    let (width, height) = dds::size(bytes).unwrap_or_default();
    check_size(width, height, limits)?;
    let decoded = match dds::uncompressed(bytes)? {
        Some(picture) => plain(picture),
        None => {
            // Compressed blocks are 4×4 px: decode whole blocks, and cut the picture out of them.
            let blocks = general(&dds::padded(bytes), ran_out, ImageFormat::Dds, limits)?;
            plain(blocks.picture.crop_imm(0, 0, width, height))
        }
    };
    Ok(Decoded {
        has_more: dds::has_more(bytes),
        ..decoded
    })
}

/// Samples without further information in the file.
fn plain(picture: DynamicImage) -> Decoded {
    Decoded {
        picture,
        is_ink: false,
        coding: None,
        has_more: false,
    }
}

/// The colours of a picture of inks, which stand where red, green, blue and alpha are: by its profile, or as if each ink
/// took all the light of one colour.
pub(super) fn of_inks(image: Image, coding: Option<&Coding>) -> Result<(Image, Option<Remark>)> {
    let (width, height) = (image.width(), image.height());
    let black = match image.alpha() {
        Some(black) => black.to_vec(),
        // Alpha of 1 everywhere is left out.
        None => vec![1.0; width * height],
    };
    let [cyan, magenta, yellow] = image.into_planes();
    let inks = [cyan, magenta, yellow, black];
    let converted = match coding {
        Some(Coding::Icc(icc)) => profile::of_inks(&inks, width, icc).map(Some),
        _ => Ok(None),
    };
    let (planes, remark) = match converted {
        Ok(Some(planes)) => (planes, Some(Remark::Converted)),
        Ok(None) => (taken_away(&inks), Some(Remark::Inks)),
        Err(why) => (taken_away(&inks), Some(Remark::ProfileIgnored(why))),
    };
    Ok((Image::new(width, height, planes)?, remark))
}

/// Light that ideal inks leave.
fn taken_away([cyan, magenta, yellow, black]: &[Vec<f32>; 4]) -> [Vec<f32>; 3] {
    // Cyan takes away red, magenta green, yellow blue, and black a share of all three.
    [cyan, magenta, yellow].map(|ink| {
        let pairs = ink.iter().zip(black);
        pairs
            .map(|(ink, black)| (1.0 - ink) * (1.0 - black))
            .collect()
    })
}
