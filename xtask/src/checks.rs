//! Two tiers of checks: a change must pass the first, a release the second.

use std::process::{Command, Stdio};

use crate::shell::{command, exists, install, need, output, root, step};
use crate::{browser, costs, documents, fuzz, growth, lines, planted};

/// The oldest compiler that the workspace names.
const OLDEST: &str = "1.89";

/// Packages and tests, all where none is named, that have more to do with the feature `long`.
const LONG: [(&str, &str); 11] = [
    ("mbs-book", "pictures"),
    ("mbs-codegen", ""),
    ("mbs-motions", ""),
    ("mbs-cases", ""),
    ("mechanisms", "catalogue"),
    ("mechanisms", "effects"),
    ("mechanisms", "functions_of_files"),
    ("mechanisms", "lecture"),
    ("mbs-tests", "assembly"),
    ("mbs-tests", "proofs"),
    ("mbs-faults", ""),
];

/// Options of tests that are run with optimisation: the stack that code takes, and whole studies.
const OPTIMISED: [&[&str]; 2] = [
    &["-p", "mbs-motions", "--test", "stiff", "of_stack"],
    &["-p", "mechanisms", "--test", "catalogue", "--", "desmo::whole", "play"],
];

/// Format, lints, documentation, tests, counts of instructions, hard cases.
///
/// # Errors
/// The first step that fails, or a missing tool with its cure.
pub fn ci() -> Result<(), String> {
    need("python3", "install Python 3.11 or newer with venv")?;
    need("cc", "install a C compiler")?;
    need("nm", "install binutils")?;
    step(&mut command("cargo", &["fmt", "--all", "--check"]))?;
    built_once()?;
    step(&mut command("cargo", &["fmt", "--all", "--check", "--manifest-path", "tests/proofs/Cargo.toml"]))?;
    step(&mut command(
        "cargo",
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--features",
            "mbs-book/long,mbs-cases/long,mbs-codegen/long,mbs-faults/long,mbs-motions/long,mbs-tests/long,mechanisms/long",
            "--",
            "-D",
            "warnings",
        ],
    ))?;
    documents::rustdoc()?;
    step(&mut command("cargo", &["test", "--workspace", "--no-run"]))?;
    // Many tests keep one core busy. The other one counts instructions meanwhile, and runs hard cases.
    let counts = || {
        let own = std::env::current_exe().map_err(|error| format!("this program: {error}"))?;
        let counted = output(command(&own.display().to_string(), &["instructions"]).stdin(Stdio::null()))?;
        let judged = output(&mut hard_cases(&[], &["--cases", FEW_CASES]))?;
        Ok(counted + &judged)
    };
    let tests = || step(&mut command("cargo", &["test", "--workspace"]));
    let (tested, counted) = beside(tests, counts);
    println!("{}", counted.as_ref().map_or("", String::as_str));
    tested.and(counted.map(drop))
}

/// Cases of the first tier, one a kind of trouble: a program of all takes seven minutes of processor time to build. Their program is built
/// without optimisation, with the crates that the tests have built.
const FEW_CASES: &str = "change_point,lock_up,pendulum";

