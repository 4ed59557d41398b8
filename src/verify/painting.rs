//! A picture that grows, as one SVG after another is drawn over it.

use resvg::tiny_skia::Pixmap;

use super::Size;
use super::raster::{Raster, image, opaque};
use super::tree::parse;
use crate::error::Result;
use crate::image::Image;
use crate::scene::Rgb;

/// Render of the parts drawn so far. Parts of a drawing, drawn one after another, give the picture of the whole to the
/// bit, because a renderer rounds after every stroke.
pub struct Painting {
    pixmap: Pixmap,
    size: Size,
}

impl Painting {
    /// Starts with the SVG text `first` on `matte`.
    ///
    /// # Errors
    /// As [`render`](super::render).
    pub fn new(first: &str, size: Size, matte: Rgb) -> Result<Self> {
        let tree = parse(first)?;
        // The first part fixes the raster, and is then drawn like all others.
        let mut pixmap = Raster::new(&tree, size)?.pixmap()?;
        pixmap.fill(opaque(matte));
        let mut painting = Self { pixmap, size };
        painting.add(first)?;
        Ok(painting)
    }

    /// Draws another SVG text, of the same size, over it.
    ///
    /// # Errors
    /// As [`render`](super::render).
    pub fn add(&mut self, svg: &str) -> Result<()> {
        let tree = parse(svg)?;
        let transform = Raster::new(&tree, self.size)?.transform;
        resvg::render(&tree, transform, &mut self.pixmap.as_mut());
        Ok(())
    }

    /// The picture so far, opaque.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](crate::ErrorKind::Picture) as [`Image::new`].
    pub fn image(&self) -> Result<Image> {
        image(&self.pixmap)
    }
}
