//! Builds and runs `tests/proofs/peers`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mbs_tests::proofs::{self, Workshop};
use mbs_tests::tools;
use mbs_workbench::verify::environment::Environment;

use super::machine;

/// Python packages that generate the peers' C code, with versions.
pub const REQUIREMENTS: &str = include_str!("../../proofs/peers/requirements.txt");

/// Result of one implementation.
pub struct Implementation {
    /// Largest difference from the reference.
    pub error: f64,
    /// Time (ns) in each round.
    pub times: Vec<f64>,
}

/// Results of a target's code: problems, and implementations by name.
pub struct Measured {
    /// The compiler's flags in words.
    pub target: &'static str,
    /// Mean number of waiting programs in the minute before, if the system reports it.
    pub load: Option<String>,
    /// In the order of measuring.
    pub problems: Vec<(String, Vec<(String, Implementation)>)>,
}

/// Build settings of a program.
struct Target {
    /// In words.
    title: &'static str,
    /// Directory of the build.
    directory: &'static str,
    rust_flags: &'static str,
    c_flags: &'static str,
}

const TARGETS: [Target; 2] = [
    Target {
        title: "target-cpu=native",
        directory: "peers-native",
        rust_flags: "-C target-cpu=native",
        c_flags: "-march=native",
    },
    Target { title: "default target", directory: "peers-default", rust_flags: "", c_flags: "" },
];

/// Results for this processor, and for the default target.
///
/// # Errors
/// A message with the part that cannot be built, or with every implementation whose error exceeds `limit`. Errors are
/// checked before anything is timed.
pub fn all(subject: &str, rounds: &str, limit: Limit) -> Result<[Measured; 2], String> {
    let sources = sources()?;
    let [native, default] = &TARGETS;
    let programs = [program(native, &sources)?, program(default, &sources)?];
    let mut faults = Vec::new();
    for (target, program) in TARGETS.iter().zip(&programs) {
        eprintln!("comparing results, {}", target.title);
        faults.extend(measured(target, program, ["0", subject])?.faults(limit));
    }
    if !faults.is_empty() {
        return Err(faults.join("\n"));
    }
    let [native_program, default_program] = &programs;
    eprintln!("measuring {rounds} rounds for each target");
    Ok([
        measured(native, native_program, [rounds, subject])?,
        measured(default, default_program, [rounds, subject])?,
    ])
}

/// Largest error that is allowed, by problem and implementation.
pub type Limit = fn(&str, &str) -> f64;

/// The C code of CasADi and SymPy.
fn sources() -> Result<PathBuf, String> {
    let environment = Environment::ready_for(REQUIREMENTS, &|step| eprintln!("{step}"));
    let environment = environment.map_err(|error| error.to_string())?;
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("peers-sources");
    if let Err(error) = fs::remove_dir_all(&directory)
        && directory.exists()
    {
        return Err(format!("cannot remove {}: {error}", directory.display()));
    }
    eprintln!("generating the peers' code");
    let mut generate = Command::new(environment.python());
    generate.arg(proofs::directory().join("peers/generate.py")).arg(&directory);
    tools::output(
        &mut generate,
        "the Python environment is broken: delete `mbs-oracle` below the target directory",
    )?;
    Ok(directory)
}

fn program(target: &Target, sources: &Path) -> Result<PathBuf, String> {
    let mut workshop = Workshop::new(env!("CARGO_TARGET_TMPDIR"), target.directory, target.rust_flags);
    workshop.set("MBS_PEERS", sources.as_os_str());
    workshop.set("MBS_PEERS_FLAGS", target.c_flags.as_ref());
    eprintln!("building for the {}", target.title);
    workshop.build(&["--profile=freestanding", "--package=proof-peers"], "freestanding/proof-peers", "peers")
}

fn measured(target: &Target, program: &Path, arguments: [&str; 2]) -> Result<Measured, String> {
    let load = machine::load();
    let lines = tools::output(Command::new(program).args(arguments), "it was built a moment ago")?;
    let mut problems: Vec<(String, Vec<(String, Implementation)>)> = Vec::new();
    for line in lines.lines() {
        let mut words = line.split_whitespace();
        let (Some(problem), Some(name)) = (words.next(), words.next()) else { continue };
        let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
        let numbers = numbers.map_err(|error| format!("{line}: {error}"))?;
        let Some((error, times)) = numbers.split_first() else { continue };
        let found = (name.to_owned(), Implementation { error: *error, times: times.to_vec() });
        match problems.iter_mut().find(|(known, _)| known == problem) {
            Some((_, implementations)) => implementations.push(found),
            None => problems.push((problem.to_owned(), vec![found])),
        }
    }
    Ok(Measured { target: target.title, load, problems })
}

