//! Mechanisms cut as long ones beside themselves in one piece.

use mbs_runtime::dynamics::{Explicit, RungeKutta4, Simulation, VelocityTransformation};
use mbs_runtime::{Dynamic, Kinematic, Partitioned, Stepper};

/// Both do the same operations; loops over blocks may leave an iteration of Newton's method out, or do one more.
const ROUNDING: f64 = 1e-11;

/// Steps of each motion.
const STEPS: usize = 100;

fn main() {
// COMPARISONS
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

fn compared(name: &str, cut: Vec<f64>, whole: Vec<f64>) {
    assert_eq!(cut.len(), whole.len(), "{name}");
    let mut largest = 0.0_f64;
    for (cut, whole) in cut.iter().zip(&whole) {
        largest = largest.max((cut - whole).abs() / whole.abs().max(1.0));
    }
    assert!(largest <= ROUNDING, "{name}: {largest:e}");
    println!("{name}: {} numbers, largest difference {largest:.1e}", whole.len());
}

