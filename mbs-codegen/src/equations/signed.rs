//! What must not become negative while a mechanism is used: masses, moments of inertia and stiffnesses that parameters make.

use std::collections::{BTreeMap, BTreeSet};

use crate::symbolic::{Graph, Leaf, Node, NodeId, Stage};

/// A value of parameters alone that is at least 0.
#[derive(Clone, Copy, Debug)]
pub struct Signed {
    /// Which of the model's signed values it is, the first of those that are one node.
    pub index: usize,
    /// The value.
    pub node: NodeId,
    /// The first parameter that it is made of.
    pub parameter: u32,
}

/// Before: the signed values of a model as nodes. After: those that parameters alone decide about, each node once; numbers are
/// judged already, and what else they are made of may change their sign on the way.
pub fn signed(graph: &Graph, values: impl Iterator<Item = NodeId>) -> Vec<Signed> {
    let mut known = BTreeSet::new();
    let mut candidates: Vec<(usize, NodeId)> = values.enumerate().collect();
    candidates.retain(|(_, node)| graph.stage(*node) == Stage::Parameter && known.insert(*node));
    let mut parameters = BTreeMap::new();
    for id in graph.reachable(known) {
        let node = graph.node(id);
        let own = match node {
            Node::Leaf(Leaf::Parameter(index)) => Some(index),
            _ => node.operands().find_map(|operand| parameters.get(&operand).copied()),
        };
        parameters.extend(own.map(|own| (id, own)));
    }
    let found = candidates.into_iter();
    found
        .filter_map(|(index, node)| Some(Signed { index, node, parameter: *parameters.get(&node)? }))
        .collect()
}
