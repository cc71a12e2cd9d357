//! Tests that the book names: every `cargo test -p …` in its text selects at least one test. Decision records are short.

use std::fs;
use std::path::{Path, PathBuf};

/// Lines of a decision record, at most.
const LONGEST_RECORD: usize = 40;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the workspace")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Files with this ending in `folder` and below.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|extension| extension == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Folder of a package of the workspace.
fn package(name: &str) -> Option<PathBuf> {
    let below = fs::read_dir(root().join("tests")).expect("a folder").flatten().map(|entry| entry.path());
    let above = fs::read_dir(root()).expect("a folder").flatten().map(|entry| entry.path());
    let named = format!("name = \"{name}\"");
    above.chain(below).find(|folder| {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
        manifest.lines().any(|line| line == named)
    })
}

/// Module path of a file below `base`; a file that another one includes as its `tests` has that one's path.
fn module(base: &Path, file: &Path) -> String {
    let inner = file.strip_prefix(base).unwrap_or(Path::new("")).with_extension("");
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut parts: Vec<String> =
        inner.iter().map(|part| part.to_string_lossy().into_owned()).filter(|part| part != "mod").collect();
    if let Some(owner) = stem.strip_suffix("_tests")
        && file.with_file_name(format!("{owner}.rs")).exists()
    {
        parts.pop();
        parts.extend([owner.to_owned(), "tests".to_owned()]);
    }
    if matches!(parts.last().map(String::as_str), Some("main" | "lib")) {
        parts.pop();
    }
    parts.join("::")
}

/// Paths of the tests of a package: of one target, or of all.
fn tests(folder: &Path, target: Option<&str>) -> Vec<String> {
    let bases = match target {
        None => vec![folder.to_owned()],
        Some("--lib") => vec![folder.join("src")],
        Some(name) => vec![folder.join("tests").join(name), folder.join(name)],
    };
    let mut found = Vec::new();
    for base in bases {
        let mut sources = files(&base, "rs");
        sources.extend(Some(base.with_extension("rs")).filter(|file| file.is_file()));
        for source in sources {
            let text = read(&source);
            for after in text.split("#[test]").skip(1) {
                let name = after.split("fn ").nth(1).and_then(|rest| rest.split('(').next());
                found.extend(name.map(|name| format!("{}::{name}", module(&base, &source))));
            }
        }
    }
    found
}

/// Commands within backticks, outside of blocks of code.
fn commands(text: &str) -> Vec<String> {
    let prose: String = text.split("```").step_by(2).collect();
    let prose = prose.split_whitespace().collect::<Vec<_>>().join(" ");
    let spans = prose.split('`').skip(1).step_by(2);
    spans.filter(|span| span.starts_with("cargo test -p ")).map(str::to_owned).collect()
}

/// `true` if the command selects at least one test.
fn selects(command: &str) -> bool {
    let mut words = command.split(' ').skip(3);
    let Some(folder) = words.next().and_then(package) else { return false };
    let (mut target, mut filter) = (None, "");
    while let Some(word) = words.next() {
        match word {
            "--test" => target = words.next(),
            "--lib" => target = Some(word),
            "--doc" => return true,
            "--features" => drop(words.next()),
            _ if word.starts_with("--") => {}
            _ => filter = word,
        }
    }
    tests(&folder, target).iter().any(|test| test.contains(filter))
}

#[test]
fn every_test_that_the_book_names_exists() {
    let mut missing = Vec::new();
    for chapter in files(&root().join("book/src"), "md") {
        let commands = commands(&read(&chapter));
        missing.extend(
            commands
                .into_iter()
                .filter(|command| !selects(command))
                .map(|command| format!("{}: `{command}`", chapter.display())),
        );
    }
    assert!(missing.is_empty(), "no test is selected by\n{}", missing.join("\n"));
}

#[test]
fn commands_that_select_nothing_are_told() {
    assert!(selects("cargo test -p mbs-book --test named_tests commands_that_select"));
    assert!(!selects("cargo test -p mbs-book --test named_tests commands_that_select_all"));
    assert!(!selects("cargo test -p mbs-book --test no_such_target"));
    assert!(!selects("cargo test -p no-such-package"));
}

#[test]
fn decision_records_are_short_and_numbered_without_gaps() {
    let records = files(&root().join("book/src/decisions"), "md");
    let records: Vec<&PathBuf> = records.iter().filter(|file| !file.ends_with("index.md")).collect();
    for (number, record) in (1..).zip(&records) {
        let text = read(record);
        let name = record.file_name().unwrap_or_default().to_string_lossy().into_owned();
        assert!(text.lines().count() <= LONGEST_RECORD, "{name} has more than {LONGEST_RECORD} lines");
        assert!(name.starts_with(&format!("{number:04}-")), "{name}: number {number:04} is expected");
        for part in ["Date: ", "## Context", "## Decision", "## Alternatives", "## Evidence"] {
            assert!(text.contains(part), "{name} has no `{part}`");
        }
    }
}
