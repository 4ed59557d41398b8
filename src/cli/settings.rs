//! Configuration files: `--config FILE` reads one, `--print-config` writes one.
//!
//! A key is the long name of a flag, and its value is the flag's value. The file's entries are inserted as flags
//! before the flags of the command line: all rules for flags apply to them, and the command line wins. The
//! one door of `toml`.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, ArgAction, ArgMatches, Command, FromArgMatches, Id, value_parser};
use toml::{Spanned, Value};

use super::hint::Hint;
use super::options::Options;
use super::refusal::parts;
use super::{input, misuse};

const CONFIG: &str = "config";
const PRINT: &str = "print_config";

/// Options that a file cannot set.
const NOT_IN_FILES: [&str; 3] = ["help", CONFIG, PRINT];

/// The commands that take options from files.
const DRAWING: [&str; 2] = ["fit", "refine"];

/// The command, with the two options if it draws, and with a hidden opposite to each switch, so that flags
/// can override a file.
pub(super) fn offer(command: Command) -> Command {
    if !DRAWING.contains(&command.get_name()) {
        return command;
    }
    let switches: Vec<(Id, String)> = settable(&command)
        .filter(|arg| is_switch(arg))
        .filter_map(|arg| Some((arg.get_id().clone(), opposite(arg.get_long()?))))
        .collect();
    let command = command.args_override_self(true).args(options());
    switches
        .into_iter()
        .fold(command, |command, (id, opposite)| {
            let undo = Arg::new(opposite.clone()).long(opposite).hide(true);
            command.arg(undo.action(ArgAction::SetTrue).overrides_with(id))
        })
}

fn options() -> [Arg; 2] {
    let config = Arg::new(CONFIG)
        .value_name("FIT.toml")
        .value_parser(value_parser!(PathBuf))
        .help("Read options from a file with lines such as strokes = 500. Flags override the file");
    let print = Arg::new(PRINT)
        .action(ArgAction::SetTrue)
        .help("Print all options in the form of such a file, and draw nothing");
    [config.long("config"), print.long("print-config")]
}

/// The command that `args` name, and what they say as far as that can be understood.
fn understood(command: &Command, args: &[OsString]) -> Option<(String, ArgMatches)> {
    let lenient = command.clone().ignore_errors(true);
    lenient.try_get_matches_from(args).ok()?.remove_subcommand()
}

/// `args` with the flags of the file that they name, if they do.
pub(super) fn expand(command: &Command, mut args: Vec<OsString>) -> Result<Vec<OsString>> {
    let Some((name, matches)) = understood(command, &args) else {
        return Ok(args);
    };
    let path = matches.try_get_one::<PathBuf>(CONFIG).ok().flatten();
    let place = args.iter().skip(1).position(|arg| *arg == *name);
    if let (Some(path), Some(place), Some(command)) = (path, place, command.find_subcommand(&name))
    {
        let ids = command.get_positionals().map(|arg| arg.get_id().as_str());
        let pictures = ids.filter_map(|id| matches.get_raw(id)).flatten();
        let files: Vec<&Path> = pictures.map(Path::new).chain([path.as_path()]).collect();
        input::expect_one_stdin(&files, "the options and a picture")?;
        let flags = flags(path, &input::text(path, "a TOML file")?, command)?;
        args.splice(place + 2..place + 2, flags);
    }
    Ok(args)
}

/// Text that `--print-config` prints, if `args` ask for it.
pub(super) fn printed(command: &Command, args: &[OsString]) -> Result<Option<String>, clap::Error> {
    let is_asked = |(_, matches): &(String, ArgMatches)| {
        let asked = matches.try_get_one::<bool>(PRINT).ok().flatten();
        asked.is_some_and(|asked| *asked)
    };
    let Some((name, _)) = understood(command, args).filter(is_asked) else {
        return Ok(None);
    };
    // Neither input nor output is needed to print.
    let eased = command
        .clone()
        .mut_subcommand(&name, |command| command.mut_args(|arg| arg.required(false)));
    let matches = eased.try_get_matches_from(args)?;
    check_ranges(&matches)?;
    let command = command.find_subcommand(&name);
    Ok(command
        .zip(matches.subcommand_matches(&name))
        .map(|(command, matches)| text(command, matches)))
}

