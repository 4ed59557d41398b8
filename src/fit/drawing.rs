//! The drawing in progress: its strokes, the number of frozen ones, and the resolution of the fit.

pub(super) mod background;
pub(super) mod bounds;
pub(super) mod focus;
pub(super) mod masking;
pub(super) mod objective;
mod scene;
mod shading;
pub(super) mod shadows;
pub(super) mod surface;

use fearless_simd::Level;

use crate::render::{Canvas, CanvasLoss, Gradients, Params, Renderer, Softness, Strokes, Survey};
use crate::scene::{Area, Mark, Rgb};
use bounds::Bounds;
use focus::Focus;
use objective::Target;
use scene::enlarge;
use surface::Surface;

/// Most strokes of a drawing of lines; drawings of more are not of a few pens.
const MOST_LINES: usize = 600;

/// A drawing in progress. The *free* strokes are fitted, judged and relocated; the frozen ones behind them are
/// rendered once, as their backdrop. Large strokes are fitted to a reduced picture. The parameters of strokes are in
/// px of the current level of the pyramid; lengths that methods take and return are in px of the picture.
pub(super) struct Drawing {
    /// One surface, or two for a transparent drawing; both have the same size and resolution.
    pub(super) surfaces: Vec<Surface>,
    pub(super) renderer: Renderer,
    pub(super) level: Level,
    /// True if the background keeps its colour.
    pub(super) background_fixed: bool,
    /// The areas on the background, behind all strokes.
    pub(super) ground: Vec<Area>,
    /// The strokes that are kept as they are, back to front, and on top of them those that are fitted.
    frozen: Strokes,
    free: Strokes,
    /// The stage of each stroke, counted from 0, never decreasing.
    stage_of: Vec<usize>,
    pub(super) bounds: Bounds,
    /// The edge of the finished drawing.
    edge: Softness,
    known: Known,
    pub(super) counters: Counters,
}

/// Knowledge of the drawing as it is.
#[derive(Debug, Clone, Copy, Default)]
struct Known {
    /// True if the canvases show it.
    is_rendered: bool,
    /// Its mean squared error.
    mse: Option<f64>,
}

/// Counters of a whole fit.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Counters {
    /// Searches for candidates. The count is part of the random key, so that no two searches use the same cells.
    pub(super) searches: u64,
    /// Strokes that were removed because they became non-finite.
    pub(super) lost: usize,
    /// The first stage that was not traced, unless none was.
    pub(super) traced_until: usize,
    /// The first stage that was not traced where it is seen, unless none was.
    pub(super) placed_until: usize,
    /// Strokes that were removed because nobody could see them.
    pub(super) hidden: usize,
}

impl Drawing {
    /// An empty drawing on one or more `surfaces`.
    pub(super) fn new(
        surfaces: Vec<Surface>,
        (background_fixed, ground): (bool, Vec<Area>),
        bounds: Bounds,
        edge: Softness,
        level: Level,
    ) -> Self {
        Self {
            renderer: renderer(&surfaces[0], level),
            surfaces,
            level,
            background_fixed,
            ground,
            frozen: Strokes::new(),
            free: Strokes::new(),
            stage_of: Vec::new(),
            bounds,
            edge,
            known: Known::default(),
            counters: Counters::default(),
        }
    }

    /// The number of strokes, frozen ones included.
    pub(super) fn len(&self) -> usize {
        self.frozen.len() + self.free.len()
    }

    /// The strokes that are not frozen, back to front.
    pub(super) fn free(&self) -> &Strokes {
        &self.free
    }

    /// Mutable access to the free strokes.
    pub(super) fn free_mut(&mut self) -> &mut Strokes {
        self.known = Known::default();
        &mut self.free
    }

    /// A copy of all strokes, back to front.
    fn all(&self) -> Strokes {
        let mut all = self.frozen.clone();
        all.append(&mut self.free.clone());
        all
    }

    /// Switches to the resolution for strokes of `scale` px if that is finer than the current one, and frees all
    /// strokes. Returns whether it did.
    pub(super) fn sharpen(&mut self, scale: f32) -> bool {
        let now = self.surface().halvings();
        let halvings = self.surface().halvings_for(scale);
        if halvings >= now {
            return false;
        }
        self.halve(halvings);
        // Parameters are in px of the current level, and grow with it.
        enlarge(self.free_mut(), now - halvings);
        true
    }

    /// Switches to the picture halved `halvings` times and frees all strokes. Their parameters are not converted.
    fn halve(&mut self, halvings: usize) {
        self.surfaces.iter_mut().for_each(|s| s.halve(halvings));
        let grid = self.surface().grid();
        self.renderer = renderer(self.surface(), self.level);
        self.bounds = self.bounds.on((grid, halvings));
        self.free_all();
    }

