//! Inkscape, which draws with Cairo.

use super::Engine;

pub(super) const ENGINE: Engine = Engine {
    name: "inkscape",
    install: "apt-get install inkscape, or https://inkscape.org",
    programs: &["inkscape"],
    arguments: |job| {
        let mut png = std::ffi::OsString::from("--export-filename=");
        png.push(job.png());
        Ok(vec![
            "--export-type=png".into(),
            png,
            "--export-area-page".into(),
            format!("--export-width={}", job.request.width).into(),
            format!("--export-height={}", job.request.height).into(),
            "--export-background=#ffffff".into(),
            "--export-background-opacity=1".into(),
            job.svg().into(),
        ])
    },
    failure: None,
    keeps_home: false,
    has_margin: false,
};
