//! Forces of contacts as code: the forces with all contacts open, and the force that each contact adds.

use std::collections::{BTreeMap, BTreeSet};

use super::schedule::{Angle, Assignment, Section};
use crate::equations::{ByContact, Dynamics, Push};
use crate::symbolic::{Graph, NodeId};

/// Parts of Q, ∂Q/∂q, ∂Q/∂q̇ and of the powers.
#[derive(Debug)]
pub struct PushProgram {
    /// Q
    pub force: Section,
    /// ∂Q/∂q
    pub force_q: Section,
    /// ∂Q/∂q̇
    pub force_qd: Section,
    /// Powers of the forces.
    pub powers: Section,
}

/// One section a function.
#[derive(Debug)]
pub struct ContactProgram {
    /// All other forces.
    pub open: PushProgram,
    /// Sines and cosines that several contacts use, after the other forces: for contacts that are evaluated alone.
    pub shared: PushProgram,
    /// One a contact: its code after both.
    pub contacts: Vec<PushProgram>,
}

/// The roots of each function.
pub struct ContactRoots {
    open: [Vec<NodeId>; 4],
    contacts: Vec<[Vec<NodeId>; 4]>,
    /// All of the contacts.
    all: Vec<NodeId>,
}

impl ContactRoots {
    pub fn of(dynamics: &Dynamics) -> Option<Self> {
        let ByContact { open, contacts } = dynamics.by_contact.as_ref()?;
        let is_contact = |index: usize| contacts.iter().any(|contact| contact.named == index);
        let others = dynamics.powers.iter().enumerate().filter(|(index, _)| !is_contact(*index));
        let each: Vec<_> = contacts
            .iter()
            .map(|contact| of_push(&contact.push, contact.power.into_iter().collect()))
            .collect();
        Some(ContactRoots {
            open: of_push(open, others.filter_map(|(_, power)| *power).collect()),
            all: each.iter().flatten().flatten().copied().collect(),
            contacts: each,
        })
    }

    /// The forces that every step of every method evaluates.
    pub fn force(&self) -> &[NodeId] {
        let [force, ..] = &self.open;
        force
    }

    /// All functions but the one of these, those of the contacts as one.
    pub fn rare(&self) -> impl Iterator<Item = &[NodeId]> {
        self.open.iter().skip(1).chain([&self.all]).map(Vec::as_slice)
    }

    /// Before: functions that order the code of a function of the state, and of one after another. After: all in order; the first
    /// section of each function, and that of the shared values, have the values that contacts use among their results.
    pub fn order(
        &self,
        graph: &Graph,
        section: impl Fn(&[NodeId]) -> Section,
        behind: impl Fn(&Section, &[NodeId]) -> Section,
    ) -> ContactProgram {
        let function = |index: usize| {
            let roots = |all: &'_ [Vec<NodeId>; 4]| all.get(index).cloned().unwrap_or_default();
            let mut open = section(&roots(&self.open));
            let shared = shared_angles(self.contacts.iter().map(|all| behind(&open, &roots(all))));
            let mut shared = behind(&open, &shared);
            let used = shared.lines.iter().flat_map(|line| line.operands(graph));
            let mut used: BTreeSet<NodeId> = used.chain(shared.results.iter().copied()).collect();
            // Contacts find the values of both.
            let first = open.lines.len();
            open.lines.append(&mut shared.lines);
            let mut contacts = Vec::new();
            for all in &self.contacts {
                let roots = roots(all);
                let code = behind(&open, &roots);
                used.extend(code.lines.iter().flat_map(|line| line.operands(graph)).chain(roots));
                contacts.push(code);
            }
            shared.lines = open.lines.split_off(first);
            shared.results = shared.computed().filter(|id| used.contains(id)).collect();
            let used: Vec<NodeId> = open.computed().filter(|id| used.contains(id)).collect();
            open.results.extend(used);
            (open, shared, contacts)
        };
        let [force, force_q, force_qd, powers] = [0, 1, 2, 3].map(function);
        let open = PushProgram { force: force.0, force_q: force_q.0, force_qd: force_qd.0, powers: powers.0 };
        let shared =
            PushProgram { force: force.1, force_q: force_q.1, force_qd: force_qd.1, powers: powers.1 };
        let contacts = force.2.into_iter().zip(force_q.2).zip(force_qd.2).zip(powers.2);
        let contacts = contacts.map(|(((force, force_q), force_qd), powers)| PushProgram {
            force,
            force_q,
            force_qd,
            powers,
        });
        ContactProgram { open, shared, contacts: contacts.collect() }
    }
}

/// Sines and cosines of the angles that more than one section computes.
fn shared_angles(sections: impl Iterator<Item = Section>) -> Vec<NodeId> {
    let mut found: BTreeMap<NodeId, (usize, BTreeSet<NodeId>)> = BTreeMap::new();
    for section in sections {
        for line in section.lines {
            let Assignment::SineCosine(angles) = line else { continue };
            for Angle { angle, sine, cosine } in angles {
                let (count, values) = found.entry(angle).or_default();
                *count += 1;
                values.extend(sine.into_iter().chain(cosine));
            }
        }
    }
    found.into_values().filter(|(count, _)| 1 < *count).flat_map(|(_, values)| values).collect()
}

fn of_push(push: &Push, powers: Vec<NodeId>) -> [Vec<NodeId>; 4] {
    let entries =
        |matrix: &[Vec<(usize, NodeId)>]| matrix.iter().flatten().map(|(_, entry)| *entry).collect();
    [push.force.iter().copied().flatten().collect(), entries(&push.force_q), entries(&push.force_qd), powers]
}
