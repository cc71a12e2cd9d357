//! README, ARCHITECTURE and the book's list of commands and mechanisms agree with the code.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Texts in single back quotes.
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
fn every_long_motion_is_listed_with_the_feature_that_it_needs() {
    let manifest = read("tests/motions/Cargo.toml");
    for file in fs::read_dir(root().join("tests/motions/tests")).expect("the folder").flatten() {
        let path = file.path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let entry = format!("[[test]]\nname = \"{name}\"\nrequired-features = [\"long\"]\n");
        assert!(manifest.contains(&entry), "tests/motions/Cargo.toml does not list `{name}`");
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
fn the_readme_fits_on_three_pages_and_its_links_lead_to_files() {
    let text = read("README.md");
    assert!(text.lines().count() <= 150, "{} lines", text.lines().count());
    let prose: String = text.split("```").step_by(2).collect();
    let links = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let links: Vec<&str> = links.collect();
    assert!(links.len() > 15, "{links:?}");
    for link in links {
        let file = link.split('#').next().unwrap_or(link);
        assert!(root().join(file).exists(), "README.md links to `{link}`, which is not there");
    }
}

#[test]
fn the_readme_has_the_two_commands_and_the_first_example() {
    let text = read("README.md");
    assert!(text.contains("cargo run --release") && text.contains("cargo test --workspace"));
    let example = read("mbs-runtime/examples/four_bar.rs");
    let (_, program) = example.split_once("\n\n").expect("a heading and a program");
    assert!(text.contains(&format!("```rust\n{program}```")), "README.md does not show\n{program}");
}

#[test]
fn every_mechanism_and_command_stands_in_the_chapter_on_the_program() {
    let text = read("book/src/program.md");
    for command in [
        "new",
        "list",
        "run",
        "print",
        "latex",
        "structure",
        "newton",
        "basins",
        "next",
        "dof",
        "drift",
        "cost",
        "effects",
        "compare",
        "table",
        "expand",
        "verify",
        "watch",
        "check",
        "fmt",
    ] {
        assert!(text.contains(&format!("## `mbs {command}`")), "no section on `mbs {command}`");
    }
    for command in ["run", "kinematics", "simulate", "inverse", "equilibrium", "modes"] {
        assert!(text.contains(&format!("| `mbs {command}` |")), "no row on `mbs {command}`");
    }
    for name in mechanisms::CATALOGUE.names() {
        assert!(text.contains(&format!("`{name}`")), "the chapter on the program does not name `{name}`");
    }
}
