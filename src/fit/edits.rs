//! Edits: other marks, or other points, in the place of some. They stay if they pay.
//!
//! A proposer is a function of a drawing. It foresees the squared error that each of its edits removes, and says what the
//! bytes are worth that the edit saves. [`choose`] takes the edits that gain most and do not touch each other.
//! [`apply_priced`] makes those that need no trial, and tries the others: all at once and, where that adds more squared error
//! than they may add, each half of them.
//!
//! | file | what it proposes |
//! | --- | --- |
//! | `terrain` | the quadratic model of the squared error around a path that foresees what points gain |
//! | `points` | a point more, a point less, a corner that becomes smooth or the reverse |
//! | `joins` | one stroke for two that meet |

pub(super) mod joins;
pub(super) mod model;
pub(super) mod points;

use std::collections::{BTreeMap, BTreeSet};

use super::drawing::Drawing;
use crate::render::{STYLE, StrokeRef, Strokes};
use crate::scene::{Mark, PointKind};

/// The index of marks that come on top of all others.
pub(super) const TOP: usize = usize::MAX;

/// A change of the free marks of a drawing.
#[derive(Debug, Clone)]
pub(super) struct Edit {
    /// The marks that change, by their indices, and what takes the place of each.
    pub(super) changes: Vec<(usize, Change)>,
    /// Squared error that it removes, as foreseen; below 0 if it adds some.
    pub(super) gain: f32,
    /// Squared error that it may add for what it saves; below 0 if it has to remove some for what it costs.
    pub(super) price: f32,
    /// Growth of the number of points, or of marks.
    pub(super) growth: isize,
    /// False if it is made without a trial, as the descent that follows mends what it costs.
    pub(super) is_tried: bool,
}

/// Replacement of a mark.
#[derive(Debug, Clone)]
pub(super) enum Change {
    /// These marks; none if it goes.
    Marks(Vec<Mark>),
    /// The mark with other points of one of its paths.
    Path {
        index: usize,
        points: Vec<[f32; 2]>,
        kinds: Vec<PointKind>,
    },
}

impl Change {
    /// A path with the points that take the place of its own.
    fn on<'a>(&'a self, path: StrokeRef<'a>) -> Option<StrokeRef<'a>> {
        match self {
            Self::Marks(_) => None,
            Self::Path { points, kinds, .. } => Some(StrokeRef {
                points,
                kinds,
                form: None,
                ..path
            }),
        }
    }
}

impl Edit {
    /// Foreseen gain beyond its price.
    pub(super) fn surplus(&self) -> f32 {
        self.gain + self.price
    }

    /// True if it gains more than its price. A mark has to be worth more than its bytes, so it goes at that price, too.
    fn pays(&self) -> bool {
        let is_drop = matches!(&self.changes[..], [(_, Change::Marks(marks))] if marks.is_empty());
        self.surplus() > 0.0 || is_drop && self.surplus() >= 0.0
    }

    /// `marks` in the place of mark `i`.
    pub(super) fn replacing(i: usize, marks: Vec<Mark>, price: f32) -> Self {
        Self {
            growth: marks.len() as isize - 1,
            changes: vec![(i, Change::Marks(marks))],
            gain: 0.0,
            price,
            is_tried: true,
        }
    }
}

/// Most points of a stroke in its file. A curve that turns back is written as a corner, and then the implied points at its
/// ends are points.
pub(super) fn written_points(stroke: StrokeRef<'_>) -> usize {
    let next = stroke.kinds.iter().cycle().skip(1);
    let pairs = stroke.kinds.iter().zip(next);
    let last = usize::from(!stroke.closed);
    let implied = pairs
        .take(stroke.kinds.len() - last)
        .filter(|(a, b)| [**a, **b] == [PointKind::Quad; 2]);
    stroke.points.len() + implied.count()
}

