//! Functions that the text declares and the caller supplies: their declarations, and that each is called.

use std::collections::BTreeSet;

use super::counts::LONGEST;
use super::declarations::Declarations;
use super::initialiser::{initialiser, numbers};
use super::names::Callable;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Value};
use super::{Function, InArray};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Item, Name, Operation, Signature, Statement, StatementKind};

impl Declarations<'_> {
    /// Declares a function, or an array of them; the period is a number.
    pub(super) fn function(&mut self, name: &Name, docs: Vec<String>, signature: &Signature) {
        let Signature { value, argument, continuity, period } = signature;
        let unit = &value.unit;
        let declared = self.declared(value);
        let taken = Dimension::of(argument, self.diagnostics);
        if !self.owns(name) {
            return;
        }
        let length = declared.shape.first().copied();
        let dimension =
            (!declared.faulty && self.is_declarable(name, &declared.shape)).then_some(declared.dimension);
        let period = period.as_ref().and_then(|expression| {
            let period = self.elaborate(|work| {
                let value = work.value(expression)?;
                let scalar = work.scalar(&value, "a period", value.span)?;
                if let (Quantity::Known(found), Some(taken)) = (scalar.quantity, taken)
                    && scalar.bare != Bare::Wholly
                    && found != taken
                {
                    let (function, unit) = (&name.text, &argument.text);
                    let message =
                        format!("the period of `{function}` has the unit `{found}`, its argument `{unit}`");
                    return Err(work.fault(value.span, message, "write the period in the argument's unit"));
                }
                let value = initialiser(work, Value::scalar(scalar, value.span), taken.ok_or(Fault)?)?;
                let period = numbers(work, expression, &value, "a period")?.pop().ok_or(Fault)?;
                if period > 0.0 {
                    return Ok(period);
                }
                let message = format!("the period of `{}` is not positive", name.text);
                Err(work.fault(value.span, message, "write a positive period, or none"))
            });
            period.ok()
        });
        if let (Some(value), Some(argument)) = (dimension, taken) {
            let index = self.model.functions.len();
            let callable = Callable { index, length, unit: value, argument, bare: Bare::of(unit) };
            self.names.define_function(&name.text, callable);
        }
        let function = |array| Function {
            name: name.clone(),
            docs: docs.clone(),
            unit: unit.text.clone(),
            argument_unit: argument.text.clone(),
            dimensions: [dimension, taken],
            continuity: *continuity,
            period,
            array,
        };
        match length.filter(|_| dimension.is_some()) {
            Some(length) => {
                let places = (0..length).map(|index| Some(InArray { index, length }));
                self.model.functions.extend(places.map(function));
            }
            None => self.model.functions.push(function(None)),
        }
    }

    /// `true` if a function may have these lengths; otherwise they are reported.
    fn is_declarable(&mut self, name: &Name, shape: &[usize]) -> bool {
        let message = match shape {
            [] => return true,
            [length] if self.model.functions.len() + length <= LONGEST => return true,
            [_] => format!("the text declares more than {LONGEST} functions"),
            _ => format!("the array of functions `{}` has several lengths", name.text),
        };
        let help = match shape {
            [_] => "declare shorter arrays",
            _ => "write one length, `[m; 6]`, and compute the number of each: `lift[3*i + k](x)`",
        };
        self.diagnostics.report(name.span, message, help);
        false
    }

    /// Replaces a declaration that could not be read, so that its calls are not reported too.
    pub(super) fn unknown_function(&mut self, name: &Name, docs: Vec<String>) {
        self.model.functions.push(Function {
            name: name.clone(),
            docs,
            unit: "1".into(),
            argument_unit: "1".into(),
            dimensions: [None; 2],
            continuity: 0,
            period: None,
            array: None,
        });
    }
}

/// Reports declared functions that the text does not call: each would ask its caller for a type to no purpose.
///
/// In a text with other faults the calls may be in parts that could not be read.
pub fn check_called(statements: &[Statement], diagnostics: &mut Diagnostics) {
    if !diagnostics.is_empty() {
        return;
    }
    let instructions = statements.iter().flat_map(|s| s.kind.expressions()).flat_map(|e| &e.code);
    let called: BTreeSet<&str> = instructions
        .filter_map(|instruction| match &instruction.operation {
            Operation::Call { function, .. } => Some(function.as_str()),
            _ => None,
        })
        .collect();
    for statement in statements {
        if let StatementKind::Function { name, signature } = &statement.kind
            && !called.contains(name.text.as_str())
        {
            let number = if signature.value.shape.is_empty() { "" } else { "[0]" };
            let help = format!("call it, `{}{number}(x)`, or remove the declaration", name.text);
            diagnostics.report(name.span, format!("function `{}` is never called", name.text), help);
        }
    }
    check_curves(statements, diagnostics);
}

/// Reports curves that nothing uses, as functions: their radius would be one that is never called.
fn check_curves(statements: &[Statement], diagnostics: &mut Diagnostics) {
    let instructions = statements.iter().flat_map(|s| s.kind.expressions()).flat_map(|e| &e.code);
    let named = instructions.filter_map(|instruction| match &instruction.operation {
        Operation::Name(name) => Some(name.as_str()),
        _ => None,
    });
    let items = statements.iter().flat_map(|statement| match &statement.kind {
        StatementKind::Constraint { items, .. } => items.as_slice(),
        _ => &[],
    });
    let touched = items.filter_map(|item| match item {
        Item::On { curve, .. } => Some(curve.text.as_str()),
        _ => None,
    });
    let used: BTreeSet<&str> = named.chain(touched).collect();
    for statement in statements {
        if let StatementKind::Curve { name, .. } = &statement.kind
            && !used.contains(name.text.as_str())
        {
            let help = format!("write `A on {}` in a constraint, or remove the declaration", name.text);
            diagnostics.report(name.span, format!("curve `{}` is never used", name.text), help);
        }
    }
}
