//! Reports of what commands did: plain records that serialise to JSON.
//!
//! Scripts rely on the field names: fields may be added, none is renamed. Times are in seconds; errors are
//! as in [`metrics`](crate::metrics). `psnr_db` is `null` where two pictures are equal, since JSON has no
//! infinity. Fields that do not apply, or that could not be measured, are `null` as well.

mod check;
mod event;
mod fit;
mod judged;
#[cfg(feature = "animation")]
#[doc(hidden)]
pub mod picture;
mod scene;
mod size;
mod usage;

use serde::{Deserialize, Serialize};

use crate::damage::Damage;
use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, Remark};

pub use check::{AgainstResvg, CheckReport, NotDrawn, RendererEntry};
pub use event::{Event, PhaseEntry};
pub use fit::{BaseEntry, FitReport, Run};
pub use judged::{Judged, OnFocus};
pub use scene::{MarkRecord, SceneRecord, ShadeRecord};
pub(crate) use size::deflated;
pub use size::{gzip_bytes, per_stroke};
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
