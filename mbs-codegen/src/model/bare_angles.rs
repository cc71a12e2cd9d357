//! Bare numbers as angles: beyond two turns degrees are meant, or the unit is written.

use std::f64::consts::TAU;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Scalar, Value};
use super::written::number;
use crate::syntax::ast::{Instruction, Operation, Operator, Unit};

/// Largest angle in radians that a number without a unit may be: guesses and bounds of machines stay within two turns.
const LARGEST: f64 = 2.0 * TAU;

impl Elaborator<'_> {
    /// Before: an expression in the place of an angle. After: a number without a unit as all of it, or as a component, that is
    /// larger than two turns is reported.
    pub fn bare_angles(&mut self, code: &[Instruction]) -> Result<(), Fault> {
        let is_list = code.iter().all(|instruction| {
            matches!(
                instruction.operation,
                Operation::Number { .. } | Operation::Negate | Operation::Array { .. }
            )
        });
        let mut result = Ok(());
        if !is_list {
            return result;
        }
        for (index, instruction) in code.iter().enumerate() {
            let Operation::Number { value, unit: None, .. } = instruction.operation else { continue };
            // The fault of a number that is none was reported.
            if value <= LARGEST || value.is_nan() {
                continue;
            }
            let is_negative =
                matches!(code.get(index + 1).map(|next| &next.operation), Some(Operation::Negate));
            let text = format!("{}{}", if is_negative { "-" } else { "" }, number(value));
            result = Err(self.fault(
                instruction.span,
                format!("`{text}` is an angle of {} turns, in radians", number((value / TAU).round())),
                format!("write `{text}deg`, or `{text}rad` where radians are meant"),
            ));
        }
        result
    }

    /// `true` for a bare number of more than two turns.
    pub fn is_large(&self, value: &Value) -> bool {
        let is_large = |scalar: &Scalar| match self.expressions.node(scalar.id) {
            Node::Number(number) => scalar.bare == Bare::Wholly && number.abs() > LARGEST,
            _ => false,
        };
        value.items.iter().any(is_large)
    }

    /// [`bare_angles`](Self::bare_angles) in a side of an equation or sum whose other side is an angle.
    pub fn beside_angle(
        &mut self,
        (other, of_other): (&Value, &[Instruction]),
        code: &[Instruction],
    ) -> Result<(), Fault> {
        let is_beside = other.items.iter().any(is_angle) && is_linear(of_other);
        if is_beside { self.bare_angles(code) } else { Ok(()) }
    }
}

/// `true` for an angle, not its rate.
fn is_angle(scalar: &Scalar) -> bool {
    scalar.bare == Bare::Angle && scalar.quantity == Quantity::Known(Dimension::NUMBER)
}

/// `true` for a sum of names and of their multiples: the square of an angle is none.
fn is_linear(code: &[Instruction]) -> bool {
    let count = |wanted: fn(&Operation) -> bool| code.iter().filter(|part| wanted(&part.operation)).count();
    let others = count(|operation| {
        !matches!(
            operation,
            Operation::Number { .. }
                | Operation::Name(_)
                | Operation::Negate
                | Operation::Index { .. }
                | Operation::Array { .. }
                | Operation::Binary(
                    Operator::Add | Operator::Subtract | Operator::Multiply | Operator::Divide
                )
        )
    });
    let products =
        count(|operation| matches!(operation, Operation::Binary(Operator::Multiply | Operator::Divide)));
    others == 0 && (products == 0 || count(|operation| matches!(operation, Operation::Name(_))) < 2)
}

/// `true` for the unit of an angle.
pub fn is_of_angles(unit: &Unit) -> bool {
    matches!(unit.factors.as_slice(), [(symbol, 1.0)] if matches!(symbol.text.as_str(), "rad" | "turn"))
}
