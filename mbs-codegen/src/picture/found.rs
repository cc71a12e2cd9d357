//! Values of names in the picture.

use crate::model::expression::{Id, Node};
use crate::model::unit_inference::Bare;
use crate::model::units::Dimension;
use crate::model::value::{Quantity, Scalar, Value};

/// A value found for a name.
pub struct Found {
    pub name: String,
    pub ids: Vec<Id>,
    /// Lengths of its array.
    pub shape: Vec<usize>,
    pub unit: Unit,
    /// The unit as a message has it.
    pub said: String,
    pub is_output: bool,
}

/// Unit of all components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Bare numbers, which take the unit of their place.
    Any,
    Metre,
    /// Unit of numbers and angles.
    Number,
    Other,
}

impl Unit {
    /// Unit as declared.
    pub fn written(text: &str) -> Self {
        match text {
            "m" => Unit::Metre,
            "1" | "rad" => Unit::Number,
            _ => Unit::Other,
        }
    }

    /// Unit of components, which may have several.
    pub fn of(items: &[Scalar]) -> Self {
        let mut unit = Unit::Any;
        for item in items {
            let next = match item.quantity {
                _ if matches!(item.bare, Bare::Wholly | Bare::Zero) => continue,
                Quantity::Any => continue,
                Quantity::Known(Dimension::METRE) => Unit::Metre,
                Quantity::Known(Dimension::NUMBER) => Unit::Number,
                Quantity::Known(_) => Unit::Other,
            };
            unit = if unit == Unit::Any || unit == next { next } else { Unit::Other };
        }
        unit
    }

    pub fn fits(self, wanted: Self) -> bool {
        self == Unit::Any || self == wanted
    }
}

impl Found {
    /// A point of the model.
    pub fn point(name: String, ids: &[Id]) -> Self {
        Found {
            name,
            ids: ids.to_vec(),
            shape: vec![ids.len()],
            unit: Unit::Metre,
            said: String::new(),
            is_output: false,
        }
    }
}

/// `name.0.1`
pub fn numbered(name: &str, counts: &[usize]) -> String {
    counts.iter().fold(name.to_owned(), |name, count| format!("{name}.{count}"))
}

/// The name as declared, without its numbers.
pub fn first(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// Rest of an array after its counts; `None` where it does not have them.
pub fn component<'v>(value: &'v Value, counts: &[usize]) -> Option<(Vec<usize>, &'v [Scalar])> {
    let rest = value.shape.get(counts.len()..)?;
    let mut offset = 0;
    for (count, length) in counts.iter().zip(&value.shape) {
        if count >= length {
            return None;
        }
        offset = offset * length + count;
    }
    let size: usize = rest.iter().product();
    Some((rest.to_vec(), value.items.get(offset * size..(offset + 1) * size)?))
}

/// Reason why the text alone cannot evaluate an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    Function,
    Motion,
}

impl Outside {
    /// Reason in an expression itself, without its operands.
    pub fn of(node: Node) -> Option<Self> {
        match node {
            Node::Call { .. } => Some(Outside::Function),
            Node::Margin(_) | Node::Ratio(..) => Some(Outside::Motion),
            node if node.is_of_motion() => Some(Outside::Motion),
            _ => None,
        }
    }

    pub fn message(self) -> &'static str {
        match self {
            Outside::Function => "calls a function of the caller",
            Outside::Motion => "uses a state or a multiplier",
        }
    }
}
