//! Largest contradiction allowed between rows of a constraint marked `redundant`.

use super::expression::Node;
use super::initialiser::initialiser;
use super::resolver::Resolver;
use super::units::Dimension;
use super::value::{Fault, Reach, Value};
use crate::syntax::ast::Expression;

impl Resolver<'_> {
    /// `within 1e-6m`, of the rows from `first` on.
    pub(super) fn width(&mut self, first: usize, within: &Expression) -> Result<(), Fault> {
        let mut rows = self.model.rows.iter().skip(first).map(|row| row.dimension);
        // A loop may leave a constraint without rows.
        let dimension = rows.next().unwrap_or(Dimension::NUMBER);
        let other = rows.find(|other| *other != dimension);
        let width = self.elaborate(Reach::Position, |work| {
            let value = work.value(within)?;
            if let Some(other) = other {
                let message = format!("one width for rows in different units, `{dimension}` and `{other}`");
                let help = "divide the constraint into one for each unit, each with its own width";
                work.diagnostics.report(value.span, message, help);
                return Err(Fault);
            }
            let scalar = work.scalar(&value, "a width", value.span)?;
            let value = initialiser(work, Value::scalar(scalar, scalar.span), dimension)?;
            value.items.first().copied().ok_or(Fault)
        })?;
        if self.varies(width.id) {
            self.diagnostics.report(
                width.span,
                "the width of a constraint varies in time",
                "make it of numbers, constants and parameters",
            );
            return Err(Fault);
        }
        if let Node::Number(number) = self.model.expressions.node(width.id)
            && !(number >= 0.0 && number.is_finite())
        {
            let message = format!("the width of a constraint is {number}");
            let help =
                "write how far its rows may contradict others: `constraint pin redundant within 1e-6m { … }`";
            self.diagnostics.report(width.span, message, help);
            return Err(Fault);
        }
        self.model.rows.iter_mut().skip(first).for_each(|row| row.within = Some(width.id));
        Ok(())
    }
}
