//! The functions of the language and those that the caller supplies: shapes, units, scalar definitions.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::names::{Callable, is_of_two};
use super::rotation;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Scalar, Value};
use crate::symbolic::operations::Units;
use crate::symbolic::{Binary, Unary};

/// Before: arguments in the order of the stack. After: the value of `function`, or the fault reported.
pub fn call(
    work: &mut Elaborator<'_>,
    function: &str,
    arguments: Vec<Value>,
    span: Span,
) -> Result<Value, Fault> {
    match function {
        "atan2" => return atan2(work, arguments, span),
        "min" => return fold(work, "min", Binary::Min, arguments, span),
        "max" => return fold(work, "max", Binary::Max, arguments, span),
        "hypot" => return fold(work, "hypot", Binary::Hypot, arguments, span),
        "dot" => return dot(work, arguments, span),
        "cross" => return cross(work, arguments, span),
        "norm" => return norm(work, arguments, span),
        "det" => return det(work, arguments, span),
        "unit" => return unit(work, arguments, span),
        "rot" => return rot(work, arguments, span),
        "rotate" => return rotation::rotate(work, arguments, span),
        "angular_velocity" => return rotation::angular_velocity(work, arguments, span),
        "der" => return work.rate(arguments, "der", 1, span),
        "der2" => return work.rate(arguments, "der2", 2, span),
        _ if is_of_two(function, 2) && work.names.get(function).is_none() => {
            return Err(work.arity(function, "2 arguments", arguments.len(), span));
        }
        "rate" => {
            let [_] = work.arguments("rate", arguments, span)?;
            return Err(work.fault(
                span,
                "`rate` is not all of the left side of a drive",
                "write `drive crank: rate(phi) == omega;`; outputs take rates as `der(x)`",
            ));
        }
        _ => {}
    }
    let found = Unary::called().find(|unary| unary.entry().name == function);
    let Some(unary) = found else { return Err(work.unknown_function(function, span)) };
    let [argument] = work.arguments(function, arguments, span)?;
    let scalar = work.scalar(&argument, &format!("`{function}`"), argument.span)?;
    let quantity = match unary.entry().units {
        Units::Number | Units::Angle => {
            work.argument_of(function, scalar, argument.span)?;
            Quantity::Known(Dimension::NUMBER)
        }
        Units::Any => Quantity::Known(Dimension::NUMBER),
        Units::Same => scalar.quantity,
        Units::Root => work.root(scalar.quantity, 0.5, span)?,
    };
    work.unary(unary, scalar, quantity, span)
}

fn atan2(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [y, x] = work.arguments("atan2", arguments, span)?;
    let (a, b) = (work.scalar(&y, "`atan2`", y.span)?, work.scalar(&x, "`atan2`", x.span)?);
    work.agree(a, b)?;
    work.binary(Binary::Atan2, a, b, Quantity::Known(Dimension::NUMBER), span)
}

/// `min`, `max` and `hypot` of two or more arguments.
fn fold(
    work: &mut Elaborator<'_>,
    name: &str,
    function: Binary,
    arguments: Vec<Value>,
    span: Span,
) -> Result<Value, Fault> {
    if arguments.len() < 2 {
        return Err(work.arity(name, "two or more arguments", arguments.len(), span));
    }
    let mut result: Option<Scalar> = None;
    for argument in &arguments {
        let scalar = work.scalar(argument, &format!("`{name}`"), argument.span)?;
        result = Some(match result {
            None => scalar,
            Some(so_far) => {
                let quantity = work.agree(so_far, scalar)?;
                work.binary_scalar(function, so_far, scalar, quantity, span)?
            }
        });
    }
    Ok(Value::scalar(result.ok_or(Fault)?, span))
}

fn dot(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [a, b] = work.arguments("dot", arguments, span)?;
    work.vector(&a, "`dot`", a.span)?;
    work.same_shape(&a, &b, "`dot`", b.span)?;
    let result = work.sum_of_products(a.items.iter().copied().zip(b.items.iter().copied()), b.span)?;
    Ok(Value::scalar(result, span))
}

fn cross(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [a, b] = work.arguments("cross", arguments, span)?;
    work.same_shape(&a, &b, "`cross`", b.span)?;
    match (a.items.as_slice(), b.items.as_slice()) {
        ([ax, ay], [bx, by]) if a.shape.len() == 1 => {
            Ok(Value::scalar(work.determinant2([*ax, *ay], [*bx, *by], span)?, span))
        }
        ([ax, ay, az], [bx, by, bz]) if a.shape.len() == 1 => {
            let x = work.determinant2([*ay, *az], [*by, *bz], span)?;
            let y = work.determinant2([*az, *ax], [*bz, *bx], span)?;
            let z = work.determinant2([*ax, *ay], [*bx, *by], span)?;
            Ok(Value { shape: vec![3], items: vec![x, y, z], span })
        }
        _ => Err(work.wrong_shape("`cross`", "two vectors of 2 or of 3 components", &a, a.span)),
    }
}

fn norm(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [a] = work.arguments("norm", arguments, span)?;
    work.vector(&a, "`norm`", a.span)?;
    let components = a.items.iter().map(|item| Value::scalar(*item, a.span)).collect::<Vec<_>>();
    match components.len() {
        1 => call(work, "abs", components, span),
        _ => fold(work, "norm", Binary::Hypot, components, span),
    }
}

