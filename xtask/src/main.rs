//! Tasks of the project: `cargo xtask TASK`.

mod browser;
mod checks;
mod costs;
mod documents;
mod fuzz;
mod growth;
mod instructions;
mod lines;
mod mutants;
mod planted;
mod shell;
mod words;

use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask TASK

ci                       what a change must pass: format, lints, documents, tests, counts of instructions, hard cases
full [PART…]             ci, long (tests with this feature), optimised, browser, book, package, growth, lines, costs, hard-cases, planted, fuzz,
                         oldest (Rust 1.89 where it is installed): all, or these
bench [OPTIONS]          kinematics, dynamics and linkages against their peers; `--docs` writes the tables of the book
growth                   times that a compiler takes over long mechanisms
instructions [--update]  instructions of evaluations and steps, compared with the stored counts or stored
lines [--update]         lines of LLVM code that the workbench costs a mechanism, compared with the stored ones or stored
docs                     documentation of all crates without warnings, doc tests of README and book, the book
browser                  reports of all mechanisms in headless Chromium
costs                    `mbs cost` of all mechanisms, and of the pendulum with other programs
fuzz [SECONDS] [--keep]  texts and calls by chance, a minute for each of three targets or as long as asked; `--keep` stores new inputs
planted [FAULT…]         planted faults: each must turn a cell of the matrix of hard cases to wrong
mutants [MINUTES]        judges changes of the sources that `xtask/mutants/sample.txt` lists, by tests that must fail, for an hour or as long as
                         asked; `mutants --sample SEED` draws a new list
package                  packages of all crates, each compiled as a registry would have it
words [--count]          reader's aid: doc comments that begin with a question word, sentences of more than 25 words";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (task, options) = match arguments.split_first() {
        Some((task, options)) => (task.as_str(), options),
        None => ("help", &[][..]),
    };
    let options: Vec<&str> = options.iter().map(String::as_str).collect();
    let done = match (task, &options[..]) {
        ("help" | "--help" | "-h", []) => {
            println!("{USAGE}");
            Ok(())
        }
        ("ci", []) => checks::ci(),
        ("full", parts) => checks::full(parts),
        ("bench", options) => checks::bench(options),
        ("growth", []) => growth::run(),
        ("instructions", []) => instructions::run(false),
        ("instructions", ["--update"]) => instructions::run(true),
        ("lines", []) => lines::run(false),
        ("lines", ["--update"]) => lines::run(true),
        ("docs", []) => documents::all(),
        ("browser", []) => browser::run(),
        ("costs", []) => costs::peers().and_then(|()| costs::index()),
        ("fuzz", []) => fuzz::run(60, false),
        ("fuzz", [seconds, rest @ ..]) if matches!(rest, [] | ["--keep"]) => {
            let number = seconds.parse().map_err(|_| format!("`{seconds}` is no number of seconds"));
            number.and_then(|seconds| fuzz::run(seconds, !rest.is_empty()))
        }
        ("planted", names) => planted::run(names),
        ("mutants", []) => mutants::judged(60),
        ("mutants", ["--sample", seed]) => seed
            .parse()
            .map_err(|_| format!("`{seed}` is no seed: a whole number"))
            .and_then(mutants::sampled),
        ("mutants", [minutes]) => minutes
            .parse()
            .map_err(|_| format!("`{minutes}` is no number of minutes"))
            .and_then(mutants::judged),
        ("package", []) => documents::package(),
        ("words", []) => words::run(false),
        ("words", ["--count"]) => words::run(true),
        _ => Err(format!("unknown task `{}`\n\n{USAGE}", arguments.join(" "))),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}
