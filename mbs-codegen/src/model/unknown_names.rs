//! Faults at names that are unknown, or not known where they stand.

use proc_macro2::Span;

use super::compound;
use super::elaborator::Elaborator;
use super::names::{CONSTANTS, Symbol, functions, is_function, is_of_two};
use super::references::{REFERRING, is_reference};
use super::undeclared::{meant_value, rate_of};
use super::units::with_suffix;
use super::uses::Undeclared;
use super::value::{Fault, Reach};
use crate::diagnostics::nearest;
use crate::syntax::ast::{Expression, Instruction, Operation, Operator};
use crate::syntax::unit_symbols::DOTS;

/// `true` if an instruction is an operand of a product or quotient, as the unit of `2*s` is.
fn is_factor(code: &[Instruction], index: usize) -> bool {
    let operation = |index: usize| code.get(index).map(|instruction| &instruction.operation);
    let is_product = |index: usize| {
        matches!(operation(index), Some(Operation::Binary(Operator::Multiply | Operator::Divide)))
    };
    let is_operand = matches!(operation(index + 1), Some(Operation::Name(_) | Operation::Number { .. }));
    is_product(index + 1) || is_operand && is_product(index + 2)
}

impl Elaborator<'_> {
    /// Reports the unknown names after a fault, which are not evaluated any more.
    pub(super) fn unknown_names(&mut self, expression: &Expression, from: usize) {
        let is_variable = |name: &str| {
            expression.code.iter().any(|instruction| {
                matches!(&instruction.operation, Operation::SumBegin { variable, .. } if variable.text == name)
            })
        };
        for (index, instruction) in expression.code.iter().enumerate().skip(from) {
            match &instruction.operation {
                Operation::Name(_) if is_reference(&expression.code, index) => {}
                Operation::Name(name) if !is_variable(name) => {
                    let known = self.names.get(name).is_some() || CONSTANTS.contains(&name.as_str());
                    // The units of one product are one fault.
                    let follows = compound::in_brackets(&expression.code, index).is_some()
                        && !compound::is_first(&expression.code, index);
                    if !known && !follows {
                        self.unknown_name(name, (&expression.code, index));
                    }
                }
                Operation::Call { function, arguments, .. } if is_of_two(function, *arguments) => {}
                Operation::Call { function, .. }
                    if function != "rate"
                        && !REFERRING.contains(&function.as_str())
                        && !self.knows_function(function) =>
                {
                    self.unknown_function(function, instruction.span);
                }
                _ => {}
            }
        }
    }

    /// A fault at a name that is used before its declaration allows it.
    pub(super) fn too_early(&mut self, name: &str, span: Span) -> Fault {
        self.fault(
            span,
            format!("`{name}` cannot be used here"),
            "constants and defaults use constants alone, guesses constants and parameters; what depends on more is a `let`",
        )
    }

    /// `true` if the name is that of a function, or of a declaration that was reported.
    fn knows_function(&self, name: &str) -> bool {
        let declared =
            matches!(self.names.get(name), Some(Symbol::Function(_) | Symbol::Pending | Symbol::Faulty));
        declared || is_function(name)
    }

    /// A fault at the derivative of a function that is not declared.
    pub(super) fn no_derivative(&mut self, name: &str, span: Span) -> Fault {
        if !is_function(name) {
            return self.unknown_function(name, span);
        }
        let message = format!("`{name}` is no declared function, and has no `.d1` or `.d2`");
        self.fault(span, message, "write its derivative as an expression")
    }

    /// A fault at an unknown name.
    pub(super) fn unknown_name(&mut self, name: &str, (code, index): (&[Instruction], usize)) -> Fault {
        let span = code.get(index).map_or_else(Span::call_site, |instruction| instruction.span);
        if self.names.is_local(name) {
            let message = format!("`{name}` is known inside its `for` alone, behind its declaration");
            return self.fault(span, message, "move this into the loop, or declare a `let` outside of it");
        }
        let message = format!("unknown name `{name}`");
        let is_value = |name: &str| matches!(self.names.get(name), Some(Symbol::Value(_)));
        let dots = name.contains(DOTS);
        let mut is_undeclared = false;
        let help = if let Some(effect) = self.names.effect_of(name) {
            format!("effect `{effect}` declares it: let the scene add it with `+ {effect}`")
        } else if let Some(meant) = meant_value(name) {
            meant
        } else if dots {
            format!("`·` is part of the name; write a product as `{}`", name.replace(DOTS, "*"))
        } else if let Some((stem, order)) = rate_of(name, is_value) {
            match (self.reach, order) {
                (Reach::Position, 1) => {
                    format!("a rate is written `der({stem})`, in a drive `rate({stem}) == …`")
                }
                (_, 1) => format!("a rate is written `der({stem})`"),
                _ => format!("an acceleration is written `der2({stem})`"),
            }
        } else if is_function(name) {
            format!("`{name}` is a function; write `{name}(…)`")
        } else if let Some(number) = compound::in_brackets(code, index) {
            format!("write a compound unit in brackets behind its number: `{number}`")
        } else if let Some(known) = nearest(name, self.names.all().chain(CONSTANTS)) {
            is_undeclared = true;
            format!("did you mean `{known}`?")
        } else if with_suffix(1.0, name).is_ok() && is_factor(code, index) {
            format!(
                "a unit is joined to its number, `2{name}`, or stands in brackets behind it: `30 [rad/s]`"
            )
        } else {
            is_undeclared = true;
            "declare it with `const`, `param`, `input`, `coord` or `let`".into()
        };
        // A unit as a name has another cure at each of its uses.
        if with_suffix(1.0, name).is_err() || is_undeclared {
            self.names.report_once(name, span);
        }
        let span = match self.names.uses.get(name) {
            Some((_, first)) if self.names.get(name).is_some() => *first,
            _ => span,
        };
        if is_undeclared {
            self.names.undeclared.push(Undeclared {
                name: name.to_owned(),
                span,
                message: message.clone(),
                is_function: false,
            });
        }
        self.fault(span, message, help)
    }

    /// A fault at an unknown function.
    pub fn unknown_function(&mut self, name: &str, span: Span) -> Fault {
        let known = || self.names.functions().chain(functions());
        let help = match nearest(name, known().filter(|known| *known != name)) {
            Some(known) => format!("did you mean `{known}`?"),
            None => format!("declare it: `function {name}: m(rad), C3;`"),
        };
        let span = self.names.uses.get(name).map_or(span, |(_, first)| *first);
        let message = format!("unknown function `{name}`");
        self.names.report_once(name, span);
        let (name, reported) = (name.to_owned(), message.clone());
        self.names.undeclared.push(Undeclared { name, span, message: reported, is_function: true });
        self.fault(span, message, help)
    }
}
