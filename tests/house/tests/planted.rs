//! Planted faults (`xtask/planted`) fit the sources: what a patch takes away stands in its file once.

use std::fs;
use std::path::Path;

#[test]
fn patches_fit_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let entries = fs::read_dir(root.join("xtask/planted")).expect("folder of the patches");
    let patches: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    assert!(patches.len() >= 9, "nine faults are planted");
    for path in patches {
        let patch = fs::read_to_string(&path).expect("a patch");
        let name = path.display();
        assert!(patch.contains("\nCases: "), "{name}: no line of its cases");
        let (mut source, mut before, mut hunks) = (String::new(), Vec::new(), 0);
        for line in patch.lines().chain(["@@"]) {
            if let Some(file) = line.strip_prefix("--- a/") {
                judge(&path, &source, &mut before);
                let file = root.join(file);
                source = fs::read_to_string(&file)
                    .unwrap_or_else(|error| panic!("{name}: {}: {error}", file.display()));
            } else if line.starts_with("@@") {
                judge(&path, &source, &mut before);
                hunks += 1;
            } else if !source.is_empty() && line.starts_with([' ', '-']) {
                before.push(line[1..].to_string());
            }
        }
        assert!(hunks > 1, "{name}: nothing is changed");
    }
}

/// The lines of a hunk that stand in the source without it.
fn judge(path: &Path, source: &str, before: &mut Vec<String>) {
    if !before.is_empty() {
        let before = std::mem::take(before).join("\n") + "\n";
        let count = source.matches(&before).count();
        assert_eq!(
            count,
            1,
            "{}: plant the fault anew; its sources no longer have once:\n{before}",
            path.display()
        );
    }
}
