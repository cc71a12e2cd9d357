//! Expressions as text again, and their factors: for messages that quote them.

use crate::syntax::ast::{Instruction, Operation, Operator};

/// Most instructions of an expression that a message quotes.
pub const LONGEST: usize = 40;

/// Index of the first instruction of the value that the one at `end` completes.
pub fn start(code: &[Instruction], end: usize) -> Option<usize> {
    let (mut index, mut needed) = (end, 1_usize);
    loop {
        let operation = &code.get(index)?.operation;
        let operands = match operation {
            Operation::Number { .. } | Operation::Name(_) => 0,
            Operation::Negate => 1,
            Operation::Binary(_) => 2,
            Operation::Call { arguments, indexed, .. } => arguments + usize::from(*indexed),
            Operation::Array { length } => *length,
            Operation::Index { indices } => indices + 1,
            Operation::Reference { targets, .. } => targets.iter().filter(|target| target.indexed).count(),
            Operation::SumBegin { .. } => 2,
            Operation::SumEnd { begin } => {
                index = *begin;
                2
            }
        };
        needed = needed - 1 + operands;
        if needed == 0 {
            return Some(index);
        }
        index = index.checked_sub(1)?;
    }
}

/// The values of `number` operands that end just before `end`, the first one first.
pub fn operands(code: &[Instruction], end: usize, number: usize) -> Option<Vec<&[Instruction]>> {
    let (mut found, mut end) = (Vec::new(), end);
    for _ in 0..number {
        let from = start(code, end.checked_sub(1)?)?;
        found.push(code.get(from..end)?);
        end = from;
    }
    found.reverse();
    Some(found)
}

/// Binding strength of a text; an atom needs no parentheses.
const ATOM: u8 = 9;

/// The expression as one writes it; `…` where it is long or holds a sum over counts.
pub fn written(code: &[Instruction]) -> String {
    if code.len() > LONGEST {
        return "…".into();
    }
    let mut stack: Vec<(String, u8)> = Vec::new();
    for instruction in code {
        let Some(text) = step(&instruction.operation, &mut stack) else { return "…".into() };
        stack.push(text);
    }
    stack.pop().map_or_else(|| "…".into(), |(text, _)| text)
}

fn step(operation: &Operation, stack: &mut Vec<(String, u8)>) -> Option<(String, u8)> {
    let bracketed =
        |(text, strength): (String, u8), least: u8| if strength < least { format!("({text})") } else { text };
    let mut list = |count: usize| -> Option<String> {
        let taken = stack.split_off(stack.len().checked_sub(count)?);
        Some(taken.into_iter().map(|(text, _)| text).collect::<Vec<_>>().join(", "))
    };
    Some(match operation {
        Operation::Number { value, unit: None, .. } => (number(*value), ATOM),
        Operation::Number { value, unit: Some(unit), .. } => (with_unit(*value, &unit.text), ATOM),
        Operation::Name(name) => (name.clone(), ATOM),
        Operation::Negate => {
            let operand = stack.pop()?;
            (format!("-{}", bracketed(operand, 3)), 3)
        }
        Operation::Binary(operator) => {
            let (right, left) = (stack.pop()?, stack.pop()?);
            let (sign, strength, of_right) = match operator {
                Operator::Add => (" + ", 1, 1),
                Operator::Subtract => (" - ", 1, 2),
                Operator::Multiply => ("*", 2, 2),
                Operator::Divide => ("/", 2, 3),
                Operator::Power => ("^", 4, 4),
            };
            let of_left = if *operator == Operator::Power { 5 } else { strength };
            (format!("{}{sign}{}", bracketed(left, of_left), bracketed(right, of_right)), strength)
        }
        Operation::Call { function, order, arguments, indexed } => {
            let arguments = list(*arguments)?;
            let number = if *indexed { format!("[{}]", list(1)?) } else { String::new() };
            let derivative = if *order == 0 { String::new() } else { format!(".d{order}") };
            (format!("{function}{number}{derivative}({arguments})"), ATOM)
        }
        Operation::Array { length } => (format!("[{}]", list(*length)?), ATOM),
        Operation::Index { indices } => {
            let indices = list(*indices)?;
            let array = stack.pop()?;
            (format!("{}[{indices}]", bracketed(array, ATOM)), ATOM)
        }
        Operation::SumBegin { .. } | Operation::SumEnd { .. } | Operation::Reference { .. } => return None,
    })
}

