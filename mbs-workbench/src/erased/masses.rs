//! Mechanisms with masses and forces behind the object-safe traits.

use mbs_runtime::{Dynamic, DynamicState, Entry, StateSlope};

use crate::erased::dynamics::AnyDynamics;
use crate::erased::dynamics::direct_dynamics::PartitionedFunctions;
use crate::erased::dynamics::integrators::Integrators;
use crate::erased::facade::{Facade, Forced, State};

/// States and multipliers of a state of motion, in addition to coordinates and their rates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// First-order states of the text.
    pub states: Vec<f64>,
    /// Multipliers λ: M.
    pub lambda: Vec<f64>,
}

/// Names of the states, forces and loads of a text with masses.
#[derive(Clone, Copy, Debug)]
pub struct Tables {
    /// First-order states.
    pub states: &'static [Entry],
    /// Forces by name.
    pub forces: &'static [Entry],
    /// Outputs of multipliers and states.
    pub loads: &'static [Entry],
}

/// Every emitted function of masses and forces at one state; matrices row after row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Masses {
    /// M: N·N.
    pub mass: Vec<f64>,
    /// M q̈: N.
    pub mass_times: Vec<f64>,
    /// Q: N.
    pub force: Vec<f64>,
    /// ∂Q/∂q: N·N.
    pub force_q: Vec<f64>,
    /// ∂Q/∂q̇: N·N.
    pub force_qd: Vec<f64>,
    /// ∂Q/∂λ: N·M.
    pub force_lambda: Vec<f64>,
    /// ∂Q/∂z of each first-order state: K·N.
    pub force_z: Vec<f64>,
    /// (M q̈)_q with q̈ held: N·N.
    pub mass_times_q: Vec<f64>,
    /// Φ_qᵀ λ: N.
    pub reaction: Vec<f64>,
    /// (Φ_qᵀ λ)_q: N·N.
    pub reaction_q: Vec<f64>,
    /// Φ̇_qᵀ λ: N; empty where the text does not know the third derivative of its rows.
    pub reaction_rate: Vec<f64>,
    /// λᵀγ̇, γ̇ the derivative of γ along (q̇, 1); empty likewise.
    pub gamma_rate: Vec<f64>,
    /// Kinetic and potential energy (J).
    pub energy: Vec<f64>,
    /// Powers of the forces (W).
    pub powers: Vec<f64>,
    /// Rates of the first-order states.
    pub state_rates: Vec<f64>,
    /// ∂ż/∂q, ∂ż/∂q̇ and ∂ż/∂z of each first-order state: K·N, K·N, K·K; empty where a function lacks a derivative.
    pub state_slopes: [Vec<f64>; 3],
    /// Outputs of multipliers and states.
    pub loads: Vec<f64>,
}

impl<S, I, const N: usize, const M: usize> Forced<S, N, M> for PartitionedFunctions<S, I, N, M>
where
    S: Dynamic<f64, N, M> + 'static,
    I: Integrators,
{
    const TABLES: Option<Tables> = Some(Tables { states: S::STATES, forces: S::FORCES, loads: S::LOADS });

    fn masses(mechanism: &S, state: &State, loads: &Loads) -> Option<Masses> {
        let array = |values: &[f64]| <[f64; N]>::try_from(values).ok();
        let (q, qd, qdd) = (array(&state.q)?, array(&state.qd)?, array(&state.qdd)?);
        let lambda = <[f64; M]>::try_from(loads.lambda.as_slice()).ok()?;
        let mut p = mechanism.parameters();
        // The law of sliding forwards, as the oracle has it.
        S::set_valued_modes_mut(&mut p).iter_mut().for_each(|mode| mode.direction = 1.0);
        S::remembered_mut(&mut p).fill(1.0);
        let mut z = mechanism.start_states(&p);
        for (slot, value) in z.as_mut().iter_mut().zip(&loads.states) {
            *slot = *value;
        }
        let here = mechanism.position(&p, &q, state.t);
        let flat = |matrix: [[f64; N]; N]| matrix.as_flattened().to_vec();
        let energy = mechanism.energy(&p, &here, &qd);
        let slopes = mechanism.state_slopes(&p, &here, &qd, &z, &lambda);
        let slopes = slopes.as_ref().map_or(&[][..], |slopes| slopes.as_ref());
        let by_state = |part: fn(&StateSlope<f64, N, S::States>) -> &[f64]| {
            slopes.iter().flat_map(part).copied().collect()
        };
        let third = mechanism.third_derivative(&p, &here, &qd, &lambda);
        let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: &z };
        Some(Masses {
            mass: flat(mechanism.mass(&p, &here)),
            mass_times: mechanism.mass_times(&p, &here, &qdd).to_vec(),
            force: mechanism.force(&p, &here, &qd, &z, &lambda).to_vec(),
            force_q: flat(mechanism.force_q(&p, &here, &qd, &z, &lambda)),
            force_qd: flat(mechanism.force_qd(&p, &here, &qd, &z, &lambda)),
            force_lambda: mechanism.force_lambda(&p, &here, &qd, &z, &lambda).as_flattened().to_vec(),
            force_z: by_state(|slope| &slope.force),
            mass_times_q: flat(mechanism.mass_times_q(&p, &here, &qdd)),
            reaction: mechanism.reaction(&p, &here, &lambda).to_vec(),
            reaction_q: flat(mechanism.reaction_q(&p, &here, &lambda)),
            reaction_rate: third.map_or_else(Vec::new, |(direction, _)| direction.to_vec()),
            gamma_rate: third.map_or_else(Vec::new, |(_, rate)| vec![rate]),
            energy: vec![energy.kinetic, energy.potential],
            powers: mechanism.powers(&p, &here, &qd, &z, &lambda).as_ref().to_vec(),
            state_rates: mechanism.state_rates(&p, &here, &qd, &z, &lambda).as_ref().to_vec(),
            state_slopes: [
                by_state(|slope| &slope.q),
                by_state(|slope| &slope.qd),
                by_state(|slope| slope.states.as_ref()),
            ],
            loads: mechanism.loads(&p, &here, &motion).as_ref().to_vec(),
        })
    }

    fn dynamics(facade: &Facade<S, N, M, Self>) -> Option<&dyn AnyDynamics> {
        Some(facade)
    }
}
