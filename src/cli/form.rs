//! Options for the form of the file, shared by the commands that write one.

use clap::ValueEnum;
use strokefit::svg::{self, Length, WriteOptions};

use super::domain;

/// How the SVG is written.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "File")]
pub(super) struct Args {
    /// Decimals of coordinates and widths, 0 to 6
    #[arg(long, value_name = "N", default_value = "2", value_parser = domain::precision, allow_negative_numbers = true)]
    precision: u8,
    /// What one element of the SVG holds
    #[arg(long, value_enum, default_value_t = Form::Plain)]
    form: Form,
    /// What one layer of the SVG holds
    #[arg(long, value_enum, default_value_t = Group::Stage)]
    group: Group,
    /// Write filled outlines instead of strokes, for programs that ignore strokes
    #[arg(long, conflicts_with = "form")]
    outline: bool,
    /// Width of the page in mm, cm, in, pt or px, such as 120mm [default: one px per pixel of the picture]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    width: Option<Length>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Form {
    /// One stroke, always
    Elements,
    /// One stroke, or a polyline of opaque strokes that lie end to end
    Plain,
    /// As many strokes as possible: fewest bytes, hardest to edit
    Smallest,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Group {
    /// The strokes of one stage
    Stage,
    /// Strokes of one colour, as far as the picture stays the same
    Color,
}

impl Args {
    pub(super) fn options(&self) -> WriteOptions {
        WriteOptions {
            precision: self.precision,
            form: match self.form {
                _ if self.outline => svg::Form::Outlines,
                Form::Elements => svg::Form::Elements,
                Form::Plain => svg::Form::Plain,
                Form::Smallest => svg::Form::Smallest,
            },
            group: match self.group {
                Group::Stage => svg::Group::Stage,
                Group::Color => svg::Group::Color,
            },
            width: self.width,
        }
    }
}
