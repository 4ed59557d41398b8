//! The numbers of the presets.

use super::{
    Correction, Dense, Forms, Inks, Joins, Pens, Points, Polish, Preset, Rates, Recipe, Recoloring,
    Relocation, Rounds, Sharing, Stages,
};

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
        let Self { stages, polish, .. } = BALANCED;
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
                min_opacity: BALANCED.min_opacity,
                jitter: 0.0,
            },
            relocation: Relocation {
                every: 20,
                scale: 0.4,
                gain: 3.0,
            },
            // A round takes as long as a fifth of the polish.
            settling_rounds: 0,
            ..BALANCED
        }
    }
}

const BALANCED: Recipe = Recipe {
    doubt: 0.0,
    min_opacity: 0.1,
    most_marks: usize::MAX,
    stages: Stages {
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
    },
    polish: Polish {
        iterations: 1000,
        sparse_share: 2.5,
        coarse_share: 0.7,
        rates: Rates {
            position: 2.5,
            radius: 0.5,
            color: 0.02,
            opacity: 0.03,
            area: 0.08,
            last: 0.06,
        },
        jitter: 0.0,
        softness: 2.4,
    },
    dense: Dense {
        share: 0.75,
        position: 1.5,
        min_opacity: 0.3,
        jitter: 0.1,
    },
    relocation: Relocation {
        every: 25,
        scale: 0.5,
        gain: 4.0,
    },
    points: Points {
        from: 0.1,
        until: 0.85,
        share: 0.5,
        swapped: 0.2,
        filled: 0.995,
        alone: 0.5,
        reach: 0.5,
        shortest: 0.5,
        gain: 120.0,
        smoothness: 0.7,
        spared: 0.3,
        prunings: 30,
        at_a_time: 4,
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
        worth_bytes: 30,
        most_lost_db: [2.0, 34.0],
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
};
