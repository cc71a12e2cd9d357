//! Emitted {Φ, Φ_q, Φ_t, γ} in one call against CasADi's generated C.
//!
//! ```text
//! cargo bench -p mbs-tests --bench evaluate
//! ```
//!
//! The lecture's four-bar with the same constants on both sides: ours through `Mechanism::evaluate`, release,
//! `target-cpu=native`; CasADi's C with `cc -O3 -march=native`, the faster of its plain code and of that with common
//! subexpressions eliminated. One process, 101 interleaved rounds, inputs walking along 256 states, outputs stored:
//! `tests/proofs/evaluation/main.c`. Prints a table and writes it to `bench/evaluate.md` below the target directory.
//!
//! Fails where the two differ by more than 1e-13 of a row's scale, or where CasADi's code is faster. On a busy
//! machine the spread is wide; the median holds. Needs Python 3 (for CasADi) and a C compiler.
#![forbid(unsafe_code)]

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use mbs_tests::{
    proofs::{self, Workshop},
    tools,
};
use mechanisms::verify::environment::Environment;

/// Every ratio is the median of so many.
const ROUNDS: &str = "101";

/// Largest difference from CasADi's numbers, relative to the largest value of the row.
const LARGEST_ERROR: f64 = 1e-13;

/// Names in `main.c`, what they are, and whether they have to be exact and at least as fast as CasADi.
const IMPLEMENTATIONS: [(&str, &str, Requirement); 8] = [
    ("casadi_plain", "CasADi C", Requirement::Exact),
    ("casadi_shared", "CasADi C, `cse`", Requirement::Exact),
    ("emitted", "**emitted**", Requirement::ExactAndFast),
    ("emitted_adjustable", "emitted, numbers as parameters", Requirement::ExactAndFast),
    ("emitted_lanes", "emitted, 8 lanes, per mechanism", Requirement::ExactAndFast),
    ("by_hand", "by hand in Rust, runtime's sine", Requirement::Exact),
    ("by_hand_c_library", "by hand in Rust, C library's sine", Requirement::Exact),
    ("differences", "central differences in Rust", Requirement::None),
];

#[derive(Clone, Copy, PartialEq)]
enum Requirement {
    None,
    Exact,
    ExactAndFast,
}

/// A line of the program's output.
struct Measurement {
    /// Median time of a call (ns).
    time: f64,
    /// CasADi's time over this one's: median, 10 % and 90 % of the rounds.
    ratio: [f64; 3],
    /// Largest difference from CasADi's plain code.
    error: f64,
}

fn main() -> ExitCode {
    // `cargo test --benches` runs this program too, without the argument.
    if !std::env::args().any(|argument| argument == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    match compare() {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn compare() -> Result<(), String> {
    let workshop = Workshop::new(env!("CARGO_TARGET_TMPDIR"), "proofs-native", "-C target-cpu=native");
    eprintln!("building the emitted code");
    let arguments = ["--profile=freestanding", "--package=proof-evaluation"];
    let library = workshop.build(&arguments, "freestanding/libproof_evaluation.a", "evaluation.a")?;
    let program = program(workshop.target(), &library)?;
    eprintln!("measuring {ROUNDS} rounds");
    let measured = tools::output(Command::new(program).arg(ROUNDS), "it was built a moment ago")?;
    let mut table = String::from(
        "| {Φ, Φ_q, Φ_t, γ} of the four-bar | ns | CasADi C / this | 10 … 90 % | error |\n|---|---|---|---|---|\n",
    );
    let mut faults = Vec::new();
    for (name, title, requirement) in IMPLEMENTATIONS {
        let Measurement { time, ratio: [median, low, high], error } = measurement(&measured, name)?;
        table += &format!("| {title} | {time:.1} | {median:.2} | {low:.2} … {high:.2} | {error:.1e} |\n");
        // Both are false for NaN.
        let (exact, fast) = (error <= LARGEST_ERROR, median >= 1.0);
        if requirement != Requirement::None && !exact {
            faults.push(format!("{title}: differs from CasADi by {error:e}, allowed are {LARGEST_ERROR:e}"));
        }
        if requirement == Requirement::ExactAndFast && !fast {
            faults.push(format!("{title}: CasADi's code is faster, {median:.2}"));
        }
    }
    println!("{table}");
    save(&table)?;
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n")) }
}

/// CasADi's C, the emitted code and the program that times them, linked.
fn program(directory: &Path, library: &Path) -> Result<std::path::PathBuf, String> {
    let environment = Environment::ready(&|step| eprintln!("{step}")).map_err(|error| error.to_string())?;
    let sources = proofs::directory().join("evaluation");
    let definition = proofs::directory().join("../casadi/four_bar.py");
    let mut generate = Command::new(environment.python());
    generate.arg(sources.join("casadi_four_bar.py")).arg(definition).arg(directory);
    tools::output(
        &mut generate,
        "the Python environment is broken: delete `mbs-oracle` below the target directory",
    )?;
    let program = directory.join("evaluation");
    let mut include = OsString::from("-I");
    include.push(directory);
    let files = [sources.join("main.c"), directory.join("casadi_plain.c"), directory.join("casadi_shared.c")];
    let mut arguments: Vec<&OsStr> = ["-O3", "-march=native", "-o"].map(OsStr::new).to_vec();
    arguments.extend([program.as_os_str(), include.as_os_str()]);
    arguments.extend(files.iter().map(|file| file.as_os_str()));
    arguments.extend([library.as_os_str(), OsStr::new("-lm")]);
    tools::compile(&arguments)?;
    Ok(program)
}

fn measurement(measured: &str, name: &str) -> Result<Measurement, String> {
    let line = measured.lines().find(|line| line.split(' ').next() == Some(name));
    let numbers: Vec<f64> =
        line.unwrap_or_default().split(' ').skip(1).filter_map(|number| number.parse().ok()).collect();
    match numbers[..] {
        [time, median, low, high, error] => Ok(Measurement { time, ratio: [median, low, high], error }),
        _ => Err(format!("`{name}` was not measured:\n{measured}")),
    }
}

/// Writes the table to `bench/evaluate.md` below the target directory.
fn save(table: &str) -> Result<(), String> {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("bench");
    let file = directory.join("evaluate.md");
    let written = fs::create_dir_all(&directory).and_then(|()| fs::write(&file, table));
    written.map_err(|error| format!("cannot write {}: {error}", file.display()))?;
    println!("written to {}", file.display());
    Ok(())
}
