//! The `mbs` program.
fn main() {}
