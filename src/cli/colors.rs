//! Options for the colours of a drawing, and the palette files they read.

use std::fs;

use strokefit::fit::Colors;

use super::domain;

/// Which colours to draw with.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Look")]
pub(super) struct Args {
    /// At most N colours, including the background
    #[arg(long, value_name = "N", value_parser = domain::colors, allow_negative_numbers = true)]
    colors: Option<usize>,
    /// Only these colours: a list #rrggbb,#rrggbb,..., a file with one colour per line, or a GIMP palette
    #[arg(long, value_name = "LIST|FILE", conflicts_with = "colors", value_parser = palette)]
    palette: Option<Palette>,
}

impl Args {
    pub(super) fn colors(&self) -> Colors {
        match (&self.palette, self.colors) {
            (Some(palette), _) => Colors::Palette(palette.0.clone()),
            (None, Some(most)) => Colors::AtMost(most),
            (None, None) => Colors::Free,
        }
    }
}

/// 8-bit colours, each once.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Palette(Vec<[u8; 3]>);

/// Most colours of a palette.
const MOST: usize = 4096;

/// Longest file that is taken for a palette, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// The head of a GIMP palette.
const GIMP: &str = "GIMP Palette";

/// A list, or what a file says.
fn palette(text: &str) -> Result<Palette, String> {
    if text.starts_with('#') {
        let list = text
            .split(',')
            .map(|word| (word, domain::channels(word.trim())));
        return distinct(list.map(|(word, color)| {
            color.ok_or_else(|| format!("\"{word}\" is not a colour: give #rrggbb,#rrggbb,..."))
        }));
    }
    let remedy =
        "give #rrggbb,#rrggbb,..., a file with one such colour per line, or a GIMP palette";
    let unreadable = |e: std::io::Error| format!("cannot be read ({e}): {remedy}");
    let length = fs::metadata(text).map_err(unreadable)?.len();
    if length > MAX_BYTES {
        return Err(format!("the file is longer than 1 MiB: {remedy}"));
    }
    let bytes = fs::read(text).map_err(unreadable)?;
    let content = String::from_utf8(bytes).map_err(|_| format!("not a text file: {remedy}"))?;
    file(&content)
}

/// What a file of lines says.
fn file(content: &str) -> Result<Palette, String> {
    let lines = || content.lines().map(str::trim).enumerate();
    let is_gimp = content.trim_start_matches('\u{feff}').starts_with(GIMP);
    let colors = lines()
        .filter(|(_, line)| !line.is_empty())
        .filter(|(i, line)| {
            let head = *i == 0 || line.starts_with('#') || line.contains(':');
            !(is_gimp && head)
        });
    distinct(colors.map(|(i, line)| {
        let color = if is_gimp {
            levels(line)
        } else {
            domain::channels(line)
        };
        let wanted = if is_gimp {
            "three levels of 0 to 255"
        } else {
            "#rrggbb"
        };
        color.ok_or_else(|| format!("line {} is \"{}\": give {wanted}", i + 1, short(line)))
    }))
}

/// The first three numbers of a line of a GIMP palette; a name may follow.
fn levels(line: &str) -> Option<[u8; 3]> {
    let mut words = line.split_ascii_whitespace().map(|word| word.parse().ok());
    Some([words.next()??, words.next()??, words.next()??])
}

fn distinct(colors: impl Iterator<Item = Result<[u8; 3], String>>) -> Result<Palette, String> {
    let mut palette = Vec::new();
    for color in colors {
        let color = color?;
        if !palette.contains(&color) {
            palette.push(color);
        }
        if palette.len() > MOST {
            return Err(format!("more than {MOST} colours: give fewer"));
        }
    }
    if palette.is_empty() {
        return Err("it has no colour: give one #rrggbb or more".into());
    }
    Ok(Palette(palette))
}

/// The beginning of a line, for a message.
fn short(line: &str) -> String {
    line.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED_AND_INK: [[u8; 3]; 2] = [[255, 0, 0], [16, 32, 48]];

    #[test]
    fn lists_and_files_say_the_same() {
        let expected = Ok(Palette(RED_AND_INK.to_vec()));
        assert_eq!(palette("#ff0000,#102030, #FF0000"), expected);
        assert_eq!(file("#ff0000\n\n#102030\r\n"), expected);
        let gimp = "GIMP Palette\nName: two\nColumns: 2\n#\n255   0   0\tRed\n 16  32  48\n";
        assert_eq!(file(gimp), expected);
    }

    #[test]
    fn what_is_no_palette_is_refused_with_its_place() {
        let cases = [
            (palette("#ff0000,#12"), "\"#12\""),
            (palette("no-such-file"), "cannot be read"),
            (file("#ff0000\nred"), "line 2 is \"red\""),
            (file("GIMP Palette\n300 0 0"), "line 2"),
            (file("GIMP Palette\n#\n"), "has no colour"),
            (file(""), "has no colour"),
        ];
        for (outcome, words) in cases {
            let message = outcome.unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
