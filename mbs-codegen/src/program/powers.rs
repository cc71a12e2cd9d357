//! Powers by roots, in every function.

use crate::equations::Equations;
use crate::structure::Structure;
use crate::symbolic::{self, Binary, Node};

/// Before: equations with all of their derivatives, and their block order. After: powers of halves and quarters by roots and products.
pub fn take_roots(equations: &mut Equations, structure: &mut Structure) {
    let mut roots: Vec<_> = equations.roots_mut().into_iter().map(|root| *root).collect();
    roots.extend(structure.roots_mut().into_iter().map(|root| *root));
    let graph = &mut equations.graph;
    let mut nodes = graph.reachable(roots.iter().copied()).into_iter();
    if !nodes.any(|id| matches!(graph.node(id), Node::Binary(Binary::Power, ..))) {
        return;
    }
    let images = symbolic::take_roots(graph, &roots);
    for root in equations.roots_mut().into_iter().chain(structure.roots_mut()) {
        *root = images.of(*root);
    }
}
