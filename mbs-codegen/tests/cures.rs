//! Mistakes of newcomers: each is one fault, at the token where it was made, and its cure gives a text without a fault.
//!
//! A file of `cures/` has the same mistake in several texts of `cures/texts`. A case names its text, lines to leave out (`-`),
//! lines in their place (`+`), and what these become by the cure (`=`); behind it stands the stored answer. After a change that
//! is meant, run `UPDATE_SNAPSHOTS=1 cargo test -p mbs-codegen --test cures` and read the difference.
#![forbid(unsafe_code)]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use mbs_codegen::Fault;

/// Line between two cases of a file.
const DIVIDER: &str = "\n========================================\n";
/// Mark of the lines of an answer.
const MARGIN: char = '|';

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cures")
}

/// Names and contents of the files.
fn files() -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(folder()).expect("the cases").map(|entry| entry.expect("a case").path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    files.sort();
    let read = |path: PathBuf| {
        let content = fs::read_to_string(&path).expect("a readable case");
        (path, content)
    };
    files.into_iter().map(read).collect()
}

/// A mistake in a text.
struct Case {
    /// Case as written, without its answer.
    head: String,
    /// Stored answer.
    answer: String,
    sound: String,
    wrong: String,
    cured: String,
    /// Lines of the mistake in the wrong text, from 1.
    mistake: std::ops::Range<usize>,
}

fn case(content: &str) -> Case {
    let (answer, head): (Vec<&str>, Vec<&str>) =
        content.trim_end().lines().partition(|line| line.starts_with(MARGIN));
    let name = head.first().expect("the name of a text");
    let sound = fs::read_to_string(folder().join("texts").join(format!("{name}.txt"))).expect(name);
    let marked = |mark: char| -> Vec<&str> {
        head.iter().skip(1).filter_map(|line| line.strip_prefix(mark)?.strip_prefix(' ')).collect()
    };
    let (left_out, wrong, cured) = (marked('-'), marked('+'), marked('='));
    assert_eq!(left_out.len() + wrong.len() + cured.len(), head.len() - 1, "{content}");
    let lines: Vec<&str> = sound.lines().collect();
    let at = match left_out.as_slice() {
        [] => lines.len() - 1,
        _ => lines.windows(left_out.len()).position(|found| found == left_out).expect("lines to leave out"),
    };
    let with = |inserted: &[&str]| {
        let behind = &lines[at + left_out.len()..];
        [&lines[..at], inserted, behind].concat().join("\n")
    };
    Case {
        head: head.join("\n"),
        answer: answer.join("\n"),
        wrong: with(&wrong),
        cured: with(&cured),
        mistake: at + 1..at + 1 + wrong.len(),
        sound,
    }
}

/// The faults of a text as a compiler shows them: line, caret, message, cure.
fn answer(text: &str, faults: &[Fault]) -> String {
    let mut shown = String::new();
    for fault in faults {
        let line = text.lines().nth(fault.line - 1).unwrap_or_default();
        let length = match fault.end_line == fault.line {
            true => fault.end_column.saturating_sub(fault.column).max(1),
            false => 1,
        };
        let caret = format!("{}{}", " ".repeat(fault.column - 1), "^".repeat(length));
        let _ = write!(
            shown,
            "{MARGIN} {line}\n{MARGIN} {caret}\n{MARGIN} error: {}\n{MARGIN} help: {}\n",
            fault.message, fault.help
        );
    }
    shown.trim_end().to_owned()
}

#[test]
fn every_mistake_is_answered_once_where_it_was_made() {
    let update = std::env::var_os("UPDATE_SNAPSHOTS").is_some();
    let mut complaints = String::new();
    for (path, content) in files() {
        let mut written = Vec::new();
        for case in content.split(DIVIDER).map(case) {
            let faults = mbs_codegen::outline(&case.wrong).err().unwrap_or_default();
            let found = answer(&case.wrong, &faults);
            // Where a line was left out, the fault stands where it is missed first.
            let is_there = |fault: &Fault| case.mistake.is_empty() || case.mistake.contains(&fault.line);
            if faults.len() != 1 || !faults.iter().all(is_there) {
                let _ =
                    writeln!(complaints, "{}: not one fault there\n{}\n{found}", path.display(), case.head);
            } else if !update && found != case.answer {
                let _ = writeln!(complaints, "{}\n{}\n{found}", path.display(), case.head);
            }
            written.push(format!("{}\n{found}", case.head));
        }
        if update {
            fs::write(&path, written.join(DIVIDER) + "\n").expect("a writable case");
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
}

#[test]
fn the_cure_gives_a_text_without_a_fault() {
    let mut complaints = String::new();
    for (path, content) in files() {
        for case in content.split(DIVIDER).map(case) {
            for text in [&case.sound, &case.cured] {
                if let Err(report) = mbs_codegen::expand_source(text) {
                    let _ = writeln!(complaints, "{}\n{}\n{report}", path.display(), case.head);
                }
            }
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
}

/// Words that an answer may not fall back on: a list of everything known is no cure.
#[test]
fn every_mistake_comes_in_several_texts_with_a_short_cure() {
    let files = files();
    assert!(files.len() > 55);
    for (path, content) in files {
        let cases: Vec<Case> = content.split(DIVIDER).map(case).collect();
        assert!(cases.len() >= 3, "{}", path.display());
        for case in cases {
            let help = case.answer.lines().last().unwrap_or_default();
            assert!(help.chars().count() < 160, "{}: {help}", path.display());
        }
    }
}
