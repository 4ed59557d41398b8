//! The result of a fit.

use std::time::Duration;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::base::Base;
use super::drawing::focus::Focus;
use crate::image::Image;
use crate::metrics::null_is_infinite;
use crate::restore::Damage;
use crate::scene::{Dropped, Rgb, Scene};
use crate::svg::WriteOptions;

/// A finished drawing and how it came to be.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The drawing, rounded like the numbers of its SVG. On a document it holds only the strokes on top.
    pub scene: Scene,
    /// The base, if there was one.
    pub base: Option<Base>,
    /// Where errors counted, if not everywhere alike.
    pub focus: Option<Focus>,
    /// Options of the file. The drawing was fitted and settled for these options.
    pub file: WriteOptions,
    /// The target: the picture with its alpha, or flattened onto the background.
    pub target: Image,
    /// What the file lies on when it is compared with the target: where the picture is opaque and the file has no background, the
    /// colour of the picture's paper.
    pub matte: Rgb,
    /// Damage of the picture, if some was recognised: the drawing is then of the restored picture.
    pub damage: Option<Damage>,
    /// The picture that was drawn, if that is not the target: without its damage.
    pub meant: Option<Image>,
    /// Our own render of `scene` with the edge of a finished drawing; with alpha if the drawing has no
    /// background and the picture has alpha.
    pub soft: Image,
    /// One record per stage of `scene`, the base's stages included.
    pub stages: Vec<StageRecord>,
    /// Why the fit ended.
    pub stop: Stop,
    /// Loss of fidelity, dB, because the colours were stacked to have one layer each; `None` if they were not.
    pub stacking_db: Option<f64>,
    /// Strokes that were dropped because they became non-finite or could not be seen.
    pub dropped: Dropped,
}

impl Fit {
    /// The drawing as SVG text, together with its base.
    pub fn svg(&self) -> String {
        Base::write(self.base.as_ref(), &self.scene, &self.file)
    }
}

/// The record of one stage. In JSON, an infinite number of dB is `null`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StageRecord {
    /// From 1.
    pub index: usize,
    /// Strokes of this stage in the final drawing.
    pub strokes: usize,
    /// Iterations of the optimiser.
    pub iterations: usize,
    /// Wall time of the stage; a checkpoint and a report have `wall_s`, in s.
    #[serde(
        rename = "wall_s",
        serialize_with = "seconds",
        deserialize_with = "span"
    )]
    pub wall: Duration,
    /// Fidelity of the soft render to the target after the stage, dB, at the resolution that the stage
    /// was fitted at: large strokes are fitted to a reduced picture.
    #[serde(deserialize_with = "null_is_infinite")]
    pub psnr_db: f64,
    /// Fidelity of the finished drawing's layers up to this one, dB.
    #[serde(deserialize_with = "null_is_infinite")]
    pub layer_psnr_db: f64,
}

fn seconds<S: Serializer>(wall: &Duration, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(wall.as_secs_f64())
}

fn span<'de, D: Deserializer<'de>>(from: D) -> Result<Duration, D::Error> {
    Duration::try_from_secs_f64(f64::deserialize(from)?).map_err(de::Error::custom)
}

/// Why a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stop {
    /// The stroke budget is used.
    Strokes,
    /// The fidelity asked for is reached.
    Psnr,
    /// The byte budget is used.
    Bytes,
    /// The time is up.
    Time,
    /// No further stroke pays.
    Converged,
    /// The observer or a [`CancelToken`](super::CancelToken) stopped the fit.
    Interrupted,
}
