//! `mbs` with no mechanism of its own.

use std::process::ExitCode;

fn main() -> ExitCode {
    mbs_workbench::program(&[])
}
