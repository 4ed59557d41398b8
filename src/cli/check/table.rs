//! The table that `check` prints.

use strokefit::engines::MIN_DB_AGAINST_RESVG;
use strokefit::report::{CheckReport, RendererEntry};
use strokefit::verify::OnMattes;

/// One line for each program, then one for each finding of the lint.
pub(super) fn table(record: &CheckReport) -> String {
    let mut table = format!(
        "{:<9} {:<14} {:>7} {:>7} {:>11} {:>7} {:>9}  {:<20} {:>7}\n",
        "renderer",
        "version",
        "PSNR dB",
        "SSIM",
        "SSIMULACRA2",
        "details",
        "to resvg",
        "largest difference",
        "seconds"
    );
    for entry in &record.renderers {
        table += &row(entry);
    }
    if let Some(alpha) = &record.alpha {
        table += &mattes(alpha);
    }
    for finding in &record.lint {
        table += &format!("{finding}\n");
    }
    table
}

fn row(entry: &RendererEntry) -> String {
    let RendererEntry {
        renderer,
        version,
        fidelity,
        against_resvg,
        wall_s,
        ..
    } = entry;
    let psnr = fidelity.map_or_else(|| "-".into(), |f| format!("{:.2}", f.psnr_db));
    let ssim = fidelity.map_or_else(|| "-".into(), |f| format!("{:.4}", f.ssim));
    let seen = fidelity.map_or_else(|| "-".into(), |f| format!("{:.2}", f.ssimulacra2));
    let kept = fidelity.and_then(|f| f.details_kept);
    let kept = kept.map_or_else(|| "-".into(), |share| format!("{:.1} %", 100.0 * share));
    let (agreement, largest) = match against_resvg {
        Some(other) => {
            let db = other.psnr_db.unwrap_or(f64::INFINITY);
            (
                format!("{db:.2}"),
                format!("{} at {}, {}", other.max_abs, other.x, other.y),
            )
        }
        None => ("-".into(), "-".into()),
    };
    format!(
        "{renderer:<9} {version:<14} {psnr:>7} {ssim:>7} {seen:>11} {kept:>7} {agreement:>9}  {largest:<20} {wall_s:>7.2}\n"
    )
}

/// A picture with alpha, on each matte.
fn mattes(alpha: &OnMattes) -> String {
    let rows = [
        ("black", alpha.black_db, alpha.black_ssimulacra2),
        ("white", alpha.white_db, alpha.white_ssimulacra2),
        ("magenta", alpha.magenta_db, alpha.magenta_ssimulacra2),
    ];
    let row = |(matte, db, seen)| {
        format!(
            "resvg     {:<14} {db:>7.2} {:>7} {seen:>11.2}\n",
            format!("on {matte}"),
            ""
        )
    };
    rows.map(row).concat()
}

/// Says how a program that did not pass differs from resvg.
pub(super) fn shortfall(entry: &RendererEntry) -> String {
    let name = &entry.renderer;
    let agreement_db = entry.against_resvg.and_then(|other| other.psnr_db);
    format!(
        "{name}: draws the file differently from resvg: they agree to {:.2} dB, less than \
         {MIN_DB_AGAINST_RESVG}: see the findings, and use --pictures DIR to see where",
        agreement_db.unwrap_or(f64::INFINITY)
    )
}
