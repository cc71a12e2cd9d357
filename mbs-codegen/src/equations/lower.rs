//! The model's expressions as nodes of the graph.

use crate::model::expression::{self, Id};
use crate::model::units::Dimension;
use crate::model::{Model, VariableKind};
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Stage, Unary, tangent};

/// The graph with everything that needs no differentiation.
pub struct Lowered {
    pub graph: Graph,
    pub residuals: Vec<NodeId>,
    pub branches: Vec<NodeId>,
    /// Lower bound, value, upper bound.
    pub limits: Vec<[NodeId; 3]>,
    /// Driven argument, and its rate.
    pub phases: Vec<[NodeId; 2]>,
    /// Value, and the number of time derivatives that its definition admits.
    pub outputs: Vec<(NodeId, u8)>,
    pub guesses: Vec<NodeId>,
    pub coordinate_scales: Vec<NodeId>,
    pub row_scales: Vec<NodeId>,
    /// Widths by which rows may contradict each other; empty where the text gives none.
    pub widths: Vec<NodeId>,
    /// The reference length.
    pub length: NodeId,
    /// One a call of a declared function, in the order of the model.
    pub calls: Vec<NodeId>,
    pub clock: Clock,
    /// One an expression of the model.
    pub nodes: Vec<NodeId>,
}

/// First index of a given leaf that is a margin, by its group; others are ∂q/∂drive, by the drive's row.
pub const MARGIN: u32 = u32::MAX;
/// First index of a given leaf that represents the force of a pin until its sums are known, by pin and component.
pub const PIN: u32 = u32::MAX - 1;

/// Time derivatives of leaves.
pub struct Clock {
    kinds: Vec<VariableKind>,
}

impl Clock {
    /// Motion with the coordinates held: time and inputs.
    pub fn partial(&self, g: &mut Graph, leaf: Leaf) -> Option<NodeId> {
        match leaf {
            Leaf::Time => Some(g.constant(1.0)),
            // The rate follows the value, the acceleration follows the rate.
            Leaf::Input(i) if self.moves(i) => Some(g.leaf(Leaf::Input(i + 1))),
            _ => None,
        }
    }

    /// Motion of all leaves; `accelerating`: `true` if q̇ moves too.
    pub fn total(&self, g: &mut Graph, leaf: Leaf, accelerating: bool) -> Option<NodeId> {
        match leaf {
            Leaf::Position(i) => Some(g.leaf(Leaf::Velocity(i))),
            Leaf::Velocity(i) if accelerating => Some(g.leaf(Leaf::Acceleration(i))),
            other => self.partial(g, other),
        }
    }

    fn kind(&self, index: u32) -> Option<VariableKind> {
        self.kinds.get(index as usize).copied()
    }

    /// `true` if the next variable is this one's rate.
    fn moves(&self, index: u32) -> bool {
        match self.kind(index) {
            Some(VariableKind::InputWithRates) => true,
            Some(VariableKind::InputRate) => {
                self.kind(index.wrapping_sub(1)) == Some(VariableKind::InputWithRates)
            }
            _ => false,
        }
    }

    /// Number of times that a leaf was differentiated already, of two.
    fn order(&self, leaf: Leaf) -> u8 {
        match leaf {
            Leaf::Parameter(_) | Leaf::Time | Leaf::Position(_) => 0,
            Leaf::Velocity(_) => 1,
            Leaf::Acceleration(_)
            | Leaf::State(_)
            | Leaf::Multiplier(_)
            | Leaf::Sliding(_)
            | Leaf::Holding(_)
            | Leaf::Impulse(_)
            | Leaf::Remembered(_)
            | Leaf::Direction(_)
            | Leaf::Given(..) => 2,
            Leaf::Input(i) => match self.kind(i) {
                Some(VariableKind::InputWithRates) => 0,
                Some(VariableKind::InputRate) if self.moves(i) => 1,
                _ => 2,
            },
        }
    }
}

/// Before: a resolved model. After: all its expressions in one graph.
pub fn lower(model: &Model) -> Lowered {
    let clock = Clock { kinds: model.variables.iter().map(|variable| variable.kind).collect() };
    let mut graph = Graph::default();
    let nodes = expressions(model, &clock, &mut graph);
    let zero = graph.constant(0.0);
    let of = |id: Id| nodes.get(id.index()).copied().unwrap_or(zero);
    let outputs = model.outputs.iter().map(|output| of(output.value));
    let outputs = outputs.map(|value| (value, derivatives(model, &graph, &clock, value))).collect();
    let length = reference_length(model, &mut graph);
    let mut scale = |dimension: Dimension| {
        let exponent = graph.constant(dimension.metres());
        graph.power(length, exponent)
    };
    Lowered {
        residuals: model.rows.iter().map(|row| of(row.residual)).collect(),
        branches: model.branches.iter().map(|branch| of(branch.value)).collect(),
        limits: model.limits.iter().map(|limit| [of(limit.low), of(limit.value), of(limit.high)]).collect(),
        phases: model.phases.iter().map(|phase| [of(phase.argument), of(phase.speed)]).collect(),
        outputs,
        guesses: model.coordinates.iter().map(|coordinate| coordinate.guess.map_or(zero, of)).collect(),
        coordinate_scales: model.coordinates.iter().map(|coordinate| scale(coordinate.dimension)).collect(),
        row_scales: model.rows.iter().map(|row| scale(row.dimension)).collect(),
        widths: match model.rows.iter().any(|row| row.within.is_some()) {
            true => model.rows.iter().map(|row| row.within.map_or(zero, of)).collect(),
            false => Vec::new(),
        },
        length,
        calls: model.expressions.calls().iter().map(|call| of(call.id)).collect(),
        graph,
        clock,
        nodes,
    }
}

