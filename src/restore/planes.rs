//! A picture on white, as luma and two chromas.

use crate::error::Result;
use crate::image::Image;

/// How many values of luma have each tone of four levels.
pub(super) fn tones(luma: impl Iterator<Item = f32>) -> [usize; 64] {
    let mut tones = [0; 64];
    for value in luma {
        tones[(value / 4.0).clamp(0.0, 63.0) as usize] += 1;
    }
    tones
}

/// Luma and two chromas (BT.601, as JPEG has them), in levels of 8 bits: luma 0 to 255, chromas −128 to 127.
#[derive(Clone)]
pub(super) struct Planes {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) planes: [Vec<f32>; 3],
    /// The picture's alpha, if it has some.
    pub(super) alpha: Option<Vec<f32>>,
}

impl Planes {
    /// The planes of a picture on white.
    pub(super) fn of(picture: &Image) -> Self {
        let on_white = picture.on([1.0; 3]);
        let [red, green, blue] = on_white.planes();
        let plane = |weights: [f32; 3]| {
            let rgb = red.iter().zip(green).zip(blue);
            rgb.map(|((r, g), b)| 255.0 * (weights[0] * r + weights[1] * g + weights[2] * b))
                .collect()
        };
        Self {
            width: picture.width(),
            height: picture.height(),
            planes: [
                plane([0.299, 0.587, 0.114]),
                plane([-0.168_736, -0.331_264, 0.5]),
                plane([0.5, -0.418_688, -0.081_312]),
            ],
            alpha: picture.alpha().map(<[f32]>::to_vec),
        }
    }

    /// True if nothing shows through a pixel.
    pub(super) fn is_opaque(&self, pixel: usize) -> bool {
        self.alpha.as_ref().is_none_or(|alpha| alpha[pixel] >= 1.0)
    }

    /// The picture of these planes, with its alpha.
    pub(super) fn image(&self) -> Result<Image> {
        let [luma, blue, red] = &self.planes;
        let plane = |of_blue: f32, of_red: f32| {
            let values = luma.iter().zip(blue).zip(red);
            values
                .map(|((y, b), r)| ((y + of_blue * b + of_red * r) / 255.0).clamp(0.0, 1.0))
                .collect()
        };
        let planes = [
            plane(0.0, 1.402),
            plane(-0.344_136, -0.714_136),
            plane(1.772, 0.0),
        ];
        let Some(alpha) = &self.alpha else {
            return Image::new(self.width, self.height, planes);
        };
        // Without the white that shows through.
        let planes = planes.map(|plane: Vec<f32>| {
            let pixels = plane.iter().zip(alpha);
            let own =
                pixels.map(|(v, a)| ((v - (1.0 - a)) / a.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0));
            own.collect()
        });
        Image::new(self.width, self.height, planes)?.with_alpha(alpha.clone())
    }
}
