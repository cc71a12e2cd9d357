//! Messages that a user sees: the compiler's own, for one fault in each file, and no further errors.
//!
//! Every case uses the mechanism too, so that the stored messages prove that the stub serves. After a change that is
//! meant, run `TRYBUILD=overwrite cargo test -p mbs-faults --features long --test ui` and read the difference.
#![forbid(unsafe_code)]

use std::fs;
use std::path::{Path, PathBuf};

/// Each so many of the cases goes to the compiler, which takes two thirds of a second for one.
const STRIDE: usize = if cfg!(feature = "long") { 1 } else { 5 };

#[test]
fn faults_are_reported_by_the_compiler_and_nothing_else_is() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("ui");
    let files = fs::read_dir(folder).expect("the cases").map(|file| file.expect("a file").path());
    let mut cases: Vec<PathBuf> =
        files.filter(|file| file.extension().is_some_and(|suffix| suffix == "rs")).collect();
    cases.sort();
    assert!(cases.len() > 280, "{} cases", cases.len());
    let compiler = trybuild::TestCases::new();
    cases.iter().step_by(STRIDE).for_each(|case| compiler.compile_fail(case));
}

/// `mbs-codegen` keeps the same texts with what it reports by itself, whatever the compiler's version.
#[test]
fn every_case_has_its_twin_without_a_compiler() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let twins = root.join("../../mbs-codegen/tests/diagnostics");
    let mut compared = 0;
    for twin in fs::read_dir(twins).expect("the twins") {
        let twin = twin.expect("a twin").path();
        let name = twin.file_stem().and_then(|name| name.to_str()).expect("a name");
        let stored = fs::read_to_string(&twin).expect("a readable twin");
        let (text, report) = stored.split_once("\n-----").expect("a report");
        let case = fs::read_to_string(root.join("ui").join(name).with_extension("rs")).expect(name);
        let indented: String = text.lines().map(|line| format!("    {line}\n")).collect();
        assert!(case.contains(&format!("mechanism! {{\n{indented}}}")), "{name}");
        // The compiler shows the same messages, in its own layout.
        let shown = fs::read_to_string(root.join("ui").join(name).with_extension("stderr")).expect(name);
        let messages: Vec<&str> = report.lines().skip(1).filter(|line| !line.starts_with("  help")).collect();
        for message in &messages {
            let message = message.splitn(3, ':').nth(2).expect("line:column: message").trim();
            assert!(shown.contains(&format!("error: {message}\n")), "{name}: {message}");
        }
        assert_eq!(shown.matches("error").count(), messages.len(), "{name}");
        compared += 1;
    }
    assert!(compared > 40);
}
