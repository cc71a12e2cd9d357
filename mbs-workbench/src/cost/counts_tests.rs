//! Counts and errors of all methods on a pendulum: a method that becomes dearer or less accurate fails here.
//!
//! `UPDATE_SNAPSHOTS=1` stores them anew in `counts.txt`.

use std::fmt::Write;
use std::{env, fs};

use super::tests::{AT_ONE, Pendulum, moved};
use crate::cost::reference::linear::worse;
use crate::setting::{MotionMethod, Numbers, Resolution, Setting};

/// Errors below it are rounding: 1e3 ε of the length of the pendulum.
const ROUNDED: f64 = 1e3 * f64::EPSILON;

/// Changes of errors and, on other targets than the default one, of counts.
const CHANGE: f64 = 0.02;

/// Target of the snapshot.
const IS_DEFAULT: bool = cfg!(all(target_arch = "x86_64", target_os = "linux"));

/// Evaluations, corrections, steps and the error at 1 s of a setting.
#[derive(Debug)]
struct Line {
    setting: String,
    counts: [f64; 3],
    error: f64,
}

fn lines() -> Vec<Line> {
    let mechanism = moved(Pendulum::default());
    let (numbers, runs) = &mechanism.runs[0];
    assert_eq!(*numbers, Numbers::Double);
    let mut lines = Vec::new();
    for method in MotionMethod::all().into_iter().filter(|method| runs.admits(*method)) {
        let resolutions = match method.is_adaptive() {
            true => [1e-4, 1e-7, 1e-10].map(Resolution::Tolerance).to_vec(),
            false => [240, 960].map(Resolution::Steps).to_vec(),
        };
        for resolution in resolutions {
            let setting = Setting::Motion { numbers: *numbers, method, resolution };
            let mut end = None;
            let effort = runs.run(method, resolution, &[0.0, 1.0], Some(&mut |seen| end = Some(seen)));
            let (effort, end) = (effort.expect("a motion"), end.expect("an end"));
            let error = end.q.iter().zip(AT_ONE).map(|(q, exact)| (q - exact).abs()).fold(0.0, worse);
            let counts = [effort.evaluations, effort.corrections, effort.steps].map(|count| count as f64);
            lines.push(Line { setting: setting.to_string(), counts, error });
        }
    }
    lines
}

fn read(line: &str) -> Option<Line> {
    let (setting, numbers) = line.rsplit_once(": ")?;
    let numbers: Vec<f64> = numbers.split(' ').filter_map(|number| number.parse().ok()).collect();
    let [evaluations, corrections, steps, error] = numbers[..] else { return None };
    Some(Line { setting: setting.to_string(), counts: [evaluations, corrections, steps], error })
}

/// Reasons why `found` is not as it was stored.
fn changes(found: &Line, stored: &Line) -> Vec<&'static str> {
    let near = |a: f64, b: f64| (a - b).abs() <= CHANGE * a.max(b);
    let mut changes = Vec::new();
    let names = ["evaluations", "corrections", "steps"];
    for ((name, found), stored) in names.into_iter().zip(found.counts).zip(stored.counts) {
        if !(found == stored || !IS_DEFAULT && near(found, stored)) {
            changes.push(name);
        }
    }
    let is_rounded = found.error <= ROUNDED && stored.error <= ROUNDED;
    if !(is_rounded || (found.error - stored.error).abs() <= (CHANGE * stored.error).max(ROUNDED)) {
        changes.push("error");
    }
    changes
}

#[test]
fn counts_and_errors_of_all_methods_are_as_stored() {
    let found = lines();
    assert!(found.len() >= 60, "{}", found.len());
    let mut text = "# Setting: evaluations, corrections, steps, error (m) at 1 s.\n".to_string();
    for Line { setting, counts: [evaluations, corrections, steps], error } in &found {
        let _ = writeln!(text, "{setting}: {evaluations} {corrections} {steps} {error:.4e}");
    }
    if env::var_os("UPDATE_SNAPSHOTS").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/cost/counts.txt");
        fs::write(path, &text).expect("a file");
        return;
    }
    let stored: Vec<Line> = include_str!("counts.txt").lines().filter_map(read).collect();
    let names = |lines: &[Line]| lines.iter().map(|line| line.setting.clone()).collect::<Vec<_>>();
    assert_eq!(names(&found), names(&stored));
    for (found, stored) in found.iter().zip(&stored) {
        assert!(
            changes(found, stored).is_empty(),
            "{:?}: {found:?}, stored {stored:?}",
            changes(found, stored)
        );
    }
}

#[test]
fn a_dearer_or_less_accurate_method_is_a_change() {
    let line = |evaluations: f64, error: f64| Line {
        setting: String::new(),
        counts: [evaluations, 2.0, 1.0],
        error,
    };
    let stored = line(1000.0, 1e-6);
    assert!(changes(&line(1000.0, 1.01e-6), &stored).is_empty());
    assert_eq!(changes(&line(1030.0, 1e-6), &stored), ["evaluations"]);
    assert_eq!(changes(&line(1000.0, 1.1e-6), &stored), ["error"]);
    assert_eq!(changes(&line(1000.0, 0.9e-6), &stored), ["error"]);
    assert!(changes(&line(1000.0, 1e-15), &line(1000.0, 2e-13)).is_empty());
}
