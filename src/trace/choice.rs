//! The choice between strokes and areas.
//!
//! Strokes and regions that share pixels make a group. A group is drawn by its strokes if they have the outlines of its
//! regions and cost no more; or else by areas.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::Traced;
use super::areas::{self, Pixels};
use super::edge::{self, Middle, Ring};
use super::even::{Pen, Shape, WAVERING};
use super::fill::{Fill, Filled, Flat, Placing, TIP};
use super::gain::coverage;
use super::parts::{COVERED, Part};
use super::strokes::TracedStroke;
use crate::math::{self, distance};
use crate::scene::{self, Area, Cap, Mark, Stroke, polyline};

/// Strokes and regions that share pixels.
#[derive(Debug, Default)]
struct Group {
    strokes: Vec<usize>,
    regions: Vec<u32>,
}

/// Traced strokes have points that do not pay, so they may cost so many times as much as areas. A guess.
const MOST_PRICE: f32 = 4.0;

/// The regions under a stroke, with the pixels of each that it covers.
type Votes = BTreeMap<u32, f32>;

/// Strokes and areas of which a picture may be drawn.
pub(super) struct Choice<'a> {
    flat: &'a Flat<'a>,
    strokes: Vec<TracedStroke>,
    pixels: &'a Pixels<'a>,
    votes: Vec<Votes>,
    groups: Vec<Group>,
}

/// What draws a picture.
struct Chosen {
    /// The regions that strokes draw.
    is_stroked: Vec<bool>,
    /// For each stroke, if it is drawn, that, its place in the stack and what it gains.
    strokes: Vec<Option<(Stroke, usize, f32)>>,
}

impl<'a> Choice<'a> {
    pub(super) fn of(
        flat: &'a Flat<'a>,
        strokes: Vec<TracedStroke>,
        pixels: &'a Pixels<'a>,
    ) -> Self {
        let votes: Vec<Votes> = strokes
            .par_iter()
            .map(|traced| votes(traced, flat, pixels))
            .collect();
        let groups = groups(&votes, flat.region_count());
        Self {
            flat,
            strokes,
            pixels,
            votes,
            groups,
        }
    }

    /// True if pens may draw all that there is.
    pub(super) fn may_be_lines(&self) -> bool {
        let mut shapes = self.flat.shapes();
        let is_drawn = |group: &Group| self.pens(group).is_some();
        shapes.all(|region| self.is_grouped(region)) && self.groups.par_iter().all(is_drawn)
    }

    /// True if descents find edges sooner than what places them, as there is much of them.
    fn is_long(&self) -> bool {
        let edges = self.flat.edges();
        edges > MOST_EDGES || (edges > MOST_OF_LINES && self.may_be_lines())
    }

    /// True if strokes have a part of a region.
    fn is_grouped(&self, region: u32) -> bool {
        let mut groups = self.groups.iter();
        groups.any(|group| group.regions.contains(&region))
    }

    /// The marks that draw the picture, in painting order, to be fitted; or lines that came apart from blobs although strokes do not
    /// draw them, each as its shape and its region.
    pub(super) fn fitted(
        &self,
        price: &(dyn Fn(&Mark) -> f32 + Sync),
    ) -> Result<Vec<Traced>, Vec<(u32, u32)>> {
        let Self { flat, strokes, .. } = self;
        let fills = flat.fills();
        let wins = |group: &Group| {
            let pens = self.pens(group);
            pens.filter(|_| self.is_worth_strokes(group, &fills, price))
        };
        let pens: Vec<Option<Vec<Pen>>> = self.groups.par_iter().map(wins).collect();
        let has_bands = pens
            .iter()
            .flatten()
            .flatten()
            .any(|pen| pen.band.is_some());
        let drawn = self.groups.iter().zip(pens).map(|(group, pens)| {
            let strokes = group.strokes.iter().map(|&i| &strokes[i].stroke);
            Some(
                strokes
                    .zip(pens?)
                    .map(|(stroke, pen)| drawn_by(pen, stroke))
                    .collect(),
            )
        });
        let drawn: Vec<Option<Vec<Stroke>>> = drawn.collect();
        let won = drawn.iter().map(Option::is_some).collect();
        let won = unjoined(won, &self.groups, flat, &fills, strokes);
        let chosen = self.chosen(&fills, drawn, won, price)?;
        let areas = flat.areas(fills, &chosen.is_stroked);
        // A drawing of lines is one of strokes as they were traced.
        if areas.is_empty() && !has_bands {
            return Ok(strokes.iter().cloned().map(Traced::from).collect());
        }
        Ok(stacked(chosen.strokes, areas, false))
    }

