//! Masses and forces → M, Q, their derivatives, energies and powers.

use super::acting_bodies::{Attribution, Undetermined};
use super::contacts::{ByContact, Push, by_contact};
use super::deferred::Missing;
use super::events::Events;
use super::generalized_forces::{self, Acting};
use super::inertia::Inertia;
use super::lower::Clock;
use super::non_negative::{NonNegative, Of, signed};
use super::normal_forces::{NormalForces, normal_forces};
use super::second_moments::second_moments;
use super::set_valued::{SetValuedRow, set_valued_rows};
use super::sparse::{Sparse, derivative, hessian, mirrored, products, transposed};
use super::sum::Sum;
use super::{Row, again};
use crate::model::dynamics::{Body, Dynamics as Declared, Rotation};
use crate::model::expression::Id;
use crate::symbolic::{Graph, Leaf, Node, NodeId, tangent};

/// Derivatives of the forces by a first-order state, and of its rate.
#[derive(Debug)]
pub struct Slope {
    /// ∂Q/∂z, one a coordinate.
    pub force: Vec<Option<NodeId>>,
    /// ∂ż/∂q, one a coordinate.
    pub q: Vec<Option<NodeId>>,
    /// ∂ż/∂q̇, one a coordinate.
    pub qd: Vec<Option<NodeId>>,
    /// ∂ż/∂z, one a state.
    pub states: Vec<Option<NodeId>>,
}

impl Slope {
    /// All of its roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        [&self.force, &self.q, &self.qd, &self.states].into_iter().flatten().copied().flatten()
    }
}

/// Roots of d³/dt³ λᵀΦ = λᵀΦ_q q⃛ + 3 (Φ̇_qᵀ λ)ᵀ q̈ − λᵀγ̇, λ held.
#[derive(Debug)]
pub struct Third {
    /// Φ̇_qᵀ λ = ∂_q(λᵀ(Φ_q q̇ + Φ_t)), one a coordinate.
    pub row: Vec<Option<NodeId>>,
    /// λᵀγ̇, γ̇ the derivative of γ along (q̇, 1): less the third directional derivative of λᵀΦ.
    pub right: Option<NodeId>,
}

impl Third {
    /// All of its roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.row.iter().copied().flatten().chain(self.right)
    }
}

/// The gap of a contact.
#[derive(Debug)]
pub struct Gap {
    /// Gap.
    pub gap: NodeId,
    /// Its time derivative.
    pub rate: Option<NodeId>,
    /// Largest second derivative while it is open, where the text gives it.
    pub bound: Option<NodeId>,
}

impl Gap {
    /// All of its roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> {
        [Some(self.gap), self.rate, self.bound].into_iter().flatten()
    }
}

