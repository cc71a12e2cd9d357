//! Sines and cosines of sums of angles by the addition theorems.

use std::collections::BTreeMap;

use super::graph::{Graph, Node, NodeId};
use super::operations::Unary;
use super::substitute::{Images, replace};

/// An angle as the sum of two others, or as their difference.
#[derive(Clone, Copy, Debug)]
pub struct AngleSum {
    /// The angle.
    pub angle: NodeId,
    /// The first of the others.
    pub first: NodeId,
    /// The second of them.
    pub second: NodeId,
    /// `true` if the second is taken off the first.
    pub minus: bool,
}

/// Before: roots, and sums ordered so that sums which others depend on come first. No sine and no cosine of one of the
/// angles is below an angle. After: `sin(a ± b) = sin a cos b ± cos a sin b` and `cos(a ± b) = cos a cos b ∓ sin a sin b`
/// replace the sines and cosines of the sums below the roots. At any angle the error is a few roundings of values up to 1.
pub fn add_angles(graph: &mut Graph, roots: &[NodeId], sums: &[AngleSum]) -> Images {
    let mut pairs: BTreeMap<NodeId, [NodeId; 2]> = BTreeMap::new();
    for AngleSum { angle, first, second, minus } in sums {
        let mut pair = |angle: &NodeId| match pairs.get(angle) {
            Some(pair) => *pair,
            None => [graph.unary(Unary::Sin, *angle), graph.unary(Unary::Cos, *angle)],
        };
        let ([sine_a, cosine_a], [sine_b, cosine_b]) = (pair(first), pair(second));
        let (along, across) = (graph.multiply(sine_a, cosine_b), graph.multiply(cosine_a, sine_b));
        let sine = if *minus { graph.subtract(along, across) } else { graph.add(along, across) };
        let (along, across) = (graph.multiply(cosine_a, cosine_b), graph.multiply(sine_a, sine_b));
        let cosine = if *minus { graph.add(along, across) } else { graph.subtract(along, across) };
        pairs.insert(*angle, [sine, cosine]);
    }
    replace(graph, roots, |graph, id| match graph.node(id) {
        Node::Unary(Unary::Sin, angle) => pairs.get(&angle).map(|[sine, _]| *sine),
        Node::Unary(Unary::Cos, angle) => pairs.get(&angle).map(|[_, cosine]| *cosine),
        _ => None,
    })
}
