//! CairoSVG, the usual converter of Python programs.

use super::Engine;

pub(super) const ENGINE: Engine = Engine {
    name: "cairosvg",
    install: "pip install cairosvg, or apt-get install cairosvg",
    programs: &["cairosvg"],
    arguments: |job| {
        Ok(vec![
            "--output-width".into(),
            job.request.width.to_string().into(),
            "--output-height".into(),
            job.request.height.to_string().into(),
            "--output".into(),
            job.png().into(),
            job.svg().into(),
        ])
    },
    failure: None,
    // `pip install --user` installs into the home.
    keeps_home: true,
    has_margin: false,
};
