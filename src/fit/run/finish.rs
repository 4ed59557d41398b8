//! The end of a fit: its result, from the best file.

use crate::error::Result;
use crate::fit::drawing::Drawing;
use crate::fit::drawing::surface;
use crate::fit::file::RenderedFile;
use crate::fit::result::{Fit, StageRecord};
use crate::fit::run::session::Session;
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::{Dropped, Quantized, Scene, Stage};

/// A finished drawing, and its file if that was looked at.
pub(in crate::fit) struct Drawn {
    pub(in crate::fit) fit: Fit,
    pub(in crate::fit) file: Option<RenderedFile>,
    /// True if its marks are where they were seen.
    pub(in crate::fit) is_placed: bool,
    /// Its cost before the polish, in units of that by strokes alone, if these have been compared.
    pub(in crate::fit) lead: Option<f64>,
}

/// The result of the fit: the best file or, if no file was looked at and none is to be `compared`, the drawing as it is.
pub(in crate::fit) fn finish(mut session: Session<'_>, compared: bool) -> Result<Drawn> {
    let file = match session.best.take() {
        // A drawing that competes needs the fidelity and the bytes of its file.
        None if compared => Some(session.writer.render(&session.drawing)?),
        best => best,
    };
    let rounded = match &file {
        Some(file) => file.rounded.clone(),
        None => session.writer.round(&session.drawing),
    };
    let is_placed = session.drawing.is_placed();
    let stages = records(&mut session, &rounded);
    let soft = soft(&mut session.drawing, &rounded.scene)?;
    let fit = Fit {
        soft,
        scene: rounded.scene,
        base: session.task.base.clone(),
        focus: session.task.focus.clone(),
        file: session.config.file,
        stop: session.cut_by().unwrap_or(session.history.stop),
        stacking_db: session.history.stacking_db,
        target: session.target,
        matte: session
            .drawing
            .surfaces
            .last()
            .map_or([1.0; 3], |surface| surface.matte),
        damage: None,
        meant: None,
        stages,
        dropped: Dropped {
            non_finite: rounded.dropped.non_finite + session.drawing.counters.lost,
            invisible: rounded.dropped.invisible + session.drawing.counters.hidden,
            ..rounded.dropped
        },
    };
    Ok(Drawn {
        fit,
        file,
        is_placed,
        lead: session.history.lead,
    })
}

/// The records of the stages that have strokes in the finished drawing, numbered like its layers, with the final number
/// of strokes and the fidelity of each layer.
fn records(session: &mut Session<'_>, rounded: &Quantized) -> Vec<StageRecord> {
    let mses = session.drawing.layer_mses(&rounded.scene);
    let layers = rounded.scene.stages.iter().zip(mses);
    let origins = rounded.origins.iter().enumerate();
    let record = |((number, &origin), (stage, mse)): ((_, _), (&Stage, _))| {
        Some(StageRecord {
            index: number + 1,
            strokes: stage.marks.len(),
            // Rounding may have dropped all strokes of a stage, so layers find their records by their origins.
            layer_psnr_db: psnr_db(mse),
            ..*session.history.records.get(origin)?
        })
    };
    origins.zip(layers).filter_map(record).collect()
}

/// Our own render of `scene`; with alpha if the drawing is transparent.
fn soft(drawing: &mut Drawing, scene: &Scene) -> Result<Image> {
    let mut softs = drawing.soft(scene);
    match softs.as_slice() {
        [black, white] => surface::transparent(black, white),
        _ => Ok(softs.remove(0)),
    }
}
