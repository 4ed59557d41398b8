//! Findings of `strokefit-rig scaling --quality`: how faithful a drawing is that may take so many seconds.

use serde::{Deserialize, Serialize};

use super::{Column, Table};

/// One drawing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QualityEntry {
    /// Name of the picture's file.
    pub picture: String,
    /// The program: `strokefit`, or a peer.
    pub by: String,
    /// Time limit, s, or the settings of a peer.
    pub setting: String,
    /// Wall time, s, without reading the picture and judging the drawing.
    pub wall_s: f64,
    /// Fidelity, dB.
    pub psnr_db: f64,
    /// Length of the file.
    pub bytes: usize,
}

/// All drawings of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct QualityReport {
    /// One per picture, program and setting.
    pub drawings: Vec<QualityEntry>,
}

impl QualityEntry {
    /// The line of standard output.
    pub fn line(&self) -> String {
        let Self {
            picture,
            by,
            setting,
            wall_s,
            psnr_db,
            bytes,
        } = self;
        format!("{picture}, {by} {setting}: {wall_s:.2} s, {psnr_db:.1} dB, {bytes} bytes")
    }
}

impl QualityReport {
    /// One row per drawing.
    pub fn table(&self) -> Table {
        let columns: [Column<QualityEntry>; 6] = [
            ("picture", |e| e.picture.clone()),
            ("by", |e| e.by.clone()),
            ("setting", |e| e.setting.clone()),
            ("wall_s", |e| format!("{:.2}", e.wall_s)),
            ("dB", |e| format!("{:.1}", e.psnr_db)),
            ("bytes", |e| e.bytes.to_string()),
        ];
        Table::of(&columns, &self.drawings)
    }
}
