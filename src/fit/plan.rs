//! How many strokes each stage adds, and how large they are.

/// One planned stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlannedStage {
    /// Strokes to add.
    pub(super) count: usize,
    /// Their typical radius, px.
    pub(super) scale: f32,
}

/// `total` strokes in at most `stages` stages, each `growth` times the one before; a stage's scale is
/// `scale · sqrt(pixels / strokes so far)`.
pub(super) fn stages(
    total: usize,
    stages: usize,
    growth: f64,
    pixels: usize,
    scale: f32,
) -> Vec<PlannedStage> {
    let weights: Vec<f64> = (0..stages).map(|k| growth.powi(k as i32)).collect();
    let whole: f64 = weights.iter().sum();
    let (mut planned, mut before, mut reached) = (Vec::new(), 0, 0.0);
    for weight in weights {
        reached += weight;
        let after = (total as f64 * reached / whole).round() as usize;
        if after > before {
            let scale = scale * (pixels as f32 / after as f32).sqrt();
            planned.push(PlannedStage {
                count: after - before,
                scale,
            });
        }
        before = after;
    }
    planned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_grow_and_add_up() {
        let plan = stages(1000, 8, 1.6, 65_536, 0.6);
        assert_eq!(plan.len(), 8);
        assert_eq!(plan.iter().map(|s| s.count).sum::<usize>(), 1000);
        assert!(
            plan.windows(2)
                .all(|w| w[1].count > w[0].count && w[1].scale < w[0].scale)
        );
    }

    #[test]
    fn few_strokes_make_few_stages() {
        let plan = stages(2, 8, 1.6, 100, 0.6);
        assert_eq!(plan.iter().map(|s| s.count).sum::<usize>(), 2);
        assert!(plan.iter().all(|s| s.count > 0));
    }
}
