//! Replacement of leaves.

use super::graph::{Graph, Leaf, Node, NodeId};

/// `root` with every leaf for which `replacement` gives a node replaced by it.
pub fn substitute(graph: &mut Graph, root: NodeId, replacement: impl Fn(Leaf) -> Option<NodeId>) -> NodeId {
    let nodes = graph.reachable([root]);
    let mut images: Vec<Option<NodeId>> = vec![None; graph.len()];
    for id in nodes {
        let of = |id: NodeId| images.get(id.index()).copied().flatten().unwrap_or(id);
        let image = match graph.node(id) {
            Node::Constant(_) => id,
            Node::Leaf(leaf) => replacement(leaf).unwrap_or(id),
            node if node.operands().all(|operand| of(operand) == operand) => id,
            Node::Unary(function, a) => {
                let a = of(a);
                graph.unary(function, a)
            }
            Node::Binary(function, a, b) => {
                let (a, b) = (of(a), of(b));
                graph.binary(function, a, b)
            }
            Node::Call { function, order, argument } => {
                let argument = of(argument);
                graph.call(function, order, argument)
            }
            Node::Select { less, than, yes, no } => {
                let (less, than, yes, no) = (of(less), of(than), of(yes), of(no));
                graph.select(less, than, yes, no)
            }
        };
        if let Some(slot) = images.get_mut(id.index()) {
            *slot = Some(image);
        }
    }
    images.get(root.index()).copied().flatten().unwrap_or(root)
}
