//! The program `mbs` as a person meets it.

mod arguments;
mod motions;
mod pages;
mod rest;
mod verify;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// A directory of this test alone, removed with its owner.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        Scratch(path)
    }

    /// A file of the report; of a table what stands below the line that names its origin.
    fn text(&self, file: &str) -> String {
        let text = fs::read_to_string(self.0.join(file)).expect("a file of the report");
        match text.strip_prefix("# mbs ").and_then(|rest| rest.split_once('\n')) {
            Some((_, table)) => table.to_string(),
            None => text,
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn mbs(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mbs-catalogue")).args(arguments).output().expect("the program starts")
}

fn run_into(scratch: &Scratch, arguments: &[&str]) -> Output {
    let directory = scratch.0.to_str().expect("a path of the build");
    mbs(&[arguments, &["--out", directory]].concat())
}

#[track_caller]
fn standard_output(output: Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{:?}: {errors}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The message of a command that must fail with `code`, without a panic and with nothing on standard output.
#[track_caller]
fn failure(output: Output, code: i32) -> String {
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "");
    message
}

fn cells(line: &str) -> Vec<f64> {
    line.split(',').skip(1).map(|cell| cell.parse().expect("a number")).collect()
}

#[test]
fn a_text_with_one_scene_in_the_list_goes_by_its_name() {
    let structure = |name: &str| standard_output(mbs(&["structure", name]));
    assert_eq!(structure("slider_crank_engine"), structure("slider_crank_engine:Tight"));
    let message = failure(mbs(&["structure", "slider_crank_mass"]), 2);
    assert!(message.contains("slider_crank_mass:Driven"), "{message}");
}

#[test]
fn without_arguments_the_four_bar_runs_one_turn() {
    let text = standard_output(mbs(&[]));
    for part in
        ["Four-bar", "coupler curve", "open assembly", "crossed assembly", "iterations", "closure error"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let path = text.lines().find_map(|line| line.strip_prefix("report  ")).expect("where the report is");
    assert!(fs::read_to_string(path).expect("the report").contains("<title>Four-bar"));
}

#[test]
fn the_list_names_every_mechanism_with_its_parameters() {
    let text = standard_output(mbs(&["list"]));
    for card in mechanisms::CATALOGUE.fixed() {
        let title = card.picture().expect("a text").title;
        assert!(text.contains(&card.name()) && text.contains(&title), "{text}");
    }
    assert!(text.contains("omega=30 rad/s"), "{text}");
}

#[test]
fn every_mechanism_runs_and_writes_its_report() {
    for card in mechanisms::CATALOGUE.iter() {
        let (name, runs) = (card.name(), card.runs().expect("a text").len());
        let name = name.as_str();
        let scratch = Scratch::new(name);
        // Matrices of 163 rows, implicit steps of a millisecond and impacts take a moment each where nothing is optimised.
        let until = match name {
            "n_four_bar_10" | "n_four_bar_40" | "woodpecker" => &["--until", "0.1"][..],
            "governor" | "valve_spring" => &["--until", "0.01"],
            "bouncing_balls" | "bricard" | "door_with_closer" => &["--until", "1"],
            _ => &[],
        };
        standard_output(run_into(&scratch, &[&["run", name, "--steps", "24"], until].concat()));
        let values = scratch.text("motion.csv");
        assert_eq!(values.lines().count(), 1 + 25 * runs, "{name}");
        let columns = values.lines().next().map(|line| line.split(',').count());
        assert!(values.lines().all(|line| Some(line.split(',').count()) == columns));
        assert!(scratch.text("report.html").contains(&format!("\"name\":\"{name}\"")));
        let files = fs::read_dir(&scratch.0).expect("the directory").count();
        assert_eq!(files, 2, "only the report and its values");
    }
}

/// The number before ` J` or the unit in the line that begins with `name`.
#[track_caller]
fn figure(text: &str, name: &str) -> f64 {
    let line = text.lines().find_map(|line| line.trim().strip_prefix(name)?.strip_prefix(": "));
    let line = line.unwrap_or_else(|| panic!("no `{name}` in\n{text}"));
    line.split(' ').next().and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("{line}"))
}
