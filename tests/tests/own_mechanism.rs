//! The tutorial's cross-check of a mechanism of one's own: as written there, in a crate outside the workspace.
#![forbid(unsafe_code)]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use mbs_tests::tools;
use mbs_tests::written::WrittenCrate;
use mbs_workbench::verify::environment::INTERPRETER_VARIABLE;

fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn read(path: &str) -> String {
    fs::read_to_string(file(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A copy of `tests/own`, written once.
static COPY: LazyLock<WrittenCrate> = LazyLock::new(|| {
    let copy = WrittenCrate::new(env!("CARGO_TARGET_TMPDIR"), "own", &read("own/Cargo.toml"));
    for path in ["src/lib.rs", "tests/derivatives.rs", "tests/slip.rs"] {
        copy.write(path, &read(&format!("own/{path}")));
    }
    copy
});

/// `cargo test` in the copy; `Err` if a test fails. Both hold all output.
fn cargo_test(arguments: &[&str], interpreter: Option<&str>) -> Result<String, String> {
    let mut command = COPY.cargo(&["test"]);
    command.args(arguments).args(["--", "--nocapture"]);
    if let Some(interpreter) = interpreter {
        command.env(INTERPRETER_VARIABLE, interpreter);
    }
    tools::output(&mut command, "the tests need cargo, which runs them")
}

#[test]
fn the_tutorial_shows_the_test_that_runs() {
    let test = read("own/tests/derivatives.rs");
    let tutorial = read("../book/src/tutorial.md");
    assert!(tutorial.contains(&format!("```rust\n{test}```")), "the tutorial does not show\n{test}");
    assert_eq!(test.lines().count(), 5);
}

#[test]
fn five_lines_check_a_mechanism_of_ones_own_and_find_a_slip() {
    let said = cargo_test(&[], None).unwrap_or_else(|said| panic!("{said}"));
    let expected = [
        "Mine at 1000 states beside CasADi",
        "Mine at 20 states beside 50 digits",
        "casadi_and_50_digits_confirm_my_mechanism ... ok",
        "a_slip_is_found_and_named ... ok",
    ];
    for words in expected {
        assert!(said.contains(words), "{words} is missing in\n{said}");
    }
}

#[test]
fn without_python_the_five_lines_name_the_cure() {
    let said = cargo_test(&["--test", "derivatives"], Some("no-such-python")).expect_err("no Python");
    let cure = "install Python 3, or name an interpreter in MBS_PYTHON";
    assert!(said.contains("`no-such-python` does not start") && said.contains(cure), "{said}");
}
