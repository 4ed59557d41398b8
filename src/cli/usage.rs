//! Parses the arguments, and says what they may be: help, which begins with examples, completion scripts for shells, and manual
//! pages. A refusal is one line and a hint.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::PathBuf;

use anyhow::{Result, anyhow};
use clap::error::ErrorKind;
use clap::{Command, CommandFactory, FromArgMatches};
use clap_complete::Shell;

use super::hint::Hint;
use super::output::Output;
use super::refusal::parts;
use super::{Args, Status, Verbosity, fail, misuse, settings};

/// Examples come before the list of options.
const TEMPLATE: &str = "{about}{after-help}\n\n{usage-heading} {usage}\n\n{all-args}";

/// The whole command line.
pub(super) fn command() -> Command {
    let command = examples_first(Args::command()).mut_subcommands(settings::offer);
    // What begins with a minus and a digit is a value that is out of range, and no flag.
    command.mut_subcommands(|command| command.mut_args(|arg| arg.allow_negative_numbers(true)))
}

/// The command, with help of it and of its subcommands that begins with examples.
pub fn examples_first(command: Command) -> Command {
    let command = command.help_template(TEMPLATE);
    command.mut_subcommands(examples_first)
}

/// The parsed arguments, or the status to leave with: help or options were shown, or an error.
pub(super) fn parse(args: Vec<OsString>) -> Result<Args, Status> {
    let understood = understand(args.clone()).map_err(|error| refuse(&error, &args))?;
    understood.ok_or(Status::Done)
}

/// The arguments, unless they ask for the options as a file, which is printed.
fn understand(args: Vec<OsString>) -> Result<Option<Args>> {
    let command = command();
    let args = settings::expand(&command, args)?;
    if let Some(text) = settings::printed(&command, &args)? {
        Output::Stdout.write(text.as_bytes())?;
        return Ok(None);
    }
    let matches = command.try_get_matches_from(args)?;
    settings::check_ranges(&matches)?;
    Ok(Some(Args::from_arg_matches(&matches)?))
}

/// Says what is wrong with the arguments, or shows the help that they ask for.
pub fn refuse(error: &anyhow::Error, args: &[OsString]) -> Status {
    let Some(error) = error.downcast_ref::<clap::Error>() else {
        return fail(error);
    };
    // Called without any argument: clap prints the help on standard error.
    let asks = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if error.use_stderr() && !asks {
        return fail(&told(error, args));
    }
    match error.print() {
        Ok(()) if asks => Status::Usage,
        Ok(()) => Status::Done,
        // A reader that went away has seen what it wanted.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Status::Done,
        Err(_) => Status::Failed,
    }
}

/// Error that says in one line what clap finds wrong, with what it advises or where to read on.
fn told(error: &clap::Error, args: &[OsString]) -> anyhow::Error {
    let (wrong, advice) = parts(error, args);
    Hint::maybe_on(misuse(wrong), advice)
}

/// Print a completion script for a shell
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit completions bash > ~/.local/share/bash-completion/completions/strokefit
  strokefit completions zsh > ~/.zfunc/_strokefit
  strokefit completions fish > ~/.config/fish/completions/strokefit.fish")]
pub(super) struct Completions {
    /// Shell to complete in
    #[arg(value_enum)]
    shell: Shell,
}

/// Write the manual pages
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit man -o ~/.local/share/man/man1
  man strokefit-fit")]
pub(super) struct Man {
    /// Folder to write to; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub(super) fn complete(args: &Completions) -> Result<Status> {
    let mut command = command();
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "strokefit", &mut script);
    Output::Stdout.write(&script)?;
    Ok(Status::Done)
}

pub(super) fn man(args: &Man, verbosity: Verbosity) -> Result<Status> {
    let folder = args.output.display();
    let unwritable =
        |e| anyhow!("{folder}: manual pages cannot be written ({e}): choose another place");
    fs::create_dir_all(&args.output).map_err(unwritable)?;
    clap_mangen::generate_to(command(), &args.output).map_err(unwritable)?;
    verbosity.say(format_args!(
        "{folder}: wrote the manual pages of strokefit and its commands"
    ));
    Ok(Status::Done)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(args: &[&str]) -> (String, String) {
        let args = ["strokefit"].iter().chain(args);
        let args: Vec<OsString> = args.map(OsString::from).collect();
        let error = command().try_get_matches_from(&args).unwrap_err();
        let (wrong, advice) = parts(&error, &args);
        (wrong, advice.unwrap_or_default())
    }

    #[test]
    fn the_arguments_are_consistent() {
        command().debug_assert();
    }

    #[test]
    fn refusals_are_one_line_and_a_tip() {
        let (wrong, advice) = refusal(&["fit", "a.png", "-o", "a.svg", "--stroke", "3"]);
        assert!(
            wrong.contains("--stroke") && !wrong.contains('\n'),
            "{wrong}"
        );
        assert!(
            advice.contains("--strokes") && !advice.contains('\n'),
            "{advice}"
        );
    }

    #[test]
    fn without_a_tip_the_help_of_the_command_is_named() {
        let (wrong, advice) = refusal(&["render", "a.svg"]);
        assert!(wrong.contains("--output"), "{wrong}");
        assert_eq!(advice, "strokefit render --help lists the options");
    }

    #[test]
    fn a_forgotten_command_keeps_all_that_was_given() {
        let (_, advice) = refusal(&["Cargo.toml", "-o", "a b.svg", "--strokes", "5"]);
        assert_eq!(advice, "strokefit fit Cargo.toml -o 'a b.svg' --strokes 5");
        let (_, advice) = refusal(&["--strokes", "5", "Cargo.toml"]);
        assert_eq!(advice, "strokefit fit --strokes 5 Cargo.toml -o Cargo.svg");
        let (_, advice) = refusal(&["gone.png", "-o", "b.svg"]);
        assert!(!advice.contains("strokefit fit"), "{advice}");
    }

    #[test]
    fn help_begins_with_examples() {
        for name in ["fit", "check", "render"] {
            let mut command = command();
            let help = command
                .find_subcommand_mut(name)
                .unwrap()
                .render_help()
                .to_string();
            let (examples, usage) = (help.find("Examples:"), help.find("Usage:"));
            assert!(examples.is_some() && examples < usage, "{help}");
        }
    }
}
