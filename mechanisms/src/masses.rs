//! The common face of mechanisms with masses and forces.

use core::time::Duration;

use mbs_runtime::{Dynamic, Entry, Failure, FunctionEntry, Kinematic, Motion as Moving, Partitioned};

use crate::analyses::AnyDynamics;
use crate::analyses::direct::PartitionedFunctions;
use crate::facade::{AnyEquations, AnyMechanism, Facade, Functions, Motion, MotionStop, State};
use crate::lecture::experiment::Experiment;

/// What acts in a state beside its coordinates and their rates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// First-order states of the text.
    pub states: Vec<f64>,
    /// Multipliers λ: M.
    pub lambda: Vec<f64>,
}

/// Names of what a text of dynamics has beyond its kinematics.
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
    /// (M q̈)_q with q̈ held: N·N.
    pub mass_times_q: Vec<f64>,
    /// Φ_qᵀ λ: N.
    pub reaction: Vec<f64>,
    /// (Φ_qᵀ λ)_q: N·N.
    pub reaction_q: Vec<f64>,
    /// Kinetic and potential energy (J).
    pub energy: Vec<f64>,
    /// Powers of the forces (W).
    pub powers: Vec<f64>,
    /// Rates of the first-order states.
    pub state_rates: Vec<f64>,
    /// Outputs of multipliers and states.
    pub loads: Vec<f64>,
}

/// A mechanism with masses, `N` coordinates and `M` rows behind the common face.
#[derive(Clone, Debug)]
pub struct MassFacade<S, const N: usize, const M: usize> {
    /// Its kinematics.
    pub kinematics: Facade<S, N, M>,
    /// What takes independent coordinates.
    pub partitioned: PartitionedFunctions<S, N>,
}

/// A new mechanism of type `S` with masses, which its rows may leave free.
pub fn boxed_masses<S, const N: usize, const M: usize>() -> Box<dyn AnyEquations>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default + 'static,
{
    Box::new(MassFacade::<S, N, M>::new(S::default()))
}

/// A new mechanism of type `S` with masses and more than 120 coordinates and rows, which its rows may leave free.
pub fn boxed_large_masses<S, const N: usize, const M: usize>() -> Box<dyn AnyEquations>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default + 'static,
{
    let partitioned = PartitionedFunctions::of_large::<M>();
    Box::new(MassFacade::<S, N, M> { kinematics: Facade(S::default()), partitioned })
}

/// A new mechanism of type `S` with masses, of whose rows some follow from others, and which they leave free.
pub fn boxed_redundant_masses<S, const N: usize, const M: usize>() -> Box<dyn AnyEquations>
where
    S: Dynamic<f64, N, M> + Default + 'static,
{
    Box::new(MassFacade::<S, N, M> {
        kinematics: Facade(S::default()),
        partitioned: PartitionedFunctions::of_redundant::<M>(),
    })
}

/// A new mechanism of type `S` with masses, whose rows fix every coordinate.
pub fn boxed_driven<S, const N: usize>() -> Box<dyn AnyMechanism>
where
    S: Dynamic<f64, N, N> + Partitioned<f64, N, N> + Kinematic<f64, N> + Default + 'static,
{
    Box::new(MassFacade::<S, N, N>::new(S::default()))
}