    /// The marks that draw the picture where their edges are seen, in painting order, lines of varying width among them if there
    /// `may_be_ink`; `None` where shapes come apart, edges are long, lines are left that nothing draws, or colours do not tell where
    /// edges are.
    pub(super) fn placed(
        &self,
        may_be_ink: bool,
        price: &(dyn Fn(&Mark) -> f32 + Sync),
    ) -> Option<Vec<Traced>> {
        // Where lines join blobs of their colour is no edge, so that descents find it.
        if self.flat.is_apart() || self.is_long() {
            return None;
        }
        let placing = Placing::of(self.flat);
        // Where there is no damage, edges that colours do not tell are those of something else, such as gradients.
        let is_clean = self.flat.tracing.doubt.most() == 0.0;
        // The tips of lines are no shapes.
        let is_shape = |region: u32| self.flat.size(region) > TIP;
        let has_to_be_sure = |region: u32| is_clean && is_shape(region) && !self.is_grouped(region);
        let fills = placing.fills(has_to_be_sure)?;
        let lines = |group: &Group| self.lines(group, &placing, &fills);
        let mut lines: Vec<Option<Vec<Stroke>>> = self.groups.par_iter().map(lines).collect();
        self.keep_pens(&mut lines, &fills);
        let won = lines.iter().map(Option::is_some).collect();
        let mut chosen = self.chosen(&fills, lines, won, price).ok()?;
        // Damage makes many lines of what is none, and lines of one width need no other ones.
        let has_ink = may_be_ink
            && is_clean
            && !self.may_be_lines()
            && self.add_ink(&mut chosen, &placing, &fills);
        if has_ink {
            // What lies on top of regions that lines of ink draw was laid along parts of those.
            let strokes = chosen.strokes.iter_mut().zip(&self.votes);
            let orphans = strokes.filter(|(_, votes)| votes.is_empty());
            orphans.for_each(|(stroke, _)| *stroke = None);
        }
        // What colours tell badly is to be fitted, and so are strokes that no region tells.
        let is_told = |(votes, stroke): (&Votes, &Option<_>)| !votes.is_empty() || stroke.is_none();
        let is_sure = self.votes.iter().zip(&chosen.strokes).all(is_told)
            && placing.is_sure(&fills, |fill| {
                // Beside lines of ink, specks decide nothing.
                chosen.is_stroked[fill.region as usize] || (has_ink && fill.size <= TIP)
            });
        if !is_sure && is_clean {
            return None;
        }
        let count = chosen.strokes.iter().flatten().count();
        let areas = placing.areas(&fills, &chosen.is_stroked, count);
        Some(stacked(chosen.strokes, areas, is_sure)).filter(|marks| !marks.is_empty())
    }

    /// What draws the picture, if these strokes draw groups; or lines that came apart from blobs although strokes do not draw them.
    fn chosen<R>(
        &self,
        fills: &[Fill<R>],
        drawn: Vec<Option<Vec<Stroke>>>,
        mut won: Vec<bool>,
        price: &(dyn Fn(&Mark) -> f32 + Sync),
    ) -> Result<Chosen, Vec<(u32, u32)>> {
        let Self {
            flat,
            strokes,
            pixels,
            votes,
            groups,
        } = self;
        let undrawn = undrawn(groups, &won, flat);
        if !undrawn.is_empty() {
            return Err(undrawn);
        }
        // The regions that strokes draw need no area.
        let mut is_stroked = vec![false; flat.region_count()];
        for region in crossed(groups, &won, flat, strokes, pixels) {
            is_stroked[region as usize] = true;
            let own = groups
                .iter()
                .zip(&mut won)
                .filter(|(group, _)| group.regions == [region]);
            own.for_each(|(_, won)| *won = false);
        }
        let mut places = vec![None; strokes.len()];
        let gains: BTreeMap<u32, f32> = fills.iter().map(|fill| (fill.region, fill.gain)).collect();
        let drawn = groups.iter().zip(drawn).zip(&won).filter(|(_, won)| **won);
        for ((group, drawn), _) in drawn {
            let regions = group.regions.iter();
            regions.for_each(|&region| is_stroked[region as usize] = true);
            for (&i, stroke) in group.strokes.iter().zip(drawn.into_iter().flatten()) {
                let rank = rank(&strokes[i], &votes[i], flat, pixels);
                // On top of an area it gains what its regions do.
                let contribution = votes[i].iter().map(|(region, votes)| {
                    let gain = gains.get(region).copied().unwrap_or_default();
                    gain * (votes / flat.size(*region)).min(1.0) / flat.mattes as f32
                });
                let gain = contribution.sum::<f32>().max(strokes[i].gain);
                places[i] = Some((stroke, rank, gain));
            }
        }
        // What no region has a part of lies on top.
        let orphans = (0..strokes.len()).filter(|&i| votes[i].is_empty());
        for i in orphans {
            let stroke = &strokes[i].stroke;
            let covered = coverage_of(stroke, pixels);
            let gain = flat.gain_on_top((stroke.color, stroke.opacity), &covered);
            if gain > price(&stroke.clone().into()) {
                places[i] = Some((stroke.clone(), usize::MAX, gain));
            }
        }
        Ok(Chosen {
            is_stroked,
            strokes: places,
        })
    }

