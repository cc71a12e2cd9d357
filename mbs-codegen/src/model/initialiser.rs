//! Values after the `=` of a declaration: their unit, their shape, and the check that they are numbers.

use super::elaborator::Elaborator;
use super::expression::Node;
use super::names::Symbol;
use super::unit_faults::{Place, UnitOf};
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::syntax::ast::{Expression, Operation, Unit};

/// The value of a `let`, in its unit where one is declared, and the quantities that must be allowed where it is used.
pub fn definition(
    work: &mut Elaborator<'_>,
    name: &str,
    unit: Option<&Unit>,
    expression: &Expression,
) -> Result<(Value, Reach), Fault> {
    work.reach = Reach::Let;
    named(work, name, unit, expression).map(|value| (value, work.needs))
}

fn named(
    work: &mut Elaborator<'_>,
    name: &str,
    unit: Option<&Unit>,
    expression: &Expression,
) -> Result<Value, Fault> {
    let value = work.value(expression)?;
    match unit {
        None => Ok(value),
        Some(unit) => {
            let dimension = Dimension::of(unit, work.diagnostics).ok_or(Fault)?;
            let place = Place::Value(name.to_owned());
            let value =
                work.concerning(place, (expression, None), |work| initialiser(work, value, dimension))?;
            Ok(in_unit(value, unit))
        }
    }
}

/// A value that is known to be in a declared unit, which may be that of an angle.
pub fn in_unit(value: Value, unit: &Unit) -> Value {
    let items = value.items.iter().map(|item| Scalar { bare: Bare::of(unit), ..*item }).collect();
    Value { items, ..value }
}

/// Before: the value after a `=`. After: the same in the declared unit: bare numbers and their multiples without a unit take it
/// on, others must have it.
pub fn initialiser(work: &mut Elaborator<'_>, value: Value, declared: Dimension) -> Result<Value, Fault> {
    let mut items = Vec::new();
    for item in &value.items {
        let takes_it = match item.bare {
            Bare::Wholly | Bare::Zero => true,
            Bare::Partly => item.quantity.dimension() == Dimension::NUMBER,
            Bare::Not | Bare::Angle => item.quantity == Quantity::Any,
        };
        if !takes_it {
            has_unit(work, *item, declared)?;
        }
        if !work.expressions.measures(item.id) {
            work.expressions.name_length(item.id, declared, |length| format!("{length} m"), item.span);
        }
        items.push(Scalar { quantity: Quantity::Known(declared), bare: Bare::Not, ..*item });
    }
    Ok(Value { items, ..value })
}

/// The declared unit, at a value that has one of its own.
fn has_unit(work: &mut Elaborator<'_>, item: Scalar, declared: Dimension) -> Result<(), Fault> {
    if item.quantity == Quantity::Known(Dimension::NUMBER) && declared != Dimension::NUMBER {
        let message = format!("units differ: `1` here, `{declared}` on the other side");
        let help =
            format!("multiply it by a quantity of this unit, or write its number so: `1 [{declared}]*…`");
        let wanted = UnitOf { dimension: declared, is_angle: false };
        return Err(work.unit_fault((Place::Terms, item, wanted), message, help));
    }
    let expected = Scalar { quantity: Quantity::Known(declared), bare: Bare::Not, ..item };
    work.agree(expected, item).map(|_| ())
}

/// Value of the declared shape; a scalar fills every component.
pub fn filling(work: &mut Elaborator<'_>, value: Value, shape: &[usize]) -> Result<Value, Fault> {
    if let ([item], []) = (value.items.as_slice(), value.shape.as_slice()) {
        let items = vec![*item; shape.iter().product()];
        return Ok(Value { shape: shape.to_vec(), items, span: value.span });
    }
    fits_shape(work, &value, shape)?;
    Ok(value)
}

/// The shape that was declared.
pub fn fits_shape(work: &mut Elaborator<'_>, value: &Value, shape: &[usize]) -> Result<(), Fault> {
    if value.shape == shape {
        return Ok(());
    }
    let declared = Value { shape: shape.to_vec(), items: Vec::new(), span: value.span }.describe();
    let message = format!("{} is declared, {} is given", declared, value.describe());
    let help = match shape {
        [_, _] => format!("give the components row by row: `{}`", zeros(shape)),
        [_, _, _, ..] => "give the components nested as the lengths are, the outermost first".into(),
        _ => "declare the shape as `[m; 2]`, give the components as `[x, y]`".into(),
    };
    Err(work.fault(value.span, message, help))
}

/// An array of this shape as one writes it, the first rows of each dimension.
fn zeros(shape: &[usize]) -> String {
    const SHOWN: usize = 3;
    shape.iter().rev().fold("0".into(), |inner, length| {
        let shown = vec![inner.as_str(); (*length).min(SHOWN)].join(", ");
        let more = if *length > SHOWN { ", …" } else { "" };
        format!("[{shown}{more}]")
    })
}

/// The components, all numbers; otherwise the first name that is none is reported.
pub fn numbers(
    work: &mut Elaborator<'_>,
    expression: &Expression,
    value: &Value,
    what: &str,
) -> Result<Vec<f64>, Fault> {
    let number = |item: &Scalar| match work.expressions.node(item.id) {
        Node::Number(number) => Some(number),
        _ => None,
    };
    if let Some(found) = value.items.iter().map(number).collect() {
        return Ok(found);
    }
    let is_variable = |name: &str| match work.names.get(name) {
        Some(Symbol::Value(value)) => value.items.iter().any(|item| number(item).is_none()),
        Some(Symbol::Function(_)) => true,
        _ => name == "t",
    };
    let variable = expression.code.iter().find_map(|instruction| match &instruction.operation {
        Operation::Name(name) | Operation::Call { function: name, .. } if is_variable(name) => {
            Some((name, instruction.span))
        }
        _ => None,
    });
    let help = "use numbers and constants alone; what depends on parameters is a `let`";
    Err(match variable {
        Some((name, span)) => work.fault(span, format!("`{name}` cannot stand in {what}"), help),
        None => work.fault(value.span, format!("{what} must be a number"), help),
    })
}