/// Roots of M q̈ + Φ_qᵀ λ = Q. `None` is a structural zero.
#[derive(Debug)]
pub struct Dynamics {
    /// M, symmetric: an entry and its mirror image are one node.
    pub mass: Sparse,
    /// M x
    pub mass_times: Vec<Option<NodeId>>,
    /// (M x)_q
    pub mass_times_q: Sparse,
    /// Q, velocity-quadratic terms included.
    pub force: Vec<Option<NodeId>>,
    /// `true` if Q depends on a multiplier: friction.
    pub force_uses_multipliers: bool,
    /// ∂Q/∂q
    pub force_q: Sparse,
    /// ∂Q/∂q̇
    pub force_qd: Sparse,
    /// ∂Q/∂λ
    pub force_lambda: Sparse,
    /// Q as a sum of multipliers, their absolute values and norms, where it depends on them in such a way alone.
    pub normal_forces: Option<NormalForces>,
    /// Φ_qᵀ λ
    pub reaction: Vec<Option<NodeId>>,
    /// (Φ_qᵀ λ)_q, symmetric.
    pub reaction_q: Sparse,
    /// Third derivative of the rows as a condition on accelerations; none where it needs a derivative of a declared
    /// function that nothing else needs.
    pub third: Option<Third>,
    /// Kinetic energy.
    pub kinetic: Option<NodeId>,
    /// Potential energy.
    pub potential: Option<NodeId>,
    /// One a named force.
    pub powers: Vec<Option<NodeId>>,
    /// Power with which time alone changes kinetic and potential energy.
    pub carried: Option<NodeId>,
    /// One a first-order state.
    pub state_rates: Vec<Option<NodeId>>,
    /// One a first-order state: ∂Q/∂z and the derivatives of its rate.
    pub slopes: Vec<Slope>,
    /// One a first-order state.
    pub start_states: Vec<Option<NodeId>>,
    /// One a coordinate.
    pub start_rates: Vec<Option<NodeId>>,
    /// Masses, moments of inertia and stiffnesses that parameters alone make, each value once.
    pub signed: Vec<NonNegative>,
    /// One a contact.
    pub gaps: Vec<Gap>,
    /// One a friction with stiction.
    pub set_valued: Vec<SetValuedRow>,
    /// Conditions of events and values that they latch.
    pub events: Events,
    /// Q contact by contact, where there are contacts.
    pub by_contact: Option<ByContact>,
    /// Time derivatives of the working ranges, by which parts of a motion can be enclosed. Given where the text calls no function and
    /// no drive prescribes a rate.
    pub limit_rates: Vec<[Option<NodeId>; 3]>,
    /// Derivatives that are left out of ∂Q/∂q, ∂Q/∂q̇, (M x)_q, (Φ_qᵀ λ)_q and the slopes, for declared functions are not
    /// smooth enough.
    pub missing: Vec<Missing>,
    /// One an output of multipliers or states.
    pub loads: Vec<NodeId>,
    /// Indices of the text's kinetic energies that are not quadratic in the rates.
    pub not_quadratic: Vec<usize>,
    /// Points, angles and lengths that the named forces act on.
    pub acting: Vec<Acting>,
    /// Reason why the forces of pins are unknown, though an output asks for them.
    pub undetermined: Option<Undetermined>,
    /// Body that each force and row acts on, where an output asks for the force of a pin and it is known.
    pub attribution: Option<Attribution>,
}

impl Dynamics {
    /// The forces of contacts, and those with all contacts open.
    pub fn pushes_mut(&mut self) -> impl Iterator<Item = &mut Push> {
        self.by_contact.iter_mut().flat_map(ByContact::pushes_mut)
    }

    /// The roots of every function that is emitted, to be replaced.
    pub fn roots_mut(&mut self) -> Vec<&mut NodeId> {
        let matrices = [
            &mut self.mass,
            &mut self.mass_times_q,
            &mut self.force_q,
            &mut self.force_qd,
            &mut self.force_lambda,
            &mut self.reaction_q,
        ];
        let vectors = [
            &mut self.mass_times,
            &mut self.force,
            &mut self.reaction,
            &mut self.powers,
            &mut self.state_rates,
            &mut self.start_states,
            &mut self.start_rates,
        ];
        let mut roots: Vec<&mut NodeId> =
            matrices.into_iter().flatten().flatten().map(|(_, entry)| entry).collect();
        roots.extend(vectors.into_iter().flatten().flatten());
        if let Some(third) = &mut self.third {
            roots.extend(third.row.iter_mut().chain([&mut third.right]).flatten());
        }
        roots.extend([&mut self.kinetic, &mut self.potential].into_iter().flatten());
        roots.extend(&mut self.loads);
        roots.extend(self.normal_forces.iter_mut().flat_map(NormalForces::roots_mut));
        for Gap { gap, rate, bound } in &mut self.gaps {
            roots.push(gap);
            roots.extend([rate, bound].into_iter().flatten());
        }
        roots.extend(self.set_valued.iter_mut().flat_map(SetValuedRow::roots_mut));
        roots.extend(self.events.roots_mut());
        roots.extend(self.limit_rates.iter_mut().flatten().flatten());
        roots.extend(self.by_contact.iter_mut().flat_map(ByContact::roots_mut));
        roots
    }
}

