//! Values that a stage keeps for later stages.

use std::collections::{BTreeMap, BTreeSet};

use crate::symbolic::{Graph, Leaf, Node, NodeId, Stage};

/// Values of parameters alone that something of a later stage, or a root, uses.
pub fn parameter_fields(graph: &Graph, functions: &[&[NodeId]]) -> BTreeSet<NodeId> {
    let mut fields = BTreeSet::new();
    let early = |id: NodeId| graph.stage(id) == Stage::Parameter && !matches!(graph.node(id), Node::Leaf(_));
    let roots = || functions.iter().flat_map(|roots| roots.iter().copied());
    fields.extend(roots().filter(|id| early(*id)));
    let mut operands = Vec::new();
    for id in graph.reachable(roots()) {
        if graph.stage(id) > Stage::Parameter {
            graph.node(id).operands_onto(&mut operands);
        }
    }
    fields.extend(operands.into_iter().filter(|operand| early(*operand)));
    fields
}

/// Values of `(q, t)` that several functions share, as far as a value that is not shared uses them.
///
/// Coordinates and time themselves count as shared: functions after the stage do not get them again. Values that only
/// `rare` functions share are not kept.
pub fn position_fields(graph: &Graph, functions: &[&[NodeId]], rare: &[&[NodeId]]) -> BTreeSet<NodeId> {
    let all: Vec<&[NodeId]> = functions.iter().chain(rare).copied().collect();
    let reached: Vec<Vec<NodeId>> = all.iter().map(|roots| graph.reachable(roots.iter().copied())).collect();
    let mut users = vec![0_u32; graph.len()];
    // A jet is one operation, whichever of its derivatives a function uses.
    let mut users_of_jets: BTreeMap<(u32, NodeId), BTreeSet<usize>> = BTreeMap::new();
    for (user, nodes) in reached.iter().take(functions.len()).enumerate() {
        for id in nodes {
            if let Some(count) = users.get_mut(id.index()) {
                *count += 1;
            }
            if let Node::Call { function, argument, .. } = graph.node(*id) {
                users_of_jets.entry((function, argument)).or_default().insert(user);
            }
        }
    }
    let shared = |id: NodeId| match graph.node(id) {
        Node::Leaf(Leaf::Position(_) | Leaf::Time) => true,
        Node::Leaf(_) => false,
        _ if graph.stage(id) != Stage::Position => false,
        Node::Call { function, argument, .. } => {
            users_of_jets.get(&(function, argument)).is_some_and(|users| users.len() > 1)
        }
        _ => users.get(id.index()).is_some_and(|count| *count > 1),
    };
    let mut fields = BTreeSet::new();
    for (roots, nodes) in all.iter().zip(&reached) {
        fields.extend(roots.iter().copied().filter(|id| shared(*id)));
        for id in nodes.iter().filter(|id| !shared(**id)) {
            fields.extend(graph.node(*id).operands().filter(|operand| shared(*operand)));
        }
    }
    fields
}
