//! Forces of contacts, each by itself: an open one is left out of every evaluation.

use super::jacobian;
use super::sparse::{Sparse, derivative};
use crate::model::dynamics::{Action, Dynamics as Declared};
use crate::model::expression::Id;
use crate::symbolic::{Graph, Leaf, Node, NodeId};

/// A force with its derivatives by coordinates and velocities.
#[derive(Debug, Default)]
pub struct Push {
    /// Its part of Q, one a coordinate.
    pub force: Vec<Option<NodeId>>,
    /// Its part of ∂Q/∂q.
    pub force_q: Sparse,
    /// Its part of ∂Q/∂q̇.
    pub force_qd: Sparse,
}

impl Push {
    fn of(g: &mut Graph, force: Vec<Option<NodeId>>) -> Self {
        let force_q = derivative(g, &force, force.len(), Leaf::Position);
        let force_qd = derivative(g, &force, force.len(), Leaf::Velocity);
        Push { force, force_q, force_qd }
    }

    fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let matrices = self.force_q.iter_mut().chain(&mut self.force_qd).flatten();
        self.force.iter_mut().flatten().chain(matrices.map(|(_, entry)| entry))
    }
}

/// One contact.
#[derive(Debug)]
pub struct Pressing {
    /// Index among the contacts.
    pub contact: usize,
    /// Index among the named forces.
    pub named: usize,
    /// Force of the closed contact.
    pub push: Push,
    /// Its power.
    pub power: Option<NodeId>,
}

/// Q with all contacts open, and the force that each closed contact adds.
#[derive(Debug)]
pub struct ByContact {
    /// All other forces, velocity-quadratic terms included.
    pub open: Push,
    /// The contacts. One whose force depends on multipliers is among the other forces.
    pub contacts: Vec<Pressing>,
}

impl ByContact {
    /// The forces of contacts, and those with all contacts open.
    pub fn pushes_mut(&mut self) -> impl Iterator<Item = &mut Push> {
        [&mut self.open].into_iter().chain(self.contacts.iter_mut().map(|contact| &mut contact.push))
    }

    /// The roots of every function, to be replaced.
    pub fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let contacts = self
            .contacts
            .iter_mut()
            .flat_map(|contact| contact.push.roots_mut().chain(contact.power.iter_mut()));
        self.open.roots_mut().chain(contacts)
    }
}

/// Before: the forces of the text with the power of each; `open` gives Q without the forces of these indices. After: the contacts
/// by themselves; `None` where there are none.
pub fn by_contact(
    g: &mut Graph,
    declared: &Declared,
    of: &impl Fn(Id) -> NodeId,
    powers: &[Option<NodeId>],
    open: impl FnOnce(&mut Graph, &[usize]) -> Vec<Option<NodeId>>,
) -> Option<ByContact> {
    let count = declared.contacts.iter().enumerate();
    let known: Vec<_> = count
        .filter_map(|(contact, declaration)| {
            let Action::Work(pairs) = &declared.forces.get(declaration.force)?.action else { return None };
            let pairs: Vec<_> = pairs.iter().map(|(value, on)| (of(*value), of(*on))).collect();
            let is_multiplier = |id| matches!(g.node(id), Node::Leaf(Leaf::Multiplier(_)));
            let reached = g.reachable(pairs.iter().map(|(value, _)| *value));
            (!reached.into_iter().any(is_multiplier)).then_some((contact, declaration.force, pairs))
        })
        .collect();
    if known.is_empty() {
        return None;
    }
    let left_out: Vec<usize> = known.iter().map(|(_, named, _)| *named).collect();
    let open = open(g, &left_out);
    let coordinates = open.len();
    let open = Push::of(g, open);
    let contacts = known.into_iter().map(|(contact, named, pairs)| {
        let mut force = vec![None; coordinates];
        for (value, place) in pairs {
            for (coordinate, entry) in
                jacobian(g, &[place], coordinates, Leaf::Position).into_iter().flatten()
            {
                let part = g.multiply(entry, value);
                if let Some(sum) = force.get_mut(coordinate) {
                    *sum = Some(sum.map_or(part, |sum| g.add(sum, part)));
                }
            }
        }
        Pressing { contact, named, push: Push::of(g, force), power: powers.get(named).copied().flatten() }
    });
    let contacts = contacts.collect();
    Some(ByContact { open, contacts })
}
