//! Partial derivatives `d(z, u)`: exact, in the text's own expressions, so that everything else sees no new operation.

use std::collections::BTreeMap;

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::{Expressions, Id, Node};
use super::unit_inference::Bare;
use super::value::{Fault, Quantity, Scalar, Value};
use crate::symbolic::graph::{self, Graph, Leaf, NodeId};
use crate::symbolic::{Binary, Unary, tangents};

/// Most expressions that all partial derivatives of a text go through: some seconds of work.
const MOST_VISITED: usize = 4_000_000;

impl Elaborator<'_> {
    /// `d(z, u)`: a component for each of z and u, those of u the fastest.
    pub fn partial(&mut self, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
        let [z, u] = self.arguments("d", arguments, span)?;
        for item in &u.items {
            self.is_variable(*item)?;
        }
        let refused = |node| {
            matches!(
                node,
                Node::Rate(..)
                    | Node::Multiplier(_)
                    | Node::Pin(..)
                    | Node::Margin(_)
                    | Node::Ratio(..)
                    | Node::Sliding(_)
                    | Node::Holding(_)
                    | Node::Impulse(_)
                    | Node::Remembered(_)
            )
        };
        for item in &z.items {
            if self.expressions.contain(item.id, refused) {
                return Err(self.fault(
                    item.span,
                    "`d` cannot differentiate this",
                    "take partial derivatives of coordinates, parameters, inputs and states; that of a rate is \
                     `der(d(x, u))`",
                ));
            }
        }
        let [of, along] = [&z, &u].map(|value| value.items.iter().map(|item| item.id).collect::<Vec<Id>>());
        let Some(found) = self.expressions.partial(&of, &along, MOST_VISITED) else {
            return Err(self.fault(
                span,
                "the partial derivatives of the text take too much work",
                "differentiate shorter expressions, or fewer of them",
            ));
        };
        let pairs = z.items.iter().flat_map(|z| u.items.iter().map(move |u| (z, u)));
        let items = pairs.zip(found).map(|((z, u), id)| {
            let quantity = match z.quantity {
                Quantity::Any => Quantity::Any,
                Quantity::Known(dimension) => Quantity::Known(dimension.over(u.quantity.dimension())),
            };
            let is_angle = z.bare == Bare::Angle && u.bare != Bare::Angle;
            Scalar { id, quantity, bare: if is_angle { Bare::Angle } else { Bare::Not }, span }
        });
        let items = items.collect();
        let shape = z.shape.iter().chain(&u.shape).copied().collect();
        Ok(Value { shape, items, span })
    }

    /// Reports what is no coordinate, parameter, input or state.
    fn is_variable(&mut self, u: Scalar) -> Result<(), Fault> {
        let help = match self.expressions.node(u.id) {
            Node::Coordinate(_) | Node::Variable(_) | Node::State(_) => return Ok(()),
            Node::Time => "the derivative in time is `der(x)`",
            Node::Number(_) => "declare it with `param`: a constant does not vary",
            _ => "give the name of one, or one component; of a formula divide two such derivatives",
        };
        Err(self.fault(
            u.span,
            "a partial derivative is along a coordinate, a parameter, an input or a state",
            help,
        ))
    }
}

impl Expressions {
    /// Derivatives of the expressions `of` along the variables `along`, those of the last the fastest. `None` where this and the
    /// earlier ones go through more than `most` expressions.
    pub fn partial(&mut self, of: &[Id], along: &[Id], most: usize) -> Option<Vec<Id>> {
        let mut scratch = Scratch::of(self, of);
        let cost = scratch.graph.len().saturating_mul(along.len());
        if !self.spend(cost, most) {
            return None;
        }
        let leaf = |id: &Id| leaf(self.node(*id));
        let axes: Vec<Leaf> = along.iter().filter_map(leaf).collect();
        let roots: Vec<NodeId> = of.iter().filter_map(|id| scratch.nodes.get(id).copied()).collect();
        let found = tangents(&mut scratch.graph, &roots, &axes);
        let values: Vec<NodeId> = found.iter().flatten().map(|(_, value)| *value).collect();
        let written = scratch.write(self, values);
        let mut derivatives = Vec::with_capacity(of.len() * along.len());
        for row in &found {
            for place in 0..along.len() {
                let value = row.iter().find(|(axis, _)| *axis == place).and_then(|(_, v)| written.get(v));
                derivatives.push(match value {
                    Some(id) => *id,
                    None => self.push(Node::Number(0.0)),
                });
            }
        }
        Some(derivatives)
    }
}

