//! Compiles the generated C code of the peers: every `.c` file of the directory that `MBS_PEERS` names.

use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-env-changed=MBS_PEERS");
    println!("cargo::rerun-if-env-changed=MBS_PEERS_FLAGS");
    let directory =
        env::var("MBS_PEERS").expect("`cargo bench -p mbs-tests --bench kinematics` sets MBS_PEERS");
    println!("cargo::rerun-if-changed={directory}");
    let mut files: Vec<_> = fs::read_dir(&directory)
        .unwrap_or_else(|error| panic!("{directory}: {error}"))
        .map(|entry| entry.expect("an entry of a directory that is open").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "c"))
        .collect();
    files.sort();
    let mut build = cc::Build::new();
    build.opt_level(3).debug(false).warnings(false).files(files);
    for flag in env::var("MBS_PEERS_FLAGS").unwrap_or_default().split_whitespace() {
        build.flag(flag);
    }
    build.compile("peers");
    println!("cargo::rustc-link-lib=m");
}