/// An edit for each free mark that removes it, and saves its `price`.
pub(super) fn drop_marks(drawing: &mut Drawing, price: impl Fn(StrokeRef<'_>) -> f32) -> Vec<Edit> {
    let contribution = drawing.judge().contribution;
    let marks = drawing.free().iter().zip(contribution).enumerate();
    let loss = |(i, (mark, contribution)): (usize, (StrokeRef<'_>, f32))| {
        // A mark that is not finite goes at any price.
        let (gain, price) = match mark.is_finite() {
            true => (-contribution, price(mark)),
            false => (f32::INFINITY, f32::INFINITY),
        };
        Edit {
            gain,
            ..Edit::replacing(i, Vec::new(), price)
        }
    };
    marks.map(loss).collect()
}

/// The edits that remove the `count` free marks of least contribution.
pub(super) fn least(drawing: &mut Drawing, count: usize) -> Vec<Edit> {
    let mut edits = drop_marks(drawing, |_| 0.0);
    edits.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    edits.truncate(count);
    edits
}

/// Limits of a choice. By default no edit that adds points or marks is chosen.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Room {
    /// Points, or marks, that the drawing may gain beyond the ones that go.
    pub(super) free: usize,
    /// Most edits that add something.
    pub(super) most: usize,
    /// Most exchanges of an addition for a loss, once there is no room.
    pub(super) swaps: usize,
}

/// Chooses edits of different paths that pay: first all edits that add no points or marks, then the most gaining ones. Without
/// room left, the most gaining addition takes the place of the cheapest loss, as long as the exchange gains.
pub(super) fn choose(mut edits: Vec<Edit>, room: Room) -> Vec<Edit> {
    edits.sort_by(|a, b| b.surplus().total_cmp(&a.surplus()));
    // Edits that pay without growth come first: they need no room, and a loss makes some.
    let (adding, others): (Vec<_>, Vec<_>) = edits.into_iter().partition(|edit| edit.growth > 0);
    let (paying, mut leaving): (Vec<_>, Vec<_>) = others.into_iter().partition(Edit::pays);
    let mut touched = Touched::default();
    let mut chosen = paying;
    chosen.retain(|edit| touched.takes(edit));
    // Additions fill the room and what the losses freed. The iterator keeps the rest of them for the exchanges.
    let freed: usize = chosen.iter().map(|edit| edit.growth.unsigned_abs()).sum();
    let adding = adding.into_iter().filter(Edit::pays);
    let adding: Vec<Edit> = adding.filter(|edit| touched.allows(edit)).collect();
    let mut adding = adding.into_iter().take(room.most);
    let coming = adding.by_ref().take(room.free.saturating_add(freed));
    chosen.extend(coming.filter(|edit| touched.takes(edit)));
    // Exchanges, where the room is used up.
    // A loss that doesn't pay by itself still pays in exchange for an addition that gains more than it costs.
    leaving.retain(|edit| edit.growth < 0);
    leaving.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    // The best addition meets the cheapest loss, the next best the next cheapest, until a pair gains nothing.
    for (new, old) in adding.zip(leaving).take(room.swaps) {
        if new.gain + old.gain <= 0.0 {
            break;
        }
        if touched.allows(&old) && touched.takes(&new) && touched.takes(&old) {
            chosen.extend([old, new]);
        }
    }
    chosen
}

/// Drops edits that touch a path of an earlier one.
pub(super) fn disjoint(mut edits: Vec<Edit>) -> Vec<Edit> {
    let mut touched = Touched::default();
    edits.retain(|edit| touched.takes(edit));
    edits
}

/// The paths that edits change, each by its mark and by its index among the mark's paths, or [`ALL`].
#[derive(Debug, Default)]
struct Touched(BTreeSet<(usize, usize)>);

/// The index of all paths of a mark.
const ALL: usize = usize::MAX;

impl Touched {
    /// Adds the paths of an edit, unless another edit changes one of them. Returns whether it did.
    fn takes(&mut self, edit: &Edit) -> bool {
        let is_free = self.allows(edit);
        if is_free {
            self.0.extend(places(edit));
        }
        is_free
    }

    /// True if no other edit changes a path of this one.
    fn allows(&self, edit: &Edit) -> bool {
        places(edit).all(|(mark, path)| {
            let mut others = self.0.range((mark, 0)..=(mark, ALL));
            !others.any(|&(_, other)| other == path || [path, other].contains(&ALL))
        })
    }
}

/// The paths that an edit changes.
fn places(edit: &Edit) -> impl Iterator<Item = (usize, usize)> {
    let changes = edit.changes.iter().filter(|(mark, _)| *mark != TOP);
    changes.map(|(mark, change)| match change {
        Change::Marks(_) => (*mark, ALL),
        Change::Path { index, .. } => (*mark, *index),
    })
}

/// Most trials of a step. A guess: each renders the drawing.
pub(super) const TRIALS: usize = 64;

/// Edits that were tried.
#[derive(Debug, Default)]
pub(super) struct Tried {
    pub(super) made: Vec<Edit>,
    /// The former index of each number of the free strokes, `None` for a new one.
    pub(super) sources: Vec<Option<usize>>,
}

/// Makes the edits that need no trial, and those that pay: rendered, they add no more squared error than their prices allow.
/// The edits change different paths. All edits that should pay by their surplus are tried at once and, where a group fails, each
/// half of it, as long as there are `trials`. The others are then tried one by one.
pub(super) fn apply_priced(drawing: &mut Drawing, edits: Vec<Edit>, trials: usize) -> Tried {
    // The loss is a mean over pixels and channels, prices are sums.
    let values = 3.0 * drawing.pixels() as f64;
    let before = drawing.marks();
    let (tried, mut taken): (Vec<usize>, Vec<usize>) =
        (0..edits.len()).partition(|&i| edits[i].is_tried);
    let mut error = 0.0;
    if !tried.is_empty() {
        drawing.apply(taken.iter().map(|&i| &edits[i]));
        error = drawing.mse();
    }
    let (paying, others): (Vec<usize>, Vec<usize>) =
        tried.into_iter().partition(|&i| edits[i].surplus() >= 0.0);
    let groups = std::iter::once(paying).chain(others.into_iter().map(|i| vec![i]));
    // Each trial adds one group to all that were taken, so that interaction between edits is in the measured error.
    by_halves(groups.collect(), trials, |group| {
        // Edits have the indices of the original marks, so every trial starts from these.
        let tried = [&taken[..], group].concat();
        drawing.set_marks(before.clone());
        drawing.apply(tried.iter().map(|&i| &edits[i]));
        let now = drawing.mse();
        let allowed: f64 = group.iter().map(|&i| f64::from(edits[i].price)).sum();
        let pays = (now - error) * values <= allowed;
        if pays {
            (error, taken) = (now, tried);
        }
        pays
    });
    // The last trial may have been refused; the edits taken are applied once more.
    drawing.set_marks(before);
    let sources = drawing.apply(taken.iter().map(|&i| &edits[i]));
    taken.sort_unstable();
    let edits = edits.into_iter().enumerate();
    let made = edits.filter(|(i, _)| taken.binary_search(i).is_ok());
    let made = made.map(|(_, edit)| edit).collect();
    Tried { made, sources }
}

/// Offers each group to `accepts`, and each half of a refused group, down to single edits.
fn by_halves(
    mut groups: Vec<Vec<usize>>,
    trials: usize,
    mut accepts: impl FnMut(&[usize]) -> bool,
) {
    groups.retain(|group| !group.is_empty());
    // A stack, whose top is the first group. Of two halves the first comes next, too, so that edits are tried in their order.
    groups.reverse();
    for _ in 0..trials {
        let Some(group) = groups.pop() else { return };
        if !accepts(&group) && group.len() > 1 {
            let (first, second) = group.split_at(group.len() / 2);
            groups.extend([second.to_vec(), first.to_vec()]);
        }
    }
}

impl Drawing {
    /// Makes edits of different paths. Returns the former index of each number of the free strokes, `None` for a new one.
    pub(super) fn apply<'a>(
        &mut self,
        edits: impl IntoIterator<Item = &'a Edit>,
    ) -> Vec<Option<usize>> {
        let (strokes, stages) = self.marks();
        let mut changes: Vec<Vec<&Change>> = vec![Vec::new(); strokes.len()];
        let (mut on_top, mut known) = (Vec::new(), BTreeMap::new());
        for (i, change) in edits.into_iter().flat_map(|edit| &edit.changes) {
            match (changes.get_mut(*i), change) {
                (Some(changes), change) => {
                    changes.push(change);
                    let starts = strokes.range(*i).step_by(2);
                    let places = strokes.get(*i).points.iter().zip(starts);
                    known.extend(places.map(|(point, start)| (point.map(f32::to_bits), start)));
                }
                (None, Change::Marks(marks)) => on_top.extend(marks),
                (None, Change::Path { .. }) => {}
            }
        }
        // Rebuild the marks from back to front. Each new number records its former index, so that the optimiser's moments follow.
        let (mut edited, mut of_stages, mut sources) = (Strokes::new(), Vec::new(), Vec::new());
        for (i, (stroke, changes)) in strokes.iter().zip(&changes).enumerate() {
            let range = strokes.range(i);
            match changes[..] {
                [] => {
                    edited.push(stroke);
                    of_stages.push(stages[i]);
                    sources.extend(range.map(Some));
                    continue;
                }
                [Change::Marks(marks)] => marks.iter().for_each(|mark| edited.push_mark(mark)),
                _ => {
                    sources.extend(push_with_paths(&mut edited, stroke, range.start, changes));
                    sources.extend((range.end - STYLE..range.end).map(Some));
                    of_stages.push(stages[i]);
                    continue;
                }
            }
            // A point that stays where it is keeps its numbers, and so does the style of a mark.
            for k in of_stages.len()..edited.len() {
                for point in edited.get(k).points {
                    let at = known.get(&point.map(f32::to_bits)).copied();
                    sources.extend([at, at.map(|at| at + 1)]);
                }
                sources.extend((range.end - STYLE..range.end).map(Some));
            }
            of_stages.resize(edited.len(), stages[i]);
        }
        // The first of them is drawn last, so that none of lesser gain hides it.
        on_top.iter().rev().for_each(|mark| edited.push_mark(mark));
        of_stages.resize(edited.len(), self.last_stage());
        sources.resize(edited.numbers().len(), None);
        self.set_marks((edited, of_stages));
        sources
    }
}

