//! Geometry words of the crate: the one door of `nalgebra`.

/// A point of the picture plane in px; x to the right, y down, pixel centres at +0.5.
pub type Point = nalgebra::Point2<f32>;

/// A displacement in the picture plane in px.
pub type Vector = nalgebra::Vector2<f32>;
