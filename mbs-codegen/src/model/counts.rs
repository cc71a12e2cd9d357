//! Counts, ranges, arrays and their components.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::operands::Operands;
use super::units::Dimension;
use super::value::{Fault, Value};
use crate::syntax::ast::{Instruction, Operation};

/// Longest array.
pub const LONGEST: usize = 6_000;
/// Largest count, and most rounds of all loops together.
pub const MOST_ROUNDS: usize = 100_000;

impl Elaborator<'_> {
    /// A value that counts: a non-negative integer from literals, constants and loop names.
    pub fn count(&mut self, value: &Value) -> Result<usize, Fault> {
        let help = "counts are made of integers, integer constants and loop names";
        let number = match value.items.as_slice() {
            [item] if value.shape.is_empty() => match self.expressions.node(item.id) {
                Node::Number(number) if item.quantity.dimension() == Dimension::NUMBER => Some(number),
                _ => None,
            },
            _ => None,
        };
        match number {
            Some(number) if number >= 0.0 && number <= MOST_ROUNDS as f64 && number.fract() == 0.0 => {
                Ok(number as usize)
            }
            Some(number) if number > MOST_ROUNDS as f64 => Err(self.fault(
                value.span,
                format!("this count is larger than {MOST_ROUNDS}"),
                "shorten the loop or the array",
            )),
            Some(number) => Err(self.fault(value.span, format!("{number} is no count"), help)),
            None => Err(self.fault(value.span, "this is no count", help)),
        }
    }

    /// The counts of a range from `low` up to the one before `high`; `written`: both are numbers as written. Constants and
    /// outer loops may leave a range empty; an empty range of numbers is a fault.
    pub fn range(&mut self, low: &Value, high: &Value, written: bool) -> Result<(usize, usize), Fault> {
        let (first, end) = (self.count(low)?, self.count(high)?);
        if written && first >= end {
            let message = format!("the range `{first}..{end}` is empty");
            let help =
                "write the first count, and behind the dots one more than the last: `0..3` counts 0, 1, 2";
            return Err(self.fault(low.span, message, help));
        }
        Ok((first, end))
    }

    /// Stacks values of one shape.
    pub fn array(&mut self, values: Vec<Value>, span: Span) -> Result<Value, Fault> {
        let first = values.first().ok_or(Fault)?.clone();
        let mut items = Vec::new();
        let mut shape = vec![values.len()];
        shape.extend(&first.shape);
        if shape.iter().product::<usize>() > LONGEST {
            return Err(self.fault(
                span,
                format!("the array has more than {LONGEST} components"),
                "split it",
            ));
        }
        for value in values {
            self.same_shape(&first, &value, "an array", value.span)?;
            items.extend(value.items);
        }
        Ok(Value { shape, items, span })
    }

    pub(super) fn index(
        &mut self,
        stack: &mut Operands<'_>,
        indices: &[Value],
        span: Span,
    ) -> Result<Value, Fault> {
        let base = stack.top_shape(self.names)?;
        if indices.len() > base.len() {
            let what = Value { shape: base, items: Vec::new(), span }.describe();
            return Err(self.fault(
                span,
                format!("{what} cannot take {} indices", indices.len()),
                "remove an index",
            ));
        }
        let mut offset = 0;
        for (value, length) in indices.iter().zip(&base) {
            let index = self.count(value)?;
            if index >= *length {
                return Err(self.fault(
                    value.span,
                    format!("index {index} is beyond the last of {length} components"),
                    format!("components are counted from 0; the last is {}", length.saturating_sub(1)),
                ));
            }
            offset = offset * length + index;
        }
        let shape: Vec<usize> = base.into_iter().skip(indices.len()).collect();
        let length = shape.iter().product::<usize>();
        let items = stack.pop_components(offset * length, length, self.names)?;
        Ok(Value { shape, items, span })
    }
}

/// `true` if the two values before `index` are numbers as written.
pub(super) fn follows_literals(code: &[Instruction], index: usize) -> bool {
    let is_literal = |back: usize| {
        let before = index.checked_sub(back).and_then(|index| code.get(index));
        matches!(before.map(|instruction| &instruction.operation), Some(Operation::Number { .. }))
    };
    is_literal(1) && is_literal(2)
}
