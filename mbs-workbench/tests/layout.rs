//! Texts of the project laid out: tokens, emitted code and comments stay, a second layout changes nothing.
#![cfg(feature = "program")]

use std::fs;
use std::path::{Path, PathBuf};

use mbs_codegen::{calls, expand_source};
use mbs_workbench::layout::{Layout, bare, rust};
use proc_macro2::{TokenStream, TokenTree};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Rust sources with texts below the folders.
fn sources(folders: &[&str]) -> Vec<(PathBuf, String)> {
    let mut open: Vec<PathBuf> = folders.iter().map(|folder| root().join(folder)).collect();
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if entry.is_dir() {
                open.extend((!entry.ends_with("target")).then_some(entry));
            } else if entry.extension().is_some_and(|suffix| suffix == "rs") {
                let content = fs::read_to_string(&entry).expect("a source");
                found.extend(content.contains("mechanism!").then_some((entry, content)));
            }
        }
    }
    found.sort();
    found
}

/// Tokens one by one. Emitted code quotes the text: its layout is left out there, its tokens are compared.
fn tokens(stream: TokenStream, found: &mut Vec<String>) {
    for tree in stream {
        match tree {
            TokenTree::Group(group) => {
                found.push(format!("{:?}", group.delimiter()));
                tokens(group.stream(), found);
                found.push("end".to_string());
            }
            TokenTree::Literal(literal) => {
                let quoted = syn::parse_str::<syn::LitStr>(&literal.to_string()).map(|text| text.value());
                let text = quoted.ok().filter(|text| text.contains("mechanism ") && text.contains("coord "));
                match text.and_then(|text| text.parse().ok()) {
                    Some(text) => tokens(text, found),
                    // Documentation that names a line of the text.
                    None if literal.to_string().contains(": line ") => {
                        found.push(literal.to_string().replace(|c: char| c.is_ascii_digit(), ""));
                    }
                    None => found.push(literal.to_string()),
                }
            }
            other => found.push(other.to_string()),
        }
    }
}

fn listed(stream: TokenStream) -> Vec<String> {
    let mut found = Vec::new();
    tokens(stream, &mut found);
    found
}

/// Comments of a source, by lines without the blanks before them.
fn comments(text: &str) -> Vec<&str> {
    let comment = |line: &str| line.find("//").or_else(|| line.find("/*"));
    text.lines().filter_map(|line| Some(line.get(comment(line)?..)?.trim_end())).collect()
}

/// The layout of a source, held to what a layout must keep. Number of its texts that have no fault.
fn held(path: &Path, content: &str) -> (Layout, usize) {
    let place = path.display();
    let layout = rust(content).unwrap_or_else(|fault| panic!("{place}: {fault:?}"));
    let (before, after) = (calls(content).expect("Rust"), calls(&layout.content).expect("Rust"));
    assert_eq!(before.len(), after.len(), "{place}");
    let faulty = layout.faults.len();
    let again = rust(&layout.content).expect("Rust");
    assert_eq!(again.content, layout.content, "{place}: a second layout changes the text");
    assert_eq!(again.faults.len(), faulty, "{place}");
    let of = |text: &str| listed(text.parse().expect("tokens"));
    assert_eq!(of(content), of(&layout.content), "{place}");
    assert_eq!(comments(content), comments(&layout.content), "{place}");
    let mut expanded = 0;
    for (before, after) in before.iter().zip(&after) {
        match (expand_source(&before.source), expand_source(&after.source)) {
            (Ok(before), Ok(after)) => {
                let (before, after) = (listed(before), listed(after));
                let differing = before.iter().zip(&after).find(|(before, after)| before != after);
                assert_eq!(differing, None, "{place}: other code is emitted");
                assert_eq!(before.len(), after.len(), "{place}");
                expanded += 1;
            }
            (Err(_), Err(_)) => {}
            _ => panic!("{place}: a fault comes or goes with the layout"),
        }
    }
    (layout, expanded)
}

