//! Powers of halves and quarters by roots and products, once all derivatives are there.

use super::graph::{Graph, Node, NodeId};
use super::operations::{Binary, Unary};
use super::rules::LARGEST_POWER;
use super::substitute::{Images, replace_by};

/// Before: roots, with every derivative among them. After: rule 15 of the [numbered ones](super::rules) in place of the powers below
/// the roots.
///
/// The rule comes last: the derivative of x √x is no number at 0, where that of x^1.5 is 0.
pub fn take_roots(graph: &mut Graph, roots: &[NodeId]) -> Images {
    replace_by(graph, roots, |graph, id| match graph.node(id) {
        Node::Binary(Binary::Power, base, exponent) => power(graph, base, exponent),
        _ => None,
    })
}

/// `base ^ exponent` by roots and products.
fn power(g: &mut Graph, base: NodeId, exponent: NodeId) -> Option<NodeId> {
    let exponent = g.constant_value(exponent)?;
    let (whole, quarters) = (exponent.abs().trunc(), exponent.abs().fract() * 4.0);
    if quarters == 0.0 || quarters.fract() != 0.0 || whole > f64::from(LARGEST_POWER) {
        return None;
    }
    let root = g.unary(Unary::Sqrt, base);
    let roots = if quarters == 2.0 {
        root
    } else {
        let fourth = g.unary(Unary::Sqrt, root);
        if quarters == 1.0 { fourth } else { g.multiply(root, fourth) }
    };
    let whole = g.constant(whole);
    let whole = g.power(base, whole);
    let power = g.multiply(whole, roots);
    if 0.0 < exponent {
        return Some(power);
    }
    let one = g.constant(1.0);
    Some(g.divide(one, power))
}

#[cfg(test)]
#[path = "powers_tests.rs"]
mod tests;
