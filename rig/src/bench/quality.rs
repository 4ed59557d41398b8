//! Time to quality: how faithful a drawing is that may take so many seconds, and those of peers beside it.

use std::path::PathBuf;
use std::time::Instant;

use strokefit::Result;
use strokefit::fit::{Budget, Config, Fitter};
use strokefit::image::Image;
use strokefit::report::Judged;
use strokefit::verify;

use super::peers::Peer;
use crate::report::quality::{QualityEntry, QualityReport};

/// Limits, s; the last drawing has none.
const LIMITS_S: [f64; 6] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0];

/// Draws each of the `pictures` on white within each limit, and at each setting of the `peers`, and says a line for each drawing.
///
/// # Errors
/// When a picture cannot be read or drawn.
pub fn run(
    pictures: &[PathBuf],
    peers: &[Box<dyn Peer>],
    say: &mut dyn FnMut(&str),
) -> Result<QualityReport> {
    let mut report = QualityReport::default();
    for path in pictures {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let picture = Image::open(path)?.flattened([1.0; 3]);
        let limits = LIMITS_S.into_iter().map(Some).chain([None]);
        let own = limits.map(|limit_s| ours(&name, &picture, limit_s));
        let others = peers.iter().flat_map(|peer| {
            let settings = peer.settings().into_iter();
            settings.map(|setting| theirs(&name, &picture, peer.as_ref(), setting))
        });
        for drawing in own.chain(others) {
            let drawing = drawing?;
            say(&drawing.line());
            report.drawings.push(drawing);
        }
    }
    Ok(report)
}

fn ours(name: &str, picture: &Image, limit_s: Option<f64>) -> Result<QualityEntry> {
    let config = Config {
        budget: Budget {
            time: limit_s.map(std::time::Duration::from_secs_f64),
            ..Budget::default()
        },
        ..Config::default()
    };
    let start = Instant::now();
    let fit = Fitter::new(config).fit(picture)?;
    let wall_s = start.elapsed().as_secs_f64();
    let judged = Judged::new(fit)?;
    Ok(QualityEntry {
        picture: name.into(),
        by: "strokefit".into(),
        setting: limit_s.map_or_else(|| "no limit".into(), |s| format!("{s} s")),
        wall_s,
        psnr_db: judged.verdict.fidelity.psnr_db,
        bytes: judged.svg.len(),
    })
}

fn theirs(name: &str, picture: &Image, peer: &dyn Peer, setting: String) -> Result<QualityEntry> {
    let start = Instant::now();
    let svg = peer.trace(picture, &setting)?.svg;
    let wall_s = start.elapsed().as_secs_f64();
    Ok(QualityEntry {
        picture: name.into(),
        by: peer.name().into(),
        setting,
        wall_s,
        psnr_db: verify::fidelity(&svg, picture)?.psnr_db,
        bytes: svg.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_limit_has_a_drawing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("disc.png");
        let disc = Image::from_fn(32, 32, 3, |x, y, _| {
            let away = strokefit::math::hypot(x as f32 - 16.0, y as f32 - 16.0);
            if away < 9.5 { 0.2 } else { 1.0 }
        });
        std::fs::write(&path, disc.unwrap().encode_png().unwrap()).unwrap();
        let mut lines = Vec::new();
        let report = run(&[path], &[], &mut |line| lines.push(line.to_owned())).unwrap();
        assert_eq!(report.drawings.len(), LIMITS_S.len() + 1);
        assert_eq!(lines.len(), report.drawings.len());
        let last = report.drawings.last().unwrap();
        assert!(
            last.psnr_db > 25.0 && last.setting == "no limit",
            "{last:?}"
        );
        assert!(
            lines[0].starts_with("disc, strokefit 0.1 s: "),
            "{}",
            lines[0]
        );
    }
}
