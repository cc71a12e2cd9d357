//! The example program, which has mechanisms of its own, as a user starts it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the example, which stands beside this test's binary.
pub fn wiper(arguments: &[&str]) -> Output {
    let test = std::env::current_exe().expect("a path");
    let folder = test.ancestors().nth(2).expect("the profile's folder");
    Command::new(folder.join("examples/wiper")).args(arguments).output().expect("the example is built")
}

#[track_caller]
pub fn text(arguments: &[&str]) -> String {
    let output = wiper(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

pub fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Data of the report's page.
pub fn data(folder: &Path) -> serde_json::Value {
    let page = fs::read_to_string(folder.join("report.html")).expect("a report");
    let (_, rest) = page.split_once("id=\"data\">").expect("the data element");
    serde_json::from_str(rest.split_once("</script>").expect("its end").0).expect("JSON")
}

/// The message of a command that must fail with `code`.
#[track_caller]
pub fn failure(arguments: &[&str], code: i32) -> String {
    let output = wiper(arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    assert!(output.stdout.is_empty() && !said.contains("panicked"), "{arguments:?}: {said}");
    said
}