impl<S, const N: usize, const M: usize> MassFacade<S, N, M>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
{
    fn new(mechanism: S) -> Self {
        MassFacade { kinematics: Facade(mechanism), partitioned: PartitionedFunctions::of() }
    }
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> MassFacade<S, N, M> {
    fn functions(&self, state: &State, loads: &Loads) -> Option<Masses> {
        let mechanism = &self.kinematics.0;
        let array = |values: &[f64]| <[f64; N]>::try_from(values).ok();
        let (q, qd, qdd) = (array(&state.q)?, array(&state.qd)?, array(&state.qdd)?);
        let lambda = <[f64; M]>::try_from(loads.lambda.as_slice()).ok()?;
        let p = mechanism.parameters();
        let mut z = mechanism.start_states(&p);
        for (slot, value) in z.as_mut().iter_mut().zip(&loads.states) {
            *slot = *value;
        }
        let here = mechanism.position(&p, &q, state.t);
        let flat = |matrix: [[f64; N]; N]| matrix.as_flattened().to_vec();
        let energy = mechanism.energy(&p, &here, &qd);
        let motion = Moving { qd: &qd, qdd: &qdd, lambda: &lambda, states: &z };
        Some(Masses {
            mass: flat(mechanism.mass(&p, &here)),
            mass_times: mechanism.mass_times(&p, &here, &qdd).to_vec(),
            force: mechanism.force(&p, &here, &qd, &z, &lambda).to_vec(),
            force_q: flat(mechanism.force_q(&p, &here, &qd, &z, &lambda)),
            force_qd: flat(mechanism.force_qd(&p, &here, &qd, &z, &lambda)),
            mass_times_q: flat(mechanism.mass_times_q(&p, &here, &qdd)),
            reaction: mechanism.reaction(&p, &here, &lambda).to_vec(),
            reaction_q: flat(mechanism.reaction_q(&p, &here, &lambda)),
            energy: vec![energy.kinetic, energy.potential],
            powers: mechanism.powers(&p, &here, &qd, &z, &lambda).as_ref().to_vec(),
            state_rates: mechanism.state_rates(&p, &here, &qd, &z, &lambda).as_ref().to_vec(),
            loads: mechanism.loads(&p, &here, &motion).as_ref().to_vec(),
        })
    }
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> AnyEquations for MassFacade<S, N, M> {
    fn type_name(&self) -> &'static str {
        self.kinematics.type_name()
    }
    fn scene(&self) -> &'static str {
        self.kinematics.scene()
    }
    fn source(&self) -> &'static str {
        self.kinematics.source()
    }
    fn coordinates(&self) -> &'static [Entry] {
        self.kinematics.coordinates()
    }
    fn rows(&self) -> &'static [Entry] {
        self.kinematics.rows()
    }
    fn variables(&self) -> &'static [Entry] {
        self.kinematics.variables()
    }
    fn outputs(&self) -> &'static [Entry] {
        self.kinematics.outputs()
    }
    fn functions(&self) -> &'static [FunctionEntry] {
        self.kinematics.functions()
    }
    fn get(&self, index: usize) -> Option<f64> {
        self.kinematics.get(index)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.kinematics.set(index, value)
    }
    fn coordinate_scales(&self) -> Vec<f64> {
        self.kinematics.coordinate_scales()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.kinematics.row_scales()
    }
    fn evaluate(&self, state: &State) -> Functions {
        self.kinematics.evaluate(state)
    }
    fn tables(&self) -> Option<Tables> {
        Some(Tables { states: S::STATES, forces: S::FORCES, loads: S::LOADS })
    }
    fn masses(&self, state: &State, loads: &Loads) -> Option<Masses> {
        self.functions(state, loads)
    }
    fn dynamics(&self) -> Option<&dyn AnyDynamics> {
        Some(self)
    }
}

impl<S: Dynamic<f64, N, N> + Kinematic<f64, N>, const N: usize> AnyMechanism for MassFacade<S, N, N> {
    fn follow(&self, times: &[f64], progress: &mut dyn FnMut(usize)) -> Result<Motion, Failure> {
        self.kinematics.follow(times, progress)
    }
    fn stop(&self, times: &[f64]) -> Option<MotionStop> {
        self.kinematics.stop(times)
    }
    fn time_a_step(&self, times: &[f64]) -> Result<Duration, Failure> {
        self.kinematics.time_a_step(times)
    }
    fn experiment(&self) -> &dyn Experiment {
        self.kinematics.experiment()
    }
}
