//! Random texts, compiled: `values` answers states on the standard input, `digits` compares with 50 digits.

use std::io::{self, BufRead, Write};

use mbs_runtime::{Dynamic, DynamicState, Mechanism, OutputValue};
use mbs_workbench::erased::facade::Facade;
use mbs_workbench::verify::compare::compare_digits;
use mbs_workbench::verify::{Oracle, StandIn, Summary, generated_definition};

/// States compared in 50 digits.
const DIGITS_STATES: usize = 5;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("values") => answer(),
        _ => compare(),
    }
}

/// Reads one line for each state: the number of the text or scene, then the bits of q, q̇, q̈, t, λ and states (with masses),
/// variables. Answers with a line of bits.
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

/// The numbers of a state.
struct Numbers<'a, const N: usize> {
    q: [f64; N],
    qd: [f64; N],
    qdd: [f64; N],
    t: f64,
    rest: &'a [f64],
}

impl<'a, const N: usize> Numbers<'a, N> {
    fn of(numbers: &'a [f64]) -> Self {
        let array = |index: usize| <[f64; N]>::try_from(&numbers[index * N..][..N]).expect("N numbers");
        Numbers { q: array(0), qd: array(1), qdd: array(2), t: numbers[3 * N], rest: &numbers[3 * N + 1..] }
    }
}

fn set<S: Mechanism<f64, N, M> + Default, const N: usize, const M: usize>(variables: &[f64]) -> S {
    let mut mechanism = S::default();
    for (index, value) in variables.iter().enumerate() {
        assert!(mechanism.set(index, *value), "variable {index}");
    }
    mechanism
}

fn values<S: Mechanism<f64, N, M> + Default, const N: usize, const M: usize>(numbers: &[f64]) -> Vec<f64> {
    let numbers = Numbers::of(numbers);
    kinematics::<S, N, M>(&set(numbers.rest), &numbers)
}

/// Those of a text with masses.
fn with_masses<S, const N: usize, const M: usize>(numbers: &[f64]) -> Vec<f64>
where
    S: Dynamic<f64, N, M> + Default,
{
    let numbers = Numbers::<N>::of(numbers);
    let (lambda, rest) = numbers.rest.split_first_chunk::<M>().expect("M multipliers");
    let (states, variables) = rest.split_at(S::STATES.len());
    let mechanism: S = set(variables);
    let p = mechanism.parameters();
    let mut z = mechanism.start_states(&p);
    z.as_mut().copy_from_slice(states);
    let Numbers { q, qd, qdd, t, .. } = &numbers;
    let here = mechanism.position(&p, q, *t);
    let energy = mechanism.energy(&p, &here, qd);
    let motion = DynamicState { qd, qdd, lambda, states: &z };
    let (row, right) = mechanism.third_derivative(&p, &here, qd, lambda).expect("no declared function");
    [
        &kinematics::<S, N, M>(&mechanism, &numbers)[..],
        mechanism.mass(&p, &here).as_flattened(),
        &mechanism.mass_times(&p, &here, qdd),
        &mechanism.force(&p, &here, qd, &z, lambda),
        &mechanism.reaction(&p, &here, lambda),
        mechanism.force_q(&p, &here, qd, &z, lambda).as_flattened(),
        mechanism.force_qd(&p, &here, qd, &z, lambda).as_flattened(),
        mechanism.mass_times_q(&p, &here, qdd).as_flattened(),
        mechanism.reaction_q(&p, &here, lambda).as_flattened(),
        &row,
        &[right],
        &[energy.kinetic, energy.potential],
        mechanism.powers(&p, &here, qd, &z, lambda).as_ref(),
        mechanism.state_rates(&p, &here, qd, &z, lambda).as_ref(),
        mechanism.loads(&p, &here, &motion).as_ref(),
    ]
    .concat()
}

/// Every function of the kinematics in the order of the oracle.
fn kinematics<S: Mechanism<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    Numbers { q, qd, qdd, t, .. }: &Numbers<'_, N>,
) -> Vec<f64> {
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, q, *t);
    let branches = mechanism.branches(&parameters, &position);
    let outputs = mechanism.outputs(&parameters, &position, qd, qdd);
    let three = |y: &OutputValue<f64>| [Some(y.value), y.rate, y.acceleration].map(|x| x.unwrap_or(f64::NAN));
    let outputs: Vec<[f64; 3]> = outputs.as_ref().iter().map(three).collect();
    [
        &mechanism.phi(&parameters, &position)[..],
        mechanism.phi_q(&parameters, &position).as_flattened(),
        &mechanism.phi_t(&parameters, &position),
        &mechanism.phi_tt(&parameters, &position),
        &mechanism.phi_qt_qd(&parameters, &position, qd),
        &mechanism.gamma(&parameters, &position, qd),
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

fn digits<S: Mechanism<f64, N, M> + Default + 'static, const N: usize, const M: usize>(
    oracle: &Oracle,
    summary: &mut Summary,
) {
    let mut facade = Facade::<S, N, M>::of(S::default());
    let definition = generated_definition(&facade).unwrap_or_else(|error| panic!("{error}"));
    let agreement = compare_digits(&mut facade, oracle, &definition, DIGITS_STATES);
    let agreement = agreement.unwrap_or_else(|error| panic!("{error}"));
    assert!(agreement.holds(), "{agreement}");
    summary.add(agreement);
}

