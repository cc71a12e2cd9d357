//! Degrees of a function in the rates, where its structure shows them.

use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Stage, Unary};

/// `true` if `root` is a sum of products of two rates each, the rest of each free of rates.
pub fn is_quadratic(graph: &Graph, root: NodeId) -> bool {
    let nodes = graph.reachable([root]);
    let mut degrees: Vec<Option<i64>> = vec![None; graph.len()];
    for id in nodes {
        let of = |id: NodeId| degrees.get(id.index()).copied().flatten();
        let degree = match graph.node(id) {
            _ if graph.stage(id) < Stage::Velocity => Some(0),
            Node::Leaf(Leaf::Velocity(_)) => Some(1),
            Node::Unary(Unary::Negate | Unary::Abs, a) => of(a),
            Node::Binary(Binary::Add | Binary::Subtract, a, b) => {
                of(a).filter(|degree| of(b) == Some(*degree))
            }
            Node::Binary(Binary::Multiply, a, b) => of(a).zip(of(b)).map(|(a, b)| a.saturating_add(b)),
            Node::Binary(Binary::Divide, a, b) => of(a).zip(of(b)).map(|(a, b)| a.saturating_sub(b)),
            Node::Binary(Binary::Power, a, exponent) => {
                let twice = graph.constant_value(exponent) == Some(2.0);
                of(a).filter(|_| twice).map(|degree| degree.saturating_mul(2))
            }
            _ => None,
        };
        if let Some(slot) = degrees.get_mut(id.index()) {
            *slot = degree;
        }
    }
    degrees.get(root.index()).copied().flatten() == Some(2)
}