    /// The pens of the strokes of a group, if they draw its regions.
    fn pens(&self, group: &Group) -> Option<Vec<Pen>> {
        let Self { flat, pixels, .. } = self;
        let strokes = self.strokes_of(group);
        // What lines join is a thing, unless it is a line itself.
        let is_blob = matches!(flat.part(group.regions[0]), Part::Blob(_));
        let is_dot = is_blob && strokes.iter().any(|stroke| length(stroke) < LINE);
        if is_dot || darken(&strokes, pixels) {
            return None;
        }
        let members = flat.members(&group.regions);
        let shape = Shape {
            inside: |p| flat.share_at(p, &members),
            region: |p| pixels.at(p).map(|i| flat.region(i)),
        };
        let even: Vec<Option<Pen>> = strokes.iter().map(|stroke| shape.pen(stroke)).collect();
        let is_even = |(_, pen): &(&&Stroke, &Option<Pen>)| pen.is_some();
        let lengths = |odd: bool| {
            let own = strokes.iter().zip(&even).filter(|own| odd != is_even(own));
            own.map(|(stroke, _)| length(stroke) * stroke.radius as f32)
                .sum::<f32>()
        };
        // Of the lines of a shape that came apart, few run so close to another one that neither is even.
        let is_apart = matches!(flat.part(group.regions[0]), Part::Lines(_));
        let most_odd = if is_apart {
            MOST_ODD * lengths(false)
        } else {
            0.0
        };
        if lengths(true) > most_odd || even.iter().all(Option::is_none) {
            return None;
        }
        let pens = strokes.iter().zip(even);
        let pens = pens.map(|(stroke, pen)| pen.unwrap_or(Pen::round(stroke.radius as f32)));
        let mut pens: Vec<Pen> = pens.collect();
        // Letters of bars are things, and no lines.
        // Ends that are hidden are like those that are seen.
        let is_square = |pen: &Pen| pen.band.is_some() && !pen.is_round;
        match pens.iter().any(is_square) {
            true => {
                let lengths: f32 = strokes.iter().map(|stroke| length(stroke)).sum();
                if lengths < LONG * strokes.len() as f32 {
                    return None;
                }
            }
            false => pens.iter_mut().for_each(|pen| pen.band = None),
        }
        is_covered(&strokes, flat, &members, group, pixels).then_some(pens)
    }

    /// The strokes of a group, as they were traced.
    fn strokes_of(&self, group: &Group) -> Vec<&Stroke> {
        let strokes = group.strokes.iter();
        strokes.map(|&i| &self.strokes[i].stroke).collect()
    }

    /// True if strokes that draw a group cost little more than its areas, which are no ellipse.
    fn is_worth_strokes(
        &self,
        group: &Group,
        fills: &[Fill],
        price: &(dyn Fn(&Mark) -> f32 + Sync),
    ) -> bool {
        let strokes = self.strokes_of(group).into_iter();
        let of_strokes: f32 = strokes
            .map(|stroke| price(&without_wavering(stroke).into()))
            .sum();
        let own = |fill: &&Fill| group.regions.contains(&fill.region);
        let areas: Vec<Area> = fills
            .iter()
            .filter(own)
            .flat_map(|fill| self.flat.area_of(fill))
            .collect();
        let of_areas: f32 = areas.iter().map(|area| price(&area.clone().into())).sum();
        let is_ellipse = matches!(&areas[..], [area] if is_ellipse(area));
        !is_ellipse && of_strokes <= MOST_PRICE * of_areas
    }

