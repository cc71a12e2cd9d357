//! Functions of masses and forces as code.

use super::contacts::{ContactProgram, ContactRoots};
use super::schedule::Section;
use crate::equations::normal_forces::NormalForces;
use crate::equations::{Dynamics, Gap, SetValuedRow, Sparse};
use crate::symbolic::{Graph, NodeId};

/// One section a function.
#[derive(Debug)]
pub struct DynamicsProgram {
    /// M
    pub mass: Section,
    /// M x
    pub mass_times: Section,
    /// Q
    pub force: Section,
    /// Φ_qᵀ λ
    pub reaction: Section,
    /// Rates of the first-order states.
    pub state_rates: Section,
    /// ∂Q/∂q
    pub force_q: Section,
    /// ∂Q/∂q̇
    pub force_qd: Section,
    /// ∂Q/∂λ
    pub force_lambda: Section,
    /// Q in the multipliers, where they are its terms or those of absolute values and norms.
    pub normal_forces: Section,
    /// (M x)_q
    pub mass_times_q: Section,
    /// (Φ_qᵀ λ)_q
    pub reaction_q: Section,
    /// The third derivative of the rows.
    pub third: Section,
    /// Kinetic and potential energy.
    pub energy: Section,
    /// Powers of the forces.
    pub powers: Section,
    /// Power with which time alone changes the energies.
    pub carried: Section,
    /// Derivatives by first-order states, and of their rates.
    pub slopes: Section,
    /// Outputs of multipliers and states.
    pub loads: Section,
    /// Gaps of contacts with their rates.
    pub gaps: Section,
    /// Rows of frictions with stiction.
    pub set_valued: Section,
    /// Conditions of events, and values that they latch.
    pub events: Section,
    /// Rates of working ranges.
    pub limit_rates: Section,
    /// Forces by contact, where there are contacts.
    pub by_contact: Option<ContactProgram>,
    /// First-order states at the start.
    pub start_states: Section,
    /// Rates at the start.
    pub start_rates: Section,
    /// Values that must be non-negative.
    pub signed: Section,
}

/// The roots of each function.
pub struct Roots {
    mass: Vec<NodeId>,
    mass_times: Vec<NodeId>,
    force: Vec<NodeId>,
    reaction: Vec<NodeId>,
    state_rates: Vec<NodeId>,
    force_q: Vec<NodeId>,
    force_qd: Vec<NodeId>,
    force_lambda: Vec<NodeId>,
    normal_forces: Vec<NodeId>,
    mass_times_q: Vec<NodeId>,
    reaction_q: Vec<NodeId>,
    third: Vec<NodeId>,
    energy: Vec<NodeId>,
    powers: Vec<NodeId>,
    carried: Vec<NodeId>,
    slopes: Vec<NodeId>,
    loads: Vec<NodeId>,
    gaps: Vec<NodeId>,
    set_valued: Vec<NodeId>,
    events: Vec<NodeId>,
    limit_rates: Vec<NodeId>,
    by_contact: Option<ContactRoots>,
    start_states: Vec<NodeId>,
    start_rates: Vec<NodeId>,
    signed: Vec<NodeId>,
}