/// The flags that the file's text stands for.
fn flags(path: &Path, text: &str, command: &Command) -> Result<Vec<OsString>> {
    let name = input::name(path);
    let line = |offset: usize| text[..offset].matches('\n').count() + 1;
    let entries: BTreeMap<Spanned<String>, Spanned<Value>> = toml::from_str(text).map_err(|e| {
        let at = e.span().map_or(1, |span| line(span.start));
        let message = e.message().split_whitespace().collect::<Vec<_>>().join(" ");
        anyhow!("{name}:{at}: not TOML ({message}): write lines like strokes = 500")
    })?;
    let mut entries: Vec<_> = entries.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let mut flags = Vec::new();
    for (key, value) in entries {
        let at = format!("{name}:{}", line(key.span().start));
        let flag = flag(&at, command, key.get_ref(), value.get_ref())?;
        check(&at, command, &flag)?;
        flags.push(flag);
    }
    Ok(flags)
}

/// The flag that one line stands for.
fn flag(at: &str, command: &Command, key: &str, value: &Value) -> Result<OsString> {
    let is_named = |arg: &&Arg| {
        let others = arg.get_all_aliases().unwrap_or_default();
        arg.get_long() == Some(key) || others.contains(&key)
    };
    let Some(arg) = settable(command).find(is_named) else {
        let error = misuse(format!("{at}: no option is called {key}"));
        let advice = similar(command, key).map_or_else(
            || format!("strokefit {} --help lists the options", command.get_name()),
            |near| format!("did you mean {near}?"),
        );
        return Err(Hint::on(error, advice));
    };
    let text = match value {
        Value::Boolean(on) if is_switch(arg) => {
            let flag = if *on { key.to_owned() } else { opposite(key) };
            return Ok(format!("--{flag}").into());
        }
        _ if is_switch(arg) => {
            return Err(misuse(format!(
                "{at}: {key} is {value}: give true or false"
            )));
        }
        Value::String(text) => text.clone(),
        Value::Integer(_) | Value::Float(_) => value.to_string(),
        _ => {
            return Err(misuse(format!(
                "{at}: {key} is {value}: give one number or text"
            )));
        }
    };
    Ok(format!("--{key}={text}").into())
}

/// Refuses an option of a drawing that is out of its range.
pub(super) fn check_ranges(matches: &ArgMatches) -> Result<(), clap::Error> {
    match matches.subcommand() {
        Some((name, matches)) if DRAWING.contains(&name) => in_range(matches),
        _ => Ok(()),
    }
}

fn in_range(matches: &ArgMatches) -> Result<(), clap::Error> {
    let refusal = |error| clap::Error::raw(ErrorKind::ValueValidation, format!("--{error}"));
    Options::from_arg_matches(matches)?.check().map_err(refusal)
}

/// Checks that the command takes the flag's value.
fn check(at: &str, command: &Command, flag: &OsString) -> Result<()> {
    let args = [OsString::from(command.get_name()), flag.clone()];
    let eased = command.clone().mut_args(|arg| arg.required(false));
    let outcome = eased.try_get_matches_from(args);
    match outcome.and_then(|matches| in_range(&matches)) {
        Err(e)
            if matches!(
                e.kind(),
                ErrorKind::InvalidValue | ErrorKind::ValueValidation
            ) =>
        {
            let (wrong, advice) = parts(&e, &[]);
            let wrong = misuse(format!("{at}: {wrong}"));
            Err(Hint::maybe_on(wrong, advice))
        }
        _ => Ok(()),
    }
}

/// The option that clap would suggest in place of `key`.
fn similar(command: &Command, key: &str) -> Option<String> {
    let outcome = command
        .clone()
        .try_get_matches_from([command.get_name(), &format!("--{key}")]);
    match outcome.err()?.get(ContextKind::SuggestedArg)? {
        ContextValue::String(flag) => Some(flag.trim_start_matches('-').to_owned()),
        _ => None,
    }
}

/// The options that a file can set.
fn settable(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|arg| {
        let known = arg.get_long().is_some() && !arg.is_hide_set();
        known && !NOT_IN_FILES.contains(&arg.get_id().as_str())
    })
}

fn is_switch(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::SetTrue | ArgAction::SetFalse)
}

/// Switch that undoes the switch `key`.
fn opposite(key: &str) -> String {
    match key.strip_prefix("no-") {
        Some(rest) => rest.to_owned(),
        None => format!("no-{key}"),
    }
}

