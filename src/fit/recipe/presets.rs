//! The numbers of the presets.

use super::{
    AdamSettings, Correction, Dense, Domain, Doubts, EdgeShape, Forms, Inks, Jitter, Joins,
    Masking, Pens, Points, Polish, Preset, Rates, Recipe, Recoloring, Recovery, Reduction,
    Relocation, Rounds, SCREEN_PIXELS, Sharing, Stages, TimeShares,
};
use crate::optim::AdamParams;
use crate::seed::Probing;

impl Recipe {
    /// The recipe of a preset.
    pub fn of(preset: Preset) -> Self {
        match preset {
            Preset::Draft => Self::draft(),
            Preset::Balanced => BALANCED,
            Preset::Best => Self {
                polish: Polish {
                    iterations: 3600,
                    sparse_share: 2.0,
                    rates: Rates {
                        last: 0.03,
                        ..BALANCED.polish.rates
                    },
                    ..BALANCED.polish
                },
                relocation: Relocation {
                    every: 20,
                    ..BALANCED.relocation
                },
                ..BALANCED
            },
        }
    }

    /// Few, long steps.
    fn draft() -> Self {
        let Self {
            stages,
            domain,
            polish,
            dense,
            relocation,
            ..
        } = BALANCED;
        // With few iterations, steps have to be long until the end.
        let rates = Rates {
            position: 1.3,
            radius: 0.3,
            last: 0.2,
            ..polish.rates
        };
        Self {
            stages: Stages {
                scale: 0.25,
                iterations: 20,
                polished_share: 1.0,
                rates: Rates {
                    position: 1.5,
                    ..stages.rates
                },
                ..stages
            },
            polish: Polish {
                iterations: 130,
                sparse_share: 1.0,
                coarse_share: 0.3,
                rates,
                ..polish
            },
            // These steps help dense points, but take more iterations than a draft has.
            dense: Dense {
                share: 0.9,
                position: rates.position,
                min_opacity: domain.min_opacity,
                jitter: 0.0,
                ..dense
            },
            relocation: Relocation {
                every: 20,
                scale: 0.4,
                gain: 3.0,
                ..relocation
            },
            // A round takes as long as a fifth of the polish.
            settling_rounds: 0,
            ..BALANCED
        }
    }
}

