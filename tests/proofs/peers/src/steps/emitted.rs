//! The runtime's stepper on emitted code.

use std::hint::black_box;

use mbs_runtime::{Batch, Kinematic, Lanes, Mechanism, Stepper};

use super::{Motion, STEP, STEPS, Turn};
use crate::measure::Case;

/// The assembled position at time 0, with its rates.
pub fn start<S: Kinematic<f64, N>, const N: usize>(mechanism: S, guess: [f64; N]) -> Motion<N> {
    motion(&assembled(mechanism, guess))
}

fn assembled<S: Kinematic<f64, N>, const N: usize>(mechanism: S, guess: [f64; N]) -> Stepper<S, f64, N> {
    Stepper::assemble(mechanism, guess, 0.0).expect("it can be assembled")
}

fn motion<S: Kinematic<f64, N>, const N: usize>(stepper: &Stepper<S, f64, N>) -> Motion<N> {
    Motion { q: *stepper.q(), qd: *stepper.qd(), qdd: *stepper.qdd() }
}

/// Steps of a turn from the same start.
pub fn turn<S, const N: usize>(turn: &Turn<N>, mechanism: S) -> Case
where
    S: Kinematic<f64, N> + Copy + 'static,
    Stepper<S, f64, N>: Clone,
{
    commanded("emitted", turn, mechanism, |_, _| {})
}

/// As [`turn`], with inputs that `command` sets before each step for the time of its end.
pub fn commanded<S, const N: usize>(
    name: &'static str,
    turn: &Turn<N>,
    mechanism: S,
    command: impl Fn(&mut Stepper<S, f64, N>, f64) + Copy + 'static,
) -> Case
where
    S: Kinematic<f64, N> + Copy + 'static,
    Stepper<S, f64, N>: Clone,
{
    let start = assembled(mechanism, turn.start.q);
    let step = move |stepper: &mut Stepper<S, f64, N>, k: u32| {
        let t = f64::from(k) * STEP;
        command(stepper, t);
        stepper.advance_to(t).expect("the mechanism is regular");
    };
    let mut stepper = start.clone();
    let ends = [1..=STEPS / 2, STEPS / 2 + 1..=STEPS].map(|steps| {
        steps.for_each(|k| step(&mut stepper, k));
        motion(&stepper)
    });
    let error = turn.error(&ends);
    let run = move || {
        let mut stepper = black_box(&start).clone();
        (1..=STEPS).for_each(|k| step(&mut stepper, k));
        black_box(stepper.q());
    };
    Case { group: turn.group, name, work: STEPS, error, run: Box::new(run) }
}

/// Steps of a turn of L mechanisms at once, each the L-th part of a turn (s) ahead of the one before.
pub fn lanes<S, const L: usize, const N: usize>(name: &'static str, turn: &Turn<N>, mechanism: S) -> Case
where
    S: Kinematic<Lanes<f64, L>, N> + Clone + 'static,
    S::Lane: Kinematic<f64, N> + 'static,
    <S as Mechanism<Lanes<f64, L>, N, N>>::Parameters: 'static,
{
    commanded_lanes::<S, L, N>(name, turn, mechanism, |_, _| {})
}

/// As [`lanes`], with inputs that `command` sets before each step for the times of the lanes' ends.
pub fn commanded_lanes<S, const L: usize, const N: usize>(
    name: &'static str,
    turn: &Turn<N>,
    mechanism: S,
    command: impl Fn(&mut Batch<S, f64, L, N>, [f64; L]) + Copy + 'static,
) -> Case
where
    S: Kinematic<Lanes<f64, L>, N> + Clone + 'static,
    S::Lane: Kinematic<f64, N> + 'static,
    <S as Mechanism<Lanes<f64, L>, N, N>>::Parameters: 'static,
{
    let assembled = Batch::assemble(mechanism, &[turn.start.q; L], [0.0; L]);
    let mut start = assembled.map_err(|(_, failure)| failure).expect("it can be assembled");
    let advance = move |batch: &mut Batch<S, f64, L, N>, times: [f64; L]| {
        command(batch, times);
        let steps = batch.advance_to(times);
        assert!(steps.iter().all(Result::is_ok), "the mechanism is regular");
    };
    let phases: [f64; L] = std::array::from_fn(|lane| lane as f64 / L as f64);
    for k in 1..=STEPS {
        advance(&mut start, phases.map(|phase| f64::from(k) * STEP * phase));
    }
    let step = move |batch: &mut Batch<S, f64, L, N>, k: u32| {
        advance(batch, phases.map(|phase| phase + f64::from(k) * STEP));
    };
    let mut batch = start.clone();
    let [half, whole] = [1..=STEPS / 2, STEPS / 2 + 1..=STEPS].map(|steps| {
        steps.for_each(|k| step(&mut batch, k));
        [0, L / 2].map(|lane| motion(&batch.stepper(lane).expect("a lane")))
    });
    // The lane in the middle is half a turn ahead: it ends the turn when the first is in the middle of it.
    let error = turn.error(&[half[0], whole[0]]).max(turn.error(&half));
    let run = move || {
        let mut batch = black_box(&start).clone();
        (1..=STEPS).for_each(|k| step(&mut batch, k));
        black_box(batch.q());
    };
    let work = STEPS * L as u32;
    Case { group: turn.group, name, work, error, run: Box::new(run) }
}
