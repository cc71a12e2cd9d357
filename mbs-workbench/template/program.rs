//! The program `mbs` for the mechanisms of the library: `cargo run -- --help` lists its commands.

use std::process::ExitCode;

use mbs_workbench::card;

fn main() -> ExitCode {
    // A mechanism more is a card more. The first one runs without arguments.
    mbs_workbench::program(&[card!(__CRATE__::__TYPE__Turning::default())])
}
