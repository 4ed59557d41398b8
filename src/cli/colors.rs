//! Options for the colours of a drawing, and the palette files they read.

use std::fs;
use std::io;
use std::path::Path;

use strokefit::fit::Colors;

use super::domain;

/// Which colours to draw with.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Look")]
pub(super) struct Args {
    /// At most N colours, including the background
    #[arg(long, alias = "colours", value_name = "N", value_parser = domain::colors, allow_negative_numbers = true)]
    colors: Option<usize>,
    /// Only these colours: a list #rrggbb,white,..., a file with one colour per line, or a GIMP palette. Paper
    /// stays as it is if none of them is like it
    #[arg(long, value_name = "LIST|FILE", conflicts_with = "colors", value_parser = palette)]
    palette: Option<Colors>,
}

impl Args {
    pub(super) fn colors(&self) -> Colors {
        match (&self.palette, self.colors) {
            (Some(palette), _) => palette.clone(),
            (None, Some(most)) => Colors::AtMost(most),
            (None, None) => Colors::Free,
        }
    }
}

/// Longest file that is taken for a palette, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A list, or what a file says.
fn palette(text: &str) -> Result<Colors, String> {
    let read = |text: &str| Colors::palette(text).map_err(|error| error.to_string());
    let is_file = Path::new(text).exists();
    if text.starts_with('#') || !is_file && (text.contains(',') || read(text).is_ok()) {
        return read(text);
    }
    let remedy =
        "give #rrggbb,#rrggbb,..., a file with one such colour per line, or a GIMP palette";
    let unreadable = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => format!("no such file: {remedy}"),
        _ => format!("cannot be read ({e}): {remedy}"),
    };
    let length = fs::metadata(text).map_err(unreadable)?.len();
    if length > MAX_BYTES {
        return Err(format!("the file is longer than 1 MiB: {remedy}"));
    }
    let bytes = fs::read(text).map_err(unreadable)?;
    let content = String::from_utf8(bytes).map_err(|_| format!("not a text file: {remedy}"))?;
    read(&content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_told_from_a_file() {
        let red = Colors::Palette(vec![[255, 0, 0]]);
        assert_eq!(palette("#ff0000"), Ok(red));
        let message = palette("no-such-file").unwrap_err();
        assert!(message.contains("no such file"), "{message}");
    }

    #[test]
    fn a_list_of_names_is_understood_or_refused_by_the_first_that_is_none() {
        let both = Colors::Palette(vec![[255, 0, 0], [0, 0, 255]]);
        assert_eq!(palette("red,blue"), Ok(both));
        let message = palette("rot,blau").unwrap_err();
        assert!(message.contains("'rot' is not a colour"), "{message}");
    }
}