impl Measured {
    /// An implementation by problem and name.
    pub fn of(&self, problem: &str, name: &str) -> Option<&Implementation> {
        let (_, implementations) = self.problems.iter().find(|(known, _)| known == problem)?;
        implementations.iter().find(|(known, _)| known == name).map(|(_, implementation)| implementation)
    }

    /// Implementations whose error exceeds `limit`.
    fn faults(&self, limit: Limit) -> Vec<String> {
        let mut faults = Vec::new();
        for (problem, implementations) in &self.problems {
            for (name, Implementation { error, .. }) in implementations {
                let limit = limit(problem, name);
                // False for NaN.
                let exact = *error <= limit;
                if !exact {
                    let target = self.target;
                    faults
                        .push(format!("{problem}, {name}, {target}: error {error:e}, allowed are {limit:e}"));
                }
            }
        }
        faults
    }
}

impl Implementation {
    /// Median time (ns).
    pub fn time(&self) -> f64 {
        quantile(self.times.clone(), 0.5)
    }

    /// The peer's time over this one's, round by round: median, 10 %, 90 %.
    pub fn faster_than(&self, peer: &Implementation) -> [f64; 3] {
        let ratios: Vec<f64> = peer.times.iter().zip(&self.times).map(|(peer, own)| peer / own).collect();
        [0.5, 0.1, 0.9].map(|part| quantile(ratios.clone(), part))
    }
}

/// The smallest time of each round.
pub fn fastest(peers: &[&Implementation]) -> Implementation {
    let rounds = peers.iter().map(|peer| peer.times.len()).min().unwrap_or(0);
    let least = |round: usize| {
        peers
            .iter()
            .filter_map(|peer| peer.times.get(round))
            .fold(f64::INFINITY, |least, time| least.min(*time))
    };
    let error = peers.iter().fold(0.0, |error: f64, peer| error.max(peer.error));
    Implementation { error, times: (0..rounds).map(least).collect() }
}

fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = ((values.len().saturating_sub(1)) as f64 * part).round() as usize;
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// Names by which implementations are counted, in words.
pub fn titles() -> BTreeMap<&'static str, &'static str> {
    BTreeMap::from([
        ("casadi_plain", "CasADi C"),
        ("casadi_shared", "CasADi C, `cse`"),
        ("sympy", "SymPy C, `cse`"),
        ("by_hand", "by hand in Rust, runtime's sine"),
        ("by_hand_from_parts", "by hand in Rust, runtime's sine, α + φ2 from its parts"),
        ("by_hand_c_library", "by hand in Rust, C library's sine"),
        ("dual", "num-dual, forward"),
        ("differences", "central differences in Rust"),
        ("emitted", "**emitted**"),
        ("emitted_adjustable", "**emitted**, numbers as parameters"),
        ("emitted_lanes", "**emitted**, 8 lanes, a mechanism"),
        ("emitted_4_lanes", "**emitted**, 4 lanes, a mechanism"),
        ("emitted_40", "**emitted**, 40 loops"),
        ("emitted_with_inputs", "**emitted**, inputs set before each step"),
        ("emitted_lanes_with_inputs", "**emitted**, 8 lanes, inputs set before each step, a mechanism"),
        ("emitted_order_5", "**emitted**, order 5(4)"),
        ("emitted_order_8", "**emitted**, order 8(5,3)"),
        ("dense", "dense LU with multipliers, C by hand"),
        ("casadi_rates", "CasADi C, sparse QR with multipliers"),
        ("cvodes", "CVODES (Adams) on CasADi C"),
        ("casadi_previous", "CasADi `fast_newton`, from the previous position"),
        ("casadi_predicted", "CasADi `fast_newton`, from the prediction"),
        ("casadi_factored", "…, rates from one factorization"),
        ("nalgebra", "nalgebra dense Newton–Raphson, from the previous position"),
    ])
}