/// Determinant of a matrix, or of its rows as 2 or 3 vectors.
fn det(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let matrix = match arguments.len() {
        1 => arguments.into_iter().next().ok_or(Fault)?,
        2 | 3 => work.array(arguments, span)?,
        count => return Err(work.arity("det", "one matrix, or two or three vectors", count, span)),
    };
    let result = match (matrix.shape.as_slice(), matrix.items.as_slice()) {
        ([2, 2], [a, b, c, d]) => work.determinant2([*a, *b], [*c, *d], span)?,
        ([3, 3], [a, b, c, d, e, f, g, h, i]) => {
            let x = work.determinant2([*e, *f], [*h, *i], span)?;
            let y = work.determinant2([*f, *d], [*i, *g], span)?;
            let z = work.determinant2([*d, *e], [*g, *h], span)?;
            work.sum_of_products([(*a, x), (*b, y), (*c, z)].into_iter(), span)?
        }
        _ => return Err(work.wrong_shape("`det`", "a 2 × 2 or 3 × 3 matrix", &matrix, matrix.span)),
    };
    Ok(Value::scalar(result, span))
}

fn sine_cosine(
    work: &mut Elaborator<'_>,
    name: &str,
    arguments: Vec<Value>,
    span: Span,
) -> Result<[Scalar; 2], Fault> {
    let [angle] = work.arguments(name, arguments, span)?;
    let scalar = work.scalar(&angle, &format!("`{name}`"), angle.span)?;
    work.argument_of(name, scalar, angle.span)?;
    let quantity = Quantity::Known(Dimension::NUMBER);
    Ok([
        work.unary_scalar(Unary::Sin, scalar, quantity, span)?,
        work.unary_scalar(Unary::Cos, scalar, quantity, span)?,
    ])
}

fn unit(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [sine, cosine] = sine_cosine(work, "unit", arguments, span)?;
    Ok(Value { shape: vec![2], items: vec![cosine, sine], span })
}

fn rot(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [sine, cosine] = sine_cosine(work, "rot", arguments, span)?;
    let minus = work.unary_scalar(Unary::Negate, sine, sine.quantity, span)?;
    Ok(Value { shape: vec![2, 2], items: vec![cosine, minus, sine, cosine], span })
}

/// Before: arguments in the order of the stack. After: the value of a declared function, or of its derivative of this
/// order, or the fault reported.
pub fn call_declared(
    work: &mut Elaborator<'_>,
    function: Callable,
    (name, order): (&str, u8),
    arguments: Vec<Value>,
    span: Span,
) -> Result<Value, Fault> {
    if let Some(length) = function.length {
        return Err(bare_array(work, (name, order), length, span));
    }
    let written = if order == 0 { name.to_owned() } else { format!("{name}.d{order}") };
    let [argument] = work.arguments(&written, arguments, span)?;
    let scalar = work.scalar(&argument, &format!("`{written}`"), argument.span)?;
    fits(work, &written, function.argument, scalar)?;
    let mut unit = function.unit;
    for _ in 0..order {
        unit = unit.over(function.argument);
    }
    let id = work.expressions.push_call(function.index, order, scalar.id, span);
    Ok(Value::scalar(Scalar { id, quantity: Quantity::Known(unit), bare: function.bare, span }, span))
}

/// The function of this number in an array, and its name.
pub fn element(
    work: &mut Elaborator<'_>,
    array: Callable,
    name: &str,
    number: &Value,
    span: Span,
) -> Result<(Callable, String), Fault> {
    let Some(length) = array.length else {
        return Err(work.fault(
            span,
            format!("`{name}` is one function, no array of functions"),
            format!("write `{name}(…)`, or declare an array: `function {name}: [m; 2](rad), C3;`"),
        ));
    };
    let index = work.count(number)?;
    if index >= length {
        return Err(work.fault(
            number.span,
            format!("`{name}[{index}]` is beyond the last of {length} functions"),
            format!("functions are counted from 0; the last is `{name}[{}]`", length.saturating_sub(1)),
        ));
    }
    let function = Callable { index: array.index + index, length: None, ..array };
    Ok((function, format!("{name}[{index}]")))
}

/// A fault at an array of functions of which none is chosen.
pub fn bare_array(work: &mut Elaborator<'_>, (name, order): (&str, u8), length: usize, span: Span) -> Fault {
    let functions = if length == 1 { "1 function" } else { &format!("{length} functions") };
    let message = format!("`{name}` is an array of {functions}");
    let derivative = if order == 0 { String::new() } else { format!(".d{order}") };
    work.fault(span, message, format!("write the number of one, from 0: `{name}[0]{derivative}(…)`"))
}

/// The argument has the declared unit.
fn fits(
    work: &mut Elaborator<'_>,
    written: &str,
    declared: Dimension,
    argument: Scalar,
) -> Result<(), Fault> {
    match argument.quantity {
        Quantity::Known(unit) if unit != declared => {
            let help = if argument.bare == Bare::Wholly {
                "a bare number has no unit; write it with one: `100mm`, `30deg`"
            } else {
                "bring the argument to the unit that the declaration gives in parentheses"
            };
            let message =
                format!("the argument of `{written}` has the unit `{unit}`; declared is `{declared}`");
            Err(work.fault(argument.span, message, help))
        }
        _ => Ok(()),
    }
}