/// Before: everything of the text as nodes. After: every function of dynamics as roots of the same graph.
pub fn derive(
    g: &mut Graph,
    declared: &Declared,
    nodes: &[NodeId],
    clock: &Clock,
    rows: &[Row],
    guesses: &[NodeId],
) -> Dynamics {
    let count = guesses.len();
    let zero = g.constant(0.0);
    let of = |id: Id| nodes.get(id.index()).copied().unwrap_or(zero);
    let mut inertia = Inertia::new(count);
    for body in &declared.bodies {
        add_body(&mut inertia, g, body, &of, clock);
    }
    let mut not_quadratic = Vec::new();
    for (index, kinetic) in declared.kinetics.iter().enumerate() {
        if !inertia.energy(g, of(kinetic.value), clock) {
            not_quadratic.push(index);
        }
    }
    let Inertia { mass, bias, kinetic, carried } = inertia;
    let generalized_forces::Forces { force, potential, powers, acting, carried } =
        generalized_forces::derive(g, declared, &of, clock, (count, carried, &[]));
    let less_bias = |g: &mut Graph, force: Vec<Sum>| -> Vec<Option<NodeId>> {
        force.into_iter().zip(&bias).map(|(force, bias)| force.minus(g, bias.0).0).collect()
    };
    let force = less_bias(g, force);
    let by_contact = by_contact(g, declared, &of, &powers, |g, contacts| {
        let others = generalized_forces::derive(g, declared, &of, clock, (count, carried, contacts));
        less_bias(g, others.force)
    });

    let used = g.reachable(force.iter().copied().flatten());
    let force_uses_multipliers =
        used.into_iter().any(|id| matches!(g.node(id), Node::Leaf(Leaf::Multiplier(_))));

    let mass = mirrored(mass);
    let mass_times = products(g, &mass, Leaf::Direction);
    let mass_times_q = derivative(g, &mass_times, count, Leaf::Position);
    let force_q = derivative(g, &force, count, Leaf::Position);
    let force_qd = derivative(g, &force, count, Leaf::Velocity);
    let force_lambda = derivative(g, &force, rows.len(), Leaf::Multiplier);
    let normal_forces = force_uses_multipliers.then(|| normal_forces(g, &force, rows.len())).flatten();
    let state_rates: Vec<Option<NodeId>> = declared.states.iter().map(|state| state.rate.map(of)).collect();
    let slopes = slopes(g, &force, &state_rates);
    let columns = transposed(rows, count);
    let reaction = products(g, &columns, Leaf::Multiplier);
    let reaction_q = hessian(g, &reaction);
    let third = third(g, rows, &reaction, clock);
    let mut bounded: Vec<(Of, NodeId)> = Vec::new();
    bounded.extend(
        declared.signed.iter().enumerate().map(|(index, signed)| (Of::Field(index), of(signed.value))),
    );
    for (index, inertia) in declared.inertias.iter().enumerate() {
        let entries: Vec<_> =
            inertia.entries.iter().map(|(row, column, id)| (*row, *column, of(*id))).collect();
        let conditions = second_moments(g, &entries).into_iter();
        bounded.extend(conditions.map(|(condition, node)| (Of::Inertia(index, condition), node)));
    }
    let start = |rates: &[(usize, Id)], index: usize| {
        rates.iter().find(|(coordinate, _)| *coordinate == index).map(|(_, rate)| of(*rate))
    };
    let gaps = declared.contacts.iter().map(|contact| {
        let rate = tangent(g, &[of(contact.gap)], |g, leaf| clock.total(g, leaf, false)).pop().flatten();
        Gap { gap: of(contact.gap), rate, bound: contact.bound.map(of) }
    });
    let gaps = gaps.collect();
    Dynamics {
        mass,
        mass_times,
        mass_times_q,
        force,
        force_uses_multipliers,
        force_q,
        force_qd,
        force_lambda,
        normal_forces,
        reaction,
        reaction_q,
        third: Some(third),
        kinetic: kinetic.0,
        potential: potential.0,
        powers,
        carried: carried.0,
        state_rates,
        slopes,
        start_states: declared.states.iter().map(|state| state.start.map(of)).collect(),
        start_rates: (0..count).map(|index| start(&declared.rates, index)).collect(),
        signed: signed(g, bounded.into_iter()),
        gaps,
        set_valued: set_valued_rows(g, &declared.set_valued, &of, clock, count),
        events: Events::of(declared, &of),
        by_contact,
        limit_rates: Vec::new(),
        missing: Vec::new(),
        loads: declared.loads.iter().map(|load| of(load.value)).collect(),
        not_quadratic,
        acting,
        undetermined: None,
        attribution: None,
    }
}

