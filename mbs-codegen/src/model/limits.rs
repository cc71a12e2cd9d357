//! Working ranges, and the coordinates that are meant as independent.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::initialiser::initialiser;
use super::resolver::Resolver;
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::{Fault, Reach, Scalar, Value};
use super::{Independent, Limit, VariableKind};
use crate::syntax::ast::{Expression, Name, Operation, Statement, StatementKind, Type};

/// Magnitude of the bound on the side that a limit leaves open.
///
/// It exceeds any quantity and is finite in single precision, so that intervals of distances to it are finite. The runtime
/// knows a bound of this magnitude as none.
const OPEN: f64 = 1e30;

/// Outputs outside of loops: type and definition. Of two definitions the first counts; the second is a fault.
pub(super) fn outputs(statements: &[Statement]) -> BTreeMap<&str, (&Type, &Expression)> {
    let mut outputs = BTreeMap::new();
    let mut depth = 0_usize;
    for statement in statements {
        match &statement.kind {
            StatementKind::For(_) => depth += 1,
            StatementKind::EndFor => depth = depth.saturating_sub(1),
            StatementKind::Out { name, kind, value } if depth == 0 => {
                outputs.entry(name.text.as_str()).or_insert((kind, value));
            }
            _ => {}
        }
    }
    outputs
}

/// A part of a limit with its value.
#[derive(Clone, Copy)]
struct Part<'e> {
    written: &'e Expression,
    scalar: Scalar,
}

