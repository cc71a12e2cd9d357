//! Writes a module for the README and each chapter of the book, with the chapter as its documentation, and the texts of the
//! pictures of laws.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../..").canonicalize()?;
    let book = root.join("book/src");
    let mut chapters = Vec::new();
    // A package of this crate alone has neither.
    if book.is_dir() {
        chapters.push(root.join("README.md"));
        collect(&book, &mut chapters)?;
    }
    chapters.sort();
    let mut modules = String::new();
    for chapter in &chapters {
        let path = chapter.strip_prefix(&book).unwrap_or(chapter.strip_prefix(&root)?);
        let name: String = path.with_extension("").to_string_lossy().to_lowercase();
        let name = name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "_");
        writeln!(modules, "#[doc = include_str!({:?})]\nmod chapter_{name} {{}}", chapter.display())?;
        println!("cargo::rerun-if-changed={}", chapter.display());
    }
    println!("cargo::rerun-if-changed={}", book.display());
    let folder = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(folder.join("chapters.rs"), modules)?;
    fs::write(folder.join("laws.rs"), texts_of_laws(&root, &chapters)?)?;
    Ok(())
}

/// Texts that pictures of laws show beside those of the chapters: source and name of the mechanism.
const OTHERS: [(&str, &str); 5] = [
    ("mechanisms/src/kerb.rs", "Kerb"),
    ("tests/cases/laws/door.rs", "Door"),
    ("tests/cases/laws/half_car.rs", "HalfCar"),
    ("tests/cases/laws/tyre.rs", "Braking"),
    ("tests/motions/tests/clearance.rs", "Loose"),
];

/// Blocks with a header in chapters of laws, and [`OTHERS`], each within `mechanism!`.
fn texts_of_laws(root: &Path, chapters: &[PathBuf]) -> Result<String, Box<dyn Error>> {
    let mut found = String::new();
    let laws =
        |path: &&PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().ends_with("laws.md"));
    for chapter in chapters.iter().filter(laws) {
        let text = fs::read_to_string(chapter)?;
        let blocks = text.split("```").skip(1).step_by(2).filter_map(|block| block.strip_prefix("mbs\n"));
        for block in blocks.filter(|block| block.contains("pub mechanism ")) {
            writeln!(found, "mechanism! {{\n{block}}}")?;
        }
    }
    for (source, name) in OTHERS {
        let path = root.join(source);
        println!("cargo::rerun-if-changed={}", path.display());
        // A package of this crate alone has none.
        let Ok(text) = fs::read_to_string(path) else { continue };
        let mut texts = text.split("\nmechanism! {\n").skip(1).filter_map(|rest| rest.split("\n}\n").next());
        let header = format!("pub mechanism {name};");
        let text = texts.find(|text| text.contains(&header)).ok_or(format!("{source} has no {name}"))?;
        writeln!(found, "mechanism! {{\n{text}\n}}")?;
    }
    Ok(found)
}

/// Markdown files in `folder` and below.
fn collect(folder: &Path, chapters: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            println!("cargo::rerun-if-changed={}", path.display());
            collect(&path, chapters)?;
        } else if path.extension().is_some_and(|extension| extension == "md") {
            chapters.push(path);
        }
    }
    Ok(())
}
