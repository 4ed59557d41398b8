//! Turns clap's errors into one line that says what is wrong, and advice.

use std::path::Path;

use clap::error::{ContextKind, ContextValue};

/// What is wrong, and the advice.
pub(super) fn parts(error: &clap::Error) -> (String, Option<String>) {
    let message = error.to_string();
    let paragraphs: Vec<String> = message
        .split("\n\n")
        .map(|p| p.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    let wrong = paragraphs.first().map_or("", String::as_str);
    let wrong = wrong.trim_start_matches("error: ").to_owned();
    let tips: Vec<&str> = paragraphs
        .iter()
        .flat_map(|p| p.split("tip: ").skip(1))
        .map(str::trim)
        .collect();
    let tips = (!tips.is_empty()).then(|| tips.join("; "));
    let advice = forgotten(error).or(tips).or_else(|| further(&paragraphs));
    (wrong, advice)
}

/// The command that was meant, where a picture stands in place of the subcommand.
fn forgotten(error: &clap::Error) -> Option<String> {
    match error.get(ContextKind::InvalidSubcommand)? {
        ContextValue::String(word) if Path::new(word).is_file() => {
            let output = Path::new(word).with_extension("svg");
            Some(format!("strokefit fit {word} -o {}", output.display()))
        }
        _ => None,
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