const BALANCED: Recipe = Recipe {
    probing: Probing {
        radii: [0.3, 0.55, 1.0],
        lengths: [2.0, 4.5],
        cells: 2.5,
        probed: 0.6,
    },
    stages: Stages {
        count: 8,
        growth: 1.35,
        first: 12,
        pixels_per_stroke: 250,
        scale: 0.3,
        iterations: 120,
        polished_share: 0.34,
        rates: Rates {
            position: 1.0,
            radius: 0.3,
            color: 0.02,
            opacity: 0.02,
            area: 0.08,
            last: 0.1,
        },
        softest: 4.0,
        paying_share: 0.3,
        polish_gain_db: 12.0,
        least_slope_db: 1.3,
    },
    edge: EdgeShape {
        final_slope: 1.2,
        annealed: 0.55,
    },
    domain: Domain {
        margin: 8.0,
        min_radius: 0.51,
        min_opacity: 0.1,
    },
    optimizer: AdamSettings {
        strokes: AdamParams {
            betas: [0.9, 0.9],
            eps: 1e-10,
        },
        reduced: AdamParams {
            betas: [0.9, 0.8],
            eps: 1e-10,
        },
        background: AdamParams {
            betas: [0.9, 0.999],
            eps: 1e-8,
        },
        usual_radius: 2.0,
        radius_factors: [0.25, 4.0],
        area_color: 0.1,
    },
    polish: Polish {
        iterations: 1000,
        sparse: 160.0,
        sparse_share: 2.5,
        area_share: 0.4,
        coarse_share: 0.7,
        rates: Rates {
            position: 2.5,
            radius: 0.5,
            color: 0.02,
            opacity: 0.03,
            area: 0.08,
            last: 0.06,
        },
        jitter: Jitter {
            px: 0.0,
            from: 0.85,
        },
        softness: 2.4,
    },
    dense: Dense {
        pixels: 16.0,
        share: 0.75,
        position: 1.5,
        min_opacity: 0.3,
        jitter: 0.1,
    },
    relocation: Relocation {
        every: 25,
        share: 0.3,
        scale: 0.5,
        gain: 4.0,
        until: 0.9,
        after_areas: 0.5,
        fill: 2,
    },
    recovery: Recovery {
        weight: 8.0,
        contrast: 10.0 / 255.0,
        reach: 4,
        polish_share: 0.2,
    },
    points: Points {
        from: 0.1,
        until: 0.85,
        share: 0.5,
        swapped: 0.2,
        per_stroke: 7.0,
        bought: 4.0,
        capsules: 0.8,
        filled: 0.995,
        alone: 0.5,
        reach: 0.5,
        shortest: 0.5,
        gain: 120.0,
        smoothness: 0.7,
        spared: 0.3,
        prunings: 30,
        at_a_time: 4,
        beyond_db: 6.0,
        area_price: 0.25,
        stroke_price: 0.1,
        joins: Joins {
            reach: 8.0,
            gap: 0.6,
            alike: 0.3,
            share: 0.1,
        },
    },
    coloring: Recoloring {
        rounds: Rounds {
            count: 12,
            iterations: 0.6,
            rate: 0.3,
        },
        quiet_rounds: 2,
        damping: 0.7,
        means: 10,
        min_shown: 1e-3,
        kept_share: 0.25,
        kept_distance: 0.2,
        window: 4096,
    },
    pens: Pens {
        rounds: Rounds {
            count: 8,
            iterations: 0.2,
            rate: 0.1,
        },
        share: 0.7,
        ladder: 1.2,
        contrast: 0.02,
        window: 1024,
    },
    sharing: Sharing {
        error: 0.1,
        most: 600,
        nearly_opaque: 0.8,
        off_page: 0.1,
        thin: 1.0,
    },
    inks: Inks {
        thin: 2.0,
        least_radius: 0.85,
        beside: 2.0,
        alike: 0.06,
        least_even: 0.7,
        least_change: 0.95,
    },
    forms: Forms {
        iterations: 20,
        rate: 0.03,
        tolerance_px: 0.45,
        level_px: 0.25,
        level_slope: 0.05,
        split_rings: [12, 24],
        most_marks: usize::MAX,
        worth_bytes: 30,
        most_lost_db: [2.0, 34.0],
    },
    masking: Masking {
        window: 6,
        contrast: 0.04,
        ceiling: 0.2,
    },
    settling_rounds: 5,
    correction: Correction {
        regained_db: 1.5,
        count: 6,
        db_per_doubling: 2.8,
        least_part: 0.125,
        excess_db: 0.1,
        precision: 0.1,
        least_gain: 0.2,
        hope: 1.3,
        few_strokes: 400,
        very_few_strokes: 32,
        filled: 0.98,
        layers_share: 0.03,
        approach_share: 0.2,
        polish_share: 0.4,
    },
    reduction: Reduction {
        enough_pixels: 2 * SCREEN_PIXELS,
        least_pixels: SCREEN_PIXELS,
        pixels_per_stroke: 200,
        bytes_per_stroke: 70,
        same_db: 44.0,
        nearly_same_db: 36.0,
        flat_share: 0.6,
        one_color: 4.0 / 255.0,
        soft: 0.12,
        least_soft_side: 200,
        least_factor: 1.4,
    },
    rivals: 64,
    doubts: Doubts {
        doubt: 0.0,
        double: 2.5,
        lost_db: 0.0,
        contrast: 8.0,
    },
    time: TimeShares {
        stroke_px: 160.0,
        looking: 1.15,
        judging: 1.75,
        judging_transparent: 2.2,
        judging_empty: 2.6,
        settling: 0.125,
        min_descent: 0.25,
        min_polish: 15.0,
        trial_writes: 0.01,
        min_round: 2.0,
        freshness: 0.2,
        min_search: 8,
    },
};