    /// The strokes of a group as lines of one width, if these have a shorter description than its regions.
    fn lines(
        &self,
        group: &Group,
        placing: &Placing<'_>,
        fills: &[Fill<Ring>],
    ) -> Option<Vec<Stroke>> {
        let strokes = self.strokes_of(group);
        if darken(&strokes, self.pixels) {
            return None;
        }
        let own = fills
            .iter()
            .filter(|fill| group.regions.contains(&fill.region));
        let own: Vec<&Fill<Ring>> = own.collect();
        let middle = |stroke: &&Stroke| {
            let mut places = stroke.path.flattened(FLAT);
            if stroke.path.is_closed() {
                places.extend(places.first().copied());
            }
            Middle {
                places,
                is_closed: stroke.path.is_closed(),
                radius: stroke.radius,
                radii: Vec::new(),
                crossings: Vec::new(),
            }
        };
        let middles: Vec<Middle> = strokes.iter().map(middle).collect();
        let lines = placing.lines(&own, &middles)?.into_iter();
        let drawn = lines.zip(&strokes).map(|(line, stroke)| Stroke {
            path: line.path(),
            radius: line.radius(),
            cap: line.cap(),
            ..(*stroke).clone()
        });
        Some(drawn.collect())
    }

    /// Draws shapes that no strokes draw by lines of varying width, if these have a shorter description and are most of the drawing.
    /// Returns whether there are such.
    fn add_ink(&self, chosen: &mut Chosen, placing: &Placing<'_>, fills: &[Fill<Ring>]) -> bool {
        let ink = self.ink(&chosen.is_stroked, placing, fills);
        // Among many things of other kinds, a few that are like lines are things, too.
        let mut is_drawn = chosen.is_stroked.clone();
        let drawn = ink.iter().flat_map(|(fills, _)| fills);
        drawn.for_each(|fill| is_drawn[fill.region as usize] = true);
        let areas = fills.iter().filter(|fill| !is_drawn[fill.region as usize]);
        let areas = areas.filter(|fill| fill.size > TIP).count();
        let strokes = self.votes.iter().zip(&chosen.strokes);
        let even = strokes.filter(|(votes, stroke)| stroke.is_some() && !votes.is_empty());
        let lines = ink.iter().flat_map(|(_, lines)| lines);
        let (varying, others) = lines.partition::<Vec<&edge::Line>, _>(|l| l.varying().is_some());
        let others = others.len() + areas + even.count();
        if varying.is_empty() || varying.len() < others {
            return false;
        }
        chosen.is_stroked = is_drawn;
        for (fills, lines) in ink {
            let gain: f32 = fills.iter().map(|fill| fill.gain).sum();
            let gain = gain / (self.flat.mattes * lines.len()) as f32;
            // The largest one, as tips are pale.
            let fill = fills[0];
            let (color, opacity) = areas::ink(&fill.color, self.flat.mattes);
            chosen.strokes.extend(lines.into_iter().map(|line| {
                let stroke = Stroke {
                    path: line.path(),
                    radius: line.radius(),
                    radii: line.varying().unwrap_or_default(),
                    cap: line.cap(),
                    color,
                    opacity,
                };
                Some((stroke, fill.rank, gain))
            }));
        }
        true
    }

