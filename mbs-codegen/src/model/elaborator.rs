//! State of an evaluation: expressions so far, names, quantities that are allowed.

use proc_macro2::Span;

use super::Reference;
use super::expression::{Expressions, Id, Node};
use super::names::Names;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar};
use crate::diagnostics::Diagnostics;
use crate::symbolic::{Binary, Unary};

/// Executes the postfix code of expressions.
pub struct Elaborator<'a> {
    pub expressions: &'a mut Expressions,
    pub names: &'a mut Names,
    pub diagnostics: &'a mut Diagnostics,
    /// Quantities that are allowed here.
    pub reach: Reach,
    /// Quantities used here so far.
    pub needs: Reach,
    /// Groups that `margin` and `ratio` can refer to.
    pub groups: &'a [Reference],
}

impl Elaborator<'_> {
    /// A bare number; `0` fits any unit.
    pub fn number_literal(&mut self, value: f64, span: Span) -> Scalar {
        let (quantity, bare) = match value == 0.0 {
            true => (Quantity::Any, Bare::Zero),
            false => (Quantity::Known(Dimension::NUMBER), Bare::Wholly),
        };
        Scalar { id: self.expressions.push(Node::Number(value)), quantity, bare, span }
    }

    /// Reports a fault.
    pub fn fault(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> Fault {
        self.diagnostics.report(span, message, help);
        Fault
    }

    /// Before: any operands. After: an expression of numbers is folded to its value, which must be finite.
    pub fn push_unary(&mut self, function: Unary, a: Id, span: Span) -> Result<Id, Fault> {
        match self.expressions.node(a) {
            Node::Number(a) => self.folded((function.entry().value)(a), span),
            _ => Ok(self.expressions.push(Node::Unary(function, a))),
        }
    }

    /// Before: any operands. After: an expression of numbers is folded to its value, which must be finite.
    pub fn push_binary(&mut self, function: Binary, a: Id, b: Id, span: Span) -> Result<Id, Fault> {
        match (self.expressions.node(a), self.expressions.node(b)) {
            (Node::Number(a), Node::Number(b)) => self.folded((function.entry().value)(a, b), span),
            _ => Ok(self.expressions.push(Node::Binary(function, a, b))),
        }
    }

    fn folded(&mut self, value: f64, span: Span) -> Result<Id, Fault> {
        if value.is_finite() {
            return Ok(self.expressions.push(Node::Number(value)));
        }
        Err(self.fault(
            span,
            "this is not a finite number",
            "check for a division by zero, or a root or logarithm of a negative number",
        ))
    }
}
