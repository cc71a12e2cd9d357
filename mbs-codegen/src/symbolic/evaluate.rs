//! Values of graphs: the definition of what a node means.

use super::graph::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// A function of one number, the same on every host; the runtime's sine and cosine may differ in the last place.
pub fn unary(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Negate => -a,
        Unary::Sqrt => libm::sqrt(a),
        Unary::Exp => libm::exp(a),
        Unary::Ln => libm::log(a),
        Unary::Sin => libm::sin(a),
        Unary::Cos => libm::cos(a),
        Unary::Tan => libm::tan(a),
        Unary::Asin => libm::asin(a),
        Unary::Acos => libm::acos(a),
        Unary::Atan => libm::atan(a),
        Unary::Sinh => libm::sinh(a),
        Unary::Cosh => libm::cosh(a),
        Unary::Tanh => libm::tanh(a),
        Unary::Abs => libm::fabs(a),
        Unary::Sign if a > 0.0 => 1.0,
        Unary::Sign if a < 0.0 => -1.0,
        Unary::Sign => a,
    }
}

/// A function of two numbers, the same on every host.
pub fn binary(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => libm::pow(a, b),
        Binary::Atan2 => libm::atan2(a, b),
        Binary::Min => {
            if a < b {
                a
            } else {
                b
            }
        }
        Binary::Max => {
            if a < b {
                b
            } else {
                a
            }
        }
        Binary::Hypot => libm::hypot(a, b),
    }
}

/// What stands for a function that is known at run time alone: the sine of its argument and its index, in closed form
/// at any order. What holds for every function holds for this one.
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
            Node::Unary(function, a) => unary(function, of(a)),
            Node::Binary(function, a, b) => binary(function, of(a), of(b)),
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
