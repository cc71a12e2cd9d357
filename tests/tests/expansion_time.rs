//! Time to expand every text of the workspace. Alone in its program, so that no other test shares the caches.
#![forbid(unsafe_code)]

#[path = "texts/mod.rs"]
mod texts;

use std::fs;
use std::time::{Duration, Instant};
use texts::workspace;

/// Longest expansion in a debug build, at the best of several runs, of a text of up to [`VALUES`]; of more in proportion. A quiet machine
/// takes half of it, one whose cores are shared two thirds.
const LONGEST: Duration = Duration::from_millis(100);
/// Emitted `let`s: the kinematics of any mechanism here. Scenes with masses and pins have several times as many.
const VALUES: u32 = 1000;
const RUNS: usize = 12;
/// Files with texts that no user would write, of ten thousand operations and more.
const LARGE_ON_PURPOSE: [&str; 2] = ["size.rs", "growth.rs"];

/// Processor time of this thread, if the system reports it: other work on the machine does not count.
fn processor_time() -> Option<Duration> {
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

#[test]
fn every_text_expands_within_100_ms_a_thousand_values() {
    let as_users_write = |path: &str| LARGE_ON_PURPOSE.iter().all(|large| !path.ends_with(large));
    for text in workspace().into_iter().filter(|(path, _)| as_users_write(path)) {
        let time = || {
            let started = (processor_time(), Instant::now());
            let items = mbs_codegen::expand_source(&text.1);
            assert!(items.is_ok(), "{}", text.0);
            match started.0.zip(processor_time()) {
                Some((before, after)) => after - before,
                None => started.1.elapsed(),
            }
        };
        let code = mbs_codegen::expand_source(&text.1).expect("a text without faults").to_string();
        let values = u32::try_from(code.matches("let ").count()).expect("a number of `let`s");
        let longest = LONGEST * values.div_ceil(VALUES).max(1);
        // The first run that is fast enough decides, as the best one would.
        let mut best = Duration::MAX;
        let is_soon = (0..RUNS).any(|_| {
            best = best.min(time());
            best <= longest
        });
        assert!(is_soon, "{best:?} for {}\n{}", text.0, text.1);
    }
}
