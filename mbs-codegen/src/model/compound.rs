//! Compound units written as products, `2kg*m^2` or `30rad/s`: the form in brackets that is meant.

use super::units::{in_unit, with_suffix};
use crate::syntax::ast::{Instruction, Operation, Operator};
use crate::syntax::unit_symbols::{foreign_name, meant};

/// The number in front of a chain of units that the name at `index` is part of, with all of them in brackets:
/// `2 [kg*m^2]`; `None` where no number with a unit leads the chain.
pub fn in_brackets(code: &[Instruction], index: usize) -> Option<String> {
    let (text, end) = of_number_up_to(code, start(code, index)?)?;
    (end > index).then_some(text)
}

/// The number at `index` with the units behind it in brackets, its own by the symbol that is meant: `1 [turn/min]` of `1rev/min`.
pub fn of_number(code: &[Instruction], index: usize) -> Option<String> {
    let (text, end) = of_number_up_to(code, index)?;
    (end > index + 1 + closing(code, index + 1)).then_some(text)
}

/// The number at `start` with all units behind it, and the index behind them.
fn of_number_up_to(code: &[Instruction], start: usize) -> Option<(String, usize)> {
    let Operation::Number { value, unit: Some(unit), .. } = &code.get(start)?.operation else { return None };
    let mut text = match with_suffix(1.0, &unit.text).is_ok() || unit.text.contains(['*', '/', '^']) {
        true => unit.text.clone(),
        false => meant(&unit.text)?,
    };
    let mut next = start + 1 + closing(code, start + 1);
    while let Some((symbol, length)) = factor(code, next)
        && let Some(operator) = operator(code, next + length)
    {
        text.push(if operator == Operator::Divide { '/' } else { '*' });
        text += &symbol;
        next += length + 1;
    }
    Some((format!("{value} [{text}]"), next))
}

/// `true` if the name at `index` follows the number that leads its chain, whose own unit is known.
pub fn is_first(code: &[Instruction], index: usize) -> bool {
    let number = leading(code, index).and_then(|number| code.get(number));
    number.is_some_and(|number| match &number.operation {
        Operation::Number { value, unit: Some(unit), .. } => in_unit(*value, unit).is_ok(),
        _ => false,
    })
}

/// Index of a number with a unit that ends in front of `index`, its sign and the product that it closes aside.
fn leading(code: &[Instruction], index: usize) -> Option<usize> {
    let number = code.get(..index)?.iter().rposition(|instruction| {
        !matches!(
            instruction.operation,
            Operation::Negate | Operation::Binary(Operator::Multiply | Operator::Divide)
        )
    })?;
    let has_unit = matches!(code.get(number)?.operation, Operation::Number { unit: Some(_), .. });
    has_unit.then_some(number)
}

/// Instructions from `index` on that belong to the number in front: its sign, `-9.81m/s^2`, and a product, `3*2kg*m^2`.
fn closing(code: &[Instruction], index: usize) -> usize {
    let rest = code.get(index..).unwrap_or_default().iter();
    rest.take_while(|instruction| {
        matches!(
            instruction.operation,
            Operation::Negate | Operation::Binary(Operator::Multiply | Operator::Divide)
        )
    })
    .count()
}

/// Index of the number that leads the chain of factors up to `index`.
fn start(code: &[Instruction], mut index: usize) -> Option<usize> {
    loop {
        if let Some(number) = leading(code, index) {
            return Some(number);
        }
        let before = index.checked_sub(1)?;
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
    let symbol = match with_suffix(1.0, symbol) {
        Ok(_) => symbol.as_str(),
        // One letter is a name of the text, or the time.
        Err(_) => foreign_name(symbol).filter(|_| symbol.len() > 1)?,
    };
    match (operation(index + 1), operation(index + 2)) {
        (
            Some(Operation::Number { value, unit: None, integer: true }),
            Some(Operation::Binary(Operator::Power)),
        ) => Some((format!("{symbol}^{value}"), 3)),
        _ => Some((symbol.to_owned(), 1)),
    }
}

/// The product or quotient at `index`.
fn operator(code: &[Instruction], index: usize) -> Option<Operator> {
    match code.get(index)?.operation {
        Operation::Binary(operator @ (Operator::Multiply | Operator::Divide)) => Some(operator),
        _ => None,
    }
}
