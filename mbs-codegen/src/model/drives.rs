//! Drives: rows that prescribe a motion, or a rate whose integral the stepper keeps as a phase.

use proc_macro2::Span;

use super::declared_fields::ANY;
use super::expression::{Id, Node};
use super::resolver::Resolver;
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar};
use super::written::written;
use super::{ConstraintRow, Field, Phase, Role, Variable, VariableKind};
use crate::symbolic::Binary;
use crate::syntax::ast::{Equation, Expression, Instruction, Name, Operation};

impl Resolver<'_> {
    /// Adds the row of a drive.
    pub(super) fn drive(&mut self, name: &Name, equation: &Equation) -> Result<(), Fault> {
        let group = self.group(name, "drive")?;
        if let Some((rate, argument, span)) = differentiated(equation) {
            let order = if rate == "der" { "rate" } else { "…" };
            let other = match differentiates(&equation.left) {
                Some(_) => &equation.right,
                None => &equation.left,
            };
            let (argument, other) = (written(argument), written(&other.code));
            let help = match order {
                "rate" => format!("write `drive {}: rate({argument}) == {other};`", name.text),
                _ => format!(
                    "give the motion itself as a function of the time: `drive {}: {argument} == …;`",
                    name.text
                ),
            };
            self.diagnostics.report(span, format!("a drive prescribes no `{rate}`"), help);
            return Err(Fault);
        }
        if let Some(argument) = rated(&equation.left) {
            return self.rate_drive(name, group, &argument, equation);
        }
        let first = self.model.rows.len();
        self.equation(equation, group)?;
        if self.model.rows.len() > first + 1 {
            self.diagnostics.report(
                equation.span,
                format!("drive `{}` has {} components", name.text, self.model.rows.len() - first),
                "drive one scalar at a time: `drive x: p[0] == …;`",
            );
        }
        Ok(())
    }

    /// `rate(argument) == speed`: the row `argument − phase`, and the phase as a variable with its rates.
    fn rate_drive(
        &mut self,
        name: &Name,
        group: usize,
        argument: &Expression,
        equation: &Equation,
    ) -> Result<(), Fault> {
        let (argument, speed) = self.elaborate(Reach::Position, |work| {
            let (argument, speed) = (work.value(argument), work.value(&equation.right));
            let (argument, speed) = (argument?, speed?);
            let argument = work.scalar(&argument, "`rate`", argument.span)?;
            let speed = work.scalar(&speed, "a prescribed rate", speed.span)?;
            let rate = argument.quantity.dimension().over(Dimension::SECOND);
            work.concerning(Place::Rate, (&equation.right, None), |work| {
                work.agree(Scalar { quantity: Quantity::Known(rate), ..argument }, speed)
            })?;
            Ok::<_, Fault>((argument, speed))
        })?;
        let kinds = [
            ("a coordinate", self.contains(speed.id, |node| matches!(node, Node::Coordinate(_)))),
            ("a state", self.contains(speed.id, |node| matches!(node, Node::State(_)))),
        ];
        if let Some((kind, _)) = kinds.into_iter().find(|(_, found)| *found) {
            self.diagnostics.report(
                speed.span,
                format!("the rate that drive `{}` prescribes depends on {kind}", name.text),
                "make it of the time, parameters and inputs alone",
            );
            return Err(Fault);
        }
        let round = self.rows_of(group);
        let dimension = argument.quantity.dimension();
        let variable = self.phase_variables(name, round, argument.id, dimension)?;
        let value = self.model.expressions.push(Node::Variable(variable));
        let residual = self.elaborate(Reach::Position, |work| {
            work.push_binary(Binary::Subtract, argument.id, value, equation.span)
        })?;
        self.model.phases.push(Phase { variable, argument: argument.id, speed: speed.id });
        let row = ConstraintRow {
            name: String::new(),
            dimension,
            residual,
            driven: true,
            reversed: false,
            redundant: false,
            within: None,
            span: equation.span,
        };
        self.push_row(group, row);
        Ok(())
    }

    /// The field that keeps a phase: value, rate and acceleration as three variables. Returns the index of the value.
    fn phase_variables(
        &mut self,
        name: &Name,
        round: usize,
        argument: Id,
        dimension: Dimension,
    ) -> Result<usize, Fault> {
        let text = match self.loops.is_empty() {
            true => format!("{}_phase", name.text),
            false => format!("{}_{round}_phase", name.text),
        };
        if self.names.get(&text).is_some() || self.model.fields.iter().any(|field| field.name.text == text) {
            self.diagnostics.report(
                name.span,
                format!(
                    "the phase of drive `{}` is kept under the name `{text}`, which is declared",
                    name.text
                ),
                "rename the drive or the declaration",
            );
            return Err(Fault);
        }
        let (unit, first) = (self.unit_of(argument, dimension), self.model.variables.len());
        let parts = [("", "", 0), (".rate", "/s", 1), (".acceleration", "/s^2", 2)];
        for (part, per, order) in parts {
            let seconds = Dimension::SECOND.power(f64::from(order)).unwrap_or_default();
            self.model.variables.push(Variable {
                range: ANY,
                tolerance: None,
                name: format!("{text}{part}"),
                unit: format!("{unit}{per}"),
                dimension: dimension.over(seconds),
                default: 0.0,
                turns: false,
                kind: if order == 0 { VariableKind::InputWithRates } else { VariableKind::InputRate },
                span: name.span,
            });
        }
        let docs =
            vec![format!(" Where drive `{}` holds what it drives; moved on by the stepper.", name.text)];
        let name = Name { text, span: name.span };
        self.model.fields.push(Field { name, docs, unit, shape: Vec::new(), first, role: Role::Phase });
        Ok(first)
    }
}

/// The `der` or `der2` that is all of one side of a drive, with its argument.
fn differentiated(equation: &Equation) -> Option<(&str, &[Instruction], Span)> {
    differentiates(&equation.left).or_else(|| differentiates(&equation.right))
}

fn differentiates(expression: &Expression) -> Option<(&str, &[Instruction], Span)> {
    let (Instruction { operation, span }, argument) = expression.code.split_last()?;
    match operation {
        Operation::Call { function, order: 0, arguments: 1, indexed: false }
            if function.starts_with("der") =>
        {
            Some((function, argument, *span))
        }
        _ => None,
    }
}

/// Argument of `rate(…)`, where that is all of the expression.
fn rated(expression: &Expression) -> Option<Expression> {
    let (Instruction { operation, .. }, argument) = expression.code.split_last()?;
    match operation {
        Operation::Call { function, order: 0, arguments: 1, indexed: false } if function == "rate" => {
            Some(Expression { code: argument.to_vec() })
        }
        _ => None,
    }
}
