//! Proposals: marks in the place of others, which are fitted as what they are and stay if they pay.

use crate::fit::descent::held::Held;
use crate::fit::descent::{Course, Descent, TRACED_PACE};
use crate::fit::drawing::Drawing;
use crate::fit::halves::by_halves;
use crate::fit::recipe::{Forms, Rates};
use crate::fit::run::session::Session;
use crate::render::StrokeRef;
use crate::scene::Mark;
use crate::svg::mark_bytes;

/// Marks in the place of one; none if it stays as it is.
pub(super) type Proposal = Option<Vec<Mark>>;

/// The proposals for areas, and for strokes that were traced.
pub(super) fn traced(
    drawing: &Drawing,
    mut propose: impl FnMut(usize, Mark) -> Proposal,
) -> Vec<Proposal> {
    let formed = drawing.formed();
    let free = drawing.free().iter().enumerate();
    let is_found = |i: usize, mark: StrokeRef<'_>| i < formed || mark.is_area();
    free.map(|(i, mark)| is_found(i, mark).then(|| propose(i, mark.to_mark()))?)
        .collect()
}

/// The demands on each proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Each {
    /// It may cost more than it saves if others pay for that.
    MayLose,
    /// It pays by itself. It is one mark for one.
    Gains,
}

/// Fits the proposals, and keeps those that pay. Returns whether any does.
pub(super) fn adopt(
    session: &mut Session<'_>,
    forms: Forms,
    mut proposals: Vec<Proposal>,
    each: Each,
) -> bool {
    if proposals.iter().all(Option::is_none) {
        return false;
    }
    let home = Home::of(&session.drawing);
    let mut error = session.drawing.mse();
    let worth_before = match each {
        Each::Gains => session.drawing.judge().worth,
        Each::MayLose => Vec::new(),
    };
    let price = session.price.in_drawing(&mut session.drawing);
    home.put(&mut session.drawing, &proposals, |_| true);
    fit(session, forms, &proposals);
    let drawing = &mut session.drawing;
    proposals = fitted(drawing, &proposals);
    let bytes = |mark: &Mark| mark_bytes(mark, &session.config.file);
    let saved = |i: usize| {
        let after: usize = proposals[i].iter().flatten().map(bytes).sum();
        let mark = &home.marks[i].0;
        let bands = proposals[i]
            .iter()
            .flatten()
            .filter(|mark| mark.band().is_some());
        // A stroke with square ends is no better to an editor than one with round ends. Of areas, the attributes of the ends
        // and elements of their own are no loss, and buy no error either.
        let (worth, free) = match mark {
            Mark::Stroke(_) if bands.clone().next().is_some() => (0, 0),
            Mark::Stroke(_) => (forms.worth_bytes, 0),
            Mark::Area(_) => (
                forms.worth_bytes,
                bands.count() * (forms.worth_bytes + ENDS_BYTES),
            ),
        };
        let before = bytes(mark) + worth;
        let spent = price.of_saved(after.saturating_sub(before + free));
        price.of_saved(before.saturating_sub(after)) - spent
    };
    let allowed: Vec<f32> = (0..proposals.len()).map(saved).collect();
    let mut is_taken = vec![false; proposals.len()];
    let proposed = (0..proposals.len()).filter(|&i| proposals[i].is_some());
    let (gaining, others): (Vec<usize>, Vec<usize>) = match each {
        Each::MayLose => (proposed.collect(), Vec::new()),
        Each::Gains => {
            let worth = drawing.judge().worth;
            proposed.partition(|&i| worth_before[i] - worth[i] <= allowed[i])
        }
    };
    // Marks that share pixels have less worth by that. So a few are tried one by one.
    let singles = others.chunks(1).take(MOST_SINGLES);
    let mut accepts = |group: &[usize]| {
        let mut is_tried = is_taken.clone();
        group.iter().for_each(|&i| is_tried[i] = true);
        home.put(drawing, &proposals, |i| is_tried[i]);
        let now = drawing.mse();
        let added = (now - error) * (3 * drawing.pixels()) as f64;
        let pays = added <= group.iter().map(|&i| f64::from(allowed[i])).sum();
        if pays {
            (error, is_taken) = (now, is_tried);
        }
        pays
    };
    by_halves(gaining, &mut accepts);
    singles.for_each(|one| {
        accepts(one);
    });
    home.put(drawing, &proposals, |i| is_taken[i]);
    is_taken.contains(&true)
}

/// Most proposals that are tried one by one. A guess.
const MOST_SINGLES: usize = 24;

/// Bytes of the attributes that give a path square ends and mitred corners: its ends are not worse for them.
const ENDS_BYTES: usize = " stroke-linecap=\"butt\" stroke-linejoin=\"miter\"".len();

/// The proposals as a descent has left them in the drawing.
fn fitted(drawing: &Drawing, proposals: &[Proposal]) -> Vec<Proposal> {
    let mut marks = drawing.free().iter().map(|mark| mark.to_mark());
    let mut take = |proposal: &Proposal| {
        let count = proposal.as_ref().map_or(1, Vec::len);
        let marks: Vec<Mark> = marks.by_ref().take(count).collect();
        proposal.is_some().then_some(marks)
    };
    proposals.iter().map(&mut take).collect()
}

/// All marks of a drawing, each with its stage.
struct Home {
    marks: Vec<(Mark, usize)>,
}

impl Home {
    fn of(drawing: &Drawing) -> Self {
        let marks = drawing.free().iter().map(|mark| mark.to_mark());
        let stages = drawing.stages().iter().copied();
        Self {
            marks: marks.zip(stages).collect(),
        }
    }

    /// Makes the drawing that of these marks, those that are `taken` replaced by what is proposed for them.
    fn put(&self, drawing: &mut Drawing, proposals: &[Proposal], taken: impl Fn(usize) -> bool) {
        let replaced = |(i, (mark, stage)): (usize, &(Mark, usize))| {
            let marks = proposals[i].clone().filter(|_| taken(i));
            let marks = marks.unwrap_or_else(|| vec![mark.clone()]);
            let stage = *stage;
            marks.into_iter().map(move |mark| (mark, stage))
        };
        drawing.replace(self.marks.iter().enumerate().flat_map(replaced));
    }
}

/// Descends with what is proposed alone.
fn fit(session: &mut Session<'_>, forms: Forms, proposals: &[Proposal]) {
    let iterations = forms.iterations;
    let restricted = session.restricted_rates().without_color();
    let course = Course {
        iterations,
        before: 0,
        of: iterations,
        rates: Rates {
            // A traced stroke moves as far as an area does.
            position: forms.rate / TRACED_PACE,
            radius: forms.rate.min(restricted.radius),
            area: forms.rate,
            opacity: 0.0,
            ..restricted
        },
        pace: 1.0,
        softness: None,
        until: f32::INFINITY,
        joint: None,
    };
    let drawing = &mut session.drawing;
    let mut descent = Descent::new(drawing, &session.recipe, course, 0.0);
    descent.held = Held::of(drawing.free(), drawing.formed());
    let marks = proposals.iter().flat_map(|proposal| match proposal {
        Some(marks) => vec![true; marks.len()],
        None => vec![false],
    });
    for (i, _) in marks.enumerate().filter(|(_, moves)| !moves) {
        drawing
            .free()
            .range(i)
            .for_each(|place| descent.ties.fix(place));
    }
    for step in 0..iterations {
        let done = step as f32 / iterations as f32;
        descent.step(drawing, &session.annealing, (step, done), None);
    }
}
