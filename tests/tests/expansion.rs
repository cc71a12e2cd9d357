//! Expansion of every text of the workspace: the same bytes every time, and soon.
#![forbid(unsafe_code)]

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use std::{env, fs, thread};

/// Longest expansion in a debug build, at the best of several runs.
const LONGEST: Duration = Duration::from_millis(50);
const RUNS: usize = 12;

/// Where a child process writes what it expands.
const OUTPUT: &str = "EXPANSION_OUTPUT";

/// The texts between the braces of `mechanism! { … }` in the Rust files below a directory, in the order of paths.
fn texts(directory: &Path, found: &mut Vec<(String, String)>) {
    let entries = fs::read_dir(directory).expect("a directory");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            texts(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let file = fs::read_to_string(&path).expect("a readable file");
            for text in file.split("\nmechanism! {\n").skip(1) {
                let end = text.find("\n}\n").expect("the end of a text");
                found.push((path.display().to_string(), text[..end].to_owned()));
            }
        }
    }
}

fn workspace() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    texts(&root.join("../mechanisms/src"), &mut found);
    texts(&root.join("tests"), &mut found);
    assert!(found.len() > 10, "{}", found.len());
    found
}

fn expand((path, text): &(String, String)) -> String {
    let items = mbs_codegen::expand_source(text).unwrap_or_else(|report| panic!("{path}: {report}"));
    items.to_string()
}

fn expand_all() -> String {
    workspace().iter().map(|text| expand(text) + "\n").collect()
}

/// What this thread has spent on a processor, where the system tells: other work on the machine does not count.
fn processor_time() -> Option<Duration> {
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

#[test]
fn every_text_expands_within_50_ms() {
    // One text is large on purpose: the others are as users write them.
    for text in workspace().into_iter().filter(|(path, _)| !path.ends_with("size.rs")) {
        let time = || {
            let started = (processor_time(), Instant::now());
            let items = mbs_codegen::expand_source(&text.1);
            assert!(items.is_ok(), "{}", text.0);
            match started.0.zip(processor_time()) {
                Some((before, after)) => after - before,
                None => started.1.elapsed(),
            }
        };
        let best = (0..RUNS).map(|_| time()).min().expect("several runs");
        assert!(best <= LONGEST, "{best:?} for {}\n{}", text.0, text.1);
    }
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
