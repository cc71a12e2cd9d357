//! Replacement of nodes.

use super::graph::{Graph, Leaf, Node, NodeId};

/// Images of the nodes below the roots of a replacement.
pub struct Images(Vec<Option<NodeId>>);

impl Images {
    /// Image of a node: itself, where nothing below it was replaced.
    pub fn of(&self, id: NodeId) -> NodeId {
        self.0.get(id.index()).copied().flatten().unwrap_or(id)
    }
}

/// `root` with every leaf for which `replacement` gives a node replaced by it.
pub fn substitute(graph: &mut Graph, root: NodeId, replacement: impl Fn(Leaf) -> Option<NodeId>) -> NodeId {
    let images = replace(graph, &[root], |graph, id| match graph.node(id) {
        Node::Leaf(leaf) => replacement(leaf),
        _ => None,
    });
    images.of(root)
}

/// Before: roots of a graph. After: below them every node for which `replacement` gives another is replaced by it, and its
/// users are built anew.
pub fn replace(
    graph: &mut Graph,
    roots: &[NodeId],
    replacement: impl Fn(&Graph, NodeId) -> Option<NodeId>,
) -> Images {
    let nodes = graph.reachable(roots.iter().copied());
    let mut images = Images(vec![None; graph.len()]);
    for id in nodes {
        let image = replacement(graph, id).unwrap_or_else(|| rebuilt(graph, id, &images));
        if let Some(slot) = images.0.get_mut(id.index()) {
            *slot = Some(image);
        }
    }
    images
}

/// [`replace`], where `build` gets each node with the images of its operands.
pub fn replace_by(
    graph: &mut Graph,
    roots: &[NodeId],
    build: impl Fn(&mut Graph, NodeId) -> Option<NodeId>,
) -> Images {
    let nodes = graph.reachable(roots.iter().copied());
    let mut images = Images(vec![None; graph.len()]);
    for id in nodes {
        let image = rebuilt(graph, id, &images);
        let image = build(graph, image).unwrap_or(image);
        if let Some(slot) = images.0.get_mut(id.index()) {
            *slot = Some(image);
        }
    }
    images
}

/// The node with the images of its operands.
fn rebuilt(graph: &mut Graph, id: NodeId, images: &Images) -> NodeId {
    let of = |id: NodeId| images.of(id);
    match graph.node(id) {
        node if node.operands().all(|operand| of(operand) == operand) => id,
        Node::Constant(_) | Node::Leaf(_) => id,
        Node::Unary(function, a) => graph.unary(function, of(a)),
        Node::Binary(function, a, b) => graph.binary(function, of(a), of(b)),
        Node::Call { function, order, argument } => graph.call(function, order, of(argument)),
        Node::Select { less, than, yes, no } => graph.select(of(less), of(than), of(yes), of(no)),
    }
}
