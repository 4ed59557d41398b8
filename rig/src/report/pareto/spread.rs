//! The spread of drawings that differ only in their seed.

use serde::{Deserialize, Serialize};

use super::ParetoEntry;
use strokefit::math;

/// Drawings that differ in their seed alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The picture.
    pub picture: String,
    /// Who, and with which settings.
    pub label: String,
    /// Number of seeds.
    pub seeds: usize,
    /// Mean and standard deviation of the fidelity, dB.
    pub psnr_db: [f64; 2],
    /// Of the CPU time, s.
    pub cpu_s: [f64; 2],
    /// Of the bytes after gzip.
    pub gzip_bytes: [f64; 2],
}

/// The spreads of all drawings that were made with several seeds.
pub fn spreads(entries: &[ParetoEntry]) -> Vec<Spread> {
    let key = |entry: &ParetoEntry| {
        let unseeded = entry
            .label
            .rsplit_once("seed")
            .map_or(entry.label.as_str(), |(head, _)| head);
        (
            entry.picture.clone(),
            format!("{} {}", entry.family, unseeded.trim_end_matches([' ', ','])),
        )
    };
    let mut groups: Vec<((String, String), Vec<&ParetoEntry>)> = Vec::new();
    for entry in entries
        .iter()
        .filter(|entry| entry.seed.is_some() && entry.fidelity.is_some())
    {
        let key = key(entry);
        match groups.iter_mut().find(|(k, _)| *k == key) {
            Some((_, group)) => group.push(entry),
            None => groups.push((key, vec![entry])),
        }
    }
    let several = groups.into_iter().filter(|(_, group)| group.len() > 1);
    several
        .map(|((picture, label), group)| Spread {
            picture,
            label,
            seeds: group.len(),
            psnr_db: spread(group.iter().filter_map(|e| e.psnr_db())),
            cpu_s: spread(group.iter().filter_map(|e| e.cpu_s)),
            gzip_bytes: spread(group.iter().map(|e| e.gzip_bytes as f64)),
        })
        .collect()
}

/// Mean and standard deviation of a sample.
fn spread(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let n = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|v| math::powi(v - mean, 2)).sum::<f64>() / (n - 1.0).max(1.0);
    [mean, variance.sqrt()]
}

#[cfg(test)]
mod tests {
    use super::super::{OWN, drawing};
    use super::*;

    #[test]
    fn seeds_are_told_apart_from_settings() {
        let entries = [
            drawing(OWN, "draft 100 smoothstep seed 0", 0.5, 900, 30.0),
            drawing(OWN, "draft 100 smoothstep seed 1", 0.7, 900, 32.0),
            drawing(OWN, "best 100 smoothstep seed 0", 9.0, 900, 33.0),
        ];
        let spreads = spreads(&entries);
        assert_eq!(spreads.len(), 1);
        assert_eq!(spreads[0].seeds, 2);
        assert!((spreads[0].psnr_db[0] - 31.0).abs() < 1e-12);
        assert!((spreads[0].psnr_db[1] - 2f64.sqrt()).abs() < 1e-12);
    }
}
