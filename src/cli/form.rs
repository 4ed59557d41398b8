//! Options for the form of the file, shared by the commands that write one.

use clap::builder::TypedValueParser;
use strokefit::svg::{Form, Group, Length, Order, WriteOptions};

use super::{domain, words};

/// How the SVG is written.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "File")]
pub(super) struct Args {
    /// Decimals of coordinates and widths, 0 to 6
    #[arg(long, value_name = "N", default_value = "2", value_parser = domain::precision, allow_negative_numbers = true)]
    precision: u8,
    /// What one element of the SVG holds
    #[arg(long, default_value_t, value_parser = form())]
    form: Form,
    /// What one layer of the SVG holds
    #[arg(long, default_value_t, value_parser = group())]
    group: Group,
    /// In which order the strokes of a layer come
    #[arg(long, default_value_t, value_parser = order())]
    order: Order,
    /// Write filled outlines instead of strokes, for programs that ignore strokes
    #[arg(long, conflicts_with = "form")]
    outline: bool,
    /// Width of the page in mm, cm, in, pt or px, such as 120mm [default: one px per pixel of the picture]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    width: Option<Length>,
}

/// The forms that a file of strokes can have, with their help; outlines have a flag of their own.
fn form() -> impl TypedValueParser<Value = Form> {
    let forms = [
        (Form::Plain, "One stroke"),
        (
            Form::Smallest,
            "As many strokes as possible: fewest bytes, hardest to edit",
        ),
    ];
    words::one_of_or_former(forms, &["elements"])
}

/// The groupings, with their help.
fn group() -> impl TypedValueParser<Value = Group> {
    words::one_of([
        (Group::Stage, "The strokes of one stage"),
        (
            Group::Color,
            "Strokes of one colour. With --colors or --palette each colour has one layer",
        ),
    ])
}

/// The orders, with their help.
fn order() -> impl TypedValueParser<Value = Order> {
    words::one_of([
        (Order::Fitted, "The order that they were fitted in"),
        (
            Order::Travel,
            "With short ways between them, for a plotter; the picture stays the same",
        ),
    ])
}

impl Args {
    pub(super) fn options(&self) -> WriteOptions {
        WriteOptions {
            precision: self.precision,
            form: if self.outline {
                Form::Outlines
            } else {
                self.form
            },
            group: self.group,
            order: self.order,
            width: self.width,
        }
    }
}
