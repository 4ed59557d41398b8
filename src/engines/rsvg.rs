//! librsvg, which draws with Cairo for GNOME, Wikipedia and ImageMagick.

use super::Engine;

pub(super) const ENGINE: Engine = Engine {
    name: "rsvg",
    install: "apt-get install librsvg2-bin, or https://gitlab.gnome.org/GNOME/librsvg",
    programs: &["rsvg-convert"],
    arguments: |job| {
        Ok(vec![
            format!("--width={}", job.request.width).into(),
            format!("--height={}", job.request.height).into(),
            "--background-color=white".into(),
            "--output".into(),
            job.png().into(),
            job.svg().into(),
        ])
    },
    failure: None,
    keeps_home: false,
    has_margin: false,
};
