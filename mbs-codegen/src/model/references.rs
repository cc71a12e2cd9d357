//! Outputs that need the factors of Φ_q: margins of constraints, ratios of transmission.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::names::OF_CURVES;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::diagnostics::nearest;
use crate::syntax::ast::{Instruction, Operation};

/// Functions whose last argument is the name of a constraint or drive, not a value.
pub const REFERRING: [&str; 2] = ["margin", "ratio"];

/// `true` if the name at `index` is the last argument of one of them.
pub fn is_reference(code: &[Instruction], index: usize) -> bool {
    matches!(
        code.get(index + 1).map(|next| &next.operation),
        Some(Operation::Call { function, arguments, indexed: false, .. })
            if REFERRING.contains(&function.as_str()) || *arguments == 2 && OF_CURVES.contains(&function.as_str())
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
        if self.names.has_faulty_rows(name) {
            return Err(Fault);
        }
        if self.names.rows(name).is_some_and(|rows| rows.released) {
            let message = format!("an effect of the scene releases `{name}`, which has no `{function}` then");
            let help = "write the output in an effect, and leave that out of scenes without the constraint";
            return Err(self.fault(*place, message, help));
        }
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
