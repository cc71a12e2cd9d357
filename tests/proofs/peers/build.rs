//! Compiles the C code of the peers: every `.c` file of the directory that `MBS_PEERS` names, and the code written by hand.
//! Links CasADi's library, to which that directory points.

use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-env-changed=MBS_PEERS");
    println!("cargo::rerun-if-env-changed=MBS_PEERS_FLAGS");
    let directory = env::var("MBS_PEERS").expect("`cargo bench -p mbs-tests` sets MBS_PEERS");
    println!("cargo::rerun-if-changed={directory}");
    let mut files: Vec<_> = fs::read_dir(&directory)
        .unwrap_or_else(|error| panic!("{directory}: {error}"))
        .map(|entry| entry.expect("an entry of a directory that is open").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "c"))
        .collect();
    files.push("andrews_dense.c".into());
    println!("cargo::rerun-if-changed=andrews_dense.c");
    files.sort();
    let mut build = cc::Build::new();
    build.opt_level(3).debug(false).warnings(false).files(files);
    let flags = env::var("MBS_PEERS_FLAGS").unwrap_or_default();
    for flag in flags.split_whitespace() {
        build.flag(flag);
    }
    build.compile("peers");
    let target = if flags.is_empty() { "default" } else { "native" };
    println!("cargo::rustc-env=MBS_PEERS_CVODES={directory}/cvodes_{target}.casadi");
    println!("cargo::rustc-link-search=native={directory}/casadi");
    println!("cargo::rustc-link-lib=dylib=casadi");
    println!("cargo::rustc-link-arg=-Wl,-rpath,{directory}/casadi");
    println!("cargo::rustc-link-lib=m");
}
