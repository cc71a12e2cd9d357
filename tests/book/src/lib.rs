//! Doc tests of the README and the book: `cargo test -p mbs-book --doc` compiles and runs every Rust block.
//!
//! `build.rs` writes one module a chapter, so that a new chapter is compiled without a further line here. Doc tests of
//! the edition 2024 are merged into one program: a block costs its own code alone.

/// Chapters, in modules of their names.
#[cfg(doctest)]
mod chapters {
    include!(concat!(env!("OUT_DIR"), "/chapters.rs"));
}
