//! The end of a fit: its result, from the best file.

use crate::error::Result;
use crate::fit::base::Base;
use crate::fit::budget;
use crate::fit::budget::price::Price;
use crate::fit::config::Budget;
use crate::fit::drawing::Drawing;
use crate::fit::drawing::surface;
use crate::fit::file::RenderedFile;
use crate::fit::result::{Fit, StageRecord, Stop};
use crate::fit::run::session::Session;
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::{Dropped, Quantized, Scene, Stage};

/// A finished drawing, and its file if that was looked at.
pub(in crate::fit) struct Drawn {
    pub(in crate::fit) fit: Fit,
    budget: Budget,
    file: Option<RenderedFile>,
}

impl Drawn {
    /// The drawing, to be compared by another budget than it was made for.
    pub(in crate::fit) fn for_budget(self, budget: Budget) -> Self {
        Self { budget, ..self }
    }

    /// True if it has no more strokes and bytes than allowed.
    pub(in crate::fit) fn keeps_budget(&self) -> bool {
        let Budget { strokes, bytes, .. } = self.budget;
        let is_short = |most| self.file.as_ref().is_some_and(|file| file.bytes <= most);
        strokes.is_none_or(|most| self.fit.scene.len() <= most) && bytes.is_none_or(is_short)
    }

    /// True if there are areas.
    pub(in crate::fit) fn has_areas(&self) -> bool {
        self.fit.scene.areas().next().is_some()
    }

    /// Number of its marks.
    pub(in crate::fit) fn strokes(&self) -> usize {
        self.fit.scene.len()
    }

    /// The drawing as a base of another one.
    pub(in crate::fit) fn into_base(self) -> Base {
        Base {
            document: None,
            scene: self.fit.scene,
            width: None,
        }
    }

    /// The drawing as if it had been made at once.
    pub(in crate::fit) fn without_base(mut self) -> Self {
        self.fit.base = None;
        self
    }

    /// The result of a fit that was stopped.
    pub(in crate::fit) fn interrupted(self) -> Fit {
        Fit {
            stop: Stop::Interrupted,
            ..self.fit
        }
    }

    /// The other one if it serves the budget better.
    pub(in crate::fit) fn or_better(self, other: Option<Self>) -> Self {
        let is_better = |other: &Self| {
            let files = other.file.as_ref().zip(self.file.as_ref());
            files.is_some_and(|(new, old)| budget::is_better(&self.budget, new, old))
        };
        other.filter(is_better).unwrap_or(self)
    }
}

/// A drawing with areas that has at most so many marks, and is at least as faithful, dB, is not compared with strokes
/// alone. Both are guesses.
const FEW: usize = 30;
const FAITHFUL_DB: f64 = 38.0;

impl Drawn {
    /// True if the drawing has areas that strokes alone may be better than.
    pub(in crate::fit) fn has_doubtful_areas(&self) -> bool {
        let scene = &self.fit.scene;
        let db = self.file.as_ref().map_or(0.0, |file| psnr_db(file.mse()));
        self.has_areas() && (scene.len() > FEW || db < FAITHFUL_DB)
    }

    /// The other one if its file costs less: squared error and bytes at their `price`, or by the budget if bytes have none.
    /// A drawing that is as faithful with no more marks stays, as its editor would have it.
    pub(in crate::fit) fn or_cheaper(self, other: Self, price: Price) -> Self {
        let pixels = self.fit.target.width() * self.fit.target.height();
        let cost = |drawn: &Self| {
            let file = drawn.file.as_ref()?;
            price.cost(file.mse(), pixels, file.bytes)
        };
        let is_better = |a: &Self, b: &Self| {
            let files = a.file.as_ref().zip(b.file.as_ref());
            files.is_some_and(|(a, b)| a.mse() <= b.mse()) && a.fit.scene.len() <= b.fit.scene.len()
        };
        match cost(&self).zip(cost(&other)) {
            // Fewer marks and less error win at any price of bytes.
            _ if is_better(&self, &other) => self,
            Some((own, others)) if others < own => other,
            Some(_) => self,
            None => self.or_better(Some(other)),
        }
    }
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
    let stages = records(&mut session, &rounded);
    let soft = soft(&mut session.drawing, &rounded.scene)?;
    let fit = Fit {
        soft,
        scene: rounded.scene,
        base: session.base.cloned(),
        focus: session.focus.take(),
        file: session.config.file,
        stop: session.cut_by().unwrap_or(session.history.stop),
        stacking_db: session.history.stacking_db,
        target: session.target,
        damage: None,
        stages,
        dropped: Dropped {
            non_finite: rounded.dropped.non_finite + session.drawing.counters.lost,
            invisible: rounded.dropped.invisible + session.drawing.counters.hidden,
            ..rounded.dropped
        },
    };
    Ok(Drawn {
        fit,
        budget: session.config.budget,
        file,
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
