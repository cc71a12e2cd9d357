//! Emitted code against its peers, timed in one process.
//!
//! ```text
//! proof-peers ROUNDS kinematics|dynamics
//! ```
//!
//! Prints one line for each implementation of each problem. It has problem, name, largest difference from the reference,
//! and the time (ns) of an evaluation or a step in every round. Without rounds (0) nothing is timed.

mod dynamics;
mod evaluation;
mod measure;
mod released;
mod steps;
mod texts;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let rounds = arguments.first().and_then(|rounds| rounds.parse().ok());
    let (Some(rounds), Some(subject)) = (rounds, arguments.get(1)) else { return usage() };
    let problems = match subject.as_str() {
        "kinematics" => {
            [evaluation::four_bar, evaluation::andrews, evaluation::chain, steps::four_bar, steps::chain]
                .to_vec()
        }
        "dynamics" => [
            dynamics::squeezer_rates,
            dynamics::n_four_bar_rates,
            dynamics::squeezer_motions,
            dynamics::n_four_bar_motions,
        ]
        .to_vec(),
        _ => return usage(),
    };
    for problem in problems {
        measure::compare(&mut problem(), rounds);
    }
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    eprintln!("usage: proof-peers ROUNDS kinematics|dynamics");
    ExitCode::FAILURE
}
