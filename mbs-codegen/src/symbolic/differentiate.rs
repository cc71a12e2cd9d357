//! Exact directional derivatives, linear in the graph.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Graph, Leaf, Node, NodeId};

/// Derivatives of `roots` along the direction in which each leaf moves by `direction(leaf)`.
///
/// `None`, there and in the result, is a structural zero: it never enters the graph. One pass over the reachable
/// nodes, at most [`MOST_PER_NODE`] new nodes for each.
pub fn tangent(
    graph: &mut Graph,
    roots: &[NodeId],
    mut direction: impl FnMut(&mut Graph, Leaf) -> Option<NodeId>,
) -> Vec<Option<NodeId>> {
    let nodes = graph.reachable(roots.iter().copied());
    let mut tangents: Vec<Option<NodeId>> = vec![None; graph.len()];
    for id in nodes {
        step(graph, id, &mut tangents, &mut direction);
    }
    roots.iter().map(|root| tangents.get(root.index()).copied().flatten()).collect()
}

/// Derivatives of `roots` along one leaf after the other, without structural zeros. Of each root: pairs of a leaf's
/// place in `along` and the derivative. As [`tangent`] for each leaf, over the nodes alone that the leaf moves.
pub fn tangents(graph: &mut Graph, roots: &[NodeId], along: &[Leaf]) -> Vec<Vec<(usize, NodeId)>> {
    let users = Users::of(graph, roots);
    let mut roots_of: BTreeMap<NodeId, Vec<usize>> = BTreeMap::new();
    for (index, root) in roots.iter().enumerate() {
        roots_of.entry(*root).or_default().push(index);
    }
    let mut found = vec![Vec::new(); roots.len()];
    let mut tangents: Vec<Option<NodeId>> = vec![None; graph.len()];
    for (place, leaf) in along.iter().enumerate() {
        let Some(start) = graph.find(Node::Leaf(*leaf)).filter(|start| users.contains(*start)) else {
            continue;
        };
        let cone = users.cone(start);
        let mut direction = |g: &mut Graph, other| (other == *leaf).then(|| g.constant(1.0));
        for id in &cone {
            step(graph, *id, &mut tangents, &mut direction);
        }
        for id in cone {
            let Some(value) = tangents.get_mut(id.index()).and_then(Option::take) else { continue };
            for root in roots_of.get(&id).into_iter().flatten() {
                found.get_mut(*root).into_iter().for_each(|row: &mut Vec<_>| row.push((place, value)));
            }
        }
    }
    found
}

/// Users of the nodes below some roots.
struct Users {
    /// Place of each node of the graph among those below the roots, counted from 1.
    places: Vec<u32>,
    /// One a node below the roots.
    users: Vec<Vec<NodeId>>,
}

impl Users {
    fn of(graph: &Graph, roots: &[NodeId]) -> Self {
        let nodes = graph.reachable(roots.iter().copied());
        let mut users = Users { places: vec![0; graph.len()], users: vec![Vec::new(); nodes.len()] };
        for (place, id) in (1..).zip(&nodes) {
            users.places.get_mut(id.index()).into_iter().for_each(|slot| *slot = place);
            for operand in graph.node(*id).operands() {
                if let Some(of) = users.place(operand).and_then(|place| users.users.get_mut(place)) {
                    of.push(*id);
                }
            }
        }
        users
    }

    fn place(&self, id: NodeId) -> Option<usize> {
        self.places.get(id.index()).and_then(|place| place.checked_sub(1)).map(|place| place as usize)
    }

    fn contains(&self, id: NodeId) -> bool {
        self.place(id).is_some()
    }

    /// Nodes that depend on `start`, itself included, operands first.
    fn cone(&self, start: NodeId) -> Vec<NodeId> {
        let mut waiting = vec![start];
        let mut found = BTreeSet::from([start]);
        while let Some(id) = waiting.pop() {
            for user in self.place(id).and_then(|place| self.users.get(place)).into_iter().flatten() {
                if found.insert(*user) {
                    waiting.push(*user);
                }
            }
        }
        found.into_iter().collect()
    }
}

/// Before: tangents of the operands of `id`. After: its own.
fn step(
    graph: &mut Graph,
    id: NodeId,
    tangents: &mut [Option<NodeId>],
    direction: &mut impl FnMut(&mut Graph, Leaf) -> Option<NodeId>,
) {
    let of = |id: NodeId| tangents.get(id.index()).copied().flatten();
    let value = match graph.node(id) {
        Node::Constant(_) => None,
        Node::Leaf(leaf) => direction(graph, leaf),
        Node::Unary(function, a) => of(a).and_then(|da| (function.entry().derivative)(graph, id, a, da)),
        Node::Binary(function, a, b) => match (of(a), of(b)) {
            (None, None) => None,
            (da, db) => (function.entry().derivative)(graph, id, (a, da), (b, db)),
        },
        Node::Call { function, order, argument } => of(argument).map(|moved| {
            let slope = graph.call(function, order.saturating_add(1), argument);
            graph.multiply(slope, moved)
        }),
        Node::Select { less, than, yes, no } => match (of(yes), of(no)) {
            (None, None) => None,
            (dy, dn) => {
                let zero = graph.constant(0.0);
                Some(graph.select(less, than, dy.unwrap_or(zero), dn.unwrap_or(zero)))
            }
        },
    };
    if let Some(slot) = tangents.get_mut(id.index()) {
        *slot = value.filter(|value| graph.constant_value(*value) != Some(0.0));
    }
}

/// Bound on the nodes that one node's derivative adds.
#[cfg(test)]
pub const MOST_PER_NODE: usize = 12;

#[cfg(test)]
#[path = "differentiate_tests.rs"]
mod tests;
