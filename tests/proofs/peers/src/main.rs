//! Emitted code against its peers, timed in one process.
//!
//! ```text
//! proof-peers [ROUNDS]
//! ```
//!
//! Prints one line for each implementation of each problem: problem, name, largest difference from the reference, and
//! the time (ns) of an evaluation or a step in every round.

mod evaluation;
mod measure;
mod steps;
mod texts;

use std::process::ExitCode;

fn main() -> ExitCode {
    let rounds = std::env::args().nth(1).map_or(Ok(101), |rounds| rounds.parse());
    let Ok(rounds) = rounds else {
        eprintln!("usage: proof-peers [ROUNDS]");
        return ExitCode::FAILURE;
    };
    for mut cases in [evaluation::four_bar(), evaluation::andrews(), evaluation::chain()] {
        measure::compare(&mut cases, rounds);
    }
    for mut cases in [steps::four_bar(), steps::chain()] {
        measure::compare(&mut cases, rounds);
    }
    ExitCode::SUCCESS
}
