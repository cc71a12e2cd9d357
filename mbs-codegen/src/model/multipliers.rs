//! Lagrange multipliers of rows: `lambda(row)`, `effort(drive)`.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::diagnostics::nearest;
use crate::symbolic::Unary;
use crate::syntax::OF_FORCES;
use crate::syntax::ast::{Name, Target};

impl Elaborator<'_> {
    /// `lambda(row)`, `effort(drive)`, `reaction(pin, body)`.
    pub(super) fn reference(
        &mut self,
        function: &str,
        targets: &[Target],
        counts: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        if function == "reaction" {
            return self.reaction(targets, counts, span);
        }
        if OF_FORCES.contains(&function) {
            return self.of_force(function, targets, counts, span);
        }
        if matches!(self.reach, Reach::Position | Reach::Let) {
            return Err(self.fault(
                span,
                format!("`{function}` stands outside an output or a force"),
                "multipliers are known to forces and outputs alone",
            ));
        }
        if !matches!(function, "lambda" | "effort") {
            return Err(self.unknown_function(function, span));
        }
        if !self.names.dynamic {
            let help =
                "declare what moves: `body rod { mass: 2kg, com: P }`; without masses no row has a force";
            return Err(self.fault(span, format!("`{function}` stands in a text without masses"), help));
        }
        if targets.iter().any(|target| self.names.has_faulty_rows(&target.name.text)) {
            return Err(Fault);
        }
        let [target] = targets else {
            let message = format!("`{function}` takes 1 name, not {}", targets.len());
            return Err(self.fault(span, message, format!("write `{function}(row)`")));
        };
        let Some(rows) = self.names.rows(&target.name.text).cloned() else {
            let known: Vec<&str> = self.names.row_groups().collect();
            let help = match nearest(&target.name.text, known.iter().copied()) {
                Some(name) => format!("did you mean `{name}`?"),
                None if known.is_empty() => {
                    "a multiplier is that of a row, and the text has no constraint or drive".into()
                }
                None => format!("rows are those of {}", list(&known)),
            };
            let message = format!("`{}` is no constraint or drive", target.name.text);
            return Err(self.fault(target.name.span, message, help));
        };
        if function == "effort" && !rows.driven {
            let message = format!("`{}` is no drive", target.name.text);
            let help = format!("write `lambda({})` for the multiplier of a constraint", target.name.text);
            return Err(self.fault(target.name.span, message, help));
        }
        if rows.rows.is_empty() {
            return Err(self.without_rows(&target.name));
        }
        let chosen = match counts.first() {
            None => rows.rows.clone(),
            Some(count) => {
                let index = self.count(count)?;
                let Some(row) = rows.rows.get(index) else {
                    let (name, length) = (&target.name.text, rows.rows.len());
                    return Err(self.fault(
                        count.span,
                        format!("`{name}` has no row {index}"),
                        format!("its rows are counted from 0; the last is {}", length.saturating_sub(1)),
                    ));
                };
                vec![*row]
            }
        };
        let mut items = Vec::new();
        for (row, dimension) in &chosen {
            let quantity = Quantity::Known(Dimension::JOULE.over(*dimension));
            let id = match rows.released {
                true => self.expressions.push_absent(),
                false => self.expressions.push(Node::Multiplier(*row)),
            };
            let scalar = Scalar { id, quantity, bare: Bare::Not, span };
            items.push(match function {
                "effort" => self.unary_scalar(Unary::Negate, scalar, quantity, span)?,
                _ => scalar,
            });
        }
        let shape = if items.len() == 1 { Vec::new() } else { vec![items.len()] };
        Ok(Value { shape, items, span })
    }

    /// Reports that a group has no row, unless that follows from a fault in one.
    fn without_rows(&mut self, group: &Name) -> Fault {
        if !self.diagnostics.is_empty() {
            return Fault;
        }
        let message = format!("`{}` has no row and so no multiplier", group.text);
        self.fault(group.span, message, "write the equation whose force is meant")
    }
}

fn list(names: &[&str]) -> String {
    match names {
        [] => "no constraint yet".into(),
        _ => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    }
}
