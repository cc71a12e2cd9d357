//! `mbs` with the ready mechanisms.

use std::process::ExitCode;

fn main() -> ExitCode {
    mbs_workbench::program(&mechanisms::CATALOGUE)
}
