//! Shared ground of the workspace-wide tests.

/// The README's examples, compiled and run as they stand.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}

pub mod proofs;
pub mod tools;
pub mod written;
