//! `mbs table` as a person meets it, and the constant that it prints as the compiler meets it.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mbs_runtime::Function;
use mbs_workbench::tables::sample;

mod valve_lift {
    include!("data/valve_lift.rs");
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn mbs(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"));
    command
        .current_dir(path("../mbs-workbench/data"))
        .arg("table")
        .args(arguments)
        .output()
        .expect("the program starts")
}

#[track_caller]
fn standard_output(output: Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{:?}: {errors}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[track_caller]
fn failure(output: Output, code: i32) -> String {
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(!message.contains("panicked") && output.stdout.is_empty(), "{message}");
    message
}

/// The number after `before`.
#[track_caller]
fn figure(text: &str, before: &str) -> f64 {
    let behind = text.split(before).nth(1).unwrap_or_else(|| panic!("{before} is missing in {text}"));
    behind.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a number")
}

const LIFT: [&str; 4] = ["valve_lift.csv", "--periodic", "--knots", "48"];

#[test]
fn a_table_is_summed_up_and_drawn() {
    let picture = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("valve_lift.svg");
    let out = picture.to_str().expect("a path of the build");
    let text = standard_output(mbs(&[&LIFT[..], &["--columns", "deg, mm", "--out", out]].concat()));
    assert!(text.contains("points    360: lift (mm) over cam angle, 0.000000 to 359.000000 deg"), "{text}");
    assert!(text.contains("periodic quintic, 48 knots, 4 continuous derivatives"), "{text}");
    // A gauge of 1 µm rounds by half of it, and the fit adds its own error.
    assert!(figure(&text, "at most ") < 1.5e-6 && figure(&text, "root mean square ") < 5e-7, "{text}");
    // Noise in the second derivative grows like the power 5/2 of the number of knots: 7.5^2.5 = 154. The two splines treat the
    // shortest waves differently, for which half of it is allowed.
    let factor = text.lines().find_map(|line| line.trim().split_once(" times less")).expect("a comparison");
    assert!(factor.0.parse::<f64>().is_ok_and(|factor| factor > 77.0), "{text}");
    let svg = fs::read_to_string(&picture).expect("the picture");
    assert_eq!((svg.matches("class=\"curve\"").count(), svg.matches("<circle").count()), (3, 360));
    assert!(svg.contains("second derivative (m/rad^2)"));
}

#[test]
fn the_constant_is_what_the_program_prints() {
    let printed = standard_output(mbs(&[&LIFT[..], &["--rust", "LIFT"]].concat()));
    let stored = path("tests/data/valve_lift.rs");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&stored, &printed).expect("the folder is there");
    }
    assert_eq!(
        printed,
        fs::read_to_string(stored).expect("the constant"),
        "UPDATE_SNAPSHOTS=1 writes it anew"
    );
}

#[test]
fn the_constant_is_the_law_behind_the_table() {
    let law = sample::law().expect("a law");
    for step in 0..1000 {
        let x = TAU * f64::from(step) / 1000.0;
        let (found, expected) = (valve_lift::LIFT.derivatives(x), law.jet::<4>(x));
        // Half a micrometre of rounding; derivatives by their largest values, 0.011 m/rad and 0.025 m/rad².
        let bounds = [1e-6, 0.011 * 2e-3, 0.025 * 2e-2];
        for order in 0..3 {
            let error = (found[order] - expected[order]).abs();
            assert!(error < bounds[order], "order {order} at {x}: {error:e}");
        }
    }
    assert_eq!(<mbs_runtime::driver::PeriodicQuintic<48> as Function<f64>>::ORDER, 4);
}

#[test]
fn an_open_table_is_a_cubic_spline() {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("ramp.csv");
    let rows: String =
        (0..=20).map(|k| format!("{};{}\r\n", k, f64::from(k * k).to_string().replace('.', ","))).collect();
    fs::write(&file, format!("\u{feff}Zeit (ms);Weg (mm)\r\n{rows}")).expect("a scratch file");
    let name = file.to_str().expect("a path of the build");
    let svg = file.with_extension("svg");
    let text = standard_output(mbs(&[name, "--slopes", "0,40", "--out", svg.to_str().expect("a path")]));
    assert!(
        text.contains("points    21: Weg (mm) over Zeit") && text.contains("cubic, 21 knots, 2 continuous"),
        "{text}"
    );
    let constant = standard_output(mbs(&[name, "--rust", "WAY"]));
    assert!(constant.contains("pub const WAY: ::mbs_runtime::driver::CubicSpline<21>"), "{constant}");
}

#[test]
fn faults_name_the_line_and_the_cure() {
    let scratch = |name: &str, text: &str| {
        let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::write(&file, text).expect("a scratch file");
        file.to_str().expect("a path of the build").to_string()
    };
    let bad = scratch("bad.csv", "angle,lift\n0,1\n1,x\n");
    let message = failure(mbs(&[&bad, "--columns", "deg, mm"]), 1);
    assert!(
        message.contains("line 3, column 2: `x` is not a number") && message.contains("help:"),
        "{message}"
    );
    let message = failure(mbs(&[&bad]), 1);
    assert!(message.contains("--columns"), "{message}");
    let open = scratch("open.csv", "0,0\n120,1\n240,2\n360,1.5\n");
    let message = failure(mbs(&[&open, "--columns", "deg, mm", "--periodic"]), 1);
    assert!(message.contains("line 4, column 2: the curve does not close"), "{message}");
    let message = failure(mbs(&[&open, "--columns", "deg, mm", "--knots", "9"]), 1);
    assert!(message.contains("--knots 4"), "{message}");
    let message = failure(mbs(&[&open, "--columns", "s, mm", "--periodic"]), 2);
    assert!(message.contains("--period"), "{message}");
    let message = failure(mbs(&[&open, "--columns", "deg, milimetre"]), 2);
    assert!(message.contains("milimetre"), "{message}");
    let message = failure(mbs(&["nowhere.csv"]), 1);
    assert!(message.contains("nowhere.csv: cannot be read"), "{message}");
    failure(mbs(&[&open, "--rust", "not a name"]), 2);
    failure(mbs(&[]), 2);
}