/// Expressions in a graph of their own, by whose rules they are differentiated.
struct Scratch {
    graph: Graph,
    /// The node of an expression.
    nodes: BTreeMap<Id, NodeId>,
    /// An expression of a node.
    written: BTreeMap<NodeId, Id>,
}

impl Scratch {
    /// Before: expressions without rates, multipliers, pins, margins and ratios. After: these and their operands are in the graph.
    fn of(expressions: &Expressions, roots: &[Id]) -> Self {
        let mut scratch =
            Scratch { graph: Graph::default(), nodes: BTreeMap::new(), written: BTreeMap::new() };
        for id in expressions.operands_first(roots) {
            let node = expressions.node(id);
            let of = |id: Id| scratch.nodes.get(&id).copied();
            let g = &mut scratch.graph;
            let node = match node {
                Node::Number(value) => Some(g.constant(value)),
                Node::Unary(function, a) => of(a).map(|a| g.unary(function, a)),
                Node::Binary(function, a, b) => of(a).zip(of(b)).map(|(a, b)| g.binary(function, a, b)),
                Node::Call { function, order, argument } => {
                    of(argument).map(|argument| g.call(function as u32, order, argument))
                }
                other => leaf(other).map(|leaf| g.leaf(leaf)),
            };
            if let Some(node) = node {
                scratch.nodes.insert(id, node);
                scratch.written.entry(node).or_insert(id);
            }
        }
        scratch
    }

    /// Before: nodes of the graph. After: each is an expression.
    fn write(self, expressions: &mut Expressions, values: Vec<NodeId>) -> BTreeMap<NodeId, Id> {
        let Scratch { graph, mut written, .. } = self;
        for id in graph.reachable(values) {
            if written.contains_key(&id) {
                continue;
            }
            let of = |id: NodeId| written.get(&id).copied();
            let expression = match graph.node(id) {
                graph::Node::Constant(bits) => Some(expressions.push(Node::Number(f64::from_bits(bits)))),
                graph::Node::Leaf(leaf) => of_leaf(leaf).map(|node| expressions.push(node)),
                graph::Node::Unary(function, a) => of(a).map(|a| expressions.push(Node::Unary(function, a))),
                graph::Node::Binary(function, a, b) => {
                    of(a).zip(of(b)).map(|(a, b)| expressions.push(Node::Binary(function, a, b)))
                }
                graph::Node::Call { function, order, argument } => of(argument).map(|argument| {
                    expressions.push(Node::Call { function: function as usize, order, argument })
                }),
                graph::Node::Select { less, than, yes, no } => {
                    let operands = [less, than, yes, no].map(of);
                    let [Some(less), Some(than), Some(yes), Some(no)] = operands else { continue };
                    Some(select(expressions, (less, than), yes, no))
                }
            };
            if let Some(expression) = expression {
                written.insert(id, expression);
            }
        }
        written
    }
}

/// `yes` where less < than, else `no`, both finite: s yes + (1 − s) no with s = sign(max(than − less, 0)), which is 0 or 1.
fn select(expressions: &mut Expressions, (less, than): (Id, Id), yes: Id, no: Id) -> Id {
    let [zero, one] = [0.0, 1.0].map(|value| expressions.push(Node::Number(value)));
    let beyond = expressions.push(Node::Binary(Binary::Subtract, than, less));
    let beyond = expressions.push(Node::Binary(Binary::Max, beyond, zero));
    let is_less = expressions.push(Node::Unary(Unary::Sign, beyond));
    let is_not = expressions.push(Node::Binary(Binary::Subtract, one, is_less));
    let [yes, no] = [(is_less, yes), (is_not, no)]
        .map(|(share, value)| expressions.push(Node::Binary(Binary::Multiply, share, value)));
    expressions.push(Node::Binary(Binary::Add, yes, no))
}

/// The leaf of an expression without operands. Parameters and inputs are one kind here: none of the rules asks for it but that of
/// powers, whose slope at 0 a moving exponent keeps.
fn leaf(node: Node) -> Option<Leaf> {
    let index = |index: usize| u32::try_from(index).ok();
    match node {
        Node::Time => Some(Leaf::Time),
        Node::Coordinate(i) => index(i).map(Leaf::Position),
        Node::Variable(i) => index(i).map(Leaf::Input),
        Node::State(i) => index(i).map(Leaf::State),
        _ => None,
    }
}

fn of_leaf(leaf: Leaf) -> Option<Node> {
    match leaf {
        Leaf::Time => Some(Node::Time),
        Leaf::Position(i) => Some(Node::Coordinate(i as usize)),
        Leaf::Input(i) => Some(Node::Variable(i as usize)),
        Leaf::State(i) => Some(Node::State(i as usize)),
        _ => None,
    }
}