/// M = Σ m J ᵀJ + J_αᵀ I J_α with J = ∂com/∂q: no difference of large numbers.
fn add_body(inertia: &mut Inertia, g: &mut Graph, body: &Body, of: &impl Fn(Id) -> NodeId, clock: &Clock) {
    for component in &body.com {
        inertia.point(g, of(*component), of(body.mass), clock);
    }
    match &body.rotation {
        None => {}
        Some(Rotation::Plane { inertia: moment, angle }) => inertia.point(g, of(*angle), of(*moment), clock),
        Some(Rotation::Space { inertia: moments, orientation }) => {
            let moments = moments.iter().map(|(row, column, entry)| (*row, *column, of(*entry)));
            let moments: Vec<_> = moments.collect();
            inertia.turning(g, &moments, orientation.map(of), clock);
        }
    }
}

/// Derivatives of the forces by each state, and of each state's rate.
fn slopes(g: &mut Graph, force: &[Option<NodeId>], rates: &[Option<NodeId>]) -> Vec<Slope> {
    let (count, states) = (force.len(), rates.len());
    if states == 0 {
        return Vec::new();
    }
    let forces = derivative(g, force, states, Leaf::State);
    let by = [(count, Leaf::Position as fn(u32) -> Leaf), (count, Leaf::Velocity), (states, Leaf::State)];
    let by = by.map(|(columns, axis)| (columns, derivative(g, rates, columns, axis)));
    let row = |(columns, rows): &(usize, Sparse), state: usize| {
        let entries: &[(usize, NodeId)] = rows.get(state).map_or(&[], Vec::as_slice);
        let entry = |column: usize| entries.iter().find(|(at, _)| *at == column).map(|(_, entry)| *entry);
        (0..*columns).map(entry).collect::<Vec<_>>()
    };
    let [q, qd, own] = &by;
    let slope = |state: usize| {
        let acts =
            |row: &Vec<(usize, NodeId)>| row.iter().find(|(at, _)| *at == state).map(|(_, entry)| *entry);
        let force = forces.iter().map(acts).collect();
        Slope { force, q: row(q, state), qd: row(qd, state), states: row(own, state) }
    };
    (0..states).map(slope).collect()
}

/// The third derivative of the rows along a motion, each row times its multiplier, which is held.
fn third(g: &mut Graph, rows: &[Row], reaction: &[Option<NodeId>], clock: &Clock) -> Third {
    let row = again(g, reaction, |g, leaf| clock.total(g, leaf, false));
    let gamma: Vec<Option<NodeId>> = rows.iter().map(|row| row.gamma).collect();
    let mut right = Sum::default();
    for (index, change) in again(g, &gamma, |g, leaf| clock.total(g, leaf, false)).into_iter().enumerate() {
        let Some(change) = change else { continue };
        let multiplier = g.leaf(Leaf::Multiplier(index as u32));
        let product = g.multiply(multiplier, change);
        right.add(g, product);
    }
    Third { row, right: right.0 }
}
