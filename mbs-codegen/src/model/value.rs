//! Values of expressions: scalars with their units, in a shape.

use proc_macro2::Span;

use super::expression::Id;
use super::unit_inference::Bare;
use super::units::Dimension;

/// Dimension of a scalar, or none: `0` fits any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    Any,
    Known(Dimension),
}

impl Quantity {
    /// The dimension; that of a number where any fits.
    pub fn dimension(self) -> Dimension {
        match self {
            Quantity::Any => Dimension::NUMBER,
            Quantity::Known(dimension) => dimension,
        }
    }
}

/// A scalar with its unit.
#[derive(Clone, Copy, Debug)]
pub struct Scalar {
    pub id: Id,
    pub quantity: Quantity,
    /// Share of bare numbers, which take on a declared unit.
    pub bare: Bare,
    /// The token that it comes from.
    pub span: Span,
}

/// A scalar, vector or matrix.
#[derive(Clone, Debug)]
pub struct Value {
    /// None for a scalar.
    pub shape: Vec<usize>,
    /// Row by row.
    pub items: Vec<Scalar>,
    /// The token that it comes from.
    pub span: Span,
}

impl Value {
    /// A value without shape.
    pub fn scalar(scalar: Scalar, span: Span) -> Self {
        Value { shape: Vec::new(), items: vec![scalar], span }
    }

    /// A scalar 0 that fits any unit in the shape of another value; anything else as it is.
    pub fn spread_zero(&self, other: &Value) -> Value {
        match self.items.as_slice() {
            [zero] if self.shape.is_empty() && zero.quantity == Quantity::Any => {
                Value { shape: other.shape.clone(), items: vec![*zero; other.items.len()], span: self.span }
            }
            _ => self.clone(),
        }
    }

    /// Description in a message.
    pub fn describe(&self) -> String {
        match self.shape.as_slice() {
            [] => "a scalar".into(),
            [length] => format!("a vector of {length}"),
            shape => {
                format!("an array of {}", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" × "))
            }
        }
    }
}

/// A fault was reported.
#[derive(Clone, Copy, Debug)]
pub struct Fault;

/// Quantities that an expression may use in addition to coordinates, parameters, inputs and the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reach {
    /// None of them.
    Position,
    /// `der(x)`, multipliers and first-order states.
    Force,
    /// `der2(x)` too.
    Output,
    /// Any rate: the definition of a `let`, whose uses are checked.
    Let,
}
