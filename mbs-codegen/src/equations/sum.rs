//! Sums whose terms come one by one.

use crate::symbolic::{Graph, NodeId};

/// A sum of which no term may be there yet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum(pub Option<NodeId>);

impl Sum {
    /// Adds a term after the others.
    pub fn add(&mut self, g: &mut Graph, term: NodeId) {
        self.0 = Some(match self.0 {
            Some(sum) => g.add(sum, term),
            None => term,
        });
    }

    /// Less a term that may be zero.
    pub fn minus(self, g: &mut Graph, term: Option<NodeId>) -> Self {
        Sum(match (self.0, term) {
            (Some(sum), Some(term)) => Some(g.subtract(sum, term)),
            (sum, None) => sum,
            (None, Some(term)) => Some(g.negate(term)),
        })
    }
}
