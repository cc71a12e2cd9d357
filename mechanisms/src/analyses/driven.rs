//! Inverse dynamics: the forces of a motion that drives prescribe.

use mbs_runtime::dynamics::inverse;
use mbs_runtime::{Dynamic, Failure, Motion as Moving};

use super::determined;
use crate::facade::Motion;
use crate::motion::Forces;

/// Adds energies, loads and multipliers to the positions of `motion`, at which the rows hold.
pub(crate) fn add_forces<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    motion: &mut Motion,
) -> Result<(), Failure> {
    let mut mechanism = mechanism.clone();
    let mut forces = Forces::of(S::LOADS, S::ROWS);
    let mut before = None;
    for (index, t) in motion.time.iter().enumerate() {
        let q: [f64; N] = core::array::from_fn(|coordinate| motion.coordinates[coordinate].q[index]);
        // Drives that prescribe a rate: their phases take the steps that the motion took.
        match before.replace(*t) {
            None => mechanism.start_phases(&q, *t),
            Some(from) => mechanism.advance_phases(from, *t),
        }
        let driven = inverse(&mechanism, *t, &q)?;
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &driven.q, *t);
        let energy = mechanism.energy(&parameters, &position, &driven.qd);
        forces.push(energy, driven.loads.as_ref(), &driven.lambda);
        let states = mechanism.start_states(&parameters);
        let moving = Moving { qd: &driven.qd, qdd: &driven.qdd, lambda: &driven.lambda, states: &states };
        determined::push(&mut forces, &mechanism, (&parameters, &position), *t, &moving)?;
    }
    motion.dynamics = Some(forces);
    Ok(())
}
