//! Outputs that need the factors of Φ_q: margins of constraints, ratios of transmission.

use proc_macro2::Span;

use super::Reference;
use super::bare::Bare;
use super::elaborate::{Elaborator, Fault};
use super::expression::{Id, Node};
use super::rates::Reach;
use super::resolve::Resolver;
use super::units::Dimension;
use super::value::{Quantity, Scalar, Value};
use crate::diagnostics::nearest;
use crate::symbolic::Binary;
use crate::syntax::ast::{Instruction, Operation};

/// Functions whose last argument is the name of a constraint or drive, not a value.
pub const REFERRING: [&str; 2] = ["margin", "ratio"];

/// `true` if the name at `index` is the last argument of one of them.
pub fn is_reference(code: &[Instruction], index: usize) -> bool {
    matches!(
        code.get(index + 1).map(|next| &next.operation),
        Some(Operation::Call { function, .. }) if REFERRING.contains(&function.as_str())
    )
}

impl Elaborator<'_> {
    /// `margin(group)` or `ratio(x, drive)`, where `group` is the instruction before the call.
    pub fn referring(
        &mut self,
        function: &str,
        group: Option<&Instruction>,
        arguments: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        let help = match function {
            "margin" => "write `margin(closure)` with the name of a constraint or drive",
            _ => "write `ratio(phi3, crank)` with an expression and the name of a drive",
        };
        let Some(Instruction { operation: Operation::Name(name), span: place }) = group else {
            return Err(self.fault(span, format!("`{function}` ends with no name"), help));
        };
        if self.reach != Reach::Output {
            return Err(self.fault(
                span,
                format!("`{function}` stands outside an output"),
                "it needs the solved position; write it in an `out`",
            ));
        }
        let Some(group) = self.groups.iter().find(|group| group.name == *name) else {
            let known = nearest(name, self.groups.iter().map(|group| group.name.as_str()));
            let help = known.map_or_else(|| help.into(), |known| format!("did you mean `{known}`?"));
            return Err(self.fault(*place, format!("`{name}` is no constraint or drive"), help));
        };
        let (drive, group) = (group.drive, group.clone());
        match (function, arguments.as_slice()) {
            ("margin", []) => {
                let id = self.expressions.push(Node::Margin(group.index));
                let quantity = Quantity::Known(Dimension::NUMBER);
                Ok(Value::scalar(Scalar { id, quantity, bare: Bare::Not, span }, span))
            }
            ("ratio", [x]) => {
                let Some((row, dimension)) = drive else {
                    return Err(self.fault(*place, format!("`{name}` is no single drive"), help));
                };
                for item in &x.items {
                    self.of_position(*item, function)?;
                }
                self.each(x, span, |work, item| {
                    let id = work.expressions.push(Node::Ratio(item.id, row));
                    let quantity = Quantity::Known(item.quantity.dimension().over(dimension));
                    Ok(Scalar { id, quantity, bare: Bare::Not, span })
                })
            }
            _ => Err(self.fault(span, format!("`{function}` has another number of arguments"), help)),
        }
    }

    /// Reports values that are known with the factors or the rates alone, where their derivative is asked for.
    pub fn of_position(&mut self, x: Scalar, function: &str) -> Result<(), Fault> {
        let needs = |node: Node| match function {
            "ratio" => matches!(node, Node::Margin(_) | Node::Ratio(..) | Node::Rate(..)),
            _ => matches!(node, Node::Margin(_) | Node::Ratio(..)),
        };
        match self.expressions.contain(x.id, needs) {
            false => Ok(()),
            true => Err(self.fault(
                x.span,
                format!("`{function}` cannot differentiate this"),
                "margins and ratios come without derivatives; take the ratio of coordinates and what is made of them",
            )),
        }
    }
}

impl Resolver<'_> {
    /// Before: all rows. After: the constraints and drives that outputs can refer to.
    pub(super) fn references(&self) -> Vec<Reference> {
        let mut references = Vec::new();
        for (index, (name, kind, rows)) in self.row_groups().enumerate() {
            let drive = match rows {
                [row] if kind == "drive" => self.model.rows.get(*row).map(|found| (*row, found.dimension)),
                _ => None,
            };
            references.push(Reference { name: name.to_owned(), index, rows: rows.to_vec(), drive });
        }
        references
    }

    /// Reports an output of margins or ratios where its other values are not known together with them.
    pub(super) fn check_reference(&mut self, value: &Value) -> Result<(), Fault> {
        let refers = |node| matches!(node, Node::Margin(_) | Node::Ratio(..));
        for item in value.items.iter().filter(|item| self.contains(item.id, refers)) {
            let (message, help) = if self.contains(item.id, |node| {
                matches!(node, Node::State(_) | Node::Multiplier(_) | Node::Pin(..))
            }) {
                (
                    "an output has a margin or ratio and a multiplier or state",
                    "write two outputs: multipliers and states are known to the equations of motion alone",
                )
            } else if self.model.rows.len() < self.model.coordinates.len() {
                (
                    "margins and ratios need as many rows as coordinates",
                    "drive what moves freely, or leave the output to a scene that does",
                )
            } else {
                continue;
            };
            self.diagnostics.report(item.span, message, help);
            return Err(Fault);
        }
        Ok(())
    }

    /// `true` if the prescribed side of a row is the left one: its residual falls where the drive rises.
    pub(super) fn is_reversed(&self, residual: Id) -> bool {
        let moves = |id: Id| self.contains(id, |node| matches!(node, Node::Coordinate(_)));
        match self.model.expressions.node(residual) {
            Node::Binary(Binary::Subtract, left, right) => !moves(left) && moves(right),
            _ => false,
        }
    }
}