/// Adds the stroke or area, whose numbers begin at `start`, with some of its paths changed. Returns the former index of each
/// coordinate. Of the points between the first and the last that change, the first ones take the places of the former ones.
fn push_with_paths(
    strokes: &mut Strokes,
    stroke: StrokeRef<'_>,
    start: usize,
    changes: &[&Change],
) -> Vec<Option<usize>> {
    let (mut all_points, mut all_kinds, mut rings) = (Vec::new(), Vec::new(), Vec::new());
    let mut sources = Vec::new();
    for (k, (first, path)) in stroke.paths().enumerate() {
        let changed = changes.iter().find_map(|change| match change {
            Change::Path {
                index,
                points,
                kinds,
            } if *index == k => Some((&points[..], &kinds[..])),
            _ => None,
        });
        let (points, kinds) = changed.unwrap_or((path.points, path.kinds));
        let (new, old) = (points.len(), path.points.len());
        let same = points.iter().zip(path.points);
        let before = same.take_while(|(a, b)| a == b).count();
        let same = points.iter().rev().zip(path.points.iter().rev());
        let behind = same.take_while(|(a, b)| a == b).count();
        let behind = behind.min(new.min(old) - before);
        for i in 0..new {
            let from = match i {
                _ if i >= new - behind => Some(i + old - new),
                _ if i < old - behind => Some(i),
                _ => None,
            };
            let at = from.map(|from| start + 2 * (first + from));
            sources.extend([at, at.map(|at| at + 1)]);
        }
        all_points.extend(points);
        all_kinds.extend(kinds);
        // A ring is stored by the index at which it ends.
        rings.push(all_points.len() as u32);
    }
    strokes.push(StrokeRef {
        points: &all_points,
        kinds: &all_kinds,
        rings: if stroke.is_area() { &rings } else { &[] },
        form: None,
        ..stroke
    });
    sources
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point more, or less, on a stroke.
    fn edit(mark: usize, gain: f32, price: f32) -> Edit {
        Edit {
            changes: vec![(mark, Change::Marks(Vec::new()))],
            gain,
            price,
            growth: if price > 0.0 { -1 } else { 1 },
            is_tried: true,
        }
    }

    /// The marks and gains of the edits that are chosen of strokes with a new point and a loss of these gains each.
    fn chosen(gains: &[(f32, f32)], free: usize, price: f32) -> Vec<(usize, f32)> {
        let edits = gains.iter().enumerate().flat_map(|(i, &(new, loss))| {
            let price = price.max(f32::MIN_POSITIVE);
            [edit(i, new, -price), edit(i, loss, price)]
        });
        let room = Room {
            free,
            most: usize::MAX,
            swaps: usize::MAX,
        };
        let edits = choose(edits.collect(), room);
        let mut chosen: Vec<_> = edits
            .iter()
            .map(|edit| (edit.changes[0].0, edit.gain))
            .collect();
        chosen.sort_by_key(|(mark, _)| *mark);
        chosen
    }

    #[test]
    fn what_pays_comes_and_what_does_not_goes() {
        let chosen = chosen(&[(5.0, -9.0), (1.0, -9.0), (1.0, -1.0)], 9, 2.0);
        assert_eq!(chosen, [(0, 5.0), (2, -1.0)]);
    }

    #[test]
    fn the_most_gaining_come_first() {
        let chosen = chosen(&[(3.0, -9.0), (5.0, -9.0), (4.0, -9.0)], 2, 0.0);
        assert_eq!(chosen, [(1, 5.0), (2, 4.0)]);
    }

    #[test]
    fn without_room_what_gains_more_takes_the_place_of_what_is_worth_less() {
        let chosen = chosen(&[(1.0, -0.5), (8.0, -9.0), (1.0, -3.0)], 0, 0.0);
        assert_eq!(chosen, [(0, -0.5), (1, 8.0)]);
    }

    #[test]
    fn one_edit_changes_a_path_or_all_of_a_mark() {
        let path = |mark, index| Edit {
            changes: vec![(
                mark,
                Change::Path {
                    index,
                    points: Vec::new(),
                    kinds: Vec::new(),
                },
            )],
            ..edit(mark, 0.0, 0.0)
        };
        let edits = vec![
            path(3, 0),
            path(3, 1),
            path(3, 0),
            edit(3, 0.0, 0.0),
            edit(4, 0.0, 0.0),
        ];
        assert_eq!(disjoint(edits).len(), 3);
    }

    #[test]
    fn what_is_refused_is_found_among_many() {
        let (mut taken, mut trials) = (Vec::new(), 0);
        by_halves(vec![Vec::new(), (0..64).collect()], usize::MAX, |group| {
            trials += 1;
            let is_good = !group.contains(&17) && !group.contains(&40);
            if is_good {
                taken.extend_from_slice(group);
            }
            is_good
        });
        let good: Vec<usize> = (0..64).filter(|i| ![17, 40].contains(i)).collect();
        assert_eq!(taken, good);
        assert!(trials < 26, "{trials}");
    }
}
