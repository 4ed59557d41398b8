//! Imports go one way: no circle between the files of a folder, and no import against the order of the
//! modules that `src/lib.rs` lists. `rig/` compiles this file, too, for its own source.
//!
//! Sources are read as text: `use` declarations, and paths that begin with `crate`, `super`, `self` or the
//! library's name. Names that a module re-exports are followed to the file that they come from. Two things
//! are free: what tests import, and what a module and its own children take from each other, since both
//! are parts of one thing.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The library under test, as its program calls it.
const CRATE: &str = env!("CARGO_PKG_NAME");

/// A module's path from the root of the crate: `["fit", "config"]`.
type Module = Vec<String>;

/// Names that a file declares by `use`, with their paths, and all the paths that it mentions.
#[derive(Default)]
struct Source {
    names: BTreeMap<String, Vec<String>>,
    paths: BTreeSet<Vec<String>>,
}

/// All modules of a crate, those of library and program together.
struct Sources(BTreeMap<Module, Source>);

impl Sources {
    fn read(root: &Path) -> Self {
        let mut files = Vec::new();
        list(root, &mut files);
        let read = |path: &PathBuf| {
            let module = module_of(path.strip_prefix(root).unwrap());
            (module, Source::parse(&fs::read_to_string(path).unwrap()))
        };
        Self(files.iter().map(read).collect())
    }

    /// The module that `path`, as written in `from`, leads to; `None` for another crate's.
    fn resolve(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let (first, mut rest) = path.split_first()?;
        let mut module = match first.as_str() {
            "crate" | CRATE => Module::new(),
            "self" | "super" => from.clone(),
            child => {
                let child = [&from[..], &[child.to_owned()]].concat();
                self.0.contains_key(&child).then_some(child)?
            }
        };
        if first == "super" {
            module.pop()?;
        }
        while let Some((name, further)) = rest.split_first() {
            let child = [&module[..], std::slice::from_ref(name)].concat();
            if name == "super" {
                module.pop()?;
            } else if self.0.contains_key(&child) {
                module = child;
            } else {
                // An item of this module, or of the one that it is imported from.
                let origin = self.0.get(&module)?.names.get(name).filter(|_| depth > 0);
                let origin = origin.and_then(|path| self.resolve(&module, path, depth - 1));
                return Some(origin.unwrap_or(module));
            }
            rest = further;
        }
        Some(module)
    }

    /// Who imports from whom.
    fn imports(&self) -> BTreeSet<(Module, Module)> {
        let mut imports = BTreeSet::new();
        for (from, source) in &self.0 {
            for path in &source.paths {
                let to = self.resolve(from, path, RE_EXPORTS);
                imports.extend(to.map(|to| (from.clone(), to)));
            }
        }
        imports
    }
}

/// Number of re-exports of re-exports that are followed.
const RE_EXPORTS: usize = 8;

fn list(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            list(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            files.push(path);
        }
    }
}

fn module_of(file: &Path) -> Module {
    let path = file.with_extension("");
    let mut module: Module = path
        .iter()
        .map(|part| part.to_str().unwrap().into())
        .collect();
    module.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
    module
}

impl Source {
    fn parse(text: &str) -> Self {
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
        let lines = code.lines().map(|line| line.split("//").next().unwrap());
        let code = lines.collect::<Vec<_>>().join("\n");
        let mut source = Self::default();
        source.mention(&code);
        for (at, _) in code.match_indices("use ") {
            let starts = code[..at].chars().next_back();
            if starts.is_none_or(|c| c.is_whitespace()) {
                let tree = code[at + 4..].split(';').next().unwrap();
                source.declare(&[], tree.trim());
            }
        }
        source
    }

    /// Takes note of the paths in a piece of code.
    fn mention(&mut self, code: &str) {
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        for word in code.split(|c| !is_part(c)) {
            let path: Vec<String> = word.split("::").map(str::to_owned).collect();
            let ours = ["crate", "super", "self", CRATE].contains(&path[0].as_str());
            if ours && path.len() > 1 {
                self.paths.insert(path);
            }
        }
    }

    /// Takes note of a `use` tree below `prefix`: `a::b`, `a as b`, `a::{b, c::d}`.
    fn declare(&mut self, prefix: &[String], tree: &str) {
        if let Some((head, list)) = tree.split_once('{') {
            let prefix = join(prefix, head.trim_end_matches("::"));
            for branch in branches(list.trim_end().trim_end_matches('}')) {
                self.declare(&prefix, branch.trim());
            }
            return;
        }
        let (tree, alias) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut path = join(prefix, tree);
        if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
            path.pop();
        }
        let name = if alias.is_empty() { path.last() } else { None };
        if let Some(name) = name.cloned().or_else(|| Some(alias.to_owned())) {
            self.names.insert(name, path.clone());
        }
        self.paths.insert(path);
    }
}

