//! Form in which a value is written where it is used.

use std::collections::BTreeMap;

use crate::emit::rust::lengths::Lengths;
use crate::equations::MARGIN;
use crate::model::{Model, Role};
use crate::symbolic::{Graph, Leaf, Node, NodeId, Stage};
use crate::syntax::rust_identifiers::is_keyword;

/// Field of the parameter stage that holds how friction sticks and slides.
const MODES: &str = "__p.2";
/// Values that events set, in the parameters.
const REMEMBERED: &str = "__p.3";

/// Values and names available within a function.
pub struct Scope<'a> {
    /// The graph.
    pub graph: &'a Graph,
    /// The model, for the names of fields.
    pub model: &'a Model,
    /// Type parameters of the declared functions.
    pub types: &'a [String],
    /// Fields of the parameter stage, `__p`.
    pub parameters: Option<&'a BTreeMap<NodeId, usize>>,
    /// Fields of the position stage, `__s`.
    pub position: Option<&'a BTreeMap<NodeId, usize>>,
    /// Coordinates of the block that is being solved, `__x`.
    pub unknowns: &'a [usize],
    /// Bounds at which code is cut.
    pub lengths: Lengths,
}

/// Form of an operand.
pub enum Written {
    /// The local of a value.
    Local(NodeId),
    /// A number that is finite.
    Number(f64),
    /// An element of an array.
    Element {
        /// The array.
        array: String,
        /// Its place there.
        index: usize,
    },
    /// Something else.
    Otherwise(String),
}

impl Scope<'_> {
    /// Form that [`Scope::operand`] writes.
    pub fn written(&self, id: NodeId) -> Written {
        let node = self.graph.node(id);
        if let Node::Constant(bits) = node
            && f64::from_bits(bits).is_finite()
        {
            return Written::Number(f64::from_bits(bits));
        }
        let text = self.operand(id);
        if text == local(id) {
            return Written::Local(id);
        }
        let element = text.strip_suffix(']').and_then(|text| text.rsplit_once('['));
        match element.and_then(|(array, index)| Some((array.to_owned(), index.parse().ok()?))) {
            Some((array, index)) => Written::Element { array, index },
            None => Written::Otherwise(text),
        }
    }

    /// The value as an operand.
    pub fn operand(&self, id: NodeId) -> String {
        let field =
            |fields: Option<&BTreeMap<NodeId, usize>>| fields.and_then(|fields| fields.get(&id)).copied();
        // A stage keeps values of its own stage alone.
        match self.graph.stage(id) {
            Stage::Position => {
                if let Some(index) = field(self.position) {
                    return format!("__s.0[{index}]");
                }
            }
            Stage::Parameter => {
                if let Some(index) = field(self.parameters) {
                    return format!("__p.0[{index}]");
                }
            }
            _ => {}
        }
        match self.graph.node(id) {
            node @ (Node::Constant(_) | Node::Leaf(_)) => self.leaf(node),
            _ => local(id),
        }
    }

    /// Type and field of a declared function, and its place in an array of them.
    pub fn function(&self, index: usize) -> (&str, String, Option<usize>) {
        let function = self.model.functions.get(index);
        let name = function.map_or("", |function| &function.name.text);
        let place = function.and_then(|function| function.array).map(|array| array.index);
        (self.types.get(index).map_or("", String::as_str), format!("self.{}", field_name(name)), place)
    }

    /// The value, or 0 where there is none.
    pub fn or_zero(&self, id: Option<NodeId>) -> String {
        id.map_or_else(|| number(0.0), |id| self.operand(id))
    }

    /// A number or a variable.
    pub fn leaf(&self, node: Node) -> String {
        match node {
            Node::Constant(bits) => number(f64::from_bits(bits)),
            Node::Leaf(Leaf::Parameter(index) | Leaf::Input(index)) => variable(self.model, index as usize),
            Node::Leaf(Leaf::Time) => "__t".into(),
            Node::Leaf(Leaf::Position(index)) => {
                match self.unknowns.iter().position(|i| *i == index as usize) {
                    Some(unknown) => format!("__x[{unknown}]"),
                    None => format!("__q[{index}]"),
                }
            }
            Node::Leaf(Leaf::Velocity(index)) => format!("__qd[{index}]"),
            Node::Leaf(Leaf::Acceleration(index)) => format!("__qdd[{index}]"),
            Node::Leaf(Leaf::State(index)) => format!("__z[{index}]"),
            Node::Leaf(Leaf::Multiplier(index)) => format!("__lambda[{index}]"),
            Node::Leaf(Leaf::Direction(index)) => format!("__x[{index}]"),
            Node::Leaf(Leaf::Sliding(index)) => format!("{MODES}[{index}].direction"),
            Node::Leaf(Leaf::Holding(index)) => format!("{MODES}[{index}].force"),
            Node::Leaf(Leaf::Impulse(index)) => format!("{MODES}[{index}].impulse"),
            Node::Leaf(Leaf::Remembered(index)) => format!("{REMEMBERED}[{index}]"),
            Node::Leaf(Leaf::Given(MARGIN, group)) => format!("__margin{group}"),
            Node::Leaf(Leaf::Given(row, index)) => format!("__gain{row}[{index}]"),
            _ => number(f64::NAN),
        }
    }
}

/// Name of the local variable of a node.
pub fn local(id: NodeId) -> String {
    format!("__n{}", id.index())
}

/// A number of the scalar type.
pub fn number(value: f64) -> String {
    if value.is_nan() {
        "T::constant(::core::primitive::f64::NAN)".into()
    } else if value.is_infinite() {
        format!("T::constant(::core::primitive::f64::{}INFINITY)", if value < 0.0 { "NEG_" } else { "" })
    } else {
        format!("T::constant({value:?}f64)")
    }
}

/// A value over a number.
pub fn quotient(value: &str, divisor: f64) -> String {
    match divisor {
        1.0 => value.to_owned(),
        -1.0 => format!("-({value})"),
        other => format!("({value}) / {}", number(other)),
    }
}

/// A parameter or input in `self`.
pub fn variable(model: &Model, index: usize) -> String {
    match located(model, index) {
        Some((place, part)) => format!("self.{place}{part}"),
        None => number(f64::NAN),
    }
}

/// The field or component of one that holds a parameter, an input or a phase, with its rates.
pub fn place(model: &Model, index: usize) -> String {
    located(model, index).map_or_else(String::new, |(place, _)| place)
}

/// Field with component, and the part of a signal there.
fn located(model: &Model, index: usize) -> Option<(String, &'static str)> {
    let field = model.fields.iter().rev().find(|field| field.first <= index)?;
    let offset = index - field.first;
    let (component, part) = match field.role {
        Role::InputWithRates | Role::Phase => {
            (offset / 3, [".value", ".rate", ".acceleration"].get(offset % 3).copied().unwrap_or(""))
        }
        Role::Parameter | Role::Input => (offset, ""),
    };
    Some((format!("{}{}", field_name(&field.name.text), subscripts(component, &field.shape)), part))
}

/// `[i][j]` of a component of an array.
pub fn subscripts(component: usize, shape: &[usize]) -> String {
    let mut rest = component;
    let mut text = String::new();
    for length in shape.iter().rev() {
        text = format!("[{}]{text}", rest % (*length).max(1));
        rest /= (*length).max(1);
    }
    text
}

/// The name as an identifier of Rust, raw where it is a keyword.
pub fn field_name(name: &str) -> String {
    if is_keyword(name) { format!("r#{name}") } else { name.to_owned() }
}
