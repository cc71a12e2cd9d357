//! Evaluations and steps of emitted code, for counting their instructions.
//!
//! ```text
//! proof-instructions WORK REPETITIONS
//! ```
//!
//! `.ci/instructions` runs each work twice and takes the difference, so that what comes before and after does not count.
//! Without arguments the names of the works are printed.

#[path = "../../peers/src/texts.rs"]
mod texts;

use std::hint::black_box;
use std::process::ExitCode;

use mbs_runtime::{Batch, Kinematic, Lanes, Mechanism, Stepper};
use texts::{Andrews, Chain10, Chain40, FourBar};

/// Time of a step (s).
const STEP: f64 = 1e-3;

const LANES: usize = 8;

/// A work by name, done so many times.
type Work = (&'static str, fn(u32));

const WORKS: [Work; 8] = [
    ("evaluate_four_bar", evaluate::<FourBar, 5>),
    ("evaluate_andrews", evaluate::<Andrews, 7>),
    ("evaluate_chain", evaluate::<Chain10, 22>),
    ("evaluate_four_bar_in_8_lanes", evaluate_lanes),
    ("step_four_bar", |count| steps(FourBar::default(), [0.0, 0.0, 0.0, 0.9, 1.8], count)),
    ("step_four_bar_in_8_lanes", batch),
    ("step_chain_of_10", |count| steps(Chain10::default(), upright(), count)),
    ("step_chain_of_40", |count| steps(Chain40::default(), upright(), count)),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [work, count] = &arguments[..] else {
        WORKS.iter().for_each(|(name, _)| println!("{name}"));
        return ExitCode::SUCCESS;
    };
    match (WORKS.iter().find(|(name, _)| name == work), count.parse()) {
        (Some((_, run)), Ok(count)) => run(count),
        _ => return ExitCode::FAILURE,
    }
    ExitCode::SUCCESS
}

/// Uprights upright.
fn upright<const N: usize>() -> [f64; N] {
    std::array::from_fn(|k| (k % 2) as f64)
}

fn evaluate<S: Mechanism<f64, N, N> + Default, const N: usize>(count: u32) {
    let (mechanism, q, qd) = (S::default(), [0.3; N], [0.7; N]);
    let parameters = mechanism.parameters();
    for k in 0..count {
        let t = f64::from(k) * STEP;
        black_box(mechanism.evaluate(black_box(&parameters), black_box(&q), t, black_box(&qd)));
    }
}

fn evaluate_lanes(count: u32) {
    let mechanism = FourBar::<Lanes<f64, LANES>>::default();
    let (q, qd) = ([Lanes([0.3; LANES]); 5], [Lanes([0.7; LANES]); 5]);
    let parameters = mechanism.parameters();
    for k in 0..count {
        let t = Lanes([f64::from(k) * STEP; LANES]);
        black_box(mechanism.evaluate(black_box(&parameters), black_box(&q), t, black_box(&qd)));
    }
}

fn steps<S: Kinematic<f64, N>, const N: usize>(mechanism: S, guess: [f64; N], count: u32) {
    let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("it can be assembled");
    for k in 1..=count {
        stepper.advance_to(f64::from(k) * STEP).expect("the mechanism is regular");
    }
    black_box(stepper.q());
}

fn batch(count: u32) {
    let guess = [[0.0, 0.0, 0.0, 0.9, 1.8]; LANES];
    let assembled = Batch::assemble(FourBar::default(), &guess, [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("it can be assembled");
    for k in 1..=count {
        let steps = batch.advance_to([f64::from(k) * STEP; LANES]);
        assert!(steps.iter().all(Result::is_ok), "the mechanism is regular");
    }
    black_box(batch.q());
}
