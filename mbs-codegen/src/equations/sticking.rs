//! Frictions with stiction and rigid contacts: length, rate, gradient, right-hand side of its second derivative, and law of each.

use super::lower::Clock;
use super::{again, jacobian};
use crate::model::dynamics::{SetValued, Sticking as Declared};
use crate::model::expression::Id;
use crate::symbolic::{Graph, Leaf, NodeId, tangent};

/// A row s̈ = J q̈ − γ on which friction may hold the mechanism.
#[derive(Debug)]
pub struct Sticking {
    /// s
    pub place: NodeId,
    /// ṡ
    pub rate: Option<NodeId>,
    /// J = ∂s/∂q: column and entry.
    pub gradient: Vec<(usize, NodeId)>,
    /// γ
    pub gamma: Option<NodeId>,
    /// Largest force with which it sticks; none of a contact.
    pub limit: Option<NodeId>,
    /// Coefficient of restitution of a contact.
    pub restitution: Option<NodeId>,
}

impl Sticking {
    /// All of its roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let Sticking { place, rate, gradient, gamma, limit, restitution } = self;
        let entries = gradient.iter().map(|(_, entry)| *entry);
        [Some(*place), *rate, *gamma, *limit, *restitution].into_iter().flatten().chain(entries)
    }

    /// All of its roots, to be replaced.
    pub fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let Sticking { place, rate, gradient, gamma, limit, restitution } = self;
        let entries = gradient.iter_mut().map(|(_, entry)| entry);
        let law = [limit.as_mut(), restitution.as_mut()];
        [Some(place), rate.as_mut(), gamma.as_mut()].into_iter().chain(law).flatten().chain(entries)
    }
}

/// Before: the frictions and rigid contacts of the text. After: their rows.
pub fn sticking(
    g: &mut Graph,
    declared: &[Declared],
    of: &impl Fn(Id) -> NodeId,
    clock: &Clock,
    count: usize,
) -> Vec<Sticking> {
    let mut rows = Vec::new();
    for Declared { along, law, .. } in declared {
        let place = of(*along);
        let first = tangent(g, &[place], |g, leaf| clock.total(g, leaf, false));
        let second = again(g, &first, |g, leaf| clock.total(g, leaf, false)).pop().flatten();
        let gamma = second.map(|second| g.negate(second));
        let gradient = jacobian(g, &[place], count, Leaf::Position).pop().unwrap_or_default();
        let rate = first.into_iter().next().flatten();
        let (limit, restitution) = match law {
            SetValued::Friction { limit } => (Some(of(*limit)), None),
            SetValued::Contact { restitution } => (None, Some(of(*restitution))),
        };
        rows.push(Sticking { place, rate, gradient, gamma, limit, restitution });
    }
    rows
}