    /// The first surface. All have the same size and resolution.
    pub(super) fn surface(&self) -> &Surface {
        &self.surfaces[0]
    }

    /// The background's colour, unless the drawing is transparent or on top of a document.
    pub(super) fn background(&self) -> Option<Rgb> {
        match self.surfaces.as_slice() {
            [surface] => surface.color(),
            _ => None,
        }
    }

    /// Changes the background's colour, if there is one, and clamps it to its domain.
    pub(super) fn change_background(&mut self, change: impl FnOnce(&mut Rgb)) {
        if let Some(color) = self.surfaces[0].color_mut() {
            let mut moved = *color;
            change(&mut moved);
            // No stroke could make up for a background that is not finite.
            if moved.iter().all(|c| c.is_finite()) {
                self.known = Known::default();
                *color = moved.map(|c| c.clamp(0.0, 1.0));
            }
        }
    }

    /// Pixels of the picture per pixel of the current resolution.
    pub(super) fn pixel_area(&self) -> f32 {
        (1 << (2 * self.surface().halvings())) as f32
    }

    /// True if no stroke is frozen, so that the background can be fitted.
    pub(super) fn is_thawed(&self) -> bool {
        self.frozen.is_empty()
    }

    /// Pixels of the picture.
    pub(super) fn pixels(&self) -> usize {
        let picture = self.surface().picture();
        picture.width() * picture.height()
    }

    /// Side of the square that each of `count` strokes has to itself on average, px.
    pub(super) fn spacing(&self, count: usize) -> f32 {
        (self.pixels() as f32 / count.max(1) as f32).sqrt()
    }

    /// Freezes all strokes. They are rendered from scratch: rendered on top of the canvas of earlier frozen strokes,
    /// they would differ in the last bits from what a [`Snapshot`] restores.
    pub(super) fn freeze(&mut self) {
        self.thaw();
        self.render();
        self.surfaces.iter_mut().for_each(Surface::freeze);
        self.frozen = std::mem::take(self.free_mut());
    }

    /// Frees all strokes.
    pub(super) fn thaw(&mut self) {
        self.surfaces.iter_mut().for_each(Surface::thaw);
        self.free_all();
    }

    /// Lets errors count as `focus` says, everywhere alike if `None`. Nothing may be frozen.
    pub(super) fn focus_on(&mut self, focus: Option<&Focus>) {
        self.surfaces.iter_mut().for_each(|s| s.focus_on(focus));
        self.known = Known::default();
        self.renderer = renderer(self.surface(), self.level);
        self.render();
    }

    fn free_all(&mut self) {
        self.known = Known::default();
        // The frozen strokes lie behind, so the free ones follow them in the list, which then becomes the free one.
        self.frozen.append(&mut self.free);
        std::mem::swap(&mut self.frozen, &mut self.free);
    }

    /// Adds `marks` on top, in px of the picture, as part of stage `stage`.
    pub(super) fn extend_by(&mut self, marks: &[Mark], stage: usize) {
        let halvings = self.surface().halvings();
        self.free_mut().append(&mut scene::reduced(marks, halvings));
        self.stage_of.resize(self.len(), stage);
    }

    /// Adds `capsules` on top, as part of stage `stage`.
    pub(super) fn extend(&mut self, capsules: impl IntoIterator<Item = Params>, stage: usize) {
        for capsule in capsules {
            self.free_mut().push_capsule(&capsule);
        }
        self.stage_of.resize(self.len(), stage);
    }

    /// The free marks, back to front, and the stage of each.
    pub(super) fn marks(&self) -> (Strokes, Vec<usize>) {
        (
            self.free.clone(),
            self.stage_of[self.frozen.len()..].to_vec(),
        )
    }

    /// Replaces the free marks by these, each with its stage, in px of the current resolution.
    pub(super) fn set_marks(&mut self, (marks, stages): (Strokes, Vec<usize>)) {
        let lost = |marks: &Strokes| marks.iter().filter(|mark| !mark.is_finite()).count();
        // Marks that go because they aren't finite are lost. Trials put marks back, which takes their count back.
        self.counters.lost += lost(&self.free);
        self.counters.lost -= lost(&marks).min(self.counters.lost);
        self.stage_of.truncate(self.frozen.len());
        self.stage_of.extend(stages);
        *self.free_mut() = marks;
    }

    /// Puts the free strokes into the order that `sources` lists them in. Places keep their stages.
    pub(super) fn reorder(&mut self, sources: &[usize]) {
        *self.free_mut() = sources.iter().map(|&i| self.free.get(i)).collect();
    }

    /// The number of strokes of each stage, back to front, without empty stages.
    pub(super) fn stage_sizes(&self) -> Vec<usize> {
        let stages = self.stage_of.chunk_by(|a, b| a == b);
        stages.map(<[usize]>::len).collect()
    }

