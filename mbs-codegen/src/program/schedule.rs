//! The order of operations within a function.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use crate::symbolic::graph::in_order;
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Straight-line code.
#[derive(Debug, Default)]
pub struct Section {
    /// Operands precede their users.
    pub lines: Vec<Assignment>,
    /// Number of its operations.
    pub operations: Operations,
    /// Values that are used after it.
    pub results: BTreeSet<NodeId>,
}

impl Section {
    /// Values that it computes.
    pub fn computed(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.lines.iter().flat_map(Assignment::values)
    }
}

/// One `let`.
#[derive(Debug)]
pub enum Assignment {
    /// One value.
    Value(NodeId),
    /// Sines and cosines of angles that are known together.
    SineCosine(Vec<Angle>),
    /// A declared function and its derivatives at one argument.
    Jet(FunctionDerivatives),
}

impl Assignment {
    /// Values that it computes.
    pub fn values(&self) -> Vec<NodeId> {
        match self {
            Assignment::Value(id) => vec![*id],
            Assignment::SineCosine(angles) => {
                angles.iter().flat_map(|known| known.sine.into_iter().chain(known.cosine)).collect()
            }
            Assignment::Jet(jet) => jet.orders.iter().copied().flatten().collect(),
        }
    }

    /// Values that it uses.
    pub fn operands(&self, graph: &Graph) -> Vec<NodeId> {
        match self {
            Assignment::Value(id) => graph.node(*id).operands().collect(),
            Assignment::SineCosine(angles) => angles.iter().map(|known| known.angle).collect(),
            Assignment::Jet(jet) => vec![jet.argument],
        }
    }
}

/// A declared function at one argument, up to the highest derivative that is used.
#[derive(Clone, Debug)]
pub struct FunctionDerivatives {
    /// Index of the function.
    pub function: u32,
    /// Its argument.
    pub argument: NodeId,
    /// Value and derivatives by their order, where they are used; the last one is.
    pub orders: Vec<Option<NodeId>>,
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

/// Operations that can be computed once the sines and cosines of lower levels are known.
#[derive(Default)]
struct Level {
    /// All but sines and cosines, operands first.
    lines: Vec<Assignment>,
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
    /// Calls of declared functions, with as many derivatives as are used.
    pub calls: usize,
}

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Self) {
        self.additions += other.additions;
        self.multiplications += other.multiplications;
        self.divisions += other.divisions;
        self.sine_cosines += other.sine_cosines;
        self.functions += other.functions;
        self.selects += other.selects;
        self.calls += other.calls;
    }
}

/// Before: roots, and values that are known already. After: the rest in order, all angles of one depth together, in the
/// order of the coordinates that they begin with. Neighbours among them are then neighbours in their operands and in their
/// users. So a compiler needs fewer operations to move them into and out of registers.
pub fn schedule(graph: &Graph, roots: &[NodeId], known: &BTreeSet<NodeId>) -> Section {
    let nodes = needed(graph, roots, known);
    let mut jets = jets(graph, &nodes);
    // Number of dependent sines and cosines up to a node.
    let mut depths = vec![0_usize; graph.len()];
    let mut first = FirstCoordinates(vec![0; graph.len()]);
    let mut levels: BTreeMap<usize, Level> = BTreeMap::new();
    for id in nodes {
        let node = graph.node(id);
        let below = node.operands().filter_map(|operand| depths.get(operand.index()));
        let mut depth = below.max().copied().unwrap_or(0);
        let level = levels.entry(depth).or_default();
        match node {
            Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) => {
                let known = level.angles.entry(angle).or_insert(Angle { angle, sine: None, cosine: None });
                *(if function == Unary::Sin { &mut known.sine } else { &mut known.cosine }) = Some(id);
                depth += 1;
            }
            Node::Call { function, argument, .. } => {
                // The first order that is met brings all others along.
                level.lines.extend(jets.remove(&(function, argument)).map(Assignment::Jet));
            }
            _ => level.lines.push(Assignment::Value(id)),
        }
        if let Some(known) = depths.get_mut(id.index()) {
            *known = depth;
        }
        first.find(graph, id);
    }
    let mut section = Section { results: roots.iter().copied().collect(), ..Section::default() };
    for Level { lines, angles } in levels.into_values() {
        for line in lines {
            match &line {
                Assignment::Value(id) => count(graph.node(*id), &mut section.operations),
                Assignment::Jet(_) => section.operations.calls += 1,
                Assignment::SineCosine(_) => {}
            }
            section.lines.push(line);
        }
        if !angles.is_empty() {
            section.operations.sine_cosines += angles.len();
            let mut angles: Vec<Angle> = angles.into_values().collect();
            angles.sort_by_key(|known| first.of(graph, known.angle));
            section.lines.push(Assignment::SineCosine(angles));
        }
    }
    section
}

/// Lowest coordinate that each node depends on, as far as it is found below the values that are known already. It is stored
/// plus one, with 0 for none: zeros need no setup, and a section is scheduled for every block.
struct FirstCoordinates(Vec<u32>);

impl FirstCoordinates {
    /// The lowest coordinate of a value; above that of any where there is none.
    fn of(&self, graph: &Graph, id: NodeId) -> u32 {
        match graph.node(id) {
            Node::Leaf(Leaf::Position(index)) => index,
            _ => self.0.get(id.index()).copied().unwrap_or(0).wrapping_sub(1),
        }
    }

    /// Before: it is found of the operands. After: of the value, too.
    fn find(&mut self, graph: &Graph, id: NodeId) {
        let least = graph.node(id).operands().map(|operand| self.of(graph, operand)).min();
        if let (Some(known), Some(least)) = (self.0.get_mut(id.index()), least) {
            *known = least.wrapping_add(1);
        }
    }
}

/// The calls among `nodes`, gathered by function and argument.
fn jets(graph: &Graph, nodes: &[NodeId]) -> BTreeMap<(u32, NodeId), FunctionDerivatives> {
    let mut jets = BTreeMap::new();
    for id in nodes {
        let Node::Call { function, order, argument } = graph.node(*id) else { continue };
        let jet = jets.entry((function, argument)).or_insert(FunctionDerivatives {
            function,
            argument,
            orders: Vec::new(),
        });
        let order = usize::from(order);
        jet.orders.resize(jet.orders.len().max(order + 1), None);
        if let Some(slot) = jet.orders.get_mut(order) {
            *slot = Some(*id);
        }
    }
    jets
}

/// Operations below the roots down to known values, operands first.
pub fn needed(graph: &Graph, roots: &[NodeId], known: &BTreeSet<NodeId>) -> Vec<NodeId> {
    let mut marked = vec![false; graph.len()];
    let mut waiting: Vec<NodeId> = roots.to_vec();
    let mut found = Vec::new();
    while let Some(id) = waiting.pop() {
        let node = graph.node(id);
        let Some(mark) = marked.get_mut(id.index()) else { continue };
        if *mark || known.contains(&id) || matches!(node, Node::Constant(_) | Node::Leaf(_)) {
            continue;
        }
        *mark = true;
        found.push(id);
        node.operands_onto(&mut waiting);
    }
    in_order(found, &marked)
}

fn count(node: Node, operations: &mut Operations) {
    *(match node {
        // Jets are counted as such.
        Node::Constant(_) | Node::Leaf(_) | Node::Call { .. } => return,
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
