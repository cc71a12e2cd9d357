//! Writes a module for the README and each chapter of the book, with the chapter as its documentation.

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
    fs::write(Path::new(&env::var("OUT_DIR")?).join("chapters.rs"), modules)?;
    Ok(())
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
