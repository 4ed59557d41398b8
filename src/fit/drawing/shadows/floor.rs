//! Shadows that have no thing's shape: a light from above casts a blurred ellipse on the floor below a thing.

use super::groups::{BLOCKS, Group, Shaded};
use super::shadow::Shadow;
use super::surfaces::Light;
use crate::image::{beside, flooded};
use crate::math::{self, Point};
use crate::scene::{Area, Shape};
use crate::shading::Value;

// All of these are guesses.
/// Most of them that are looked for.
const MOST: usize = 3;
/// Share of the squared error that the first ellipse leaves, from which on there is none, and the blocks along the longer side that
/// ellipses are compared on.
const UNLIKE: f32 = 0.5;
const COARSE: usize = 40;
/// The first and the last step of the search for radii, logarithms.
const STEPS: [f64; 2] = [0.2, 0.02];

impl Shaded<'_> {
    /// The groups, and ellipses that gain `price` each in what they leave.
    pub(super) fn with_floors(&self, mut groups: Vec<Group>, price: f32) -> Vec<Group> {
        let left = self.without(&groups);
        let parts = self.soft_parts().into_iter();
        let error = |part: &[usize]| part.iter().map(|&i| self.lacking(i, &left)).sum();
        let mut parts: Vec<(f32, Vec<usize>)> = parts.map(|part| (error(&part), part)).collect();
        parts.retain(|(error, _)| *error >= price);
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        parts.truncate(MOST);
        let found = parts
            .iter()
            .filter_map(|(_, part)| self.on_floor(part, &left));
        groups.extend(found);
        groups
    }

    /// The soft pixels beside each other.
    fn soft_parts(&self) -> Vec<Vec<usize>> {
        let mut known: Vec<bool> = (0..self.values.len())
            .map(|i| !self.surfaces.is_soft(i))
            .collect();
        let mut parts = Vec::new();
        for start in 0..known.len() {
            if !std::mem::replace(&mut known[start], true) {
                let size = [self.surfaces.width(), known.len()];
                let joins = |_, k: usize| !std::mem::replace(&mut known[k], true);
                parts.push(flooded(vec![start], size, joins));
            }
        }
        parts
    }

    /// The blurred ellipse that these soft pixels show, below the lowest thing that they touch.
    fn on_floor(&self, part: &[usize], left: &[Value]) -> Option<Group> {
        let width = self.surfaces.width();
        // Edges of things cover some of the pixels beside them.
        let mut counts = vec![0; self.things.areas.len()];
        let tops = part.iter().filter_map(|&i| self.things.top[i]);
        tops.for_each(|top| counts[top] += 1);
        let floor = (0..counts.len())
            .rev()
            .find(|&k| 2 * counts[k] > part.len());
        let around = part.iter().flat_map(|&i| beside(i, width, left.len()));
        let around = around.filter(|&i| {
            self.surfaces
                .at(i)
                .is_none_or(|(_, light)| light == Light::Full)
        });
        let things = around.filter_map(|i| self.things.top[i]);
        let lowest = things.filter(|&top| Some(top) > floor).min()?;
        // 1. An ellipse that has the moments of how dark the pixels are. A uniform one has a quarter of the squared radius as variance.
        let weight = |i: usize| f64::from(self.lacking(i, left).sqrt());
        let whole: f64 = part.iter().map(|&i| weight(i)).sum();
        let mean = |of: &dyn Fn(usize) -> f64| {
            part.iter().map(|&i| weight(i) * of(i)).sum::<f64>() / whole
        };
        let places: [fn(usize, usize) -> f64; 2] = [
            |i, width| (i % width) as f64 + 0.5,
            |i, width| (i / width) as f64 + 0.5,
        ];
        let middle = places.map(|at| mean(&|i| at(i, width)));
        let variance = |axis: usize| {
            mean(&|i| {
                let away = places[axis](i, width) - middle[axis];
                away * away
            })
        };
        let radii = [0, 1].map(|axis| 2.0 * variance(axis).max(1.0).sqrt());
        // 2. The radii whose blur leaves least.
        let known = |i: usize| Some((left[i], self.shows(i, lowest)?));
        let size = self.surfaces.size();
        let shadow = |scale: [f64; 2], blocks: usize| {
            let radii = std::array::from_fn(|axis| radii[axis] * math::exp(scale[axis]));
            let ellipse = Shape::Ellipse {
                center: Point::new(middle[0], middle[1]),
                radii,
            };
            let area = Area::plain(vec![ellipse.path()], [0.0; 3], 1.0);
            Shadow::of(vec![area], size, blocks, known)
        };
        let unlike = |scale: [f64; 2]| {
            let [all, left] = shadow(scale, COARSE)?.errors(known);
            Some(left / all.max(f32::MIN_POSITIVE))
        };
        if unlike([0.0; 2])? > UNLIKE {
            return None;
        }
        let cost = |scale: [f64; 2]| unlike(scale).map_or(f64::INFINITY, f64::from);
        let scale = math::search([0.0; 2], STEPS[0], STEPS[1], cost);
        let shadow = shadow(scale, BLOCKS)?;
        Some(Group {
            things: vec![lowest],
            shadow,
        })
    }
}
