//! Expansion of every text of the workspace: the same bytes every time.
#![forbid(unsafe_code)]

#[path = "texts/mod.rs"]
mod texts;

use std::path::Path;
use std::process::Command;
use std::{env, fs, thread};
use texts::workspace;

/// Environment variable with the file to which a child process writes its expansions.
const OUTPUT: &str = "EXPANSION_OUTPUT";

fn expand((path, text): &(String, String)) -> String {
    let items = mbs_codegen::expand_source(text).unwrap_or_else(|report| panic!("{path}: {report}"));
    items.to_string()
}

fn expand_all() -> String {
    workspace().iter().map(|text| expand(text) + "\n").collect()
}

#[test]
fn one_text_gives_the_same_code_twice_and_in_two_threads() {
    let threads = [thread::spawn(expand_all), thread::spawn(expand_all)];
    let first = expand_all();
    for other in threads {
        assert!(other.join().expect("expanded") == first);
    }
    assert!(expand_all() == first);
}

#[test]
fn two_processes_give_the_same_code() {
    if let Some(path) = env::var_os(OUTPUT) {
        return fs::write(path, expand_all()).expect("a writable file");
    }
    let here = expand_all();
    for name in ["first", "second"] {
        let path =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("expansion_{name}_{}", std::process::id()));
        let mut child = Command::new(env::current_exe().expect("this program"));
        child.args(["--exact", "two_processes_give_the_same_code"]).env(OUTPUT, &path);
        let output = child.output().expect("this program again");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        let there = fs::read_to_string(&path).expect("what it wrote");
        fs::remove_file(&path).expect("a file to remove");
        assert!(there == here, "process {name}");
    }
}