/// A number as one writes it.
pub fn number(value: f64) -> String {
    let plain = format!("{value}");
    if plain.len() > 8 { format!("{value:e}") } else { plain }
}

/// A number with its unit: joined to it, or in brackets.
pub fn with_unit(value: f64, unit: &str) -> String {
    let number = number(value);
    match unit {
        "1" => number,
        unit if unit.chars().all(char::is_alphanumeric) => format!("{number}{unit}"),
        unit => format!("{number} [{unit}]"),
    }
}

/// A factor of a product: its place in the code, and its exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor {
    pub from: usize,
    pub to: usize,
    pub exponent: f64,
}

/// Factors of an expression that is a product, a quotient, or either with a sign; those within sums are none.
pub fn factors(code: &[Instruction]) -> Vec<Factor> {
    let mut found = Vec::new();
    if code.is_empty() || code.len() > LONGEST {
        return found;
    }
    let mut waiting = vec![Factor { from: 0, to: code.len(), exponent: 1.0 }];
    while let Some(factor) = waiting.pop() {
        let Factor { from, to, exponent } = factor;
        let part = code.get(from..to).unwrap_or_default();
        let Some(last) = part.last() else { continue };
        let sides = match last.operation {
            Operation::Binary(Operator::Multiply | Operator::Divide | Operator::Power) => {
                operands(part, part.len() - 1, 2)
            }
            _ => None,
        };
        let middle = from + sides.as_ref().and_then(|sides| sides.first()).map_or(0, |left| left.len());
        let left = Factor { from, to: middle, exponent };
        match (&last.operation, sides) {
            (Operation::Negate, _) => waiting.push(Factor { to: to - 1, ..factor }),
            (Operation::Binary(Operator::Multiply), Some(_)) => {
                waiting.extend([Factor { from: middle, to: to - 1, exponent }, left]);
            }
            (Operation::Binary(Operator::Divide), Some(_)) => {
                waiting.extend([Factor { from: middle, to: to - 1, exponent: -exponent }, left]);
            }
            (Operation::Binary(Operator::Power), Some(sides)) => match sides.get(1) {
                Some([Instruction { operation: Operation::Number { value, unit: None, .. }, .. }]) => {
                    waiting.push(Factor { exponent: exponent * value, ..left });
                }
                _ => found.push(factor),
            },
            _ => found.push(factor),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use proc_macro2::Span;

    use super::*;
    use crate::diagnostics::Diagnostics;
    use crate::syntax::ast::StatementKind;

    fn code(text: &str) -> Vec<Instruction> {
        let source = format!("mechanism M; coord x: m = 0; out y: m = {text};");
        let read = crate::syntax::read(source.parse().expect("tokens"), &mut Diagnostics::default())
            .expect("a text");
        match &read.statements.last().expect("an output").kind {
            StatementKind::Out { value, .. } => value.code.clone(),
            other => unreachable!("{other:?} {:?}", Span::call_site()),
        }
    }

    #[test]
    fn expressions_are_written_as_they_were() {
        for text in [
            "2*x^2/3",
            "-(a + b)*c",
            "a - (b - c)",
            "a/(b*c)",
            "m[0, 1]*[x, -y]",
            "atan2(y, x)",
            "(2*a)^2",
            "4 [m^2] + 30deg",
        ] {
            assert_eq!(written(&code(text)), text);
        }
        assert_eq!(written(&code("sum(i in 0..3: x[i])")), "…");
    }

    #[test]
    fn products_have_factors_with_exponents() {
        let code = code("-2*PI*t^2/(a + b)");
        let found: Vec<(String, f64)> = factors(&code)
            .iter()
            .map(|factor| (written(&code[factor.from..factor.to]), factor.exponent))
            .collect();
        let expected =
            [("2", 1.0), ("PI", 1.0), ("t", 2.0), ("a + b", -1.0)].map(|(text, e)| (text.to_owned(), e));
        assert_eq!(found, expected);
    }
}
