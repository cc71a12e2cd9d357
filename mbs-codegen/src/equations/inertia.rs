//! Kinetic energy → M, the inertia forces at q̈ = 0, and the power of time alone.

use super::lower::Clock;
use super::power_of_time;
use super::sum::Sum;
use super::{again, jacobian};
use crate::symbolic::{Graph, Leaf, NodeId, Stage, tangent};

/// Entries of the upper triangle of M, the inertia forces at q̈ = 0, the kinetic energy and the power of time alone in it.
pub struct Inertia {
    pub(super) mass: Vec<Vec<(usize, Sum)>>,
    pub(super) bias: Vec<Sum>,
    pub(super) kinetic: Sum,
    pub(super) carried: Sum,
}

impl Inertia {
    pub(super) fn new(count: usize) -> Self {
        let (mass, bias) = (vec![Vec::new(); count], vec![Sum::default(); count]);
        Inertia { mass, bias, kinetic: Sum::default(), carried: Sum::default() }
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.bias.len()
    }

    /// Adds to the kinetic energy.
    pub fn add_kinetic(&mut self, g: &mut Graph, energy: NodeId) {
        self.kinetic.add(g, energy);
    }

    /// Adds to the power of time alone in it.
    pub fn add_carried(&mut self, g: &mut Graph, power: NodeId) {
        self.carried.add(g, power);
    }

    /// A mass that moves along one function of q and t.
    pub(super) fn point(&mut self, g: &mut Graph, place: NodeId, mass: NodeId, clock: &Clock) {
        if g.constant_value(mass) == Some(0.0) {
            return;
        }
        let columns = jacobian(g, &[place], self.bias.len(), Leaf::Position).pop().unwrap_or_default();
        for (index, (row, left)) in columns.iter().enumerate() {
            for (column, right) in columns.iter().skip(index) {
                let product = g.multiply(*left, *right);
                let entry = g.multiply(mass, product);
                self.add(g, *row, *column, entry);
            }
        }
        let velocity = tangent(g, &[place], |g, leaf| clock.total(g, leaf, false));
        let acceleration = again(g, &velocity, |g, leaf| clock.total(g, leaf, false)).pop().flatten();
        if let Some(acceleration) = acceleration {
            let inertia = g.multiply(mass, acceleration);
            for (row, entry) in &columns {
                let bias = g.multiply(*entry, inertia);
                self.bias_at(g, *row, bias);
            }
        }
        let velocity = velocity.into_iter().next().flatten();
        power_of_time::point(g, place, velocity, mass, clock, &mut self.carried);
        if let Some(velocity) = velocity {
            let half = g.constant(0.5);
            let square = g.multiply(velocity, velocity);
            let half = g.multiply(half, mass);
            let energy = g.multiply(half, square);
            self.kinetic.add(g, energy);
        }
    }

    /// d/dt(∂T/∂q̇) − ∂T/∂q of any T at most quadratic in the rates; false where it is of a higher degree.
    pub(super) fn energy(&mut self, g: &mut Graph, energy: NodeId, clock: &Clock) -> bool {
        let count = self.bias.len();
        self.kinetic.add(g, energy);
        let momenta = jacobian(g, &[energy], count, Leaf::Velocity).pop().unwrap_or_default();
        let roots: Vec<NodeId> = momenta.iter().map(|(_, momentum)| *momentum).collect();
        let entries = jacobian(g, &roots, count, Leaf::Velocity);
        for ((row, _), entries) in momenta.iter().zip(&entries) {
            for (column, entry) in entries.iter().filter(|(column, _)| column >= row) {
                if g.stage(*entry) > Stage::Position {
                    return false;
                }
                self.add(g, *row, *column, *entry);
            }
        }
        let changes = tangent(g, &roots, |g, leaf| clock.total(g, leaf, false));
        for ((row, _), change) in momenta.iter().zip(changes) {
            if let Some(change) = change {
                self.bias_at(g, *row, change);
            }
        }
        power_of_time::energy(g, energy, &momenta, clock, &mut self.carried);
        for (row, slope) in jacobian(g, &[energy], count, Leaf::Position).into_iter().flatten() {
            let opposite = g.negate(slope);
            self.bias_at(g, row, opposite);
        }
        true
    }

    pub fn add(&mut self, g: &mut Graph, row: usize, column: usize, entry: NodeId) {
        let Some(entries) = self.mass.get_mut(row) else { return };
        match entries.iter_mut().find(|(known, _)| *known == column) {
            Some((_, sum)) => sum.add(g, entry),
            None => entries.push((column, Sum(Some(entry)))),
        }
    }

    pub fn bias_at(&mut self, g: &mut Graph, row: usize, bias: NodeId) {
        if let Some(sum) = self.bias.get_mut(row) {
            sum.add(g, bias);
        }
    }
}