/// One node an expression.
fn expressions(model: &Model, clock: &Clock, g: &mut Graph) -> Vec<NodeId> {
    let mut nodes: Vec<NodeId> = Vec::with_capacity(model.expressions.len());
    let zero = g.constant(0.0);
    for (_, node) in model.expressions.iter() {
        let of = |id: Id| nodes.get(id.index()).copied().unwrap_or(zero);
        let node = match node {
            expression::Node::Number(value) => g.constant(value),
            expression::Node::Time => g.leaf(Leaf::Time),
            expression::Node::Coordinate(i) => g.leaf(Leaf::Position(i as u32)),
            expression::Node::Variable(i) => g.leaf(match clock.kind(i as u32) {
                Some(VariableKind::Parameter) => Leaf::Parameter(i as u32),
                _ => Leaf::Input(i as u32),
            }),
            expression::Node::State(i) => g.leaf(Leaf::State(i as u32)),
            expression::Node::Multiplier(i) => g.leaf(Leaf::Multiplier(i as u32)),
            expression::Node::Sliding(i) => g.leaf(Leaf::Sliding(i as u32)),
            expression::Node::Holding(i) => g.leaf(Leaf::Holding(i as u32)),
            expression::Node::Impulse(i) => g.leaf(Leaf::Impulse(i as u32)),
            expression::Node::Remembered(i) => g.leaf(Leaf::Remembered(i as u32)),
            expression::Node::Pin(pin, component) => g.leaf(Leaf::Given(PIN, (2 * pin + component) as u32)),
            expression::Node::Unary(function, a) => g.unary(function, of(a)),
            expression::Node::Binary(function, a, b) => g.binary(function, of(a), of(b)),
            expression::Node::Margin(group) => g.leaf(Leaf::Given(MARGIN, group as u32)),
            expression::Node::Ratio(a, row) => {
                let gain = |g: &mut Graph, leaf| match leaf {
                    Leaf::Position(i) => Some(g.leaf(Leaf::Given(row as u32, i))),
                    _ => None,
                };
                tangent(g, &[of(a)], gain).into_iter().flatten().next().unwrap_or(zero)
            }
            expression::Node::Rate(a, order) => {
                let mut value = of(a);
                for _ in 0..order {
                    let rate = tangent(g, &[value], |g, leaf| clock.total(g, leaf, true));
                    value = rate.into_iter().flatten().next().unwrap_or(zero);
                }
                value
            }
            expression::Node::Call { function, order, argument } => {
                g.call(function as u32, order, of(argument))
            }
        };
        nodes.push(node);
    }
    nodes
}

/// Number of exact time derivatives of a value. q̈ and the accelerations of inputs are the last that are known, and a
/// declared function has as many derivatives as are continuous.
fn derivatives(model: &Model, graph: &Graph, clock: &Clock, value: NodeId) -> u8 {
    let left = graph.reachable([value]).into_iter().filter_map(|id| match graph.node(id) {
        Node::Leaf(leaf) => Some(2_u8.saturating_sub(clock.order(leaf))),
        Node::Call { function, order, .. } if graph.stage(id) > Stage::Parameter => {
            let continuity = model.functions.get(function as usize).map_or(0, |f| f.continuity);
            Some(continuity.saturating_sub(order))
        }
        _ => None,
    });
    left.min().unwrap_or(2).min(2)
}

/// The largest length that counts; where all are zero that of the guesses, 1 m where there is none either.
fn reference_length(model: &Model, g: &mut Graph) -> NodeId {
    let mut longest = g.constant(model.longest.as_ref().map_or(0.0, |longest| longest.length));
    for index in &model.lengths {
        let parameter = g.leaf(Leaf::Parameter(*index as u32));
        let length = g.unary(Unary::Abs, parameter);
        longest = g.binary(Binary::Max, longest, length);
    }
    let other = g.constant(model.longest_guess.as_ref().map_or(1.0, |guess| guess.length));
    let zero = g.constant(0.0);
    g.select(zero, longest, longest, other)
}
