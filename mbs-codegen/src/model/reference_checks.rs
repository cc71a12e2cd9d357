//! References of outputs to rows: their names, and the checks of what they refer to.

use super::Reference;
use super::expression::{Id, Node};
use super::resolver::Resolver;
use super::value::{Fault, Value};
use crate::symbolic::Binary;

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
            let (message, help) = if self.contains(item.id, Node::is_of_motion) {
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
