//! Quotients with a common divisor as products with its reciprocal.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Graph, Node, NodeId, Stage};
use super::operations::Binary;
use super::substitute::{Images, replace_by};

/// Quotients with one divisor from which on its reciprocal is taken: a division takes as long as three products or more.
const LEAST: usize = 3;

/// Before: roots that are computed together. After: the divisors of at least [`LEAST`] quotients below them. Those of parameters, which
/// are computed once, are left out.
pub fn common_divisors(graph: &Graph, roots: impl Iterator<Item = NodeId>) -> BTreeSet<NodeId> {
    let mut counts: BTreeMap<NodeId, usize> = BTreeMap::new();
    for id in graph.reachable(roots) {
        if let Node::Binary(Binary::Divide, _, divisor) = graph.node(id)
            && graph.stage(divisor) >= Stage::Position
        {
            *counts.entry(divisor).or_default() += 1;
        }
    }
    counts.into_iter().filter(|(_, count)| LEAST <= *count).map(|(divisor, _)| divisor).collect()
}

/// Before: roots and divisors. After: rule 16 of the [numbered ones](super::rules) in place of all quotients by these below the roots.
pub fn invert_divisors(graph: &mut Graph, roots: &[NodeId], divisors: &BTreeSet<NodeId>) -> Images {
    replace_by(graph, roots, |graph, id, image| {
        let (Node::Binary(Binary::Divide, _, divisor), Node::Binary(Binary::Divide, a, b)) =
            (graph.node(id), graph.node(image))
        else {
            return None;
        };
        if !divisors.contains(&divisor) {
            return None;
        }
        let one = graph.constant(1.0);
        let reciprocal = graph.divide(one, b);
        Some(graph.multiply(a, reciprocal))
    })
}

#[cfg(test)]
#[path = "quotients_tests.rs"]
mod tests;
