//! `strokefit bench` and `strokefit lab`: a program of its own, `strokefit-rig`, takes over where it is installed.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, anyhow};
use strokefit::engines;

use super::hint::Hint;
use super::refusal::quoted;
use super::{Status, Verbosity, misuse};

const RIG: &str = "strokefit-rig";

/// Arguments that another program understands.
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(super) struct Rest {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    args: Vec<OsString>,
}

/// Runs `strokefit-rig` with the words `first` and the rest of the arguments; its status is that of this program.
pub(super) fn run(first: &[&str], rest: &Rest, verbosity: Verbosity) -> Result<Status> {
    let flags = [
        (verbosity.quiet, "--quiet"),
        (verbosity.verbose, "--verbose"),
    ];
    let flags = flags.into_iter().filter(|(is_set, _)| *is_set);
    let before = first.iter().copied().chain(flags.map(|(_, flag)| flag));
    let args: Vec<OsString> = before
        .map(OsString::from)
        .chain(rest.args.clone())
        .collect();
    let program = installed().ok_or_else(|| missing(&args))?;
    let status = Command::new(&program).args(args).status();
    let status = status.map_err(|e| anyhow!("{}: cannot be started ({e})", program.display()))?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(Status::Failed, Status::Other))
}

/// The program, beside this one or on the path.
fn installed() -> Option<PathBuf> {
    let name = format!("{RIG}{}", env::consts::EXE_SUFFIX);
    let beside = env::current_exe().ok().map(|own| own.with_file_name(name));
    beside
        .filter(|path| path.is_file())
        .or_else(|| engines::program(RIG))
}

fn missing(args: &[OsString]) -> anyhow::Error {
    let words: Vec<String> = args
        .iter()
        .map(|word| quoted(&word.to_string_lossy()))
        .collect();
    let advice = format!(
        "in the source of strokefit, cargo run --release -p rig -- {}",
        words.join(" ")
    );
    Hint::on(
        misuse(format!(
            "{RIG} is not installed: it measures, and repeats the article's experiments"
        )),
        advice,
    )
}
