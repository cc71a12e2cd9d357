//! Links of the book: every chapter is in the table of contents, every link leads to a file and a heading.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the workspace")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Markdown files in `folder` and below.
fn chapters(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(chapters(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The text without its blocks of code.
fn prose(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// Targets of links: `file.md#heading`.
fn targets(text: &str) -> Vec<String> {
    // Calls as `lift[0](x)` are none.
    let text: String = prose(text).split('`').step_by(2).collect();
    let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    links.filter(|link| !link.contains("://")).map(str::to_owned).collect()
}

/// Anchors of the headings, as mdBook makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let text = prose(text);
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings
        .map(|line| {
            let title = line.trim_start_matches('#').trim();
            let kept = title.chars().filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
            kept.map(|letter| if letter == ' ' { '-' } else { letter.to_ascii_lowercase() }).collect()
        })
        .collect()
}

#[test]
fn every_chapter_is_in_the_table_of_contents() {
    let book = root().join("book/src");
    let listed: BTreeSet<PathBuf> =
        targets(&read(&book.join("SUMMARY.md"))).into_iter().map(|target| book.join(target)).collect();
    let present: BTreeSet<PathBuf> =
        chapters(&book).into_iter().filter(|path| !path.ends_with("SUMMARY.md")).collect();
    assert!(listed.len() > 20, "{listed:?}");
    let (absent, unlisted) = (listed.difference(&present), present.difference(&listed));
    let (absent, unlisted) = (absent.collect::<Vec<_>>(), unlisted.collect::<Vec<_>>());
    assert!(absent.is_empty() && unlisted.is_empty(), "without a file: {absent:?}, not listed: {unlisted:?}");
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut broken = Vec::new();
    let mut count = 0;
    for chapter in chapters(&root().join("book/src")) {
        let text = read(&chapter);
        for target in targets(&text) {
            count += 1;
            let (file, heading) = target.split_once('#').unwrap_or((&target, ""));
            let path = if file.is_empty() { chapter.clone() } else { chapter.with_file_name(file) };
            // mdBook writes `README.md` as `index.html`, and leaves the links to it as they are.
            let named = path.exists() && !path.ends_with("README.md");
            let leads = named && (heading.is_empty() || anchors(&read(&path)).contains(heading));
            if !leads {
                broken.push(format!("{}: {target}", chapter.display()));
            }
        }
    }
    assert!(count > 100, "{count} links");
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
