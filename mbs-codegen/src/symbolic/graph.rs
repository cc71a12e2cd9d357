//! The graph: equal terms exist once, operands always precede their users.

use std::collections::BTreeMap;

use super::operations::{Binary, Unary};

/// Index into a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(u32);

impl NodeId {
    /// Position in the graph.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A variable: its array and its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Leaf {
    /// Constant in time.
    Parameter(u32),
    /// Varies with time, from outside: inputs and their rates.
    Input(u32),
    /// The time.
    Time,
    /// Coordinate.
    Position(u32),
    /// Its rate.
    Velocity(u32),
    /// Rate of its rate.
    Acceleration(u32),
    /// Varies in addition to the coordinates, with a rate of its own.
    State(u32),
    /// Lagrange multiplier, given from outside together with velocities.
    Multiplier(u32),
    /// Component of any vector that a matrix is applied to.
    Direction(u32),
    /// Direction in which a friction slides: constant within a step, given from outside.
    Sliding(u32),
    /// Force with which it sticks, given from outside.
    Holding(u32),
    /// Impulse of the last impact of a rigid contact: constant within a step, given from outside.
    Impulse(u32),
    /// Value that events set: constant within a step, given from outside.
    Remembered(u32),
    /// Computed outside, from the position: known with the accelerations.
    Given(u32, u32),
}

/// Stage in which a value becomes known; a value is computed once, in its stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    Constant,
    Parameter,
    Position,
    Velocity,
    Acceleration,
}

/// A scalar function of the leaves. Numbers are kept by their bits, so that nodes have a total order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Node {
    Constant(u64),
    Leaf(Leaf),
    Unary(Unary, NodeId),
    Binary(Binary, NodeId, NodeId),
    /// `yes` where `less < than`, else `no`.
    Select {
        less: NodeId,
        than: NodeId,
        yes: NodeId,
        no: NodeId,
    },
    /// A function that is known at run time alone, or its derivative of this order.
    ///
    /// All orders at one argument are one operation, a jet; a stage computes it once.
    Call {
        function: u32,
        order: u8,
        argument: NodeId,
    },
}

/// The graph.
#[derive(Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    stages: Vec<Stage>,
    index: BTreeMap<Node, NodeId>,
}

impl Graph {
    /// The node.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes.get(id.index()).copied().unwrap_or(Node::Constant(f64::NAN.to_bits()))
    }

    /// The stage in which the node's value becomes known.
    pub fn stage(&self, id: NodeId) -> Stage {
        self.stages.get(id.index()).copied().unwrap_or(Stage::Constant)
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The number, where the node is one.
    pub fn constant_value(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// The node, where the graph has it already.
    pub fn find(&self, node: Node) -> Option<NodeId> {
        self.index.get(&node).copied()
    }

    /// A number.
    pub fn constant(&mut self, value: f64) -> NodeId {
        self.intern(Node::Constant(value.to_bits()))
    }

    /// A variable.
    pub fn leaf(&mut self, leaf: Leaf) -> NodeId {
        self.intern(Node::Leaf(leaf))
    }

    /// A function by its index, or its derivative of this order.
    pub fn call(&mut self, function: u32, order: u8, argument: NodeId) -> NodeId {
        self.intern(Node::Call { function, order, argument })
    }

    /// Before: operands of `node` are in the graph. After: so is `node`, once.
    pub(super) fn intern(&mut self, node: Node) -> NodeId {
        if let Some(id) = self.index.get(&node) {
            return *id;
        }
        let id = NodeId(self.nodes.len() as u32);
        let stage = match node {
            Node::Constant(_) => Stage::Constant,
            Node::Leaf(Leaf::Parameter(_)) => Stage::Parameter,
            Node::Leaf(Leaf::Input(_) | Leaf::Time | Leaf::Position(_)) => Stage::Position,
            Node::Leaf(
                Leaf::Velocity(_)
                | Leaf::State(_)
                | Leaf::Multiplier(_)
                | Leaf::Direction(_)
                | Leaf::Sliding(_)
                | Leaf::Holding(_)
                | Leaf::Impulse(_)
                | Leaf::Remembered(_),
            ) => Stage::Velocity,
            Node::Leaf(Leaf::Acceleration(_) | Leaf::Given(..)) => Stage::Acceleration,
            // The value of a function is known with the design, not before, even at a number.
            Node::Call { argument, .. } => self.stage(argument).max(Stage::Parameter),
            Node::Unary(_, a) => self.stage(a),
            Node::Binary(_, a, b) => self.stage(a).max(self.stage(b)),
            Node::Select { less, than, yes, no } => {
                self.stage(less).max(self.stage(than)).max(self.stage(yes)).max(self.stage(no))
            }
        };
        self.nodes.push(node);
        self.stages.push(stage);
        self.index.insert(node, id);
        id
    }

    /// Nodes that `roots` depend on, themselves included, operands first.
    pub fn reachable(&self, roots: impl IntoIterator<Item = NodeId>) -> Vec<NodeId> {
        let mut marked = vec![false; self.nodes.len()];
        let mut waiting: Vec<NodeId> = roots.into_iter().collect();
        let mut found = Vec::new();
        while let Some(id) = waiting.pop() {
            if let Some(mark) = marked.get_mut(id.index())
                && !*mark
            {
                *mark = true;
                found.push(id);
                self.node(id).operands_onto(&mut waiting);
            }
        }
        in_order(found, &marked)
    }
}

/// Before: the nodes that are `marked`, in any order. After: operands first.
///
/// Many are read off the marks, few are sorted: this runs for every function, and in users' debug builds.
pub fn in_order(mut found: Vec<NodeId>, marked: &[bool]) -> Vec<NodeId> {
    const MARKS_READ_WHILE_ONE_IS_SORTED: usize = 32;
    if found.len() * MARKS_READ_WHILE_ONE_IS_SORTED < marked.len() {
        found.sort_unstable();
        return found;
    }
    found.clear();
    let mut index = 0;
    while let Some(mark) = marked.get(index) {
        if *mark {
            found.push(NodeId(index as u32));
        }
        index += 1;
    }
    found
}

impl Node {
    /// Its operands.
    pub fn operands(self) -> impl Iterator<Item = NodeId> {
        let operands = match self {
            Node::Constant(_) | Node::Leaf(_) => [None; 4],
            Node::Unary(_, a) | Node::Call { argument: a, .. } => [Some(a), None, None, None],
            Node::Binary(_, a, b) => [Some(a), Some(b), None, None],
            Node::Select { less, than, yes, no } => [Some(less), Some(than), Some(yes), Some(no)],
        };
        operands.into_iter().flatten()
    }

    /// [`Self::operands`] without an iterator, for walks over the whole graph: debug builds expand texts too.
    pub fn operands_onto(self, waiting: &mut Vec<NodeId>) {
        match self {
            Node::Constant(_) | Node::Leaf(_) => {}
            Node::Unary(_, a) | Node::Call { argument: a, .. } => waiting.push(a),
            Node::Binary(_, a, b) => {
                waiting.push(a);
                waiting.push(b);
            }
            Node::Select { less, than, yes, no } => waiting.extend([less, than, yes, no]),
        }
    }
}
