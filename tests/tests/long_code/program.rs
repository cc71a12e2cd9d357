//! Mechanisms cut as long ones, compared with themselves in one piece.

use std::sync::atomic::{AtomicU32, Ordering};

use mbs_runtime::dynamics::{Explicit, RungeKutta4, Simulation, VelocityTransformation};
use mbs_runtime::{Dynamic, Function, Kinematic, Lanes, Mechanism, Partitioned, Real, Scalar, Stepper};

/// Both do the same operations; loops over blocks may leave an iteration of Newton's method out, or do one more.
const ROUNDING: f64 = 1e-11;

/// Steps of each motion.
const STEPS: usize = 100;

fn main() {
// COMPARISONS
}

/// Functions of an array, each another one: sin(k + x) with k from 1 to 12 in the order in which they are made.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Law(f64);

impl Default for Law {
    fn default() -> Self {
        static MADE: AtomicU32 = AtomicU32::new(0);
        Law(f64::from(MADE.fetch_add(1, Ordering::Relaxed) % 12 + 1))
    }
}

impl<T: Scalar> Function<T> for Law {
    const ORDER: usize = 4;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let ([sine], [cosine]) = T::sin_cos([T::constant(self.0) + x]);
        std::array::from_fn(|order| [sine, cosine, -sine, -cosine][order % 4])
    }
}

/// Positions, velocities and accelerations of driven motion.
fn turn<S: Kinematic<f64, N, M> + Default, const N: usize, const M: usize>() -> Vec<f64> {
    let mechanism = S::default();
    let guess = mechanism.guess(&mechanism.parameters());
    let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("an assembly");
    let mut motion = Vec::new();
    for _ in 0..STEPS {
        stepper.advance(0.007).expect("a step");
        motion.extend([stepper.q(), stepper.qd(), stepper.qdd()].into_iter().flatten());
    }
    motion
}

/// Positions, velocities and multipliers of motion from forces.
fn fall<S, const N: usize, const M: usize>() -> Vec<f64>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default + Copy,
{
    let method = Explicit::new(RungeKutta4, VelocityTransformation);
    let mut run = Simulation::start_from_text(S::default(), method, 0.0).expect("a start");
    let mut motion = Vec::new();
    for _ in 0..STEPS {
        run.step(0.001).expect("a step");
        motion.extend(run.q().iter().chain(run.qd()).chain(run.lambda()));
    }
    motion
}

/// All functions at a position near the guess with some rates, by their bits.
fn evaluated<T: Scalar, S: Mechanism<T, N, M> + Default, const N: usize, const M: usize>() -> Vec<u64> {
    let mechanism = S::default();
    let p = mechanism.parameters();
    let beside = |index: usize, lane: usize| 0.1 * (1.7 * index as f64 + 0.9 * lane as f64).sin();
    let rates: [T; N] = std::array::from_fn(|index| T::from_lanes(|lane| T::Real::constant(beside(index, lane))));
    let mut q = mechanism.guess(&p);
    q.iter_mut().zip(rates).for_each(|(q, beside)| *q = *q + beside);
    let s = mechanism.position(&p, &q, T::constant(0.3));
    let numbers = [
        mechanism.phi(&p, &s).to_vec(),
        mechanism.phi_q_entries(&p, &s).as_ref().to_vec(),
        mechanism.phi_t(&p, &s).to_vec(),
        mechanism.phi_tt(&p, &s).to_vec(),
        mechanism.phi_qt_qd(&p, &s, &rates).to_vec(),
        mechanism.gamma(&p, &s, &rates).to_vec(),
    ];
    let lanes = |number: T| (0..T::LANES).map(move |lane| number.lane(lane).to_f64().to_bits());
    numbers.concat().into_iter().flat_map(lanes).collect()
}

fn same(name: &str, cut: &[u64], whole: &[u64]) {
    assert_eq!(cut, whole, "{name}");
    assert!(whole.iter().any(|bits| f64::from_bits(*bits).abs() > 0.1), "{name}");
    println!("{name}: {} numbers of the same bits", whole.len());
}

fn compared(name: &str, cut: Vec<f64>, whole: Vec<f64>) {
    assert_eq!(cut.len(), whole.len(), "{name}");
    let mut largest = 0.0_f64;
    for (cut, whole) in cut.iter().zip(&whole) {
        largest = largest.max((cut - whole).abs() / whole.abs().max(1.0));
    }
    assert!(largest <= ROUNDING, "{name}: {largest:e}");
    println!("{name}: {} numbers, largest difference {largest:.1e}", whole.len());
}

