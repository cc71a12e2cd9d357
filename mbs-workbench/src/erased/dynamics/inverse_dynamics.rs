//! Inverse dynamics: the forces of a motion that drives prescribe.

use mbs_runtime::dynamics::{Explicit, Simulation, inverse_with_states};
use mbs_runtime::{Dynamic, DynamicState, Failure};

use super::direct_dynamics::{AdaptiveRun, AnyFormulation, ENDS, Pair, advance_to};
use super::integrators::Integrators;
use super::{determined, power_balance};
use crate::erased::facade::Motion;
use crate::motion::Forces;

/// Adds energies, loads, multipliers, powers and works to the positions of `motion`, at which the rows hold. `lead` sets the inputs
/// of a time (s).
pub(crate) fn add_forces<S: Dynamic<f64, N, M>, I: Integrators, const N: usize, const M: usize>(
    mut mechanism: S,
    lead: &mut dyn FnMut(&mut S, f64),
    motion: &mut Motion,
) -> Result<(), Failure> {
    let mut forces = Forces::of(S::LOADS, S::ROWS);
    let (mut before, mut run) = (None, None);
    for (index, t) in motion.time.iter().enumerate() {
        let q: [f64; N] = core::array::from_fn(|coordinate| motion.coordinates[coordinate].q[index]);
        lead(&mut mechanism, *t);
        // Drives that prescribe a rate: their phases take the steps that the motion took.
        match before.replace(*t) {
            None => mechanism.start_phases(&q, *t),
            Some(from) => mechanism.advance_phases(from, *t),
        }
        let parameters = mechanism.parameters();
        let states = states_at::<S, I, N, M>(&mut run, &mechanism, *t, &q)?;
        let driven = inverse_with_states(&mechanism, *t, &q, &states)?;
        let position = mechanism.position(&parameters, &driven.q, *t);
        let energy = mechanism.energy(&parameters, &position, &driven.qd);
        forces.push(energy, driven.loads.as_ref(), &driven.lambda);
        forces.states = states.as_ref().to_vec();
        let moving =
            DynamicState { qd: &driven.qd, qdd: &driven.qdd, lambda: &driven.lambda, states: &states };
        determined::push(&mut forces, &mechanism, (&parameters, &position), *t, &moving)?;
        power_balance::push(&mut forces, &mechanism, (&parameters, &position), &moving);
    }
    forces.add_works(&motion.time);
    power_balance::name_rows::<S, N, M>(&mut forces);
    motion.dynamics = Some(forces);
    Ok(())
}

/// A motion with masses that is integrated for its first-order states.
type Run<'a, S, I, const N: usize, const M: usize> = AdaptiveRun<'a, S, <I as Integrators>::Adaptive, N, M>;

/// The first-order states at `t` (s), integrated along the motion: `run` goes on from call to call, and starts at the first.
fn states_at<'a, S: Dynamic<f64, N, M>, I: Integrators, const N: usize, const M: usize>(
    run: &mut Option<Run<'a, S, I, N, M>>,
    mechanism: &S,
    t: f64,
    q: &[f64; N],
) -> Result<S::States, Failure> {
    if S::STATES.is_empty() {
        return Ok(mechanism.start_states(&mechanism.parameters()));
    }
    let mut moved = match run.take() {
        Some(run) => run,
        None => {
            let method = Explicit::new(I::pair(Pair::Order8), &ENDS as AnyFormulation<'a, S, N, M>);
            Simulation::start_near(mechanism.clone(), method, t, *q, [0.0; N])?
        }
    };
    if moved.t() < t {
        advance_to(&mut moved, t)?;
    }
    let states = *moved.states();
    *run = Some(moved);
    Ok(states)
}
