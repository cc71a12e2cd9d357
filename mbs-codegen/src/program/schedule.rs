//! The order of operations within a function.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Straight-line code.
#[derive(Debug, Default)]
pub struct Section {
    /// Operands stand before what uses them.
    pub lines: Vec<Line>,
    /// What it costs.
    pub operations: Operations,
    /// Values that are used behind it.
    pub results: BTreeSet<NodeId>,
}

impl Section {
    /// Values that it computes.
    pub fn computed(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.lines.iter().flat_map(Line::values)
    }
}

/// One `let`.
#[derive(Debug)]
pub enum Line {
    /// One value.
    Value(NodeId),
    /// Sines and cosines of angles that are known together.
    SineCosine(Vec<Angle>),
}

impl Line {
    /// Values that it computes.
    pub fn values(&self) -> Vec<NodeId> {
        match self {
            Line::Value(id) => vec![*id],
            Line::SineCosine(angles) => {
                angles.iter().flat_map(|known| known.sine.into_iter().chain(known.cosine)).collect()
            }
        }
    }

    /// Values that it uses.
    pub fn operands(&self, graph: &Graph) -> Vec<NodeId> {
        match self {
            Line::Value(id) => graph.node(*id).operands().collect(),
            Line::SineCosine(angles) => angles.iter().map(|known| known.angle).collect(),
        }
    }
}

/// An angle of which sine, cosine or both are computed.
#[derive(Clone, Copy, Debug)]
pub struct Angle {
    /// The angle.
    pub angle: NodeId,
    /// Its sine, where it is used.
    pub sine: Option<NodeId>,
    /// Its cosine, where it is used.
    pub cosine: Option<NodeId>,
}

/// What can be computed once the sines and cosines of lower levels are known.
#[derive(Default)]
struct Level {
    values: Vec<NodeId>,
    angles: BTreeMap<NodeId, Angle>,
}

/// Number of operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Sums, differences and changes of sign.
    pub additions: usize,
    /// Products.
    pub multiplications: usize,
    /// Quotients.
    pub divisions: usize,
    /// Angles of which sine, cosine or both are computed.
    pub sine_cosines: usize,
    /// Other elementary functions.
    pub functions: usize,
    /// Selections by a comparison.
    pub selects: usize,
}

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Self) {
        self.additions += other.additions;
        self.multiplications += other.multiplications;
        self.divisions += other.divisions;
        self.sine_cosines += other.sine_cosines;
        self.functions += other.functions;
        self.selects += other.selects;
    }
}

/// Before: roots, and values that are known already. After: the rest in order, all angles of one depth together.
pub fn schedule(graph: &Graph, roots: &[NodeId], known: &BTreeSet<NodeId>) -> Section {
    let nodes = needed(graph, roots, known);
    // How many sines and cosines stand one behind the other up to a node.
    let mut depths: BTreeMap<NodeId, usize> = BTreeMap::new();
    let mut levels: BTreeMap<usize, Level> = BTreeMap::new();
    for id in nodes {
        let node = graph.node(id);
        let depth = node.operands().filter_map(|operand| depths.get(&operand)).max().copied().unwrap_or(0);
        let level = levels.entry(depth).or_default();
        match node {
            Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) => {
                let known = level.angles.entry(angle).or_insert(Angle { angle, sine: None, cosine: None });
                *(if function == Unary::Sin { &mut known.sine } else { &mut known.cosine }) = Some(id);
                depths.insert(id, depth + 1);
            }
            _ => {
                level.values.push(id);
                depths.insert(id, depth);
            }
        }
    }
    let mut section = Section { results: roots.iter().copied().collect(), ..Section::default() };
    for Level { values, angles } in levels.into_values() {
        for id in values {
            count(graph.node(id), &mut section.operations);
            section.lines.push(Line::Value(id));
        }
        if !angles.is_empty() {
            section.operations.sine_cosines += angles.len();
            section.lines.push(Line::SineCosine(angles.into_values().collect()));
        }
    }
    section
}

/// Operations below the roots down to known values, operands first.
fn needed(graph: &Graph, roots: &[NodeId], known: &BTreeSet<NodeId>) -> BTreeSet<NodeId> {
    let mut found = BTreeSet::new();
    let mut waiting: Vec<NodeId> = roots.to_vec();
    while let Some(id) = waiting.pop() {
        let node = graph.node(id);
        if known.contains(&id) || matches!(node, Node::Constant(_) | Node::Leaf(_)) || !found.insert(id) {
            continue;
        }
        waiting.extend(node.operands());
    }
    found
}

fn count(node: Node, operations: &mut Operations) {
    *(match node {
        Node::Constant(_) | Node::Leaf(Leaf::Parameter(_) | Leaf::Input(_) | Leaf::Time) | Node::Leaf(_) => {
            return;
        }
        Node::Unary(Unary::Negate, _) | Node::Binary(Binary::Add | Binary::Subtract, ..) => {
            &mut operations.additions
        }
        Node::Binary(Binary::Multiply, ..) => &mut operations.multiplications,
        Node::Binary(Binary::Divide, ..) => &mut operations.divisions,
        Node::Unary(Unary::Abs | Unary::Sign, _)
        | Node::Binary(Binary::Min | Binary::Max, ..)
        | Node::Select { .. } => &mut operations.selects,
        Node::Unary(..) | Node::Binary(Binary::Power | Binary::Atan2 | Binary::Hypot, ..) => {
            &mut operations.functions
        }
    }) += 1;
}