/// A part of [`full`]: its name and its checks.
type Part = (&'static str, fn() -> Result<(), String>);

/// Parts of [`full`] in their order.
const PARTS: [Part; 13] = [
    ("ci", ci),
    ("long", long),
    ("optimised", optimised),
    ("browser", browser::run),
    ("book", documents::book),
    ("package", documents::package),
    ("growth", growth::run),
    ("lines", || lines::run(false)),
    ("costs", || costs::peers().and_then(|()| costs::index())),
    ("hard-cases", || step(&mut hard_cases(&["--release"], &["--variants", "8"]))),
    ("planted", || planted::run(&[])),
    ("fuzz", || fuzz::run(60, false)),
    ("oldest", oldest),
];

/// All of [`ci`], and checks that take long or need further tools: all parts, or those of these `names`. A part that fails does not keep
/// the others from running.
///
/// # Errors
/// The parts that failed, an unknown name, or a missing tool with its cure.
pub fn full(names: &[&str]) -> Result<(), String> {
    if let Some(unknown) = names.iter().find(|name| PARTS.iter().all(|(part, _)| part != *name)) {
        let known = PARTS.map(|(part, _)| part).join(", ");
        return Err(format!("`full` has no part `{unknown}`\nknown: {known}"));
    }
    if names.is_empty() {
        // Before the checks that take long.
        need("npm", "install Node.js 20 or newer")?;
        documents::need_book()?;
        need("cargo-llvm-lines", "`cargo install cargo-llvm-lines`")?;
        need("cargo-fuzz", "`cargo install cargo-fuzz`")?;
    }
    let mut failed = Vec::new();
    for (name, run) in PARTS.iter().filter(|(part, _)| names.is_empty() || names.contains(part)) {
        println!("\n==== {name}");
        if let Err(reason) = run() {
            eprintln!("{name}: {reason}");
            failed.push(*name);
        }
    }
    match failed.as_slice() {
        [] => Ok(()),
        failed => Err(format!("failed; again: `cargo xtask full {}`", failed.join(" "))),
    }
}

/// Tests with the feature `long`: all of them, with those that fail.
fn long() -> Result<(), String> {
    let mut failed = Vec::new();
    for (package, test) in LONG {
        let only = ["--test", test];
        let only = if test.is_empty() { &[][..] } else { &only };
        let options = ["test", "-p", package, "--features", "long", "--no-fail-fast"];
        failed.extend(step(command("cargo", &options).args(only)).err());
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n")) }
}

/// Tests of optimised code.
fn optimised() -> Result<(), String> {
    for options in OPTIMISED {
        step(command("cargo", &["test", "--release"]).args(options))?;
    }
    Ok(())
}

/// The list of hard cases: it fails where one of its runs is wrong. `profile`: options of `cargo run`.
fn hard_cases(profile: &[&str], options: &[&str]) -> Command {
    let words = ["-p", "mbs-workbench", "--bin", "mbs", "--", "hard-cases", "--quick"];
    let mut run = command("cargo", &["run"]);
    run.args(profile).args(words).args(options);
    run
}

/// Results of two tasks at the same time.
fn beside<A, B: Send>(
    first: impl FnOnce() -> A,
    second: impl FnOnce() -> Result<B, String> + Send,
) -> (A, Result<B, String>) {
    std::thread::scope(|scope| {
        let second = scope.spawn(second);
        let first = first();
        (first, second.join().unwrap_or_else(|_| Err("a task ended by a panic".to_string())))
    })
}

/// Fails where a crate is built twice, for the macro and for the tests: with other features, or in another version.
fn built_once() -> Result<(), String> {
    let kinds = ["tree", "--workspace", "--edges", "normal,build,dev", "--duplicates", "--depth", "0"];
    println!("\n== crates that are built twice");
    let twice = output(&mut command("cargo", &kinds))?;
    if twice.trim().is_empty() { Ok(()) } else { Err(format!("built twice:\n{twice}")) }
}

/// Compiles with the oldest compiler, where rustup has it.
fn oldest() -> Result<(), String> {
    let listed = if exists("rustup") {
        output(&mut command("rustup", &["toolchain", "list"]))?
    } else {
        String::new()
    };
    let name = listed.lines().find(|name| name.starts_with(OLDEST)).and_then(|line| line.split(' ').next());
    let Some(name) = name else {
        println!(
            "\n== not run: a build with Rust {OLDEST}, which is not installed (`rustup toolchain install {OLDEST}`)"
        );
        return Ok(());
    };
    let mut check = command("rustup", &["run", name, "cargo", "check", "--workspace"]);
    step(check.env("CARGO_TARGET_DIR", crate::shell::target().join(OLDEST)))
}

/// Benches against peers, with their packages.
const BENCHES: [(&str, &str); 5] = [
    ("mbs-tests", "kinematics"),
    ("mbs-tests", "dynamics"),
    ("mbs-tests", "linkages"),
    ("mbs-tests", "formulations"),
    ("mbs-motions", "valvetrain"),
];

/// All benches against peers; `options` are theirs.
///
/// # Errors
/// A missing tool with its cure, or a bench that fails.
pub fn bench(options: &[&str]) -> Result<(), String> {
    need("python3", "install Python 3.11 or newer with venv")?;
    need("cc", "install a C compiler")?;
    for (package, bench) in BENCHES {
        let mut command = command("cargo", &["bench", "-p", package, "--bench", bench, "--"]);
        step(command.args(options).current_dir(root()))?;
    }
    if cfg!(target_arch = "x86_64") {
        install("valgrind", "valgrind")?;
        let counts = ["bench", "-p", "mbs-tests", "--bench", "linkages", "--", "--counts"];
        step(command("cargo", &counts).args(options).current_dir(root()))?;
    }
    Ok(())
}