impl Resolver<'_> {
    /// `low <= value <= high`, `low <= value` or `value <= high`.
    pub(super) fn limit(
        &mut self,
        name: &Name,
        [first, second]: [&Expression; 2],
        third: Option<&Expression>,
    ) -> Result<(), Fault> {
        let group = self.group(name, "limit")?;
        let written = [second, first].into_iter().chain(third);
        let expanded = written.map(|part| self.with_output(name, part)).collect::<Result<Vec<_>, _>>()?;
        let parts = self.elaborate(Reach::Position, |work| {
            let values: Vec<_> =
                expanded.iter().map(|(part, kind)| part_of(work, part, kind.as_ref())).collect();
            values.into_iter().collect::<Result<Vec<Part<'_>>, Fault>>()
        })?;
        let (low, value, high) = match parts.as_slice() {
            [value, low, high] => (Some(*low), *value, Some(*high)),
            [second, first] => self.one_bound(name, *first, *second)?,
            _ => return Err(Fault),
        };
        let [low, high] = self.elaborate(Reach::Position, |work| {
            for bound in [low, high].into_iter().flatten() {
                let of_value = Value::scalar(value.scalar, value.scalar.span);
                work.beside_angle((&of_value, &value.written.code), &bound.written.code)?;
            }
            let mut in_unit = |bound: Option<Part<'_>>| bound.map(|bound| bound_of(work, bound, value));
            Ok::<_, Fault>([in_unit(low).transpose()?, in_unit(high).transpose()?])
        })?;
        for bound in [low, high].into_iter().flatten() {
            if self.varies(bound.id) {
                return Err(self.varying_bound(name, bound));
            }
        }
        let number = |bound: Option<Scalar>| bound.map(|bound| self.model.expressions.node(bound.id));
        if let (Some(lower), Some(Node::Number(a)), Some(Node::Number(b))) = (low, number(low), number(high))
            && a >= b
        {
            let message = format!("limit `{}` leaves no range: {a} is not below {b}", name.text);
            self.diagnostics.report(lower.span, message, "write `lower <= x <= upper`");
            return Err(Fault);
        }
        let [low, high] = [(low, -OPEN), (high, OPEN)].map(|(bound, open)| match bound {
            Some(bound) => bound.id,
            None => self.model.expressions.push(Node::Number(open)),
        });
        let round = self.rows_of(group);
        let value = value.scalar;
        let unit = self.unit_of(value.id, value.quantity.dimension());
        let name = match self.loops.is_empty() {
            true => name.text.clone(),
            false => format!("{}.{round}", name.text),
        };
        self.model.limits.push(Limit { name, unit, low, value: value.id, high, span: value.span });
        self.count_row(group, round);
        Ok(())
    }

    /// Before: both sides of `first <= second`. After: the side that varies is bounded by the other one.
    fn one_bound<'e>(
        &mut self,
        name: &Name,
        first: Part<'e>,
        second: Part<'e>,
    ) -> Result<(Option<Part<'e>>, Part<'e>, Option<Part<'e>>), Fault> {
        let is_number =
            |part: Part<'_>| matches!(self.model.expressions.node(part.scalar.id), Node::Number(_));
        match [first, second].map(|part| self.varies(part.scalar.id)) {
            [true, true] => Err(self.varying_bound(name, second.scalar)),
            [false, false] if is_number(first) && is_number(second) => {
                let message = format!("limit `{}` bounds a number by a number", name.text);
                let help = "write what varies on one side: `x <= 5mm` or `2mm <= x`";
                self.diagnostics.report(second.scalar.span, message, help);
                Err(Fault)
            }
            [false, true] => Ok((Some(first), second, None)),
            [false, false] if is_number(first) => Ok((Some(first), second, None)),
            [true, false] | [false, false] => Ok((None, first, Some(second))),
        }
    }

    fn varying_bound(&mut self, name: &Name, bound: Scalar) -> Fault {
        self.diagnostics.report(
            bound.span,
            format!("a bound of limit `{}` varies in time", name.text),
            "make bounds of numbers, constants and parameters, and write what varies between them",
        );
        Fault
    }

    /// The definition in place of the name of an output that is no name of a value, with the output's type.
    fn with_output<'e>(
        &mut self,
        limit: &Name,
        written: &'e Expression,
    ) -> Result<(Cow<'e, Expression>, Option<Type>), Fault> {
        let own = Ok((Cow::Borrowed(written), None));
        let Some((first, rest)) = written.code.split_first() else { return own };
        let Operation::Name(name) = &first.operation else { return own };
        let (None, Some((kind, definition))) = (self.names.get(name), self.outputs.get(name.as_str())) else {
            return own;
        };
        if !rest
            .iter()
            .all(|part| matches!(part.operation, Operation::Number { .. } | Operation::Index { .. }))
        {
            return own;
        }
        let takes_more = definition.code.iter().any(|instruction| match &instruction.operation {
            Operation::Reference { .. } => true,
            Operation::Call { function, .. } => {
                matches!(function.as_str(), "der" | "der2" | "angular_velocity" | "margin" | "ratio")
            }
            Operation::Name(name) => self.names.needs(name) > Reach::Position,
            _ => false,
        });
        if takes_more {
            let message = format!(
                "limit `{}` bounds output `{name}`, which is no function of the position",
                limit.text
            );
            let help = "a limit bounds coordinates, parameters, inputs and the time; read this output with `outputs`";
            self.diagnostics.report(first.span, message, help);
            return Err(Fault);
        }
        let mut code = definition.code.clone();
        code.iter_mut().for_each(|instruction| instruction.span = first.span);
        code.extend(rest.iter().cloned());
        Ok((Cow::Owned(Expression { code }), Some((*kind).clone())))
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

/// The value of a part; that of an output in its declared unit.
fn part_of<'e>(
    work: &mut Elaborator<'_>,
    written: &'e Expression,
    kind: Option<&Type>,
) -> Result<Part<'e>, Fault> {
    let value = work.value(written)?;
    let value = match kind {
        Some(kind) => {
            let dimension = Dimension::of(&kind.unit, work.diagnostics).ok_or(Fault)?;
            initialiser(work, value, dimension)?
        }
        None => value,
    };
    let scalar = work.scalar(&value, "a limit", value.span)?;
    Ok(Part { written, scalar })
}

/// A bound in the unit of the value.
fn bound_of(work: &mut Elaborator<'_>, bound: Part<'_>, value: Part<'_>) -> Result<Scalar, Fault> {
    let scalar = Value::scalar(bound.scalar, bound.scalar.span);
    let bound = work.concerning(Place::Sides, (bound.written, Some(value.written)), |work| {
        initialiser(work, scalar, value.scalar.quantity.dimension())
    })?;
    bound.items.first().copied().ok_or(Fault)
}
