//! Reports of what commands did: plain records that serialise to JSON.
//!
//! Scripts rely on the field names: fields may be added, none is renamed. Times are in seconds; errors are
//! as in [`metrics`](crate::metrics). `psnr_db` is `null` where two pictures are equal, since JSON has no
//! infinity. Fields that do not apply, or that could not be measured, are `null` as well. The one door of `flate2`.

mod check;
mod fit;
mod judged;
mod scene;
mod usage;

use std::io::Write;

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, Remark};
use crate::restore::Damage;

pub use check::{AgainstResvg, CheckReport, NotDrawn, RendererEntry};
pub use fit::{BaseEntry, Event, FitReport, PhaseEntry, Run};
pub use judged::{Judged, OnFocus};
pub use scene::{LineRecord, MarkRecord, MoreRecord, SceneRecord, ShadeRecord};
pub use usage::Usage;

/// Version of the records' layout.
pub const SCHEMA: u32 = 1;

/// A picture that was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// As it was named; `-` for standard input.
    pub path: String,
    /// Width in px.
    pub width: usize,
    /// Height in px.
    pub height: usize,
    /// Changes and omissions in reading it, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// Damage that its drawing leaves out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
}

impl Input {
    /// The record of `image`, named `path`.
    pub fn new(path: impl Into<String>, image: &Image) -> Self {
        Self {
            path: path.into(),
            width: image.width(),
            height: image.height(),
            remarks: Vec::new(),
            damage: None,
        }
    }

    /// This record with the changes and omissions in reading the picture.
    #[must_use]
    pub fn remarking(self, remarks: &[Remark]) -> Self {
        let remarks = remarks.iter().map(ToString::to_string).collect();
        Self { remarks, ..self }
    }
}

/// A record as `--report` writes it: indented JSON, and a line break.
///
/// # Errors
/// [`ErrorKind::Io`] when the record cannot be said in JSON, as none of this module.
pub fn json(record: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(record);
    text.map(|text| text + "\n").map_err(|cause| {
        Error::new(
            ErrorKind::Io,
            format!("a record cannot be written as JSON: {cause}"),
        )
        .caused_by(cause)
    })
}

/// Bytes of `text` after gzip at its highest level, as a web server may send it.
pub fn gzip_bytes(text: &str) -> usize {
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to memory cannot fail.
    let _ = gzip.write_all(text.as_bytes());
    gzip.finish().map_or(0, |bytes| bytes.len())
}

/// The bytes compressed as zlib does at its highest level.
pub(crate) fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing to memory cannot fail.
    let _ = zlib.write_all(bytes);
    zlib.finish().unwrap_or_default()
}

/// A picture of `values`, row by row, each coloured by `color`. Rows have `width` values; an
/// incomplete last row is left out.
///
/// # Errors
/// [`ErrorKind::Picture`](crate::ErrorKind::Picture) when there is no complete row, or a colour is
/// not finite.
#[cfg(feature = "animation")]
#[doc(hidden)]
pub fn map<V: Copy>(width: usize, values: &[V], color: impl Fn(V) -> [f64; 3]) -> Result<Image> {
    let height = values.len().checked_div(width).unwrap_or(0);
    let mut planes: [Vec<f32>; 3] = Default::default();
    for &value in &values[..width * height] {
        for (plane, c) in planes.iter_mut().zip(color(value)) {
            plane.push(c.clamp(0.0, 1.0) as f32);
        }
    }
    Image::new(width, height, planes)
}

/// From dark blue over green to yellow, for 0 to 1; equal steps look equal.
#[cfg(feature = "animation")]
#[doc(hidden)]
pub fn heat(value: f64) -> [f64; 3] {
    const STOPS: [[f64; 3]; 5] = [
        [0.27, 0.0, 0.33],
        [0.23, 0.32, 0.55],
        [0.13, 0.57, 0.55],
        [0.37, 0.79, 0.38],
        [0.99, 0.91, 0.14],
    ];
    let at = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let i = (at as usize).min(STOPS.len() - 2);
    let part = at - i as f64;
    std::array::from_fn(|k| STOPS[i][k] + part * (STOPS[i + 1][k] - STOPS[i][k]))
}

#[cfg(test)]
#[cfg(feature = "animation")]
mod tests {
    use super::*;

    #[test]
    fn incomplete_rows_are_left_out() {
        let image = map(2, &[0.0, 1.0, 0.5], heat).unwrap();
        assert_eq!((image.width(), image.height()), (2, 1));
        assert!(map(0, &[0.0], heat).is_err());
        assert!(map(4, &[0.0], heat).is_err());
    }

    #[test]
    fn colours_stay_within_their_range() {
        for i in -50..=50 {
            let value = f64::from(i) / 10.0;
            let image = map(1, &[value], heat).unwrap();
            let planes = image.planes();
            assert!(
                planes.iter().all(|p| (0.0..=1.0).contains(&p[0])),
                "{value}"
            );
        }
    }

    #[test]
    fn what_repeats_is_compressed() {
        let text = "<path/>".repeat(1000);
        assert!((18..200).contains(&gzip_bytes(&text)));
    }
}
