//! Shared ground of the workspace-wide tests.

pub mod proofs;
pub mod tools;
pub mod written;
