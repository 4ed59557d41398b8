//! Parsing of the arguments, with refusals of one line.

use clap::Parser;
use clap::error::ErrorKind;

use super::{Args, Status, complain};

/// The arguments of the process, or the status to leave with: help was shown, or a line of error.
pub(crate) fn parse() -> Result<Args, Status> {
    Args::try_parse().map_err(|error| {
        // Called without any argument: clap prints the help on standard error.
        let asks = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
        if error.use_stderr() && !asks {
            complain(one_line(&error.to_string()));
            return Status::Usage;
        }
        match error.print() {
            Ok(()) if asks => Status::Usage,
            Ok(()) => Status::Done,
            Err(_) => Status::Failed,
        }
    })
}

/// The gist of clap's message: what is wrong and its tips, without the reminder of the usage.
fn one_line(message: &str) -> String {
    let paragraphs = message
        .split("\n\n")
        .map(|p| p.split_whitespace().collect::<Vec<_>>().join(" "));
    let telling = paragraphs
        .filter(|p| !p.is_empty() && !p.starts_with("Usage:") && !p.starts_with("For more"));
    let mut line = telling.collect::<Vec<_>>().join("; ");
    line.push_str(" (see --help)");
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn refusals_are_one_line_with_their_tip() {
        let error =
            Args::try_parse_from(["strokefit", "fit", "a.png", "-o", "a.svg", "--stroke", "3"])
                .unwrap_err();
        let line = one_line(&error.to_string());
        assert!(
            line.contains("--stroke") && line.contains("--strokes") && !line.contains('\n'),
            "{line}"
        );
    }
}
