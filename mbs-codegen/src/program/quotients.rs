//! Reciprocals of divisors that forces share.

use super::{Roots, dynamics};
use crate::equations::Equations;
use crate::structure::Structure;
use crate::symbolic::{self, Binary, Node};

/// Before: equations with all of their derivatives, and their block order. After: quotients by a divisor that several of one function of
/// every step share are products with its reciprocal. Divisors of rows stay, and those of all else that kinematics compute.
pub fn invert_common_divisors(equations: &mut Equations, structure: &mut Structure) {
    let Some(dynamics) = equations.dynamics.as_ref() else { return };
    let graph = &equations.graph;
    let force = dynamics.force.iter().copied().flatten();
    let mut divisors = symbolic::common_divisors(graph, force);
    for roots in dynamics::Roots::of(dynamics).each_step() {
        divisors.extend(symbolic::common_divisors(graph, roots.iter().copied()));
    }
    let kinematic = Roots::of(equations);
    let of_blocks = structure.roots_mut().into_iter().map(|root| *root);
    let kept = kinematic.functions().into_iter().flatten().copied().chain(of_blocks);
    for id in graph.reachable(kept) {
        if let Node::Binary(Binary::Divide, _, divisor) = graph.node(id) {
            divisors.remove(&divisor);
        }
    }
    if divisors.is_empty() {
        return;
    }
    let roots: Vec<_> = equations.roots_mut().into_iter().map(|root| *root).collect();
    let images = symbolic::invert_divisors(&mut equations.graph, &roots, &divisors);
    for root in equations.roots_mut().into_iter().chain(structure.roots_mut()) {
        *root = images.of(*root);
    }
}
