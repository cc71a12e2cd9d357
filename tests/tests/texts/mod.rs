//! The texts of the workspace.

use std::fs;
use std::path::Path;

/// The texts between the braces of `mechanism! { … }` in the Rust files below a directory, in the order of paths.
fn texts(directory: &Path, found: &mut Vec<(String, String)>) {
    let entries = fs::read_dir(directory).expect("a directory");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            texts(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let file = fs::read_to_string(&path).expect("a readable file");
            for text in file.split("\nmechanism! {\n").skip(1) {
                let end = text.find("\n}\n").expect("the end of a text");
                found.push((path.display().to_string(), text[..end].to_owned()));
            }
        }
    }
}

/// File and text of every `mechanism! { … }` of the mechanisms and of the tests.
pub fn workspace() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    texts(&root.join("../mechanisms/src"), &mut found);
    texts(&root.join("tests"), &mut found);
    assert!(found.len() > 10, "{}", found.len());
    found
}
