//! Working ranges, and the coordinates that are meant as independent.

use super::expression::{Id, Node};
use super::initialiser::initialiser;
use super::resolver::Resolver;
use super::unit_faults::Place;
use super::value::{Fault, Reach, Scalar, Value};
use super::{Independent, Limit, VariableKind};
use crate::syntax::ast::{Expression, Name};

impl Resolver<'_> {
    /// `low <= value <= high`
    pub(super) fn limit(
        &mut self,
        name: &Name,
        low: &Expression,
        value: &Expression,
        high: &Expression,
    ) -> Result<(), Fault> {
        let group = self.group(name, "limit")?;
        let (of_low, middle, of_high) = (low, value, high);
        let [low, value, high] = self.elaborate(Reach::Position, |work| {
            let value = work.value(value);
            let [low, high] = [low, high].map(|part| work.value(part));
            let (low, value, high) = (low?, value?, high?);
            work.beside_angle((&value, &middle.code), &of_low.code)?;
            work.beside_angle((&value, &middle.code), &of_high.code)?;
            let scalar = [&low, &value, &high].map(|part| work.scalar(part, "a limit", part.span));
            let [low, value, high] = scalar;
            let (low, value, high) = (low?, value?, high?);
            let mut bound = |bound: Scalar, written: &Expression| {
                let bound = Value::scalar(bound, bound.span);
                let bound = work.concerning(Place::Sides, (written, Some(middle)), |work| {
                    initialiser(work, bound, value.quantity.dimension())
                })?;
                bound.items.first().copied().ok_or(Fault)
            };
            Ok::<_, Fault>([bound(low, of_low)?, value, bound(high, of_high)?])
        })?;
        for bound in [low, high] {
            if self.varies(bound.id) {
                self.diagnostics.report(
                    bound.span,
                    format!("a bound of limit `{}` varies in time", name.text),
                    "make bounds of numbers, constants and parameters, and write what varies between them",
                );
                return Err(Fault);
            }
        }
        let numbers = [low.id, high.id].map(|id| self.model.expressions.node(id));
        if let [Node::Number(a), Node::Number(b)] = numbers
            && a >= b
        {
            let message = format!("limit `{}` leaves no range: {a} is not below {b}", name.text);
            self.diagnostics.report(low.span, message, "write `lower <= x <= upper`");
            return Err(Fault);
        }
        let round = self.rows_of(group);
        let dimension = value.quantity.dimension();
        let unit = self.unit_of(value.id, dimension);
        let name = match self.loops.is_empty() {
            true => name.text.clone(),
            false => format!("{}.{round}", name.text),
        };
        self.model.limits.push(Limit {
            name,
            unit,
            low: low.id,
            value: value.id,
            high: high.id,
            span: value.span,
        });
        self.count_row(group, round);
        Ok(())
    }

    /// `true` if a value depends on more than numbers, constants and parameters.
    pub(super) fn varies(&self, id: Id) -> bool {
        self.contains(id, |node| match node {
            Node::Number(_) | Node::Unary(..) | Node::Binary(..) => false,
            Node::Variable(index) => {
                self.model.variables.get(index).is_none_or(|v| v.kind != VariableKind::Parameter)
            }
            _ => true,
        })
    }

    /// Coordinates by name; an array includes all its components.
    pub(super) fn independent(&mut self, names: &[Name]) -> Result<(), Fault> {
        for name in names {
            let field = self.model.coordinate_fields.iter().find(|field| field.name.text == name.text);
            let Some(field) = field else {
                let message = format!("`{}` is no coordinate", name.text);
                self.diagnostics.report(name.span, message, "name coordinates, as `coord` declares them");
                continue;
            };
            let size: usize = field.shape.iter().product();
            for coordinate in field.first..field.first + size {
                if self.model.independent.iter().any(|known| known.coordinate == coordinate) {
                    let message = format!("`{}` is named as independent twice", name.text);
                    self.diagnostics.report(name.span, message, "remove one of them");
                    break;
                }
                self.model.independent.push(Independent { coordinate, span: name.span });
            }
        }
        Ok(())
    }
}
