//! What the time alone gives to the energies: bodies that it carries along, potentials that it changes.
//!
//! The equations of motion move along the rates alone what virtual work and Lagrange's equations move, so that
//! q̇ᵀ(M q̈ + b) is the power of forces and rows. What kinetic and potential energy change by beside it is found here.
//! Inputs stand still while a motion is integrated, whatever rates they have; what their rates contribute to velocities and
//! accelerations is taken out again.

use super::again;
use super::degree::is_quadratic;
use super::forces::Sum;
use super::lower::Clock;
use crate::symbolic::{Graph, Leaf, NodeId, tangent};

/// Derivatives of one function along parts of a motion; `None` is a structural zero.
pub struct Rates<'a> {
    pub clock: &'a Clock,
}

impl Rates<'_> {
    /// Along everything, q̇ included.
    pub fn total(&self, g: &mut Graph, value: NodeId) -> Option<NodeId> {
        tangent(g, &[value], |g, leaf| self.clock.total(g, leaf, true)).pop().flatten()
    }

    /// With the coordinates held: along time and inputs.
    pub fn partial(&self, g: &mut Graph, value: NodeId) -> Option<NodeId> {
        tangent(g, &[value], |g, leaf| self.clock.partial(g, leaf)).pop().flatten()
    }

    /// Along the time alone.
    pub fn time(&self, g: &mut Graph, value: NodeId) -> Option<NodeId> {
        tangent(g, &[value], |g, leaf| (leaf == Leaf::Time).then(|| g.constant(1.0))).pop().flatten()
    }

    /// Along inputs alone.
    pub fn inputs(&self, g: &mut Graph, value: Option<NodeId>) -> Option<NodeId> {
        again(g, &[value], |g, leaf| match leaf {
            Leaf::Time => None,
            other => self.clock.partial(g, other),
        })
        .pop()
        .flatten()
    }

    /// Along coordinates and time, inputs held.
    pub fn held(&self, g: &mut Graph, value: NodeId) -> Option<NodeId> {
        tangent(g, &[value], |g, leaf| match leaf {
            Leaf::Time => Some(g.constant(1.0)),
            Leaf::Position(i) => Some(g.leaf(Leaf::Velocity(i))),
            _ => None,
        })
        .pop()
        .flatten()
    }
}

/// Adds what a mass that moves along `place` with `velocity` is given: m (r_t·r̈ − ṙ·r̈_u), r_t its velocity with the
/// coordinates held, r̈_u the part of its acceleration that comes from moving inputs.
pub fn point(
    g: &mut Graph,
    place: NodeId,
    velocity: Option<NodeId>,
    mass: NodeId,
    clock: &Clock,
    sum: &mut Sum,
) {
    let rates = Rates { clock };
    let Some(carried) = rates.partial(g, place) else { return };
    let Some(velocity) = velocity else { return };
    if let Some(acceleration) = rates.total(g, velocity) {
        let product = g.multiply(carried, acceleration);
        let power = g.multiply(mass, product);
        sum.add(g, power);
    }
    if let Some(turned) = rates.inputs(g, Some(velocity)) {
        let product = g.multiply(velocity, turned);
        let power = g.multiply(mass, product);
        *sum = sum.minus(g, Some(power));
    }
}

/// Adds what a kinetic energy T of the text is given: d/dt(2T − q̇·p) + T_t − 2 T_(t,u) with p = ∂T/∂q̇, of which the first
/// is nothing where T is a quadratic form of the rates.
pub fn energy(g: &mut Graph, energy: NodeId, momenta: &[(usize, NodeId)], clock: &Clock, sum: &mut Sum) {
    let rates = Rates { clock };
    let two = g.constant(2.0);
    if !is_quadratic(g, energy) {
        let mut rest = Sum(Some(g.multiply(two, energy)));
        for (coordinate, momentum) in momenta {
            let velocity = g.leaf(Leaf::Velocity(*coordinate as u32));
            let product = g.multiply(velocity, *momentum);
            rest = rest.minus(g, Some(product));
        }
        if let Some(rate) = rest.0.and_then(|rest| rates.total(g, rest)) {
            sum.add(g, rate);
        }
    }
    if let Some(rate) = rates.time(g, energy) {
        sum.add(g, rate);
    }
    if let Some(rate) = rates.partial(g, energy) {
        let twice = g.multiply(two, rate);
        *sum = sum.minus(g, Some(twice));
    }
}

/// Adds what a weight −w·r is given: −ẇ r − w r_t, r_t along the time alone.
pub fn weight(g: &mut Graph, weight: NodeId, place: NodeId, clock: &Clock, sum: &mut Sum) {
    let rates = Rates { clock };
    if let Some(change) = rates.held(g, weight) {
        let power = g.multiply(change, place);
        *sum = sum.minus(g, Some(power));
    }
    if let Some(carried) = rates.time(g, place) {
        let power = g.multiply(weight, carried);
        *sum = sum.minus(g, Some(power));
    }
}

/// Adds what a potential is given: its derivative along the time.
pub fn potential(g: &mut Graph, energy: NodeId, clock: &Clock, sum: &mut Sum) {
    if let Some(rate) = (Rates { clock }).time(g, energy) {
        sum.add(g, rate);
    }
}

/// Takes out what a spring's power counts of ends that inputs move: k s · ṡ_u.
pub fn spring(g: &mut Graph, elastic: NodeId, moved: Option<NodeId>, sum: &mut Sum) {
    if let Some(moved) = moved {
        let power = g.multiply(elastic, moved);
        *sum = sum.minus(g, Some(power));
    }
}
