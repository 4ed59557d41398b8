//! Every dependency comes from crates.io and may be used in a program under MIT or Apache-2.0: the part of
//! `cargo deny check` that needs neither that program nor a network.

use std::process::Command;

/// Each package that tests are compiled from on this platform, and its licence.
///
/// By `cargo tree`, since cargo has fetched just these packages: `cargo metadata` asks for those of all
/// platforms, which a fresh machine does not have.
fn licences() -> Vec<(String, String)> {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--prefix", "none"])
        .args(["--no-dedupe", "--format", "{p}|{l}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&tree.stderr).into_owned();
    assert!(tree.status.success(), "{words}");
    let lines = String::from_utf8(tree.stdout).unwrap();
    let pairs = lines.lines().filter_map(|line| line.split_once('|'));
    pairs.map(|(p, l)| (p.to_owned(), l.to_owned())).collect()
}

/// The licences that `deny.toml` allows.
fn allowed() -> Vec<String> {
    let rules = include_str!("../../deny.toml");
    let list = rules.split("allow = [").nth(1).unwrap();
    let list = list.split(']').next().unwrap();
    let quoted = list.split('"').skip(1).step_by(2);
    quoted.map(str::to_owned).collect()
}

/// True if one of the alternatives of a licence expression is allowed as a whole.
fn is_allowed(expression: &str, allowed: &[String]) -> bool {
    let all = expression.split(" AND ");
    all.map(|part| part.trim_matches(['(', ')'])).all(|part| {
        let any = part.split(" OR ").flat_map(|part| part.split('/'));
        any.map(str::trim)
            .any(|licence| allowed.iter().any(|a| a == licence))
    })
}

#[test]
fn every_licence_is_allowed() {
    let (allowed, licences) = (allowed(), licences());
    assert!(licences.iter().any(|(name, _)| name.starts_with("resvg ")));
    for (name, licence) in licences {
        assert!(is_allowed(&licence, &allowed), "{name}: {licence:?}");
    }
}

#[test]
fn expressions_are_read_as_they_are_meant() {
    let allowed = ["MIT", "OFL-1.1"].map(str::to_owned);
    assert!(is_allowed("MIT OR GPL-3.0", &allowed) && is_allowed("Apache-2.0/MIT", &allowed));
    assert!(is_allowed("(MIT OR Apache-2.0) AND OFL-1.1", &allowed));
    assert!(!is_allowed("(MIT OR Apache-2.0) AND GPL-3.0", &allowed));
}

#[test]
fn every_dependency_is_from_crates_io() {
    let sources = include_str!("../../Cargo.lock")
        .lines()
        .filter_map(|line| line.strip_prefix("source = "));
    let known = "\"registry+https://github.com/rust-lang/crates.io-index\"";
    let strangers: Vec<&str> = sources.filter(|source| *source != known).collect();
    assert_eq!(strangers, [""; 0]);
}