impl Roots {
    pub fn of(dynamics: &Dynamics) -> Self {
        let some = |nodes: &[Option<NodeId>]| nodes.iter().copied().flatten().collect();
        let entries = |matrix: &Sparse| matrix.iter().flatten().map(|(_, entry)| *entry).collect();
        Roots {
            mass: entries(&dynamics.mass),
            mass_times: some(&dynamics.mass_times),
            force: some(&dynamics.force),
            reaction: some(&dynamics.reaction),
            state_rates: some(&dynamics.state_rates),
            force_q: entries(&dynamics.force_q),
            force_qd: entries(&dynamics.force_qd),
            force_lambda: entries(&dynamics.force_lambda),
            normal_forces: dynamics.normal_forces.iter().flat_map(NormalForces::roots).collect(),
            mass_times_q: entries(&dynamics.mass_times_q),
            reaction_q: entries(&dynamics.reaction_q),
            third: dynamics.third.iter().flat_map(|third| third.roots()).collect(),
            energy: some(&[dynamics.kinetic, dynamics.potential]),
            powers: some(&dynamics.powers),
            carried: some(&[dynamics.carried]),
            slopes: dynamics.slopes.iter().flat_map(|slope| slope.roots()).collect(),
            loads: dynamics.loads.clone(),
            gaps: dynamics.gaps.iter().flat_map(Gap::roots).collect(),
            set_valued: dynamics.set_valued.iter().flat_map(SetValuedRow::roots).collect(),
            events: dynamics.events.roots().collect(),
            limit_rates: dynamics.limit_rates.iter().flatten().copied().flatten().collect(),
            by_contact: ContactRoots::of(dynamics),
            start_states: some(&dynamics.start_states),
            start_rates: some(&dynamics.start_rates),
            signed: dynamics.signed.iter().map(|signed| signed.node).collect(),
        }
    }

    /// Functions that every step of every method calls.
    pub fn each_step(&self) -> [&[NodeId]; 5] {
        let force = self.by_contact.as_ref().map_or(self.force.as_slice(), ContactRoots::force);
        [&self.mass, &self.mass_times, force, &self.reaction, &self.state_rates]
    }

    /// Functions that some methods call, or that are not called in every step: no value is kept for them alone.
    pub fn rare(&self) -> impl Iterator<Item = &[NodeId]> {
        let all: [&[NodeId]; 16] = [
            &self.force_q,
            &self.force_qd,
            &self.force_lambda,
            &self.normal_forces,
            &self.mass_times_q,
            &self.reaction_q,
            &self.third,
            &self.energy,
            &self.powers,
            &self.carried,
            &self.slopes,
            &self.loads,
            &self.gaps,
            &self.set_valued,
            &self.events,
            &self.limit_rates,
        ];
        let by_contact = self.by_contact.iter();
        let whole = by_contact.clone().map(|_| self.force.as_slice());
        all.into_iter().chain(whole).chain(by_contact.flat_map(ContactRoots::rare))
    }

    /// Functions of the parameters.
    pub fn start(&self) -> [&[NodeId]; 2] {
        [&self.start_states, &self.start_rates]
    }

    /// Before: functions that order the code of a function of the state, of one after another, and of one of parameters alone.
    /// After: all in order.
    pub fn order(
        &self,
        graph: &Graph,
        section: impl Fn(&[NodeId]) -> Section,
        behind: impl Fn(&Section, &[NodeId]) -> Section,
        early: impl Fn(&[NodeId]) -> Section,
    ) -> DynamicsProgram {
        DynamicsProgram {
            mass: section(&self.mass),
            mass_times: section(&self.mass_times),
            force: section(&self.force),
            reaction: section(&self.reaction),
            state_rates: section(&self.state_rates),
            force_q: section(&self.force_q),
            force_qd: section(&self.force_qd),
            force_lambda: section(&self.force_lambda),
            normal_forces: section(&self.normal_forces),
            mass_times_q: section(&self.mass_times_q),
            reaction_q: section(&self.reaction_q),
            third: section(&self.third),
            energy: section(&self.energy),
            powers: section(&self.powers),
            carried: section(&self.carried),
            slopes: section(&self.slopes),
            loads: section(&self.loads),
            gaps: section(&self.gaps),
            set_valued: section(&self.set_valued),
            events: section(&self.events),
            limit_rates: section(&self.limit_rates),
            by_contact: self.by_contact.as_ref().map(|roots| roots.order(graph, &section, behind)),
            start_states: early(&self.start_states),
            start_rates: early(&self.start_rates),
            // Evaluated once a run: no value is kept for it.
            signed: early(&self.signed),
        }
    }
}
