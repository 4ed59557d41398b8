//! Turns clap's errors into one line that says what is wrong, and advice.

use std::error::Error;
use std::ffi::OsString;
use std::num::{ParseFloatError, ParseIntError};
use std::path::Path;

use clap::error::ErrorKind;

/// Fault of the arguments, which begin with the program's name, and the advice.
pub(super) fn parts(error: &clap::Error, args: &[OsString]) -> (String, Option<String>) {
    let message = error.to_string();
    let paragraphs: Vec<String> = message
        .split("\n\n")
        .map(|p| p.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    let wrong = paragraphs.first().map_or("", String::as_str);
    let wrong = wrong.trim_start_matches("error: ").to_owned() + remedy(error);
    let tips: Vec<&str> = paragraphs
        .iter()
        .flat_map(|p| p.split("tip: ").skip(1))
        .map(str::trim)
        .collect();
    let tips = (!tips.is_empty()).then(|| tips.join("; "));
    let advice = forgotten(error, args)
        .or(tips)
        .or_else(|| further(&paragraphs));
    (wrong, advice)
}

/// What would be right in place of a text that is no number, as the standard library does not say.
fn remedy(error: &clap::Error) -> &'static str {
    match error.source() {
        Some(cause) if cause.is::<ParseIntError>() => ": give a whole number",
        Some(cause) if cause.is::<ParseFloatError>() => ": give a number",
        _ => "",
    }
}

/// The command that was meant, where a picture was given and no subcommand.
fn forgotten(error: &clap::Error, args: &[OsString]) -> Option<String> {
    let is_missing = match error.kind() {
        ErrorKind::InvalidSubcommand => true,
        // Options of `fit` where those of the program are.
        ErrorKind::UnknownArgument => error
            .to_string()
            .contains("Usage: strokefit [OPTIONS] <COMMAND>"),
        _ => false,
    };
    let words = args.get(1..).filter(|_| is_missing)?;
    let words: Vec<&str> = words
        .iter()
        .map(|word| word.to_str())
        .collect::<Option<_>>()?;
    let picture = words.iter().map(Path::new).find(|path| path.is_file())?;
    let names_output = |word: &&&str| word.starts_with("-o") || word.starts_with("--output");
    let output = match words.iter().find(names_output) {
        Some(_) => String::new(),
        None => format!(
            " -o {}",
            quoted(&picture.with_extension("svg").to_string_lossy())
        ),
    };
    let words: Vec<String> = words.into_iter().map(quoted).collect();
    Some(format!("strokefit fit {}{output}", words.join(" ")))
}

/// The word as a shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Points to the help of the command whose usage is among the paragraphs. The message about a wrong value has
/// no usage, and says itself what would be right.
fn further(paragraphs: &[String]) -> Option<String> {
    let usage = paragraphs.iter().find_map(|p| p.strip_prefix("Usage: "))?;
    let words = usage
        .split(' ')
        .take_while(|word| word.starts_with(|c: char| c.is_ascii_lowercase()));
    let command = words.collect::<Vec<_>>().join(" ");
    Some(format!("{command} --help lists the options"))
}
