//! The one error type of the library.
//!
//! [`Error`] is opaque. [`ErrorKind`] is the class of the problem, the message names the offending file or
//! value and the remedy, and [`std::error::Error::source`] holds the cause.

use std::fmt;

/// The result of every fallible function of the library.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The class of a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file could not be read or written.
    Io,
    /// A picture could not be decoded or encoded, or has no pixels.
    Picture,
    /// An SVG could not be parsed, rendered, or is outside the dialect.
    Svg,
    /// An option or argument is outside its domain.
    Config,
    /// Another program that renders SVG is missing, or failed.
    Engine,
}

/// A problem, described in one line, with its cause.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

impl Error {
    /// An error of `kind`; `message` names the offending value and the remedy.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        // Messages may quote input or the text of a cause; this keeps them on one line.
        let message: String = message.into();
        let breaks = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
        Self {
            kind,
            message: message.replace(breaks, " "),
            source: None,
        }
    }

    /// An error of [`ErrorKind::Config`].
    pub(crate) fn config(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Config, message)
    }

    /// This error with its cause attached.
    #[must_use]
    pub fn caused_by(
        mut self,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        self.source = Some(source.into());
        self
    }

    /// This error with `context` (such as a file name) before its message.
    #[must_use]
    pub fn within(mut self, context: impl fmt::Display) -> Self {
        self.message = format!("{context}: {}", self.message);
        self
    }

    /// The class of the problem.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_ref().map(|s| s.as_ref() as _)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_has_one_line() {
        let error = Error::new(ErrorKind::Svg, "expected '>' not '\n' here\r\u{2028}");
        assert_eq!(error.to_string(), "expected '>' not ' ' here  ");
    }
}
