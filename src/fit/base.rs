//! The base that a fit goes on from: a drawing of ours, or any SVG.

use crate::error::Result;
use crate::image::Image;
use crate::scene::Scene;
use crate::svg::{self, Document, Length, WriteOptions};
use crate::verify;

/// Start of a fit: a document that stays as it is, strokes that are fitted further, or both.
#[derive(Debug, Clone)]
pub struct Base {
    /// Any SVG. It stays as it is, byte for byte, and strokes are added on top.
    pub document: Option<Document>,
    /// Strokes on top, which are fitted together with the new ones and keep their layers.
    pub scene: Scene,
    /// Width of the page, if a drawing of ours states one. It is kept unless the configuration sets another.
    pub width: Option<Length>,
}

impl Base {
    /// Reads the text of an SVG as a base for a drawing of `picture`.
    ///
    /// Strokes are taken from a drawing of ours, and from the layers that we have added to another SVG, provided that
    /// they were fitted to a picture of this size. Everything else stays as it is; with `kept` the strokes do, too.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the text is no SVG, when its aspect ratio differs from that of the
    /// picture, or when it would change the strokes on top of it.
    pub fn read(text: String, picture: &Image, kept: bool) -> Result<Self> {
        let of_its_size = |scene: &Scene| {
            let [width, height] = scene.page.unwrap_or([scene.width, scene.height]);
            (width as usize, height as usize) == (picture.width(), picture.height())
        };
        let own = svg::read(&text).ok().filter(of_its_size);
        if let Some(scene) = own.filter(|_| !kept) {
            return Ok(Self {
                document: None,
                scene,
                width: svg::page_width(&text),
            });
        }
        let document = Document::parse(text)?;
        let split = document.split();
        let laid = split.filter(|(_, scene)| !kept && of_its_size(scene));
        let (mut document, scene) = laid.unwrap_or_else(|| (document, blank(picture)));
        let placement = verify::placement(&document.probed(), document.probe(), picture)?;
        document.place(placement);
        Ok(Self {
            document: Some(document),
            scene,
            width: None,
        })
    }

    /// The SVG of `scene`, which was fitted on `base` if there is one.
    pub fn write(base: Option<&Self>, scene: &Scene, options: &WriteOptions) -> String {
        let Some(base) = base else {
            return svg::write(scene, options);
        };
        if let Some(document) = &base.document {
            return document.with_layers(scene, options);
        }
        let width = options.width.or(base.width);
        svg::write(scene, &WriteOptions { width, ..*options })
    }

    /// The width of the page of a drawing on `base`, if it has a unit.
    pub(super) fn page_width(base: Option<&Self>, options: &WriteOptions) -> Option<Length> {
        match base {
            Some(Self {
                document: Some(document),
                ..
            }) => svg::page_width(document.text()),
            Some(Self { width, .. }) => options.width.or(*width),
            None => options.width,
        }
    }

    /// The number of elements that stay as they are.
    pub fn elements(&self) -> usize {
        self.document.as_ref().map_or(0, Document::elements)
    }

    /// The number of bytes that stay as they are.
    pub(super) fn bytes(&self) -> usize {
        let document = self.document.as_ref();
        document.map_or(0, |document| document.text().len())
    }
}

/// An empty scene of the picture's size.
fn blank(picture: &Image) -> Scene {
    Scene::empty(picture.width() as u32, picture.height() as u32, None)
}
