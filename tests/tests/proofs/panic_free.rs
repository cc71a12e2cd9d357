//! No panic in any entry point, proven by `no-panic`: a function that can panic refers to a symbol that does not
//! exist.
//!
//! With the feature `long`; [`freestanding`](crate::freestanding) has the first tier. The program is `tests/proofs/panic_free`; the entry points are those of `tests/proofs/subjects`.

use std::process::Command;

use mbs_tests::{proofs::Workshop, tools};

fn workshop() -> Workshop {
    Workshop::new(env!("CARGO_TARGET_TMPDIR"), "proofs", "")
}

#[test]
fn every_entry_point_links_and_runs() {
    let name = format!("panic_free{}", std::env::consts::EXE_SUFFIX);
    let arguments = ["--release", "--package=proof-panic-free", "--bin=panic_free"];
    let program = workshop()
        .build(&arguments, &format!("release/{name}"), &name)
        .unwrap_or_else(|complaint| panic!("an entry point can panic:\n{complaint}"));
    let ran = tools::output(&mut Command::new(&program), "it was built a moment ago");
    ran.unwrap_or_else(|complaint| panic!("a solver fails:\n{complaint}"));
}

#[test]
fn an_index_out_of_range_does_not_link() {
    let arguments = ["--release", "--package=proof-panic-free", "--bin=control", "--features=control"];
    let complaint =
        workshop().build(&arguments, "release/control", "control").expect_err("a panic path went unnoticed");
    assert!(complaint.contains("detected panic in function `indexes`"), "{complaint}");
}
