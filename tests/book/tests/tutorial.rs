//! The tutorial's test of derivatives is the one that `tests/own` runs.

use std::fs;
use std::path::Path;

#[test]
fn the_tutorial_shows_the_test_that_runs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read =
        |name: &str| fs::read_to_string(root.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let test = read("tests/own/tests/derivatives.rs");
    let shown = format!("```rust\n{test}```");
    assert!(read("book/src/tutorial.md").contains(&shown), "book/src/tutorial.md does not show\n{test}");
}
