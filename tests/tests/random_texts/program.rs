//! Random texts, compiled: `values` answers states on the standard input, `digits` compares with 50 digits.

use std::io::{self, BufRead, Write};

use mbs_runtime::{Mechanism, OutputValue};
use mechanisms::facade::Facade;
use mechanisms::verify::compare::compare_digits;
use mechanisms::verify::{Oracle, StandIn, Summary, generated_definition};

/// States compared in 50 digits.
const DIGITS_STATES: usize = 5;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("values") => answer(),
        _ => compare(),
    }
}

/// A line a state: the number of the text or scene, and the bits of q, q̇, q̈, t, variables; a line of bits comes back.
fn answer() {
    let mut out = io::BufWriter::new(io::stdout().lock());
    for line in io::stdin().lock().lines() {
        let line = line.expect("text");
        let mut words = line.split(' ');
        let scene: usize = words.next().and_then(|word| word.parse().ok()).expect("a scene");
        let bits = words.map(|word| u64::from_str_radix(word, 16).expect("bits"));
        let numbers: Vec<f64> = bits.map(f64::from_bits).collect();
        for value in of_scene(scene, &numbers) {
            write!(out, " {:x}", value.to_bits()).expect("a reader");
        }
        writeln!(out).expect("a reader");
    }
}

fn of_scene(scene: usize, numbers: &[f64]) -> Vec<f64> {
    match scene {
// VALUES
        _ => panic!("no scene {scene}"),
    }
}

/// Every function in the order of the oracle.
fn values<S: Mechanism<f64, N, M> + Default, const N: usize, const M: usize>(numbers: &[f64]) -> Vec<f64> {
    let array = |index: usize| <[f64; N]>::try_from(&numbers[index * N..][..N]).expect("N numbers");
    let (q, qd, qdd, t) = (array(0), array(1), array(2), numbers[3 * N]);
    let mut mechanism = S::default();
    for (index, value) in numbers[3 * N + 1..].iter().enumerate() {
        assert!(mechanism.set(index, *value), "variable {index}");
    }
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, &q, t);
    let branches = mechanism.branches(&parameters, &position);
    let outputs = mechanism.outputs(&parameters, &position, &qd, &qdd);
    let three = |y: &OutputValue<f64>| [Some(y.value), y.rate, y.acceleration].map(|x| x.unwrap_or(f64::NAN));
    let outputs: Vec<[f64; 3]> = outputs.as_ref().iter().map(three).collect();
    [
        &mechanism.phi(&parameters, &position)[..],
        mechanism.phi_q(&parameters, &position).as_flattened(),
        &mechanism.phi_t(&parameters, &position),
        &mechanism.phi_tt(&parameters, &position),
        &mechanism.phi_qt_qd(&parameters, &position, &qd),
        &mechanism.gamma(&parameters, &position, &qd),
        branches.as_ref(),
        outputs.as_flattened(),
    ]
    .concat()
}

fn compare() {
    let oracle = Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let mut summary = Summary::default();
// DIGITS
    println!("{summary}");
}

fn digits<S: Mechanism<f64, N, M> + Default, const N: usize, const M: usize>(
    oracle: &Oracle,
    summary: &mut Summary,
) {
    let mut facade = Facade::<S, N, M>(S::default());
    let definition = generated_definition(&facade).unwrap_or_else(|error| panic!("{error}"));
    let agreement = compare_digits(&mut facade, oracle, &definition, DIGITS_STATES);
    let agreement = agreement.unwrap_or_else(|error| panic!("{error}"));
    assert!(agreement.holds(), "{agreement}");
    summary.add(agreement);
}

