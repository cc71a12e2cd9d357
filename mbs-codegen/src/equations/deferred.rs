//! Derivatives of forces that declared functions are not smooth enough for: left out, and named.

use super::continuity::derivative;
use super::{Equations, Sparse};
use crate::model::Model;
use crate::symbolic::{Node, NodeId};

/// The functions that implicit methods, rests and small motions alone need; those that a rest needs are named first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// ∂Q/∂q
    ForceByPlace,
    /// ∂Q/∂q̇
    ForceBySpeed,
    /// (M x)_q
    Inertia,
    /// (Φ_qᵀ λ)_q
    Reaction,
    /// ∂Q/∂z and the derivatives of ż
    States,
}

impl Slopes {
    const ALL: [Slopes; 5] =
        [Slopes::ForceByPlace, Slopes::Reaction, Slopes::States, Slopes::ForceBySpeed, Slopes::Inertia];

    /// `true` for those that a position of rest depends on.
    pub fn acts_at_rest(self) -> bool {
        !matches!(self, Slopes::ForceBySpeed | Slopes::Inertia)
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Slopes::ForceByPlace => "∂Q/∂q",
            Slopes::ForceBySpeed => "∂Q/∂q̇",
            Slopes::Inertia => "(M x)_q",
            Slopes::Reaction => "(Φ_qᵀ λ)_q",
            Slopes::States => "a derivative by a state",
        }
    }
}

/// A function of dynamics that is not emitted, with the reason.
#[derive(Clone, Copy, Debug)]
pub struct Missing {
    /// The missing slopes.
    pub slopes: Slopes,
    /// Index of the declared function that is not smooth enough.
    pub function: usize,
    /// The order of its derivative that would be needed.
    pub order: u8,
}

impl Missing {
    /// "the third derivative".
    pub fn derivative(self) -> String {
        derivative(self.order)
    }
}

impl Equations {
    /// Before: all roots. After: no derivatives of forces that need more of a declared function than the text declares: explicit methods do
    /// without them.
    pub(super) fn defer_slopes(&mut self, model: &Model) {
        if self.calls.is_empty() {
            return;
        }
        for slopes in Slopes::ALL {
            let Some((function, order)) = self.beyond(model, self.slope_roots(slopes)) else { continue };
            let Some(dynamics) = &mut self.dynamics else { return };
            let clear = |matrix: &mut Sparse| matrix.iter_mut().for_each(Vec::clear);
            match slopes {
                Slopes::ForceByPlace => {
                    clear(&mut dynamics.force_q);
                    dynamics.pushes_mut().for_each(|push| clear(&mut push.force_q));
                }
                Slopes::ForceBySpeed => {
                    clear(&mut dynamics.force_qd);
                    dynamics.pushes_mut().for_each(|push| clear(&mut push.force_qd));
                }
                Slopes::Inertia => clear(&mut dynamics.mass_times_q),
                Slopes::Reaction => clear(&mut dynamics.reaction_q),
                Slopes::States => dynamics.slopes.clear(),
            }
            dynamics.missing.push(Missing { slopes, function, order });
        }
    }

    fn slope_roots(&self, slopes: Slopes) -> Vec<NodeId> {
        let Some(dynamics) = &self.dynamics else { return Vec::new() };
        let matrix = match slopes {
            Slopes::ForceByPlace => &dynamics.force_q,
            Slopes::ForceBySpeed => &dynamics.force_qd,
            Slopes::Inertia => &dynamics.mass_times_q,
            Slopes::Reaction => &dynamics.reaction_q,
            Slopes::States => return dynamics.slopes.iter().flat_map(|slope| slope.roots()).collect(),
        };
        matrix.iter().flatten().map(|(_, entry)| *entry).collect()
    }

    /// The first function below `roots` with a higher order than the text declares, and its highest order.
    fn beyond(&self, model: &Model, roots: Vec<NodeId>) -> Option<(usize, u8)> {
        let calls = self.graph.reachable(roots).into_iter().filter_map(|id| match self.graph.node(id) {
            Node::Call { function, order, .. } => Some((function as usize, order)),
            _ => None,
        });
        let declared = |function: usize| model.functions.get(function).map_or(u8::MAX, |f| f.continuity);
        calls
            .filter(|(function, order)| declared(*function) < *order)
            .min_by_key(|(function, order)| (*function, u8::MAX - order))
    }
}
