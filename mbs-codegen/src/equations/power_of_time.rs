//! Power of time alone in the energies: bodies that it carries along, potentials that it changes.
//!
//! Virtual work and Lagrange's equations displace the coordinates alone, so that q̇ᵀ(M q̈ + b) is the power of forces and
//! rows. Any other change of kinetic and potential energy is derived here. Inputs with rates count as time here, as they
//! do in the rows: they are carried along within a step.

use super::degree::is_quadratic;
use super::lower::Clock;
use super::sum::Sum;
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

    /// Rate with the coordinates held: along time and inputs.
    pub fn partial(&self, g: &mut Graph, value: NodeId) -> Option<NodeId> {
        tangent(g, &[value], |g, leaf| self.clock.partial(g, leaf)).pop().flatten()
    }
}

/// Adds the power into a mass that moves along `place` with `velocity`: m r_t·r̈, r_t its velocity with the coordinates held.
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
    if let Some(acceleration) = velocity.and_then(|velocity| rates.total(g, velocity)) {
        let product = g.multiply(carried, acceleration);
        let power = g.multiply(mass, product);
        sum.add(g, power);
    }
}

/// Adds the power into a kinetic energy T of the text: d/dt(2T − q̇·p) − T_t with p = ∂T/∂q̇. The first term is zero where T is
/// a quadratic form of the rates.
pub fn energy(g: &mut Graph, energy: NodeId, momenta: &[(usize, NodeId)], clock: &Clock, sum: &mut Sum) {
    let rates = Rates { clock };
    if !is_quadratic(g, energy) {
        let two = g.constant(2.0);
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
    let rate = rates.partial(g, energy);
    *sum = sum.minus(g, rate);
}

/// Adds the power into a weight −w·r: −ẇ r − w r_t, r_t with the coordinates held.
pub fn weight(g: &mut Graph, weight: NodeId, place: NodeId, clock: &Clock, sum: &mut Sum) {
    let rates = Rates { clock };
    if let Some(change) = rates.total(g, weight) {
        let power = g.multiply(change, place);
        *sum = sum.minus(g, Some(power));
    }
    if let Some(carried) = rates.partial(g, place) {
        let power = g.multiply(weight, carried);
        *sum = sum.minus(g, Some(power));
    }
}

/// Adds the power into a potential: its derivative with the coordinates held.
pub fn potential(g: &mut Graph, energy: NodeId, clock: &Clock, sum: &mut Sum) {
    if let Some(rate) = (Rates { clock }).partial(g, energy) {
        sum.add(g, rate);
    }
}