    /// Joins the topmost `count` stages with the one below them.
    pub(super) fn join_stages(&mut self, count: usize) {
        let mut stages: Vec<usize> = self.stage_of.clone();
        stages.dedup();
        // The stages that are left begin at the lowest one to be joined; all above it take its number.
        let first = stages
            .len()
            .checked_sub(count + 1)
            .and_then(|k| stages.get(k));
        if let Some(&first) = first {
            self.stage_of
                .iter_mut()
                .for_each(|stage| *stage = first.min(*stage));
        }
    }

    /// Number of free strokes, from the back, in stages that were traced.
    pub(super) fn traced(&self) -> usize {
        self.before(self.counters.traced_until)
    }

    /// Number of free marks, from the back, in stages that were traced where they are seen.
    pub(super) fn placed(&self) -> usize {
        self.before(self.counters.placed_until)
    }

    /// Number of free marks in stages before the last one.
    pub(super) fn earlier(&self) -> usize {
        self.before(self.last_stage())
    }

    /// Number of free marks in earlier stages.
    fn before(&self, stage: usize) -> usize {
        let free = self.stage_of.get(self.frozen.len()..).unwrap_or_default();
        // Stages never decrease from back to front, so a binary search finds the first one that is not earlier.
        free.partition_point(|&own| own < stage)
    }

    /// True if there are free marks, and all of them were traced where they are seen, so that no descent knows better.
    pub(super) fn is_placed(&self) -> bool {
        !self.free().is_empty() && self.placed() == self.free().len()
    }

    /// True for a traced drawing of few marks, which come to share widths and colours.
    pub(in crate::fit) fn is_of_lines(&self) -> bool {
        self.counters.traced_until > 0 && self.free().len() <= MOST_LINES
    }

    /// Number of free strokes, from the back, that may be held to forms: those that were traced. A photograph, most of whose
    /// strokes were not, has none.
    pub(super) fn formed(&self) -> usize {
        let traced = self.traced();
        if 2 * traced >= self.free.len() || self.free.has_areas() {
            traced
        } else {
            0
        }
    }

    /// The index of the topmost stage, from 0.
    pub(super) fn last_stage(&self) -> usize {
        self.stage_of.last().copied().unwrap_or(0)
    }

    /// The mean loss over the surfaces with softness `edge`, its derivatives with respect to the free strokes and,
    /// `WITH_CONTRIBUTIONS`, the contribution of each. The loss is against the picture, or against `targets`, one per surface.
    pub(super) fn differentiate<const WITH_CONTRIBUTIONS: bool>(
        &mut self,
        edge: Softness,
        targets: Option<&[Target]>,
        gradients: &mut Gradients,
    ) {
        let (free, frozen) = (&self.free, self.frozen.len());
        // Two mattes at once cost little more than one, as only colours differ. Worth is known of one at a time.
        if let ([black, white], false) = (self.surfaces.as_slice(), WITH_CONTRIBUTIONS) {
            let backdrops = [black, white].map(|surface| surface.backdrop(frozen));
            let [of_black, of_white] = [0, 1]
                .map(|i| self.surfaces[i].objective(targets.and_then(|targets| targets.get(i))));
            let losses = [&of_black, &of_white];
            let renderer = &mut self.renderer;
            renderer.backward_on_mattes(free, edge, backdrops, losses, gradients);
            gradients.scale(0.5);
            return;
        }
        // The loss is the mean over the surfaces, and so are its derivatives.
        let mut more = Gradients::default();
        for (i, surface) in self.surfaces.iter().enumerate() {
            let out = if i == 0 { &mut *gradients } else { &mut more };
            let backdrop = surface.backdrop(frozen);
            let objective = surface.objective(targets.and_then(|targets| targets.get(i)));
            let renderer = &mut self.renderer;
            if WITH_CONTRIBUTIONS {
                renderer.backward_with_contributions(free, edge, backdrop, &objective, out);
            } else {
                renderer.backward(free, edge, backdrop, &objective, out);
            }
            if i > 0 {
                gradients.add(&more);
            }
        }
        if self.surfaces.len() > 1 {
            gradients.scale(1.0 / self.surfaces.len() as f32);
        }
    }

    /// A survey of the free strokes at the final edge, at the current resolution.
    pub(super) fn survey_at_resolution(&mut self, least: usize) -> Survey {
        let (mut survey, mut more) = (Survey::default(), Survey::default());
        for (i, surface) in self.surfaces.iter().enumerate() {
            let backdrop = surface.backdrop(self.frozen.len());
            let objective = surface.objective(None);
            let into = if i == 0 { &mut survey } else { &mut more };
            let (renderer, free) = (&mut self.renderer, &self.free);
            renderer.survey(free, least, self.edge, backdrop, &objective, into);
            if i > 0 {
                survey.add(&more);
            }
        }
        survey.scale(1.0 / self.surfaces.len() as f32);
        survey
    }

