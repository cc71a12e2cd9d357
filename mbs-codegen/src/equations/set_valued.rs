//! Frictions with stiction and rigid contacts: length, rate, gradient, right-hand side of its second derivative, and law of each.

use super::lower::Clock;
use super::{again, jacobian};
use crate::model::dynamics::{SetValued, SetValuedForce as Declared};
use crate::model::expression::Id;
use crate::symbolic::{Graph, Leaf, NodeId, tangent};

/// A row s̈ = J q̈ − γ on which friction may hold the mechanism.
#[derive(Debug)]
pub struct SetValuedRow {
    /// s
    pub place: NodeId,
    /// ṡ
    pub rate: Option<NodeId>,
    /// J = ∂s/∂q: column and entry.
    pub gradient: Vec<(usize, NodeId)>,
    /// γ
    pub gamma: Option<NodeId>,
    /// Largest force with which it sticks; none of a contact and of a friction on one.
    pub limit: Option<NodeId>,
    /// Coefficient of restitution of a contact.
    pub restitution: Option<NodeId>,
    /// `true` for a contact that strikes by itself.
    pub ordered: bool,
    /// The rigid contact that a friction is on.
    pub on: Option<OnContact>,
}

/// A friction on a rigid contact.
#[derive(Clone, Copy, Debug)]
pub struct OnContact {
    /// The contact by its index.
    pub contact: usize,
    /// Coefficient of impacts.
    pub coefficient: NodeId,
    /// Coefficient at the present speed.
    pub sliding: NodeId,
    /// Coefficient of sticking.
    pub sticking: NodeId,
}

impl SetValuedRow {
    /// All of its roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let SetValuedRow { place, rate, gradient, gamma, limit, restitution, on, ordered: _ } = self;
        let entries = gradient.iter().map(|(_, entry)| *entry);
        let coefficients = on.iter().flat_map(|on| [on.coefficient, on.sliding, on.sticking]);
        let law = [*limit, *restitution];
        [Some(*place), *rate, *gamma].into_iter().chain(law).flatten().chain(coefficients).chain(entries)
    }

    /// All of its roots, to be replaced.
    pub fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let SetValuedRow { place, rate, gradient, gamma, limit, restitution, on, ordered: _ } = self;
        let entries = gradient.iter_mut().map(|(_, entry)| entry);
        let law = [limit.as_mut(), restitution.as_mut()];
        let coefficients =
            on.iter_mut().flat_map(|on| [&mut on.coefficient, &mut on.sliding, &mut on.sticking]);
        let motion = [Some(place), rate.as_mut(), gamma.as_mut()];
        motion.into_iter().chain(law).flatten().chain(coefficients).chain(entries)
    }
}

/// Before: the frictions and rigid contacts of the text. After: their rows.
pub fn set_valued_rows(
    g: &mut Graph,
    declared: &[Declared],
    of: &impl Fn(Id) -> NodeId,
    clock: &Clock,
    count: usize,
) -> Vec<SetValuedRow> {
    let mut rows = Vec::new();
    for Declared { along, law, .. } in declared {
        let place = of(*along);
        let first = tangent(g, &[place], |g, leaf| clock.total(g, leaf, false));
        let second = again(g, &first, |g, leaf| clock.total(g, leaf, false)).pop().flatten();
        let gamma = second.map(|second| g.negate(second));
        let gradient = jacobian(g, &[place], count, Leaf::Position).pop().unwrap_or_default();
        let rate = first.into_iter().next().flatten();
        let (limit, restitution, on) = match law {
            SetValued::Friction { limit } => (Some(of(*limit)), None, None),
            SetValued::FrictionOnContact(on) => (None, None, Some(*on)),
            SetValued::Contact { restitution, .. } => (None, Some(of(*restitution)), None),
        };
        let ordered = matches!(law, SetValued::Contact { ordered: true, .. });
        let on = on.map(|on| OnContact {
            contact: on.contact,
            coefficient: of(on.coefficient),
            sliding: of(on.sliding),
            sticking: of(on.sticking),
        });
        rows.push(SetValuedRow { place, rate, gradient, gamma, limit, restitution, ordered, on });
    }
    rows
}