#[test]
fn ready_mechanisms_are_laid_out_as_they_stand() {
    let (mut lines, mut changed, mut texts) = (0, 0, 0);
    for (path, content) in sources(&["mechanisms/src"]) {
        let (layout, expanded) = held(&path, &content);
        assert_eq!(layout.faults, [], "{}", path.display());
        texts += expanded;
        let left = content.lines().filter(|line| !layout.content.lines().any(|laid| laid == *line));
        for line in left {
            println!("{}: {line}", path.display());
            changed += 1;
        }
        lines += content.lines().count();
    }
    println!("{texts} texts, {changed} of {lines} lines change");
    assert!(texts > 40 && changed == 0);
}

#[test]
fn texts_of_tests_keep_tokens_comments_and_code() {
    let mut texts = 0;
    for (path, content) in
        sources(&["tests/tests", "tests/cases", "tests/house", "tests/own", "tests/motions", "tests/benches"])
    {
        texts += held(&path, &content).1;
    }
    println!("{texts} texts");
    assert!(texts > 150);
}

#[test]
fn faulty_texts_stay_or_keep_their_tokens() {
    let mut files = 0;
    for (path, content) in sources(&["tests/faults/ui"]) {
        held(&path, &content);
        files += 1;
    }
    assert!(files > 150);
}

/// A text without its line ends and blanks gets what a layout gives it, whatever it looked like before.
#[test]
fn texts_on_one_line_are_laid_out() {
    for (path, content) in sources(&["mechanisms/src"]) {
        for call in calls(&content).expect("Rust") {
            let tokens: TokenStream = call.source.parse().expect("tokens");
            let line = tokens.to_string();
            let layout = bare(&line);
            assert_eq!(layout.faults, [], "{}", path.display());
            assert_eq!(bare(&layout.content), layout, "{}", path.display());
            assert!(layout.content.lines().count() > 3);
        }
    }
}

/// Texts with characters lost, doubled or put in are refused, or laid out once and for all; nothing panics.
#[test]
fn spoilt_texts_are_refused_or_laid_out() {
    const PUT_IN: [&str; 16] = [
        "{", "}", "[", "(", ")", ";", ",", "-", "/* x */", "// y\n", "\n", "\n\n\n", "/// z\n", "\"", "é",
        "/*",
    ];
    let mut state = 7_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).expect("31 bits") % below
    };
    let (mut laid, mut refused) = (0, 0);
    for (path, content) in sources(&["mechanisms/src"]) {
        for call in calls(&content).expect("Rust") {
            let letters: Vec<char> = content[call.place].chars().collect();
            for _ in 0..40 {
                let mut spoilt = letters.clone();
                for _ in 0..=next(2) {
                    let at = next(spoilt.len());
                    match next(3) {
                        0 => drop(spoilt.drain(at..(at + 1 + next(3)).min(spoilt.len()))),
                        1 => spoilt.insert(at, letters[at.min(letters.len() - 1)]),
                        _ => drop(spoilt.splice(at..at, PUT_IN[next(PUT_IN.len())].chars())),
                    }
                }
                let text: String = spoilt.iter().collect();
                let layout = bare(&text);
                if layout.faults.is_empty() {
                    assert_eq!(bare(&layout.content), layout, "{}:\n{text}", path.display());
                    let of = |text: &str| listed(text.parse().expect("tokens"));
                    assert_eq!(of(&text), of(&layout.content), "{}", path.display());
                    laid += 1;
                } else {
                    assert_eq!(layout.content, text);
                    // What can be read has a layout.
                    let is_known =
                        layout.faults.iter().all(|fault| !fault.help.starts_with("report this text"));
                    assert!(is_known, "{:?}\n{text}", layout.faults);
                    refused += 1;
                }
            }
        }
    }
    println!("{laid} laid out, {refused} refused");
    assert!(laid > 400 && refused > 400, "{laid} {refused}");
}
