//! The capsules of the demo: a random start, reading and writing JSON, conversion to a scene.

use serde::{Deserialize, Serialize};

use strokefit::math;
use strokefit::render::{PARAMS, Params, Strokes};
use strokefit::rng;
use strokefit::scene::Scene;
use strokefit::{Error, ErrorKind, Result};

/// Standard deviation of `b − a`, px.
const LENGTH: f32 = 4.0;

/// Capsules on a background, as the numbers that descent changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Saved", into = "Saved")]
pub struct Capsules {
    /// Width in px.
    pub width: usize,
    /// Height in px.
    pub height: usize,
    /// The colour behind all strokes.
    pub background: [f32; 3],
    /// Back to front, each of two points.
    pub strokes: Strokes,
}

/// Capsules as they are saved.
#[derive(Serialize, Deserialize)]
struct Saved {
    width: usize,
    height: usize,
    background: [f32; 3],
    /// ax, ay, bx, by, radius, red, green, blue, opacity.
    strokes: Vec<Params>,
}

impl From<Saved> for Capsules {
    fn from(saved: Saved) -> Self {
        Self {
            width: saved.width,
            height: saved.height,
            background: saved.background,
            strokes: saved.strokes.iter().collect(),
        }
    }
}

impl From<Capsules> for Saved {
    fn from(drawing: Capsules) -> Self {
        Self {
            width: drawing.width,
            height: drawing.height,
            background: drawing.background,
            strokes: drawing.strokes.numbers().as_chunks().0.to_vec(),
        }
    }
}

/// The radii of a drawing, in short.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Statistics {
    /// Number of strokes.
    pub strokes: usize,
    /// Number of strokes of radius 0.
    pub at_zero: usize,
    /// Mean radius, px.
    pub mean_radius: f64,
    /// Standard deviation of the radius, px.
    pub deviation: f64,
}

impl Capsules {
    /// `strokes` capsules at random on grey, as the article starts; `seed` is the key.
    pub fn random(width: usize, height: usize, strokes: usize, seed: u64) -> Self {
        let stroke = |i: u64| {
            let draw = |k| rng::draw(seed, 0, i, k);
            let normal = |k| LENGTH * rng::normal(seed, 1, i, k);
            let (x, y) = (draw(0) * width as f32, draw(1) * height as f32);
            let radius = 0.1 + 0.1 * draw(2);
            let [red, green, blue] = [draw(3), draw(4), draw(5)];
            [
                x,
                y,
                x + normal(0),
                y + normal(1),
                radius,
                red,
                green,
                blue,
                1.0,
            ]
        };
        Self {
            width,
            height,
            background: [0.5; 3],
            strokes: (0..strokes as u64).map(stroke).collect(),
        }
    }

    /// The drawing, if it is as large as the picture.
    pub(super) fn fitting(self, width: usize, height: usize) -> Result<Self> {
        if (self.width, self.height) == (width, height) {
            return Ok(self);
        }
        let message = format!(
            "the saved drawing has {}×{} px and the picture {width}×{height}: give the picture that it was made from",
            self.width, self.height
        );
        Err(Error::new(ErrorKind::Config, message))
    }

    /// Reads what [`to_json`](Self::to_json) writes.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when it is no such JSON.
    pub fn from_json(json: &str) -> Result<Self> {
        serde_json::from_str(json).map_err(|e| {
            let message = format!("not a saved drawing ({e}): give an article.json");
            Error::new(ErrorKind::Config, message).caused_by(e)
        })
    }

    /// The drawing as JSON; nothing is rounded.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when a number is not finite, which JSON cannot say.
    pub fn to_json(&self) -> Result<String> {
        serde_json::to_string(self).map_err(|e| {
            let message = format!("the drawing cannot be saved: {e}");
            Error::new(ErrorKind::Io, message).caused_by(e)
        })
    }

    /// The drawing as a scene of one stage.
    pub fn scene(&self) -> Scene {
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let page = Scene::empty(side(self.width), side(self.height), Some(self.background));
        let stage = self.strokes.iter().map(|stroke| stroke.to_mark()).collect();
        Scene {
            stages: vec![stage],
            ..page
        }
    }

    /// The radii in short.
    pub fn statistics(&self) -> Statistics {
        let radii = || self.strokes.iter().map(|stroke| f64::from(stroke.radius()));
        let n = self.strokes.len().max(1) as f64;
        let mean_radius = radii().sum::<f64>() / n;
        let variance = radii().map(|r| math::powi(r - mean_radius, 2)).sum::<f64>() / n;
        Statistics {
            strokes: self.strokes.len(),
            at_zero: radii().filter(|&r| r == 0.0).count(),
            mean_radius,
            deviation: variance.sqrt(),
        }
    }
}

const _: () = assert!(
    PARAMS == 9,
    "the order of the numbers is part of the file format"
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_random_drawing_is_as_the_article_says() {
        let drawing = Capsules::random(100, 50, 2000, 3);
        assert_eq!(drawing, Capsules::random(100, 50, 2000, 3));
        assert_ne!(drawing, Capsules::random(100, 50, 2000, 4));
        let squares = drawing
            .strokes
            .iter()
            .map(|stroke| f64::from(math::powi(stroke.points[1][0] - stroke.points[0][0], 2)));
        let deviation = (squares.sum::<f64>() / 2000.0).sqrt();
        assert!((deviation - 4.0).abs() < 0.2, "{deviation}");
        let statistics = drawing.statistics();
        assert!(
            (statistics.mean_radius - 0.15).abs() < 0.005,
            "{statistics:?}"
        );
        assert!(
            (statistics.deviation - 0.1 / 12_f64.sqrt()).abs() < 0.005,
            "{statistics:?}"
        );
        assert_eq!((statistics.strokes, statistics.at_zero), (2000, 0));
    }

    #[test]
    fn json_keeps_every_bit() {
        let drawing = Capsules::random(30, 20, 50, 1);
        let json = drawing.to_json().unwrap();
        assert_eq!(Capsules::from_json(&json).unwrap(), drawing);
        assert!(drawing.fitting(30, 21).is_err());
        assert_eq!(
            Capsules::from_json("{}").unwrap_err().kind(),
            ErrorKind::Config
        );
    }
}
