//! Crates of editions 2018, 2021 and 2024 that call the runtime by another name, without std. They are built, their
//! lints are satisfied, and their own tests pass.
#![forbid(unsafe_code)]

use std::env;
use std::path::Path;
use std::process::Command;

#[test]
fn mechanisms_work_in_every_edition_and_under_another_name() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("editions");
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let target = scratch.parent().unwrap_or(scratch);
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(["test", "--workspace", "--lib", "--locked"])
        .current_dir(directory)
        .env("CARGO_TARGET_DIR", target);
    let output = command.output().expect("the tests need cargo, which runs them");
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert_eq!(said.matches("the_rod_turns ... ok").count(), 3, "{said}");
    assert!(said.contains("the_slide_moves ... ok"), "{said}");
}
