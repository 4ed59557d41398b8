//! Candidates for strokes on a drawing.

use crate::fit::drawing::Drawing;
use crate::fit::drawing::surface::Surface;
use crate::seed::{Candidate, Wanted, propose};

/// At most `count` candidates of `scale` px on top of `drawing`, best first; `seed` is the fit's.
pub(in crate::fit) fn search(
    drawing: &mut Drawing,
    count: usize,
    scale: f32,
    seed: u64,
) -> Vec<Candidate> {
    drawing.counters.searches += 1;
    drawing.render();
    let area = drawing.pixel_area();
    let wanted = Wanted {
        count,
        scale: drawing.bounds.drawable(scale) / area.sqrt(),
        min_opacity: drawing.bounds.min_opacity,
        level: drawing.surface().halvings(),
        key: [seed, drawing.counters.searches],
    };
    let residuals: Vec<_> = drawing.surfaces.iter().map(Surface::residual).collect();
    let mut candidates = propose(drawing.level, &residuals, wanted);
    candidates.iter_mut().for_each(|c| c.gain *= area);
    candidates
}
