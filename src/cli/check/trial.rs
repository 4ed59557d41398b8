//! Draws one file with one program after another.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use strokefit::engines::{self, DrawRequest, Engine, Rendering};
use strokefit::image::Image;
use strokefit::metrics::{Agreement, Largest, Quality};
use strokefit::report::{AgainstResvg, NotDrawn, RendererEntry};
use strokefit::verify::{self, Size};

use super::RESVG;
use crate::cli::output::Output;

/// The folder for the pictures that the programs draw.
pub(super) struct PictureFolder(PathBuf);

impl PictureFolder {
    /// The folder, made if it does not exist.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let unusable = |e| {
            let path = path.display();
            anyhow!("{path}: pictures cannot be written to this folder ({e}): name another one")
        };
        fs::create_dir_all(path).map_err(unusable)?;
        Ok(Self(path.to_owned()))
    }

    fn write(&self, name: &str, image: &Image) -> Result<()> {
        let path = self.0.join(format!("{name}.png"));
        Output::open(&path)?.write(&image.encode_png()?)
    }
}

/// Renders so far.
pub(super) struct Trial<'a> {
    svg: &'a str,
    target: Option<&'a Image>,
    pub(super) resvg: Image,
    timeout: Duration,
    pictures: Option<PictureFolder>,
    /// resvg first.
    pub(super) drawn: Vec<RendererEntry>,
    pub(super) not_drawn: Vec<NotDrawn>,
}

impl<'a> Trial<'a> {
    /// Begins with resvg.
    pub(super) fn new(
        svg: &'a str,
        target: Option<&'a Image>,
        timeout: Duration,
        pictures: Option<PictureFolder>,
    ) -> Result<Self> {
        let start = Instant::now();
        let resvg = match target {
            Some(target) => verify::render_like(svg, target, [1.0; 3])?,
            None => verify::render(svg, Size::Scale(1.0), Some([1.0; 3]))?,
        };
        let entry = RendererEntry {
            renderer: RESVG.into(),
            version: verify::RESVG_VERSION.into(),
            fidelity: target
                .map(|target| Quality::between(target, &resvg))
                .transpose()?,
            against_resvg: None,
            wall_s: start.elapsed().as_secs_f64(),
            passed: true,
        };
        let drawn = vec![entry];
        let not_drawn = Vec::new();
        let trial = Self {
            svg,
            target,
            resvg,
            timeout,
            pictures,
            drawn,
            not_drawn,
        };
        trial.keep(RESVG, &trial.resvg)?;
        Ok(trial)
    }

    /// Draws with `engine`. A missing or failing program is a result, not an error.
    pub(super) fn ask(&mut self, engine: &Engine) -> Result<()> {
        let Some(program) = engine.locate() else {
            let reason = format!("{}: not installed: {}", engine.name, engine.install);
            self.pass_over(engine, false, reason);
            return Ok(());
        };
        let (width, height) = (self.resvg.width(), self.resvg.height());
        let request = DrawRequest {
            svg: self.svg,
            width,
            height,
        };
        match engine.draw(&program, request, self.timeout) {
            Ok(drawn) => self.compare(engine, &drawn),
            Err(error) => {
                self.pass_over(engine, true, error.to_string());
                Ok(())
            }
        }
    }

    fn pass_over(&mut self, engine: &Engine, installed: bool, reason: String) {
        let renderer = engine.name.into();
        self.not_drawn.push(NotDrawn {
            renderer,
            installed,
            reason,
        });
    }

    fn compare(&mut self, engine: &Engine, drawn: &Rendering) -> Result<()> {
        let fidelity = self
            .target
            .map(|target| Quality::between(target, &drawn.image))
            .transpose()?;
        let agreement = Agreement::between(&self.resvg, &drawn.image)?;
        let Largest { max_abs, x, y } = Largest::between(&self.resvg, &drawn.image)?;
        let psnr_db = Some(agreement.psnr_db).filter(|db| db.is_finite());
        let fidelities = fidelity.as_ref().zip(self.drawn[0].fidelity.as_ref());
        let shortfall_db = fidelities.map(|(own, resvg)| resvg.psnr_db - own.psnr_db);
        self.drawn.push(RendererEntry {
            renderer: engine.name.into(),
            version: drawn.version.clone(),
            fidelity,
            against_resvg: Some(AgainstResvg {
                psnr_db,
                max_abs,
                x,
                y,
            }),
            wall_s: drawn.wall.as_secs_f64(),
            passed: engines::passes(&agreement, shortfall_db),
        });
        self.keep(engine.name, &drawn.image)
    }

    /// Writes the picture, and what it is compared with beside it, if pictures are wanted.
    fn keep(&self, name: &str, image: &Image) -> Result<()> {
        let Some(pictures) = &self.pictures else {
            return Ok(());
        };
        let sheet = engines::compared(self.target, &self.resvg, image)?;
        pictures.write(name, image)?;
        pictures.write(&format!("{name}-compared"), &sheet)
    }
}
