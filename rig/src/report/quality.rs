//! Findings of `strokefit-rig scaling --quality`: how faithful a drawing is that may take so many seconds.

use serde::{Deserialize, Serialize};

use super::Table;

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
    fn cells(&self) -> [String; 6] {
        [
            self.picture.clone(),
            self.by.clone(),
            self.setting.clone(),
            format!("{:.2}", self.wall_s),
            format!("{:.1}", self.psnr_db),
            self.bytes.to_string(),
        ]
    }

    /// The line of standard output.
    pub fn line(&self) -> String {
        let [picture, by, setting, wall_s, psnr_db, bytes] = self.cells();
        format!("{picture}, {by} {setting}: {wall_s} s, {psnr_db} dB, {bytes} bytes")
    }
}

impl QualityReport {
    /// One row per drawing.
    pub fn table(&self) -> Table {
        let mut table = Table::new(&["picture", "by", "setting", "wall_s", "dB", "bytes"]);
        self.drawings
            .iter()
            .for_each(|drawing| table.row(drawing.cells()));
        table
    }
}
