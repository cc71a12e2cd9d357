//! Values of graphs: the definition of what a node means.

use super::graph::{Graph, Leaf, Node, NodeId};

/// Substitute for a function that is known at run time alone: the sine of its argument and its index, in closed form
/// at any order. A property of every function is a property of this one.
fn called(function: u32, order: u8, a: f64) -> f64 {
    let x = a + f64::from(function);
    match order % 4 {
        0 => libm::sin(x),
        1 => libm::cos(x),
        2 => -libm::sin(x),
        _ => -libm::cos(x),
    }
}

/// Values of `roots` where the leaves have the values that `leaf` gives.
pub fn evaluate(graph: &Graph, roots: &[NodeId], leaf: impl Fn(Leaf) -> f64) -> Vec<f64> {
    let nodes = graph.reachable(roots.iter().copied());
    // One a node, in their order: a few nodes of a large graph are a few numbers.
    let mut values: Vec<f64> = Vec::with_capacity(nodes.len());
    let of = |values: &[f64], id: NodeId| {
        nodes.binary_search(&id).ok().and_then(|place| values.get(place)).copied().unwrap_or(f64::NAN)
    };
    for id in &nodes {
        let of = |id: NodeId| of(&values, id);
        let value = match graph.node(*id) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Leaf(variable) => leaf(variable),
            Node::Unary(function, a) => (function.entry().value)(of(a)),
            Node::Binary(function, a, b) => (function.entry().value)(of(a), of(b)),
            Node::Call { function, order, argument } => called(function, order, of(argument)),
            Node::Select { less, than, yes, no } => {
                if of(less) < of(than) {
                    of(yes)
                } else {
                    of(no)
                }
            }
        };
        values.push(value);
    }
    roots.iter().map(|root| of(&values, *root)).collect()
}
