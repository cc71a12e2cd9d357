//! State of an evaluation: expressions so far, names, quantities that are allowed.

use proc_macro2::Span;

use super::Reference;
use super::expression::{Expressions, Id, Node};
use super::names::Names;
use super::unit_faults::{Place, UnitFault, UnitOf, component_at};
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar};
use super::written;
use crate::diagnostics::Diagnostics;
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::{Expression, Instruction, Operation};

/// Most faults of units that are kept for an explanation.
const MOST_UNIT_FAULTS: usize = 100;

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

    /// Reports a unit that does not fit, and keeps it for the explanation.
    pub fn unit_fault(
        &mut self,
        (place, found, wanted): (Place, Scalar, UnitOf),
        message: String,
        help: impl Into<String>,
    ) -> Fault {
        if self.names.unit_faults.len() < MOST_UNIT_FAULTS {
            let (span, found) = (found.span, UnitOf::scalar(found));
            let message = message.clone();
            let (operand, other) = (Vec::new(), Vec::new());
            self.names.unit_faults.push(UnitFault {
                span,
                message,
                place,
                found,
                wanted,
                operand,
                other,
                settled: false,
            });
        }
        self.fault(found.span, message, help)
    }

    /// Runs a check of units; what it finds concerns this place, this expression and the one on the other side.
    pub fn concerning<T>(
        &mut self,
        place: Place,
        (operand, other): (&Expression, Option<&Expression>),
        check: impl FnOnce(&mut Self) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        let before = self.names.unit_faults.len();
        let result = check(self);
        if result.is_err() {
            let other = other.map_or(&[][..], |other| &other.code);
            self.concern(before, place, &operand.code, other);
        }
        result
    }

    /// The faults of units from the one at `first` on concern this place, this expression and the one on the other side.
    pub fn concern(&mut self, first: usize, place: Place, operand: &[Instruction], other: &[Instruction]) {
        for fault in self.names.unit_faults.iter_mut().skip(first).filter(|fault| !fault.settled) {
            fault.place = place.clone();
            fault.operand = component_at(operand, fault.span).to_vec();
            fault.other = other.to_vec();
            fault.settled = true;
        }
    }

    /// Names the operands of the instruction at `index`, in which the units from the one at `first` on do not fit.
    pub fn name_operands(&mut self, code: &[Instruction], index: usize, first: usize) {
        let operands = match code.get(index).map(|instruction| &instruction.operation) {
            Some(Operation::Binary(_)) => written::operands(code, index, 2),
            Some(Operation::Call { arguments: arguments @ (1 | 2), .. }) => {
                written::operands(code, index, *arguments)
            }
            _ => None,
        };
        for fault in self.names.unit_faults.iter_mut().skip(first).filter(|fault| !fault.settled) {
            fault.settled = true;
            let Some(operands) = &operands else { continue };
            if let [.., operand] = operands.as_slice() {
                fault.operand = component_at(operand, fault.span).to_vec();
            }
            if let [other, _] = operands.as_slice() {
                fault.other = other.to_vec();
            }
        }
    }

    /// Before: any operands. After: an expression of numbers is folded to its value, which must be finite.
    pub fn push_unary(&mut self, function: Unary, a: Id, span: Span) -> Result<Id, Fault> {
        match self.expressions.node(a) {
            Node::Number(number) => {
                let value = (function.entry().value)(number);
                if value == 0.0 && self.expressions.is_absent(a) {
                    return Ok(a);
                }
                self.folded(value, span)
            }
            _ => Ok(self.expressions.push(Node::Unary(function, a))),
        }
    }

    /// Before: any operands. After: an expression of numbers is folded to its value, which must be finite.
    pub fn push_binary(&mut self, function: Binary, a: Id, b: Id, span: Span) -> Result<Id, Fault> {
        if self.expressions.is_absent(a) || self.expressions.is_absent(b) {
            return self.push_beside_absent(function, [a, b], span);
        }
        match (self.expressions.node(a), self.expressions.node(b)) {
            (Node::Number(a), Node::Number(b)) => self.folded((function.entry().value)(a, b), span),
            _ => Ok(self.expressions.push(Node::Binary(function, a, b))),
        }
    }

    /// A function of the force of a row that is not there: products with it are 0, whatever the other factor is.
    fn push_beside_absent(&mut self, function: Binary, [a, b]: [Id; 2], span: Span) -> Result<Id, Fault> {
        let [is_a, is_b] = [a, b].map(|id| self.expressions.is_absent(id));
        match (function, is_a, is_b) {
            (Binary::Divide, _, true) => Err(self.fault(
                span,
                "this divides by the force of a row that an effect of the scene releases, which is 0",
                "leave it to scenes that have the row, or keep the divisor from 0: `max(…, 1N)`",
            )),
            (Binary::Multiply, true, _) | (Binary::Divide, true, _) => Ok(a),
            (Binary::Multiply, _, true) => Ok(b),
            (Binary::Add, true, _) => Ok(b),
            (Binary::Add | Binary::Subtract, _, true) => Ok(a),
            (Binary::Subtract, true, _) => self.push_unary(Unary::Negate, b, span),
            _ => match (self.expressions.node(a), self.expressions.node(b)) {
                (Node::Number(x), Node::Number(y)) => {
                    let value = (function.entry().value)(x, y);
                    match value == 0.0 {
                        true if is_a => Ok(a),
                        true => Ok(b),
                        false => self.folded(value, span),
                    }
                }
                _ => Ok(self.expressions.push(Node::Binary(function, a, b))),
            },
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
