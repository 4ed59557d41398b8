//! Which things cast their shadows together, and what these shadows are seen on.

use super::ink;
use super::shadow::Shadow;
use super::surfaces::{FLAT, Light, Surfaces};
use super::things::Things;
use crate::scene::{Area, Mark, quantized_anywhere};
use crate::shading::Value;

// All of these are guesses.
/// Most casters that each cast shadows of their own.
const MOST_CASTERS: usize = 16;
/// Number of times that their shadows are fitted beside each other.
const ROUNDS: usize = 2;
/// Blocks that shadows are fitted to, along the longer side of where they are.
pub(super) const BLOCKS: usize = 160;
/// All shadows of a thing have to leave less than this share of the squared error, where they are seen.
const LEFT: f32 = 0.03;
/// Decimals of things that shadows are seen on.
const PRECISION: u8 = 2;

/// The things of a picture, and the surfaces that their shadows are seen on.
pub(super) struct Shaded<'a> {
    pub(super) surfaces: &'a Surfaces<'a>,
    pub(super) things: &'a Things,
    pub(super) values: Vec<Value>,
}

/// Things that cast their shadows as one.
pub(super) struct Group {
    /// Rising.
    pub(super) things: Vec<usize>,
    pub(super) shadow: Shadow,
}

impl Group {
    /// The lowest of its things, above the shadow.
    fn lowest(&self) -> usize {
        self.things[0]
    }
}

impl<'a> Shaded<'a> {
    pub(super) fn new(surfaces: &'a Surfaces<'a>, things: &'a Things) -> Self {
        Self {
            surfaces,
            things,
            values: surfaces.values(),
        }
    }

    /// The shadows of those groups that explain what is soft and gain `price` each, and the things that they are seen on, back to front.
    pub(super) fn ground(&self, groups: Vec<Group>, price: f32) -> Vec<Area> {
        let groups = self.explained(groups);
        let left = self.without(&groups);
        let size = self.surfaces.size();
        let mut shadows: Vec<Vec<Area>> = vec![Vec::new(); self.things.areas.len()];
        let mut is_below = vec![false; self.things.areas.len()];
        for group in &groups {
            let [all, left] = self.errors(group, &left);
            if all - left >= price * group.shadow.len() as f32 {
                shadows[group.lowest()].extend(group.shadow.areas(size));
                let below = self.seen(group).into_iter();
                let below = below.filter_map(|i| self.things.top[i]);
                below.for_each(|thing| is_below[thing] = true);
            }
        }
        // Below the lowest of the things that cast it, and above what it is seen on.
        let mut ground = Vec::new();
        for ((shadows, is_below), thing) in
            shadows.into_iter().zip(is_below).zip(&self.things.areas)
        {
            ground.extend(shadows);
            if is_below {
                let rounded = quantized_anywhere(&Mark::Area(thing.clone()), PRECISION);
                ground.extend(rounded.and_then(|mark| mark.as_area().cloned()));
            }
        }
        ground
    }

    /// The groups of casters whose shadows explain what is soft: all as one, or each its own if that leaves less.
    pub(super) fn groups(&self) -> Vec<Group> {
        let casters = &self.things.casters;
        // 1. As one, unless one lies on another.
        let all = match casters.is_empty() || self.is_stack() {
            true => None,
            false => self.fitted(casters.clone(), &self.values),
        };
        let one = self.explained(all.into_iter().collect());
        let is_enough = self.error(&self.without(&one)) <= LEFT * self.error(&self.values);
        if is_enough || casters.len() > MOST_CASTERS {
            return one;
        }
        // 2. Each from what the ones before it have left, and then again from what all others leave.
        let mut groups: Vec<Group> = Vec::new();
        for &caster in casters {
            groups.extend(self.fitted(vec![caster], &self.without(&groups)));
        }
        let count = groups.len();
        for k in (0..ROUNDS * count).map(|turn| turn % count) {
            let own = self.seen(&groups[k]);
            let others = groups.iter().enumerate().filter(|(i, _)| *i != k);
            let others: Vec<&Group> = others.map(|(_, group)| group).collect();
            let meets = |other: &&Group| {
                let mut seen = self.seen(other).into_iter();
                seen.any(|i| own.binary_search(&i).is_ok())
            };
            if !others.iter().any(meets) {
                continue;
            }
            let left = self.without(others);
            if let Some(group) = self.fitted(groups[k].things.clone(), &left) {
                groups[k] = group;
            }
        }
        // 3. What leaves less.
        let own = self.explained(groups);
        let errors = [&one, &own].map(|groups| self.error(&self.without(groups)));
        if errors[1] < errors[0] { own } else { one }
    }

