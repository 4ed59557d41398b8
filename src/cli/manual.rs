//! `strokefit completions` and `strokefit man`: completion scripts for shells, and manual pages.

use std::fs;
use std::path::PathBuf;

use anyhow::{Result, anyhow};
use clap_complete::Shell;

use super::output::Output;
use super::{Status, Verbosity};

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
    let mut command = super::usage::command();
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
    clap_mangen::generate_to(super::usage::command(), &args.output).map_err(unwritable)?;
    verbosity.say(format_args!(
        "{folder}: wrote the manual pages of strokefit and its commands"
    ));
    Ok(Status::Done)
}
