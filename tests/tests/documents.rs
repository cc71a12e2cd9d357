//! README, ARCHITECTURE and CHANGELOG are true today.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What stands in single back quotes.
fn quoted(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    prose.flat_map(|part| part.split('`').skip(1).step_by(2)).collect()
}

#[test]
fn every_path_that_the_architecture_names_exists() {
    let text = read("ARCHITECTURE.md");
    let paths: Vec<&str> =
        quoted(&text).into_iter().filter(|word| word.contains('/') && !word.contains(' ')).collect();
    assert!(paths.len() > 20, "the code map names its paths: {paths:?}");
    for path in paths {
        assert!(root().join(path).exists(), "ARCHITECTURE.md names `{path}`, which is not there");
    }
}

#[test]
fn every_folder_of_the_code_generator_is_on_the_map() {
    let text = read("ARCHITECTURE.md");
    let folders = fs::read_dir(root().join("mbs-codegen/src")).expect("the folder");
    for folder in folders.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_dir()) {
        let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
        assert!(
            text.contains(&format!("`mbs-codegen/src/{name}`")),
            "ARCHITECTURE.md does not name `{name}`"
        );
    }
}

#[test]
fn no_folder_of_the_code_generator_uses_one_to_its_right() {
    let order = ["syntax", "model", "symbolic", "equations", "structure", "program", "emit"];
    for (index, folder) in order.iter().enumerate() {
        for file in fs::read_dir(root().join("mbs-codegen/src").join(folder)).expect("the folder") {
            let path = file.expect("an entry").path();
            let text = fs::read_to_string(&path).expect("a source file");
            for later in order.iter().skip(index + 1) {
                let used = [format!("crate::{later}"), format!("    {later}::")];
                let found = used.iter().find(|used| text.contains(used.as_str()));
                assert!(found.is_none(), "{} uses `{later}`", path.display());
            }
            let used = text.contains("use syn") || text.contains("use quote");
            assert!(*folder != "symbolic" || !used, "{} knows of Rust's syntax", path.display());
        }
    }
}

#[test]
fn every_mechanism_and_command_stands_in_the_readme() {
    let text = read("README.md");
    for command in [
        "list",
        "run NAME",
        "expand NAME",
        "verify NAME",
        "verify --all",
        "print NAME",
        "latex NAME",
        "structure NAME",
        "newton NAME",
        "basins NAME",
        "next NAME",
        "dof NAME",
        "drift NAME",
        "compare NAME",
        "table FILE.csv",
    ] {
        assert!(text.contains(&format!("`mbs {command}")), "README.md does not show `mbs {command}`");
    }
    let free = mechanisms::registry::FREE.iter().map(|card| card.name);
    for name in mechanisms::registry::ALL.iter().map(|card| card.name).chain(free) {
        assert!(text.contains(&format!("`{name}`")), "README.md does not name `{name}`");
    }
    assert!(text.contains("cargo run --release") && text.contains("cargo test --workspace"));
}