    /// True if shadows are seen on casters, or on what lies above one.
    fn is_stack(&self) -> bool {
        let lowest = self.things.casters.iter().min();
        let soft = (0..self.values.len()).filter(|&i| self.surfaces.is(i, Light::Soft));
        let is_above = |&i: &usize| self.things.top[i].as_ref() >= lowest;
        let above = soft.clone().filter(is_above).count();
        self.things.may_be_below && above as f32 > LEFT * soft.count() as f32
    }

    /// Those groups that explain what is soft where their shadows are seen.
    fn explained(&self, mut groups: Vec<Group>) -> Vec<Group> {
        let left = self.without(&groups);
        groups.retain(|group| {
            let [all, left] = self.errors(group, &left);
            left <= LEFT * all
        });
        groups
    }

    /// The squared error of soft pixels with these values.
    fn error(&self, values: &[Value]) -> f32 {
        (0..values.len()).map(|i| self.lacking(i, values)).sum()
    }

    /// The squared difference of what is left of a soft pixel from full light; 0 of others.
    pub(super) fn lacking(&self, i: usize, left: &[Value]) -> f32 {
        match self.surfaces.at(i) {
            Some((surface, Light::Soft)) => ink::distance2(left[i], self.surfaces.base(surface, i)),
            _ => 0.0,
        }
    }

    /// The surface in full light at a pixel that shows how a shadow below a thing falls.
    pub(super) fn shows(&self, i: usize, below: usize) -> Option<Value> {
        let (surface, light) = self.surfaces.at(i)?;
        // What a fit would move is no part of the ground.
        let is_below = self.things.top[i].is_none_or(|top| self.things.may_be_below && top < below);
        (is_below && light != Light::Rim).then(|| self.surfaces.base(surface, i))
    }

    /// The shadow of things together, from what others have left of the values.
    fn fitted(&self, mut things: Vec<usize>, values: &[Value]) -> Option<Group> {
        things.sort_unstable();
        let lowest = *things.first()?;
        let casters = things.iter().map(|&k| self.things.cast_by(k)).collect();
        let known = |i: usize| Some((values[i], self.shows(i, lowest)?));
        let shadow = Shadow::of(casters, self.surfaces.size(), BLOCKS, known)?;
        Some(Group { things, shadow })
    }

    /// The values without the shadows of groups.
    pub(super) fn without<'g>(&self, groups: impl IntoIterator<Item = &'g Group>) -> Vec<Value> {
        let mut left = self.values.clone();
        for Group { things, shadow } in groups {
            for &(i, share) in shadow.shares() {
                if self.shows(i, things[0]).is_some() {
                    left[i] = shadow.below(left[i], share);
                }
            }
        }
        left
    }

    /// The squared error where the shadow of a group is seen: of the surfaces in full light, and with these values.
    fn errors(&self, group: &Group, left: &[Value]) -> [f32; 2] {
        let seen = self.seen(group).into_iter().filter_map(|i| {
            let base = self.shows(i, group.lowest())?;
            Some([self.values[i], left[i]].map(|value| ink::distance2(value, base)))
        });
        seen.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]])
    }

    /// The pixels that the shadow of a group changes, rising.
    fn seen(&self, group: &Group) -> Vec<usize> {
        let shares = group.shadow.shares().iter();
        let seen = shares.filter(|(_, share)| *share > FLAT).map(|(i, _)| *i);
        seen.filter(|&i| self.shows(i, group.lowest()).is_some())
            .collect()
    }
}
