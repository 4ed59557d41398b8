//! Rivals of a drawing of few strokes.
//!
//! Each of a few strokes has many good places, and chance decides which one it finds; that moves the fidelity by some dB. So a
//! fit of few strokes also draws as the shorter presets would, in a fraction of its time, and keeps the best drawing. A longer preset is
//! therefore never worse than a shorter one.
//!
//! Areas, too, have a rival: where many of them draw gradients or other uneven colours, or draw badly, strokes
//! alone may be better.

use std::time::Duration;

use crate::fit::budget;
use crate::fit::budget::reduction::is_flat;
use crate::fit::config::{Budget, Config};
use crate::fit::recipe::Preset;
use crate::image::Image;
use crate::scene::Marks;

/// Most strokes of a drawing that competes with those of shorter presets. A guess.
pub(in crate::fit) const FEW: usize = 64;

/// The configurations of the drawings that a drawing of `picture` by `config` competes with.
pub(in crate::fit) fn of(config: &Config, picture: &Image) -> Vec<Config> {
    let Budget {
        psnr_db,
        bytes,
        time,
        ..
    } = config.budget;
    // A search for a fidelity tries several numbers of strokes anyway.
    let is_alone = psnr_db.is_some() || time.is_some();
    let planned = budget::strokes(config, None, picture);
    if is_alone || planned.is_none_or(|strokes| strokes > FEW) {
        return Vec::new();
    }
    let with = |preset, seed| Config {
        preset,
        seed,
        ..config.clone()
    };
    let shorter: &[Preset] = match config.preset {
        Preset::Draft => &[],
        Preset::Balanced => &[Preset::Draft],
        Preset::Best => &[Preset::Draft, Preset::Balanced],
    };
    let mut rivals: Vec<Config> = shorter.iter().map(|&p| with(p, config.seed)).collect();
    // Rivals with areas have rivals by strokes alone in turn.
    let by_strokes: Vec<Config> = rivals.iter().filter_map(by_strokes_alone).collect();
    rivals.extend(by_strokes);
    // Bytes decide which strokes stay, which is chance as well.
    if bytes.is_some() && config.preset != Preset::Draft {
        rivals.push(with(Preset::Balanced, config.seed.wrapping_add(1)));
    }
    rivals
}

/// True if a drawing of `picture` by `config` competes with drawings of what pays at several qualities.
pub(in crate::fit) fn has_priced(config: &Config, picture: &Image) -> bool {
    let Budget {
        strokes,
        psnr_db,
        bytes,
        time,
    } = config.budget;
    let is_counted = strokes.is_some() || bytes.is_some();
    let is_alone = psnr_db.is_some() || time.is_some();
    if !is_counted || is_alone || config.preset == Preset::Draft {
        return false;
    }
    let planned = budget::strokes(config, None, picture);
    // Areas come from tracing, which needs points and no pens that draw lines.
    let may_trace = config.allows_points() && !config.pens_draw_lines();
    let by_areas = may_trace && config.marks != Marks::Strokes;
    planned.is_some_and(|strokes| strokes <= FEW) || by_areas && is_flat(picture)
}

/// The configuration of the drawing by strokes alone that one with areas may have to compete with.
pub(in crate::fit) fn by_strokes_alone(config: &Config) -> Option<Config> {
    (config.marks() == Marks::Auto).then(|| Config {
        marks: Marks::Strokes,
        ..config.clone()
    })
}

/// The share of a limited time after which a drawing by strokes alone is not begun. A guess.
const LATEST: f64 = 0.5;

/// True if there is time for a drawing by strokes alone beside that with areas, which took `elapsed`.
pub(in crate::fit) fn has_time_for_another(config: &Config, elapsed: Duration) -> bool {
    let limit = config.budget.time;
    limit.is_none_or(|limit| elapsed <= limit.mul_f64(LATEST))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn presets(config: &Config) -> Vec<Preset> {
        let picture = Image::filled(64, 64, [0.5; 3]).unwrap();
        of(config, &picture)
            .iter()
            .map(|rival| rival.preset)
            .collect()
    }

    fn of_strokes(strokes: usize, preset: Preset) -> Config {
        let budget = Budget {
            strokes: Some(strokes),
            ..Budget::default()
        };
        Config {
            budget,
            preset,
            ..Config::default()
        }
    }

    #[test]
    fn few_strokes_compete_with_those_of_shorter_fits() {
        let of = |preset| presets(&of_strokes(20, preset));
        assert_eq!(of(Preset::Draft), []);
        // Each by strokes alone, too.
        assert_eq!(of(Preset::Balanced), [Preset::Draft; 2]);
        let shorter = [Preset::Draft, Preset::Balanced];
        assert_eq!(of(Preset::Best), [shorter, shorter].concat());
    }

    #[test]
    fn many_strokes_and_as_many_as_pay_have_no_rivals() {
        assert_eq!(presets(&of_strokes(65, Preset::Best)), []);
        assert_eq!(presets(&Config::default()), []);
    }
}