    /// Loss, gradients and contributions of the free strokes at the final edge.
    pub(super) fn judge(&mut self) -> Gradients {
        let mut gradients = Gradients::default();
        self.differentiate::<true>(self.edge, None, &mut gradients);
        // At the final edge the loss is the mean squared error, so it needn't be computed again.
        self.known.mse = Some(gradients.loss);
        // Worth is a sum over pixels of this resolution, and is wanted in pixels of the picture.
        let area = self.pixel_area();
        gradients
            .contribution
            .iter_mut()
            .for_each(|contribution| *contribution *= area);
        gradients
    }

    /// Renders all strokes to the canvases, unless these show them already.
    pub(super) fn render(&mut self) {
        if self.known.is_rendered {
            return;
        }
        let (free, frozen) = (&self.free, self.frozen.len());
        for surface in &mut self.surfaces {
            surface.render(&mut self.renderer, free, self.edge, frozen);
        }
        self.known.is_rendered = true;
    }

    /// The derivatives of another `loss` on the first surface, with respect to all strokes, which must be free.
    pub(super) fn backward(&mut self, loss: &impl CanvasLoss, gradients: &mut Gradients) {
        let backdrop = self.surfaces[0].backdrop(0);
        self.renderer
            .backward(&self.free, self.edge, backdrop, loss, gradients);
    }

    /// The mean squared error of the drawing, at the current resolution. It is not rendered for that.
    pub(super) fn mse(&mut self) -> f64 {
        if let Some(mse) = self.known.mse {
            return mse;
        }
        let (free, frozen) = (&self.free, self.frozen.len());
        let (renderer, edge) = (&mut self.renderer, self.edge);
        let losses = self.surfaces.iter().map(|surface| {
            let objective = surface.objective(None);
            renderer.loss(free, edge, surface.backdrop(frozen), &objective)
        });
        let mse = losses.sum::<f64>() / self.surfaces.len() as f64;
        self.known.mse = Some(mse);
        mse
    }

    /// The mean squared error of rendered canvases, one per surface.
    fn mse_of<'a>(&self, canvases: impl Iterator<Item = &'a Canvas>) -> f64 {
        let pairs = self.surfaces.iter().zip(canvases);
        let losses = pairs.map(|(surface, canvas)| surface.mse_of(canvas));
        losses.sum::<f64>() / self.surfaces.len() as f64
    }
}

/// A copy of a drawing's state, from which it is restored to the bit.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Snapshot {
    halvings: usize,
    /// The background's colour, unless the drawing is on top of a document.
    color: Option<Rgb>,
    strokes: Strokes,
    stage_of: Vec<usize>,
    frozen: usize,
    counters: Counters,
}

impl Drawing {
    /// A copy of the current state.
    pub(super) fn snapshot(&self) -> Snapshot {
        Snapshot {
            halvings: self.surface().halvings(),
            color: self.surface().color(),
            strokes: self.all(),
            stage_of: self.stage_of.clone(),
            frozen: self.frozen.len(),
            counters: self.counters,
        }
    }

    /// Restores the drawing, its counters included.
    pub(super) fn restore(&mut self, snapshot: Snapshot) {
        if let (Some(color), Some(was)) = (self.surfaces[0].color_mut(), snapshot.color) {
            *color = was;
        }
        // The target of the strokes has changed only if the resolution has, or if some of them were frozen.
        if snapshot.halvings != self.surface().halvings() || !self.is_thawed() {
            self.halve(snapshot.halvings);
        }
        // All strokes are free at first. Those that were frozen are frozen again, in the same order of renders.
        *self.free_mut() = snapshot.strokes;
        self.stage_of = snapshot.stage_of;
        self.counters = snapshot.counters;
        if snapshot.frozen > 0 {
            // Only the frozen strokes may be there when they are rendered.
            let free = self.free_mut().split_off(snapshot.frozen);
            self.freeze();
            *self.free_mut() = free;
        }
    }

    /// Restores the drawing, but keeps its counters, so that no search repeats the random draws of an earlier one.
    pub(super) fn revert(&mut self, snapshot: Snapshot) {
        let counters = self.counters;
        self.restore(Snapshot {
            counters,
            ..snapshot
        });
    }
}

/// A renderer for `surface`, with its weights of errors.
fn renderer(surface: &Surface, level: Level) -> Renderer {
    let mut renderer = Renderer::new(surface.grid(), level);
    if let Some(roots) = surface.error_weights() {
        renderer.set_error_weights(roots);
    }
    renderer
}
