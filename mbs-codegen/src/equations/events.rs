//! Conditions of events, and the values that they latch.

use crate::model::dynamics::Dynamics as Declared;
use crate::model::expression::Id;
use crate::symbolic::{Graph, Leaf, Node, NodeId};

/// Two values, the first of which is the larger one where a condition holds.
pub type Condition = [NodeId; 2];

/// Everything that events evaluate.
#[derive(Debug)]
pub struct Events {
    /// One an event: conditions of its begin and of its end; none where it never ends.
    pub conditions: Vec<(Condition, Option<Condition>)>,
    /// One a latched value.
    pub latched: Vec<NodeId>,
}

impl Events {
    /// Those of a text whose expressions are `of` their identifiers.
    pub fn of(declared: &Declared, of: &impl Fn(Id) -> NodeId) -> Self {
        let conditions = declared.events.iter().filter_map(|event| {
            let ends = event.ends.map(|ends| ends.map(of));
            Some((event.begins?.map(of), ends))
        });
        let latched = declared.latches.iter().filter_map(|latch| latch.value.map(of));
        Events { conditions: conditions.collect(), latched: latched.collect() }
    }

    /// `true` if any of the roots depends on accelerations, multipliers or forces that hold.
    pub fn use_accelerations(&self, graph: &Graph) -> bool {
        let is_one = |id: NodeId| {
            let node = graph.node(id);
            matches!(node, Node::Leaf(Leaf::Acceleration(_) | Leaf::Multiplier(_) | Leaf::Holding(_)))
        };
        graph.reachable(self.roots()).into_iter().any(is_one)
    }

    /// All of the roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let conditions = self.conditions.iter().flat_map(|(begins, ends)| [Some(begins), ends.as_ref()]);
        conditions.flatten().flatten().copied().chain(self.latched.iter().copied())
    }

    /// All of the roots, to be replaced.
    pub fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let conditions = self.conditions.iter_mut().flat_map(|(begins, ends)| [Some(begins), ends.as_mut()]);
        conditions.flatten().flatten().chain(&mut self.latched)
    }
}
