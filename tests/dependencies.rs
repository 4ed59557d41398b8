//! Every dependency comes from crates.io and may be used in a program under MIT or Apache-2.0: the part of
//! `cargo deny check` that needs neither that program nor a network.
#![allow(missing_docs, clippy::unwrap_used)]

use std::process::Command;

use serde_json::Value;

fn packages() -> Vec<Value> {
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&metadata.stderr).into_owned();
    assert!(metadata.status.success(), "{words}");
    let metadata: Value = serde_json::from_slice(&metadata.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// The licences that `deny.toml` allows.
fn allowed() -> Vec<String> {
    let rules = include_str!("../deny.toml");
    let list = rules.split("allow = [").nth(1).unwrap();
    let list = list.split(']').next().unwrap();
    let quoted = list.split('"').skip(1).step_by(2);
    quoted.map(str::to_owned).collect()
}

/// Whether one of the alternatives of a licence expression is allowed as a whole.
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
    let allowed = allowed();
    for package in packages() {
        let (name, licence) = (&package["name"], package["license"].as_str());
        assert!(
            licence.is_some_and(|l| is_allowed(l, &allowed)),
            "{name}: {licence:?}"
        );
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
    for package in packages() {
        let source = package["source"].as_str();
        let known = "registry+https://github.com/rust-lang/crates.io-index";
        assert!(source.is_none_or(|source| source == known), "{package}");
    }
}
