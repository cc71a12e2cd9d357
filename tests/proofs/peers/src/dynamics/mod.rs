//! Motion from forces: accelerations of one state, and whole motions to a given accuracy.

mod casadi;
mod cvodes;
mod dense;
mod emitted;
mod pendulum;
mod squeezer;

pub use pendulum::{motions as n_four_bar_motions, rates as n_four_bar_rates};
pub use squeezer::{motions as squeezer_motions, rates as squeezer_rates};

use std::hint::black_box;

use crate::measure::Case;

/// Coordinates and velocities.
#[derive(Clone, Copy)]
pub struct State<const N: usize> {
    pub q: [f64; N],
    pub qd: [f64; N],
}

/// Accelerations of states along a motion.
struct Accelerations<const N: usize> {
    group: &'static str,
    states: Vec<State<N>>,
    /// Reference accelerations, independently computed.
    expected: Vec<[f64; N]>,
}

impl<const N: usize> Accelerations<N> {
    /// `rates` gives the accelerations of a state; it is called through a pointer, so that no caller's knowledge enters it.
    fn case(&self, name: &'static str, rates: impl Fn(&State<N>) -> [f64; N] + 'static) -> Case {
        let rates: Box<dyn Fn(&State<N>) -> [f64; N]> = Box::new(rates);
        let found: Vec<[f64; N]> = self.states.iter().map(&rates).collect();
        let states = self.states.clone();
        let run = move || {
            for state in black_box(&states) {
                black_box(black_box(&rates)(state));
            }
        };
        let (work, error) = (self.states.len() as u32, self.error(&found));
        Case { group: self.group, name, work, error, run: Box::new(run) }
    }

    /// Largest difference from the reference, over the largest acceleration of all states.
    fn error(&self, found: &[[f64; N]]) -> f64 {
        let scale = self.expected.iter().flatten().fold(0.0_f64, |scale, value| scale.max(value.abs()));
        let pairs = self.expected.iter().flatten().zip(found.iter().flatten());
        pairs.fold(0.0, |largest, (expected, found)| larger(largest, (expected - found).abs() / scale))
    }
}

/// The larger one; a NaN stays.
fn larger(largest: f64, error: f64) -> f64 {
    if error <= largest { largest } else { error }
}

/// A way to a motion's end with one tolerance of several.
struct Attempt {
    name: &'static str,
    /// Largest difference from the reference on the way.
    error: f64,
    run: Box<dyn FnMut()>,
}

/// The first attempt of each name that is within `limit`; if none is, the last one.
///
/// Attempts come with their tolerances falling, so that the first one is the fastest; choosing by a measured time would
/// choose another one in every run.
fn exact_enough(group: &'static str, limit: f64, attempts: Vec<Attempt>) -> Vec<Case> {
    let mut chosen: Vec<Case> = Vec::new();
    for Attempt { name, error, run } in attempts {
        let case = Case { group, name, work: 1, error, run };
        match chosen.iter_mut().find(|other| other.name == name) {
            Some(other) if other.error <= limit => {}
            Some(other) => *other = case,
            None => chosen.push(case),
        }
    }
    chosen
}
