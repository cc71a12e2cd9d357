//! Documentation, the book, packages.

use crate::shell::{command, need, step};

/// Documentation of all crates, doc tests of README and book, the book.
///
/// # Errors
/// Those of its parts.
pub fn all() -> Result<(), String> {
    rustdoc()?;
    step(&mut command("cargo", &["test", "-p", "mbs-book"]))?;
    book()
}

/// Documentation of all crates without a warning.
///
/// # Errors
/// A warning or an error of `cargo doc`.
pub fn rustdoc() -> Result<(), String> {
    let mut doc = command("cargo", &["doc", "--workspace", "--no-deps"]);
    step(doc.env("RUSTDOCFLAGS", "-D warnings"))
}

/// The program that makes the book.
///
/// # Errors
/// Its cure, where it is missing.
pub fn need_book() -> Result<(), String> {
    need("mdbook", "install it: `cargo install mdbook`")
}

/// The book as HTML, below `book` in the target directory.
///
/// # Errors
/// mdBook is missing, with its cure, or fails.
pub fn book() -> Result<(), String> {
    need_book()?;
    step(command("mdbook", &["build", "book", "--dest-dir"]).arg(crate::shell::target().join("book")))
}

/// Packages of all crates, each compiled as a registry would have it.
///
/// # Errors
/// A package that cannot be made or does not compile.
pub fn package() -> Result<(), String> {
    step(&mut command("cargo", &["package", "--workspace", "--allow-dirty"]))
}
