//! Random states and parameters, the same on every run and machine.

use core::f64::consts::PI;

use mbs_runtime::Entry;

use crate::erased::facade::{AnyEquations, State};
use crate::erased::masses::Loads;
use crate::random::Generator;

/// A state with the parameters and inputs it is taken at.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Coordinates, velocities, accelerations, time.
    pub state: State,
    /// Parameters and inputs in the order of the text.
    pub variables: Vec<f64>,
    /// First-order states and multipliers, where the text has masses.
    pub loads: Loads,
}

/// Seed of every comparison.
pub const SEED: u64 = 0x6D62_7331;

/// `count` random samples for the mechanism, whose parameters now are taken as nominal.
///
/// Angles are uniform in ±π; other coordinates 0.5 to 2 times their reference length, with random sign; other
/// parameters and inputs 0.5 to 2 times nominal, or in ±1 where nominal is 0; `q̇` within ±10 /s, `q̈` within
/// ±100 /s² of the coordinate's reference, `t` within ±1 s, first-order states and multipliers within ±10. The samples need not satisfy the constraints.
pub fn draw(mechanism: &dyn AnyEquations, count: usize) -> Vec<Sample> {
    let mut generator = Generator::new(SEED);
    let scales = mechanism.coordinate_scales();
    let nominal: Vec<f64> =
        (0..mechanism.variables().len()).map(|index| mechanism.get(index).unwrap_or(0.0)).collect();
    (0..count)
        .map(|_| Sample {
            state: state(&mut generator, mechanism.coordinates(), &scales),
            variables: variables(&mut generator, mechanism.variables(), &nominal),
            loads: mechanism.tables().map_or_else(Loads::default, |tables| {
                loads(&mut generator, tables.states.len(), mechanism.rows().len())
            }),
        })
        .collect()
}

fn loads(generator: &mut Generator, states: usize, rows: usize) -> Loads {
    let mut some = |count: usize| (0..count).map(|_| generator.uniform(-10.0, 10.0)).collect();
    Loads { states: some(states), lambda: some(rows) }
}

fn state(generator: &mut Generator, coordinates: &[Entry], scales: &[f64]) -> State {
    let mut state = State::default();
    for (coordinate, scale) in coordinates.iter().zip(scales) {
        state.q.push(if coordinate.is_angle() {
            generator.uniform(-PI, PI)
        } else {
            generator.sign() * generator.around(*scale)
        });
        state.qd.push(scale * generator.uniform(-10.0, 10.0));
        state.qdd.push(scale * generator.uniform(-100.0, 100.0));
    }
    state.t = generator.uniform(-1.0, 1.0);
    state
}

fn variables(generator: &mut Generator, entries: &[Entry], nominal: &[f64]) -> Vec<f64> {
    let draw = |(entry, nominal): (&Entry, &f64)| match (entry.is_angle(), *nominal) {
        (true, _) => generator.uniform(-PI, PI),
        (false, 0.0) => generator.uniform(-1.0, 1.0),
        (false, nominal) => generator.around(nominal),
    };
    entries.iter().zip(nominal).map(draw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_repeat_and_keep_their_ranges() {
        let entry = |name, unit| Entry { name, unit, line: 0 };
        let entries = [entry("phi", "rad"), entry("x", "m"), entry("u", "N")];
        let draw = || {
            let mut generator = Generator::new(SEED);
            let state = state(&mut generator, &entries[..2], &[1.0, 0.3]);
            (state, variables(&mut generator, &entries, &[0.5, 0.2, 0.0]))
        };
        let (state, variables) = draw();
        assert_eq!((state.clone(), variables.clone()), draw());
        assert!(state.q[0].abs() <= PI && (0.15..=0.6).contains(&state.q[1].abs()));
        assert!(variables[0].abs() <= PI && (0.1..=0.4).contains(&variables[1]) && variables[2].abs() <= 1.0);
    }
}
