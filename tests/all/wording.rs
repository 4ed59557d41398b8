//! The first word of a doc comment is the noun or the verb of the thing.

use std::fs;
use std::path::Path;

use crate::support::repository::committed;

const FOLDERS: [&str; 5] = ["src", "rig/src", "web/src", "python/src", "examples"];

/// Beginnings that keep a reader waiting for the noun or the verb.
const BEGINNINGS: [&str; 4] = ["What", "Whether", "How", "The same"];

#[test]
fn doc_comments_begin_with_the_noun_or_the_verb() {
    let mut found = Vec::new();
    for folder in FOLDERS {
        search(committed(folder).as_ref(), &mut found);
    }
    assert!(found.is_empty(), "{BEGINNINGS:?}:\n{}", found.join("\n"));
}

#[test]
fn only_the_first_line_of_a_doc_comment_counts() {
    let text = "//! How\n\n/// One,\n/// What.\nf;\n  /// The same.\nf;\n/// Whatever\nf;\n// What";
    assert_eq!(bad_lines(text), [1, 6]);
}

fn search(folder: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            search(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let lines = bad_lines(&fs::read_to_string(&path).unwrap());
            found.extend(lines.iter().map(|n| format!("{}:{n}", path.display())));
        }
    }
}

/// Numbers of the lines, from 1, that begin a doc comment with one of these words.
fn bad_lines(text: &str) -> Vec<usize> {
    let mut found = Vec::new();
    let mut before = "";
    for (line, number) in text.lines().map(str::trim_start).zip(1..) {
        for kind in ["///", "//!"] {
            let first = line.strip_prefix(kind).map(str::trim_start);
            let first = first.filter(|_| !before.starts_with(kind));
            let begins = |word: &&str| first.and_then(|text| text.strip_prefix(word));
            let rest = BEGINNINGS.iter().find_map(begins);
            if rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric)) {
                found.push(number);
            }
        }
        before = line;
    }
    found
}