    /// The shapes that lines of varying width draw, and those: of what no strokes draw.
    fn ink<'f>(
        &self,
        is_stroked: &[bool],
        placing: &Placing<'_>,
        fills: &'f [Fill<Ring>],
    ) -> Vec<(Vec<&'f Fill<Ring>>, Vec<edge::Line>)> {
        let open: BTreeMap<u32, &Fill<Ring>> = fills
            .iter()
            .filter(|fill| !is_stroked[fill.region as usize] && !fill.has_shades())
            .map(|fill| (fill.region, fill))
            .collect();
        // 1. What comes apart where it is thin is one shape. Larger regions come first, as tips are pale.
        let is_one =
            |a: u32, b: u32| self.flat.label(a) == self.flat.label(b) || placing.is_tip_of(b, a);
        let mut regions: Vec<u32> = open.keys().copied().collect();
        regions.sort_by(|a, b| self.flat.size(*b).total_cmp(&self.flat.size(*a)));
        let shapes = self.flat.scattered(&regions, GAP, is_one);
        let shapes = shapes.into_iter().map(|shape| {
            let fills = shape.into_iter().filter_map(|region| open.get(&region));
            fills.copied().collect::<Vec<_>>()
        });
        let is_large = |fills: &Vec<&Fill<Ring>>| {
            let sizes = fills.iter().map(|fill| fill.size);
            sizes.sum::<f32>() > TIP
        };
        let shapes: Vec<Vec<&Fill<Ring>>> = shapes.filter(is_large).collect();
        // 2. Their lines.
        let drawn = shapes.par_iter().map(|fills| placing.ink(fills));
        let drawn: Vec<Option<Vec<edge::Line>>> = drawn.collect();
        // 3. Those that are long, and others if no area has their colour.
        let label = |fills: &[&Fill<Ring>]| self.flat.label(fills[0].region);
        let pairs = shapes.iter().zip(&drawn);
        let areas = pairs.filter(|(_, lines)| lines.is_none());
        let labels: BTreeSet<u16> = areas.map(|(fills, _)| label(fills)).collect();
        let pairs = shapes.into_iter().zip(drawn);
        let lines = pairs.filter_map(|(fills, lines)| {
            let lines = lines?;
            let lengths = lines.iter().map(edge::Line::slenderness);
            let length = lengths.sum::<f64>() / lines.len() as f64;
            let is_alone = !labels.contains(&label(&fills));
            let least = if is_alone { LINE } else { SHORT };
            (length >= f64::from(least)).then_some((fills, lines))
        });
        lines.collect()
    }

    /// Forgets lines that are things rather than lines: a disc and a bar have as many numbers. A long line tells a pen, which draws
    /// others as wide, and has one width.
    fn keep_pens(&self, lines: &mut [Option<Vec<Stroke>>], fills: &[Fill<Ring>]) {
        let is_long = |strokes: &Vec<Stroke>| {
            let lengths = strokes.iter().map(length);
            lengths.sum::<f32>() >= SHORT * strokes.len() as f32
        };
        // 1. The widths of long lines, wider ones first.
        let long = lines.iter().flatten().filter(|strokes| is_long(strokes));
        let mut pens: Vec<[f64; 2]> = long
            .flatten()
            .map(|stroke| [stroke.radius, stroke.radius * f64::from(length(stroke))])
            .collect();
        pens.sort_by(|a, b| b[0].total_cmp(&a[0]));
        let pens: Vec<f64> = pens
            .chunk_by(|a, b| a[0] - b[0] < ONE_PEN * a[0])
            .map(|pen| {
                let all: f64 = pen.iter().map(|[_, length]| length).sum();
                pen.iter()
                    .map(|[radius, length]| radius * length / all)
                    .sum()
            })
            .collect();
        let pen_of = |stroke: &Stroke| {
            let away = |pen: &&f64| (*pen - stroke.radius).abs();
            let nearest = pens.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.filter(|pen| away(pen) < ONE_PEN * **pen).copied()
        };
        // 2. Lines of these; and others of some length, if no area has their colour.
        let is_stroked = |region: u32| {
            let mut groups = self
                .groups
                .iter()
                .zip(&*lines)
                .filter(|(_, lines)| lines.is_some());
            groups.any(|(group, _)| group.regions.contains(&region))
        };
        let areas = fills.iter().filter(|fill| !is_stroked(fill.region));
        let labels: BTreeSet<u16> = areas.map(|fill| self.flat.label(fill.region)).collect();
        for (group, lines) in self.groups.iter().zip(lines) {
            let Some(strokes) = lines else { continue };
            let least = |stroke: &Stroke| match stroke.cap {
                Cap::Round => LINE,
                Cap::Butt => LONG,
            };
            let mut labels_of = group.regions.iter().map(|&region| self.flat.label(region));
            let is_alone = labels_of.all(|label| !labels.contains(&label));
            let is_line =
                |stroke: &Stroke| stroke.path.is_closed() || length(stroke) >= least(stroke);
            let are_lines = is_long(strokes) || (is_alone && strokes.iter().all(is_line));
            match strokes.iter().all(|stroke| pen_of(stroke).is_some()) {
                true => strokes.iter_mut().for_each(|stroke| {
                    stroke.radius = pen_of(stroke).unwrap_or(stroke.radius);
                }),
                false if !are_lines => *lines = None,
                false => {}
            }
        }
    }
}

/// Parts of a line that come apart where it is thin are as near as this, px. A guess.
const GAP: usize = 3;

