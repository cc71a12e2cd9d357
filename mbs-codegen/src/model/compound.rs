//! Compound units written as products, `2kg*m^2` or `30rad/s`: the form in brackets that is meant.

use super::units::with_suffix;
use crate::syntax::ast::{Instruction, Operation, Operator};

/// The number in front of a chain of units that the name at `index` is part of, with all of them in brackets:
/// `2 [kg*m^2]`; `None` where no number with a unit leads the chain.
pub fn in_brackets(code: &[Instruction], index: usize) -> Option<String> {
    let start = start(code, index)?;
    let Operation::Number { value, unit: Some(unit), .. } = &code.get(start)?.operation else { return None };
    let mut text = unit.text.clone();
    let mut next = start + 1;
    while let Some((symbol, length)) = factor(code, next)
        && let Some(operator) = operator(code, next + length)
    {
        text.push(if operator == Operator::Divide { '/' } else { '*' });
        text += &symbol;
        next += length + 1;
    }
    (next > index).then(|| format!("{value} [{text}]"))
}

/// `true` if the name at `index` follows the number that leads its chain.
pub fn is_first(code: &[Instruction], index: usize) -> bool {
    let before = index.checked_sub(1).and_then(|before| code.get(before));
    matches!(before.map(|before| &before.operation), Some(Operation::Number { unit: Some(_), .. }))
}

/// Index of the number that leads the chain of factors up to `index`.
fn start(code: &[Instruction], mut index: usize) -> Option<usize> {
    loop {
        let before = index.checked_sub(1)?;
        if let Operation::Number { unit: Some(_), .. } = code.get(before)?.operation {
            return Some(before);
        }
        operator(code, before)?;
        let lengths = [1, 3].into_iter();
        index = lengths
            .filter_map(|length| before.checked_sub(length))
            .find(|from| factor(code, *from).is_some_and(|(_, length)| from + length == before))?;
    }
}

/// The unit at `index`, with its exponent, and the number of its instructions.
fn factor(code: &[Instruction], index: usize) -> Option<(String, usize)> {
    let operation = |index: usize| code.get(index).map(|instruction| &instruction.operation);
    let Some(Operation::Name(symbol)) = operation(index) else { return None };
    with_suffix(1.0, symbol).ok()?;
    match (operation(index + 1), operation(index + 2)) {
        (
            Some(Operation::Number { value, unit: None, integer: true }),
            Some(Operation::Binary(Operator::Power)),
        ) => Some((format!("{symbol}^{value}"), 3)),
        _ => Some((symbol.clone(), 1)),
    }
}

/// The product or quotient at `index`.
fn operator(code: &[Instruction], index: usize) -> Option<Operator> {
    match code.get(index)?.operation {
        Operation::Binary(operator @ (Operator::Multiply | Operator::Divide)) => Some(operator),
        _ => None,
    }
}
