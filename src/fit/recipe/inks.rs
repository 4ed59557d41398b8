//! The tuned numbers of the colours of thin lines.

/// Colours of thin lines. All of it is a guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inks {
    /// Lines of a larger radius, px, have the colours that they were fitted.
    pub thin: f32,
    /// Lines of a smaller one, px, cover no pixel as a whole.
    pub least_radius: f32,
    /// Distance from the border of a line to the page beside it, px.
    pub beside: f32,
    /// Largest difference of the channels of colours that are one.
    pub alike: f32,
    /// The share of the page beside a line that has to be one colour.
    pub least_even: f32,
    /// A colour of a larger share of a line's contrast is near enough.
    pub least_change: f32,
}