/// Most pairs of pixels between areas that are placed where they are seen: blobs of noise of 1,000 px, which have 23,000, take 22 s instead of
/// 16 s. Emoji of 1,024 px have 7,000 to 13,000.
const MOST_EDGES: u32 = 20_000;
/// As [`MOST_EDGES`], of lines: a cat in lines of 1,000 px, which has more, takes 6.1 s instead of 2.5 s, and has 5 dB less.
const MOST_OF_LINES: u32 = 6_000;

/// Widths that differ by a smaller share are those of one pen. A guess.
const ONE_PEN: f64 = 0.04;

/// Farthest that the places along a middle are from it, px.
const FLAT: f64 = 0.05;

/// The stroke that a pen draws along the path of one that was traced.
fn drawn_by(pen: Pen, traced: &Stroke) -> Stroke {
    // A width that was taken for that on the canvas.
    let is_wrong = (traced.radius - f64::from(pen.radius)).abs() > WRONG;
    let stroke = Stroke {
        radius: if is_wrong {
            pen.radius.into()
        } else {
            traced.radius
        },
        ..traced.clone()
    };
    pen.band
        .map_or_else(|| stroke.clone(), |band| band.stroke(&stroke))
}

/// Strokes and areas, in painting order. Strokes keep their order among each other, as far as areas lie not between.
fn stacked(
    strokes: Vec<Option<(Stroke, usize, f32)>>,
    areas: Vec<Filled>,
    is_placed: bool,
) -> Vec<Traced> {
    let traced = |mark: Mark, gain: f32| Traced {
        mark,
        gain,
        is_placed,
    };
    let strokes = strokes.into_iter().flatten().map(|(stroke, rank, gain)| {
        let place = areas.iter().filter(|area| area.rank < rank).count();
        (2 * place, traced(stroke.into(), gain))
    });
    let mut found: Vec<(usize, Traced)> = strokes.collect();
    for (place, area) in areas.into_iter().enumerate() {
        found.push((2 * place + 1, traced(area.area.into(), area.gain)));
    }
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(_, traced)| traced).collect()
}

/// The lines that came apart from blobs and are not drawn by strokes: shapes and regions.
fn undrawn(groups: &[Group], won: &[bool], flat: &Flat<'_>) -> Vec<(u32, u32)> {
    let drawn = groups.iter().zip(won).filter(|(_, won)| **won);
    let drawn = drawn.flat_map(|(group, _)| group.regions.iter().copied());
    let drawn: BTreeSet<u32> = drawn.collect();
    let open = (0..flat.region_count() as u32).filter(|region| !drawn.contains(region));
    let lines = open.filter_map(|region| match flat.part(region) {
        // Corners of edges are no lines.
        Part::Lines(shape) if flat.size(region) > SLIVER => Some((shape, region)),
        _ => None,
    });
    lines.collect()
}

/// A part of lines of fewer pixels is a corner that edges have left. A guess.
const SLIVER: f32 = 6.0;

/// The blobs, and corners of lines, that lines cover, as they cross there.
fn crossed(
    groups: &[Group],
    won: &[bool],
    flat: &Flat<'_>,
    strokes: &[TracedStroke],
    pixels: &Pixels<'_>,
) -> Vec<u32> {
    let drawn = groups.iter().zip(won).filter(|(_, won)| **won);
    let lines = drawn
        .flat_map(|(group, _)| &group.strokes)
        .map(|&i| &strokes[i]);
    let lines = lines.filter(|traced| matches!(traced.part, Part::Lines(_)));
    let mut covered: BTreeMap<usize, f32> = BTreeMap::new();
    for (i, share) in lines.flat_map(|traced| coverage_of(&traced.stroke, pixels)) {
        let most = covered.entry(i).or_default();
        *most = most.max(share);
    }
    let share = |region: u32| {
        let shares = flat.pixels_of(region).filter_map(|i| covered.get(&i));
        shares.sum::<f32>() / flat.size(region)
    };
    let regions = 0..flat.region_count() as u32;
    let is_crossed = |&region: &u32| match flat.part(region) {
        Part::Whole => false,
        Part::Lines(_) => flat.size(region) <= SLIVER,
        Part::Blob(_) => share(region) > COVERED,
    };
    regions.filter(is_crossed).collect()
}

fn coverage_of(stroke: &Stroke, pixels: &Pixels<'_>) -> Vec<(usize, f32)> {
    coverage(&stroke.path, stroke.radius as f32, pixels)
}

