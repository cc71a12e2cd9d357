//! Values that must not become negative while a mechanism is used: masses, moments of inertia and stiffnesses that
//! parameters make.

use std::collections::{BTreeMap, BTreeSet};

use super::second_moments::Condition;
use crate::symbolic::{Graph, Leaf, Node, NodeId, Stage};

/// Origin of a value that is at least 0.
#[derive(Clone, Copy, Debug)]
pub enum Of {
    /// The model's signed value of this index, the first of those that are one node.
    Field(usize),
    /// The model's inertia in space of this index, by this condition.
    Inertia(usize, Condition),
}

/// A value of parameters alone that is at least 0.
#[derive(Clone, Copy, Debug)]
pub struct NonNegative {
    /// Its origin.
    pub of: Of,
    /// The value.
    pub node: NodeId,
    /// The first parameter that it depends on.
    pub parameter: u32,
}

/// Before: the signed values of a model as nodes. After: those that depend on parameters alone, each node once. Numbers are
/// judged already; values that depend on more may change their sign during a motion.
pub fn signed(graph: &Graph, values: impl Iterator<Item = (Of, NodeId)>) -> Vec<NonNegative> {
    let mut known = BTreeSet::new();
    let mut candidates: Vec<(Of, NodeId)> = values.collect();
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
        .filter_map(|(of, node)| Some(NonNegative { of, node, parameter: *parameters.get(&node)? }))
        .collect()
}
