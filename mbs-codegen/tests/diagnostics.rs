//! Every fault of a text with its place and its cure, as `expand_source` reports it: no compiler takes part.
//!
//! One case a file of `diagnostics/`: the text, a line of dashes, the report. After a change that is meant, run
//! `UPDATE_SNAPSHOTS=1 cargo test -p mbs-codegen --test diagnostics` and read the difference.
#![forbid(unsafe_code)]

use std::fs;
use std::path::{Path, PathBuf};

const DIVIDER: &str = "----------------------------------------\n";

fn cases() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let entries = fs::read_dir(folder).expect("the cases");
    let mut cases: Vec<PathBuf> = entries.map(|entry| entry.expect("a case").path()).collect();
    cases.sort();
    cases
}

/// Text and stored report.
fn read(case: &Path) -> (String, String) {
    let stored = fs::read_to_string(case).expect("a readable case");
    match stored.split_once(DIVIDER) {
        Some((text, report)) => (text.to_owned(), report.to_owned()),
        None => (stored, String::new()),
    }
}

fn report(text: &str) -> String {
    match mbs_codegen::expand_source(text) {
        Ok(_) => "no fault\n".into(),
        Err(report) => report,
    }
}

#[test]
fn every_fault_is_reported_at_its_place_with_its_cure() {
    let update = std::env::var_os("UPDATE_SNAPSHOTS").is_some();
    let mut changed = Vec::new();
    for case in cases() {
        let (text, stored) = read(&case);
        let found = report(&text);
        if update {
            fs::write(&case, format!("{text}{DIVIDER}{found}")).expect("a writable case");
        } else if found != stored {
            changed.push(format!("{}\nstored:\n{stored}\nfound:\n{found}", case.display()));
        }
    }
    assert!(changed.is_empty(), "{}", changed.join("\n"));
}

#[test]
fn every_message_has_the_style_of_the_compiler() {
    for case in cases() {
        let (_, report) = read(&case);
        assert_ne!(report, "no fault\n", "{}", case.display());
        let lines: Vec<&str> = report.lines().collect();
        for fault in lines.chunks(2) {
            let [head, help] = fault else { panic!("{}: a fault without a cure", case.display()) };
            let message = head.splitn(3, ':').nth(2).expect("line:column: message").trim();
            let cure = help.strip_prefix("  help: ").expect("a cure");
            for text in [message, cure] {
                assert!(!text.is_empty() && !text.ends_with('.'), "{}: {text}", case.display());
                let first = text.chars().next().expect("a character");
                assert!(!first.is_uppercase(), "{}: {text}", case.display());
            }
        }
    }
}

#[test]
fn faults_stand_in_the_order_of_the_text() {
    for case in cases() {
        let (_, report) = read(&case);
        let place = |line: &str| -> Vec<usize> {
            line.splitn(3, ':').take(2).map(|part| part.parse().expect("a number")).collect()
        };
        let places: Vec<Vec<usize>> =
            report.lines().filter(|line| !line.starts_with(' ')).map(place).collect();
        assert!(places.is_sorted(), "{}", case.display());
    }
}