/// The place of a stroke in the stack: that of its regions, or below what it goes on beneath.
fn rank(traced: &TracedStroke, votes: &Votes, flat: &Flat<'_>, pixels: &Pixels<'_>) -> usize {
    let own = votes.keys().filter_map(|&region| flat.rank(region));
    let line = traced.stroke.path.flattened(0.1);
    let crossed = line.windows(2).flat_map(|ends| {
        let [a, b] = [math::xy(ends[0]), math::xy(ends[1])];
        let steps = distance(a, b).ceil() as usize;
        (0..steps).map(move |step| {
            let share = step as f32 / steps as f32;
            [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
        })
    });
    let crossed = crossed.filter(|_| traced.is_covered);
    let crossed = crossed.filter_map(|p| flat.rank(flat.region(pixels.at(p)?)));
    own.chain(crossed).min().unwrap_or_default()
}

/// The regions of about the stroke's colour that it covers a good part of, or that are a good part of it.
fn votes(traced: &TracedStroke, flat: &Flat<'_>, pixels: &Pixels<'_>) -> Votes {
    const GOOD: f32 = 0.2;
    let mut votes = Votes::new();
    let mut all = 0.0;
    let is_own = |region: &u32| flat.part(*region) == traced.part;
    for (i, share) in coverage_of(&traced.stroke, pixels) {
        if let Some(region) = flat.region_like(i, &traced.pixel).filter(is_own) {
            *votes.entry(region).or_default() += share;
        }
        all += share;
    }
    votes.retain(|region, share| *share > GOOD * all || *share > GOOD * flat.size(*region));
    votes
}

/// The groups of strokes and regions.
fn groups(votes: &[Votes], regions: usize) -> Vec<Group> {
    // The group of each region is named by one of its regions.
    let mut names: Vec<usize> = (0..regions).collect();
    fn name(names: &[usize], mut at: usize) -> usize {
        while names[at] != at {
            at = names[at];
        }
        at
    }
    for votes in votes {
        let mut regions = votes.keys().map(|&region| region as usize);
        let Some(first) = regions.next() else {
            continue;
        };
        for other in regions {
            let (a, b) = (name(&names, first), name(&names, other));
            names[a.max(b)] = a.min(b);
        }
    }
    let mut groups: BTreeMap<usize, Group> = BTreeMap::new();
    for (i, votes) in votes.iter().enumerate() {
        if let Some(&region) = votes.keys().next() {
            let group = groups.entry(name(&names, region as usize)).or_default();
            group.strokes.push(i);
            group.regions.extend(votes.keys());
        }
    }
    let mut groups: Vec<Group> = groups.into_values().collect();
    for group in &mut groups {
        group.regions.sort_unstable();
        group.regions.dedup();
    }
    groups
}

/// Groups that strokes draw, short ones beside areas of their colour left out: those join the areas and are no marks.
fn unjoined<R>(
    mut won: Vec<bool>,
    groups: &[Group],
    flat: &Flat<'_>,
    fills: &[Fill<R>],
    strokes: &[TracedStroke],
) -> Vec<bool> {
    let mut is_stroked = vec![false; flat.region_count()];
    for (group, _) in groups.iter().zip(&won).filter(|(_, won)| **won) {
        let regions = group.regions.iter();
        regions.for_each(|&region| is_stroked[region as usize] = true);
    }
    let areas = fills
        .iter()
        .filter(|fill| !is_stroked[fill.region as usize]);
    let labels: BTreeSet<u16> = areas.map(|fill| flat.label(fill.region)).collect();
    let is_short = |group: &Group| {
        let lengths = group.strokes.iter().map(|&i| length(&strokes[i].stroke));
        lengths.sum::<f32>() < SHORT * group.strokes.len() as f32
    };
    for (group, won) in groups.iter().zip(&mut won) {
        let is_alone = group
            .regions
            .iter()
            .all(|&r| !labels.contains(&flat.label(r)));
        *won &= is_alone || !is_short(group);
    }
    won
}

/// Length of a stroke's middle, in units of its radius.
fn length(stroke: &Stroke) -> f32 {
    let line = stroke.path.flattened(0.1);
    let sides = line.windows(2).map(|ends| ends[0].distance(ends[1]));
    (sides.sum::<f64>() / stroke.radius) as f32
}

/// Strokes of fewer radii are short. A guess.
const SHORT: f32 = 16.0;

/// A radius is replaced by one that is farther away than this, px. A guess.
const WRONG: f64 = 0.5;

/// The stroke along a polyline, if it is nearly that.
fn without_wavering(stroke: &Stroke) -> Stroke {
    let polyline = polyline(&stroke.path, WAVERING, stroke.radius);
    Stroke {
        path: polyline.unwrap_or_else(|| stroke.path.clone()),
        ..stroke.clone()
    }
}

/// Lines with square ends have so many radii on average. A guess.
const LONG: f32 = 12.0;

/// Length of the lines that are not even, in units of that of the others. A guess.
const MOST_ODD: f32 = 0.25;

/// A blob of fewer radii is no line. A guess.
const LINE: f32 = 6.0;

/// An ellipse is no stroke if its radii are above this, px. A guess.
const STOUT: f64 = 4.0;

/// Farthest that an outline is from the ellipse that it is, px: a guess, as for forms.
const NEAR: f64 = 0.45;

/// True for an ellipse that is no circle: a fat stroke is as near to it as rays tell, but not its ends.
fn is_ellipse(area: &Area) -> bool {
    let shape = match &area.rings[..] {
        [ring] => scene::Shape::like(ring, NEAR),
        _ => None,
    };
    matches!(shape, Some(scene::Shape::Ellipse { radii, .. }) if radii.iter().all(|&px| px > STOUT))
}

/// True if strokes of a group are translucent and overlap: their shape is darker there than it is seen.
fn darken(strokes: &[&Stroke], pixels: &Pixels<'_>) -> bool {
    let translucent = strokes.iter().filter(|stroke| stroke.opacity < 1.0);
    let mut most: BTreeMap<usize, f32> = BTreeMap::new();
    let mut overlap = 0.0;
    for (i, share) in translucent.flat_map(|stroke| coverage_of(stroke, pixels)) {
        let most = most.entry(i).or_default();
        overlap += share.min(*most);
        *most = most.max(share);
    }
    overlap > MOST_OVERLAP
}

/// Largest overlap of translucent strokes that is not seen, px². A guess.
const MOST_OVERLAP: f32 = 2.0;

/// True if strokes cover a group of regions and nothing else that is seen, give or take a part of a pixel.
fn is_covered(
    strokes: &[&Stroke],
    flat: &Flat<'_>,
    members: &[bool],
    group: &Group,
    pixels: &Pixels<'_>,
) -> bool {
    // Traced lines are up to a pixel off their places.
    const SLACK: [f32; 2] = [1.0, 0.1];
    let covered = |side: f32| {
        let mut covered: BTreeMap<usize, f32> = BTreeMap::new();
        for stroke in strokes {
            let radius = stroke.radius as f32;
            let slack = side * (SLACK[0] + SLACK[1] * radius);
            let radius = (radius + slack).max(0.3);
            for (i, share) in coverage(&stroke.path, radius, pixels) {
                let most = covered.entry(i).or_default();
                *most = most.max(share);
            }
        }
        covered
    };
    let size: f32 = group.regions.iter().map(|&region| flat.size(region)).sum();
    let wide = covered(1.0);
    let inner = group
        .regions
        .iter()
        .flat_map(|&region| flat.pixels_of(region));
    let missed: f32 = inner
        .map(|i| flat.share(i, members) * (1.0 - wide.get(&i).copied().unwrap_or_default()))
        .sum();
    let rank = group
        .regions
        .iter()
        .filter_map(|&region| flat.rank(region))
        .min();
    // What lies on top hides it, and so do blobs.
    let is_blob = |i: usize| matches!(flat.part(flat.region(i)), Part::Blob(_));
    let is_seen = |i: usize| flat.rank(flat.region(i)) <= rank && !is_blob(i);
    let narrow = covered(-1.0).into_iter();
    let beyond: f32 = narrow
        .filter(|&(i, _)| is_seen(i))
        .map(|(i, share)| share * (1.0 - flat.share(i, members)))
        .sum();
    // A straight line runs on below the blurred edges of what it ends at, or crosses at a sharp angle.
    let is_line = |stroke: &&Stroke| {
        stroke.path.points().len() == 2 && length(stroke) * stroke.radius as f32 >= STRAIGHT
    };
    let most_beyond = match strokes.iter().all(is_line) {
        true => 0.1 * size + 5.0,
        false => 0.03 * size + 1.0,
    };
    missed <= 0.1 * size + 1.0 && beyond <= most_beyond
}

/// Shortest straight stroke that is surely a line, px. A guess.
const STRAIGHT: f32 = 14.0;