/// The options as a file: those without a value are commented out.
fn text(command: &Command, matches: &ArgMatches) -> String {
    let name = command.get_name();
    let mut text =
        format!("# Options of strokefit {name}, read by --config. Flags override them.\n");
    let heading = |arg: &&Arg| {
        arg.get_help_heading()
            .unwrap_or("Input and output")
            .to_owned()
    };
    let mut headings = Vec::new();
    for heading in settable(command).map(|arg| heading(&arg)) {
        if !headings.contains(&heading) {
            headings.push(heading);
        }
    }
    for title in headings {
        text += &format!("\n## {title}\n");
        let args = settable(command).filter(|arg| heading(arg) == title);
        text.extend(args.map(|arg| line(arg, matches)));
    }
    text
}

/// One option with what it is for.
fn line(arg: &Arg, matches: &ArgMatches) -> String {
    let key = arg.get_long().unwrap_or_default();
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let setting = match value(arg, matches) {
        Some(value) => format!("{key} = {value}"),
        None => {
            let names = arg.get_value_names().unwrap_or_default();
            format!(
                "# {key} = {}",
                names.first().map_or("", |name| name.as_str())
            )
        }
    };
    format!("\n# {}\n{setting}\n", help.replace('\n', " "))
}

/// The option's value as TOML has it.
fn value(arg: &Arg, matches: &ArgMatches) -> Option<Value> {
    let id = arg.get_id().as_str();
    if is_switch(arg) {
        let is_set = matches.get_flag(id) == matches!(arg.get_action(), ArgAction::SetTrue);
        return Some(Value::Boolean(is_set));
    }
    let raw = matches.get_raw(id)?.next()?.to_string_lossy().into_owned();
    // The sign of +300 has a meaning, which a number of TOML loses.
    if raw.starts_with('+') {
        return Some(Value::String(raw));
    }
    Some(raw.parse().unwrap_or(Value::String(raw)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::usage::command;

    fn fit() -> Command {
        command().find_subcommand("fit").unwrap().clone()
    }

    fn read(text: &str) -> Result<Vec<OsString>> {
        flags(Path::new("fit.toml"), text, &fit())
    }

    fn refusal(text: &str) -> String {
        let error = read(text).unwrap_err();
        let (wrong, hint) = Hint::split(&error);
        format!(
            "{wrong} | {}",
            hint.map(ToString::to_string).unwrap_or_default()
        )
    }

    #[test]
    fn lines_become_flags_in_their_order() {
        let flags = read(
            "strokes = 500\npsnr = 32.5 # dB\nopaque = true\nno-polish = false\npreset = 'draft'",
        );
        let expected = [
            "--strokes=500",
            "--psnr=32.5",
            "--opaque",
            "--polish",
            "--preset=draft",
        ];
        assert_eq!(flags.unwrap(), expected);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line_and_a_suggestion() {
        for (text, words) in [
            (
                "\nstrkes = 5",
                ["fit.toml:2", "strkes", "did you mean strokes?"],
            ),
            ("zebra = 5", ["fit.toml:1", "zebra", "--help"]),
            (
                "seed = 1\nstrokes = 0",
                ["fit.toml:2", "--strokes", "give a whole number"],
            ),
            ("preset = 'drft'", ["fit.toml:1", "drft", "draft"]),
            ("opaque = 1", ["fit.toml:1", "opaque is 1", "true or false"]),
            (
                "strokes = [1, 2]",
                ["fit.toml:1", "strokes", "one number or text"],
            ),
            ("strokes 5", ["fit.toml:1", "not TOML", "strokes = 500"]),
            ("config = 'a.toml'", ["fit.toml:1", "config", "no option"]),
        ] {
            let line = refusal(text);
            for word in words {
                assert!(
                    line.contains(word),
                    "{text:?} does not say {word:?}: {line}"
                );
            }
        }
    }

    #[test]
    fn a_printed_file_reads_as_the_same_flags() {
        let args = [
            "strokefit",
            "fit",
            "--print-config",
            "--psnr",
            "32.5",
            "--strokes",
            "+300",
            "--opaque",
            "--seed",
            "18446744073709551615",
        ];
        let args: Vec<OsString> = args.map(OsString::from).into();
        let text = printed(&command(), &args).unwrap().unwrap();
        let flags = read(&text).unwrap();
        for flag in [
            "--psnr=32.5",
            "--strokes=+300",
            "--opaque",
            "--seed=18446744073709551615",
            "--polish",
            "--precision=2",
        ] {
            assert!(flags.iter().any(|f| f == flag), "{flag}: {text}");
        }
        assert!(text.contains("# bytes = N"), "{text}");
    }
}
