//! A control loop in C calls a stepper that is compiled for size: the book's example, built and run.
#![cfg(target_os = "linux")]

use std::ffi::OsStr;
use std::fs;
use std::process::Command;

use mbs_tests::proofs::{Workshop, directory};
use mbs_tests::tools;

#[test]
fn a_loop_in_c_steps_a_mechanism_compiled_for_size() {
    let workshop = Workshop::new(env!("CARGO_TARGET_TMPDIR"), "proofs", "");
    // In a profile of its own the macro would be built once more.
    let size = "--config=profile.linked.opt-level=\"s\"";
    let arguments = ["--profile=linked", size, "--package=wiper-from-c"];
    let library = workshop
        .build(&arguments, "linked/libwiper_from_c.a", "wiper_from_c.a")
        .unwrap_or_else(|complaint| panic!("the library does not compile:\n{complaint}"));
    let program = workshop.target().join("wiper_from_c");
    let source = directory().join("from_c/main.c");
    let mut link: Vec<&OsStr> =
        ["-std=c11", "-Wall", "-Wextra", "-Werror", "-Os", "-Wl,--gc-sections"].map(OsStr::new).to_vec();
    link.extend([
        source.as_os_str(),
        library.as_os_str(),
        OsStr::new("-lm"),
        OsStr::new("-o"),
        program.as_os_str(),
    ]);
    // A path to a panic calls a function that is defined nowhere.
    tools::compile(&link)
        .unwrap_or_else(|complaint| panic!("a panic, or a fault of the example:\n{complaint}"));
    let said = tools::output(&mut Command::new(&program), "the test has just linked it");
    let said = said.unwrap_or_else(|complaint| panic!("{complaint}"));
    // Behind a whole number of milliseconds the crank is at 12 rad, to the rounding of `f32`; after the reset too.
    let numbers: Vec<f64> =
        said.split(' ').filter(|word| word.contains('.')).filter_map(|word| word.parse().ok()).collect();
    assert!(numbers.len() == 2 && numbers.iter().all(|found| (found - blade(12.0)).abs() < 3e-5), "{said}");
    for part in ["rad, 1 refused\n", "after a reset from 144 bytes", "damaged page 2"] {
        assert!(said.contains(part), "{said}");
    }
}

/// Angle (rad) of the blade at a crank angle (rad), in closed form: the arm from the law of cosines about the distance of its
/// bearing from the crank pin.
fn blade(crank: f64) -> f64 {
    let (x, y) = (0.10 * crank.cos() - 0.30, 0.10 * crank.sin());
    let distance = x.hypot(y);
    let opening = ((distance * distance + 0.20 * 0.20 - 0.25 * 0.25) / (2.0 * distance * 0.20)).acos();
    let ahead = y.atan2(x) - opening;
    (ahead + core::f64::consts::PI).rem_euclid(core::f64::consts::TAU) - core::f64::consts::PI
}

#[test]
fn the_book_shows_the_example_as_it_is() {
    let book = directory().join("../../book/src/control_loops.md");
    let text = fs::read_to_string(&book).expect("a chapter");
    for file in ["src/lib.rs", "wiper.h", "main.c"] {
        let content =
            fs::read_to_string(directory().join("from_c").join(file)).expect("a file of the example");
        let (_, shown) = content.split_once("\n\n").expect("a head and a body");
        let part = shown.split("unsafe extern \"C\" {").next().expect("a text").trim();
        assert!(text.contains(part), "the chapter does not show {file}");
    }
}
