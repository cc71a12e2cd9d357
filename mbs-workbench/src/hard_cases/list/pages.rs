//! The pages of the book on the cases, and their index.
//!
//! After a change that is meant, run `UPDATE_SNAPSHOTS=1 cargo test -p mbs-workbench --lib hard_cases::list` and read the difference.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::description::{Description, MethodKind, Table, When};
use super::{Case, cases, folder};

fn kind(kind: MethodKind) -> &'static str {
    match kind {
        MethodKind::Adaptive => "adaptive steps at tolerance 1e-8",
        MethodKind::Equal => "equal steps of order 4",
        MethodKind::Euler => "equal steps of order 1",
        MethodKind::Implicit => "implicit equal steps",
        MethodKind::Drift => "Baumgarte, unstabilized",
        MethodKind::Soft => "springs in place of rows",
        MethodKind::Drives => "positions of drives",
        MethodKind::Bounded => "steps of bounded work",
        MethodKind::Single => "single precision",
    }
}

/// Pages have lines of at most so many characters.
const WIDTH: usize = 140;

fn filled(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.last().map_or(0, |line| line.chars().count());
        if last + word.chars().count() >= WIDTH {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            let gap = if line.is_empty() { "" } else { " " };
            *line += &format!("{gap}{word}");
        }
    }
    lines.join("\n")
}

fn page(case: &Case) -> String {
    let Description {
        title, origin, why, elsewhere, here, bounds, known, tables, refused, outside, few, ..
    } = &case.description;
    let mut page = format!("# {title}\n\n`{}`; from {origin}.\n\n", case.name);
    for (head, text) in
        [("Why it is hard", why), ("What fails elsewhere", elsewhere), ("What is done here", here)]
    {
        page += &format!("{}\n\n", filled(&format!("**{head}.** {text}")));
    }
    if let Some(refused) = refused {
        let at = refused.at.map_or_else(String::new, |at| format!(" at t = {at} s"));
        let text = format!(
            "Every run must be refused{at}, with `{}` in its reason: {}.",
            refused.words, refused.source
        );
        page += &format!("{}\n\n", filled(&text));
    }
    if !known.is_empty() || !tables.is_empty() {
        page += "| known value | it is | source |\n|---|---|---|\n";
        for known in known {
            let when = if known.when == When::End { " at the end" } else { "" };
            let is = known.turning.map_or_else(|| known.is.to_string(), |omega| format!("{omega} rad/s · t"));
            // Writing to a string succeeds.
            let _ =
                writeln!(page, "| `{}` | {is}{when} | {} |", known.value, known.source.replace('|', "\\|"));
        }
        for Table { file, source, known, .. } in tables {
            let _ = writeln!(
                page,
                "| {} values | those of `{file}` | {} |",
                known.len(),
                source.replace('|', "\\|")
            );
        }
        page += "\n| bound of the error over its size | |\n|---|---|\n";
        for (of, bound) in bounds {
            let _ = writeln!(page, "| {} | {bound:e} |", kind(*of));
        }
        page.push('\n');
    }
    if let Some(few) = few {
        let text = format!("It has {} alone: {}. {}", few.words(), few.methods.join(", "), few.why);
        page += &format!("{}\n\n", filled(&text));
    }
    for outside in outside {
        let all = |names: &[String], whole: &str| {
            if names.is_empty() { whole.to_string() } else { names.join(", ") }
        };
        let (methods, variants) =
            (all(&outside.methods, "all methods"), all(&outside.variants, "all variants"));
        let text = format!("Outside of the range: {methods}; {variants}: {}.", outside.why);
        page += &format!("{}\n\n", filled(&text));
    }
    page + &format!(
        "```text\n{}\n```\n\n```sh\nmbs hard-cases --cases {}\n```\n",
        case.text.trim_end(),
        case.name
    )
}

fn index(cases: &[Case]) -> String {
    let mut text = "# The list of hard cases\n\n| case | why it is hard |\n|---|---|\n".to_string();
    for case in cases {
        let Description { title, why, .. } = &case.description;
        let _ = writeln!(text, "| [{title}]({}.md) | {} |", case.name, why.replace('|', "\\|"));
    }
    text + "\nEach case is two files in `mbs-workbench/hard_cases`; this page and those of the cases are made from them.\n"
}

#[test]
fn the_book_has_the_page_of_each_case() {
    let cases = cases().unwrap_or_else(|fault| panic!("{fault}"));
    let book = folder().join("../../book/src");
    let pages = book.join("hard-cases");
    let update = std::env::var_os("UPDATE_SNAPSHOTS").is_some();
    let check = |path: &Path, expected: &str| {
        let name = path.display();
        if update {
            fs::create_dir_all(&pages).and_then(|()| fs::write(path, expected)).expect("a page is written");
        }
        let found = fs::read_to_string(path).unwrap_or_default();
        assert!(found == expected, "{name} is not that of its case: see the head of pages.rs");
    };
    let summary = fs::read_to_string(book.join("SUMMARY.md")).expect("the table of contents");
    check(&pages.join("index.md"), &index(&cases));
    for case in &cases {
        check(&pages.join(format!("{}.md", case.name)), &page(case));
        let line = format!("    - [{}](hard-cases/{}.md)", case.description.title, case.name);
        assert!(summary.contains(&line), "SUMMARY.md has no line `{line}`");
    }
    let count = fs::read_dir(&pages).map_or(0, Iterator::count);
    assert_eq!(count, cases.len() + 1, "a page of a case that there is no longer: {}", pages.display());
}