fn join(prefix: &[String], path: &str) -> Vec<String> {
    let parts = path.split("::").filter(|part| !part.is_empty());
    prefix
        .iter()
        .cloned()
        .chain(parts.map(|part| part.trim().to_owned()))
        .collect()
}

/// The parts of a list between its commas, leaving inner braces whole.
fn branches(list: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&list[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

/// For each folder, which of its modules import from which, with all that lies in them.
fn siblings(imports: &BTreeSet<(Module, Module)>) -> BTreeMap<Module, BTreeSet<(String, String)>> {
    let mut folders: BTreeMap<Module, BTreeSet<(String, String)>> = BTreeMap::new();
    for (from, to) in imports {
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if let (Some(a), Some(b)) = (from.get(common), to.get(common)) {
            let arrow = (a.clone(), b.clone());
            folders
                .entry(from[..common].to_vec())
                .or_default()
                .insert(arrow);
        }
    }
    folders
}

/// The modules of a folder that are left when those that import nothing of the others are taken away, and then
/// those that are imported by none: what is left lies on circles, or between two of them.
fn circles(arrows: &BTreeSet<(String, String)>) -> BTreeSet<String> {
    let mut left = arrows.clone();
    loop {
        let importing: BTreeSet<String> = left.iter().map(|(a, _)| a.clone()).collect();
        let imported: BTreeSet<String> = left.iter().map(|(_, b)| b.clone()).collect();
        let before = left.len();
        left.retain(|(a, b)| imported.contains(a) && importing.contains(b));
        if left.len() == before {
            return importing;
        }
    }
}

/// The modules in the order in which `lib.rs` lists them.
fn order(head: &str) -> Vec<String> {
    let list = head
        .split("```text")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let mut order = Vec::new();
    for line in list.lines() {
        let words = line.trim_start_matches("//!").split_whitespace();
        let is_module = |word: &&str| {
            ["", ".rs", "/mod.rs"].iter().any(|end| {
                let path =
                    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("src/{word}{end}"));
                path.exists()
            })
        };
        order.extend(words.take_while(is_module).map(str::to_owned));
    }
    order
}

fn ours() -> Sources {
    Sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

#[test]
fn no_files_of_a_folder_import_each_other_in_a_circle() {
    let folders = siblings(&ours().imports());
    let mut found = Vec::new();
    for (folder, arrows) in folders.iter().filter(|(folder, _)| !folder.is_empty()) {
        let circle = circles(arrows);
        if !circle.is_empty() {
            found.push(format!("src/{}: {circle:?}", folder.join("/")));
        }
    }
    assert!(
        found.is_empty(),
        "circles of imports:\n{}",
        found.join("\n")
    );
}

#[test]
fn modules_import_from_those_above_them_in_the_list_of_lib_rs() {
    let head = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
    let order = order(&fs::read_to_string(head).unwrap());
    let place = |module: &str| {
        order
            .iter()
            .position(|name| name == module)
            .unwrap_or_else(|| {
                panic!("src/lib.rs does not list {module}: add it to the pipeline in its head")
            })
    };
    let arrows = siblings(&ours().imports()).remove(&Module::new()).unwrap();
    let against: Vec<String> = arrows
        .iter()
        .filter(|(from, to)| place(from) < place(to))
        .map(|(from, to)| format!("{from} imports from {to}"))
        .collect();
    assert!(
        against.is_empty(),
        "against the order:\n{}",
        against.join("\n")
    );
}

#[test]
fn circles_are_found_through_re_exports_and_inline_paths() {
    let parse = |module: &str, text: &str| {
        let path = module.split("::").filter(|part| !part.is_empty());
        (path.map(str::to_owned).collect(), Source::parse(text))
    };
    let sources = |b: &str| {
        Sources(BTreeMap::from([
            parse("", ""),
            parse(
                "m",
                "mod a;\nmod b;\nmod c;\npub use a::{A, Other as Another};\n",
            ),
            parse("m::a", "use super::b::{self, B};\nuse std::fmt;\n"),
            parse("m::b", b),
            parse("m::c", "use crate::m::{Another, b::B};\n"),
        ]))
    };
    let circle = |b: &str| {
        let folders = siblings(&sources(b).imports());
        circles(&folders[&vec!["m".to_owned()]])
    };
    let both = BTreeSet::from(["a", "b"].map(str::to_owned));
    assert_eq!(circle("fn b() {}"), BTreeSet::new());
    assert_eq!(circle("use super::A;"), both);
    assert_eq!(circle("use super::Another;"), both);
    assert_eq!(circle("fn b() { super::a::run(); }"), both);
    assert_eq!(
        circle("// super::a\n#[cfg(test)]\nmod tests { use super::super::a; }"),
        BTreeSet::new()
    );
}
