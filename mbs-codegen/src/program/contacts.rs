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
    /// One a contact: its code after the other forces.
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
    /// section of each function has the values that contacts use among its results, and the sines and cosines that several share.
    pub fn order(
        &self,
        graph: &Graph,
        section: impl Fn(&[NodeId]) -> Section,
        behind: impl Fn(&Section, &[NodeId]) -> Section,
    ) -> ContactProgram {
        let mut function = |index: usize| {
            let roots = |all: &'_ [Vec<NodeId>; 4]| all.get(index).cloned().unwrap_or_default();
            let open = section(&roots(&self.open));
            let each = self.contacts.iter().map(|all| behind(&open, &roots(all)));
            let shared = shared_angles(each);
            let mut first = match shared.is_empty() {
                true => open,
                false => section(&[roots(&self.open), shared].concat()),
            };
            let computed: BTreeSet<NodeId> = first.computed().collect();
            let contact = |all: &[Vec<NodeId>; 4]| {
                let roots = roots(all);
                let code = behind(&first, &roots);
                let used = code.lines.iter().flat_map(|line| line.operands(graph)).chain(roots);
                let used: Vec<NodeId> = used.filter(|id| computed.contains(id)).collect();
                (code, used)
            };
            let (contacts, used): (Vec<Section>, Vec<_>) = self.contacts.iter().map(contact).unzip();
            first.results.extend(used.into_iter().flatten());
            (first, contacts)
        };
        let [force, force_q, force_qd, powers] = [0, 1, 2, 3].map(&mut function);
        let open = PushProgram { force: force.0, force_q: force_q.0, force_qd: force_qd.0, powers: powers.0 };
        let contacts = force.1.into_iter().zip(force_q.1).zip(force_qd.1).zip(powers.1);
        let contacts = contacts.map(|(((force, force_q), force_qd), powers)| PushProgram {
            force,
            force_q,
            force_qd,
            powers,
        });
        ContactProgram { open, contacts: contacts.collect() }
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
