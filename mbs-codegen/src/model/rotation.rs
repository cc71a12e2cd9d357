//! Orientations in space by Euler parameters e = (e₀, ε): a turn by φ about the unit vector n is e₀ = cos φ/2, ε = n sin φ/2.
//!
//! Source: Nikravesh 1988, ch. 6; Shabana 2013, §2.6.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::value::{Fault, Scalar, Value};
use crate::symbolic::{Binary, Unary};

/// Four parameters of an orientation.
pub type Parameters = [Scalar; 4];

/// `rotate(e, v)`: the vector v of the body in the axes of the ground, A(e) v with e·e = 1.
///
/// A component of v that is the number 0 takes no part.
pub fn rotate(work: &mut Elaborator<'_>, arguments: Vec<Value>, span: Span) -> Result<Value, Fault> {
    let [e, v] = work.arguments("rotate", arguments, span)?;
    let parameters = parameters(work, &e, "`rotate`")?;
    let ([3], &[x, y, z]) = (v.shape.as_slice(), v.items.as_slice()) else {
        return Err(work.wrong_shape("`rotate`", "parameters and a vector of 3 components", &v, v.span));
    };
    let columns = [(0, x), (1, y), (2, z)].into_iter();
    let columns: Vec<_> =
        columns.filter(|(_, item)| work.expressions.node(item.id) != Node::Number(0.0)).collect();
    let mut terms = Vec::new();
    for (column, item) in columns {
        terms.push((direction(work, parameters, column, span)?, item));
    }
    let mut items = Vec::new();
    for row in 0..3 {
        let pairs = terms.iter().filter_map(|(direction, item)| Some((*direction.get(row)?, *item)));
        items.push(match terms.is_empty() {
            true => work.number_literal(0.0, span),
            false => work.sum_of_products(pairs, span)?,
        });
    }
    Ok(Value { shape: vec![3], items, span })
}

/// The body's axis `column` in the axes of the ground: a column of A = (2 e₀² − 1) 1 + 2 (ε εᵀ + e₀ ε̃), with e·e = 1 so that
/// the diagonal is 1 − 2 (ε_j² + ε_k²).
fn direction(
    work: &mut Elaborator<'_>,
    [e0, ex, ey, ez]: Parameters,
    column: usize,
    span: Span,
) -> Result<[Scalar; 3], Fault> {
    // The axis itself and the two that follow it in cyclic order.
    let [i, j, k] = match column {
        0 => [ex, ey, ez],
        1 => [ey, ez, ex],
        _ => [ez, ex, ey],
    };
    let one = work.number_literal(1.0, span);
    let squares = work.sum_of_products([(j, j), (k, k)].into_iter(), span)?;
    let squares = twice(work, squares, span)?;
    let along = Scalar { bare: squares.bare, ..join(work, Binary::Subtract, one, squares, span)? };
    let (ij, k0) = (work.multiply(i, j, span)?, work.multiply(k, e0, span)?);
    let (ik, j0) = (work.multiply(i, k, span)?, work.multiply(j, e0, span)?);
    let second = join(work, Binary::Add, ij, k0, span)?;
    let third = join(work, Binary::Subtract, ik, j0, span)?;
    let (second, third) = (twice(work, second, span)?, twice(work, third, span)?);
    Ok(match column {
        0 => [along, second, third],
        1 => [third, along, second],
        _ => [second, third, along],
    })
}

/// `angular_velocity(e)`: ω = 2 (e₀ ε̇ − ė₀ ε + ε × ε̇), in the axes of the ground.
pub fn angular_velocity(
    work: &mut Elaborator<'_>,
    arguments: Vec<Value>,
    span: Span,
) -> Result<Value, Fault> {
    let [e] = work.arguments("angular_velocity", arguments, span)?;
    let [e0, x, y, z] = parameters(work, &e, "`angular_velocity`")?;
    let rates = work.rate(vec![e], "angular_velocity", 1, span)?;
    let &[d0, dx, dy, dz] = rates.items.as_slice() else { return Err(Fault) };
    let minus = work.unary_scalar(Unary::Negate, d0, d0.quantity, span)?;
    let axes = [([y, z], [dy, dz], x, dx), ([z, x], [dz, dx], y, dy), ([x, y], [dx, dy], z, dz)];
    let mut items = Vec::new();
    for (across, across_rates, along, along_rate) in axes {
        let product = work.determinant2(across, across_rates, span)?;
        let plain = work.sum_of_products([(e0, along_rate), (along, minus)].into_iter(), span)?;
        let sum = join(work, Binary::Add, plain, product, span)?;
        items.push(twice(work, sum, span)?);
    }
    Ok(Value { shape: vec![3], items, span })
}

/// Generalized forces of a moment (N m, in the axes of the ground) on each parameter: 2 (−ε·τ, e₀ τ + τ × ε).
pub fn moments(
    work: &mut Elaborator<'_>,
    moment: &Value,
    [e0, x, y, z]: Parameters,
    span: Span,
) -> Result<[Scalar; 4], Fault> {
    let &[mx, my, mz] = moment.items.as_slice() else { return Err(Fault) };
    let scalar = work.sum_of_products([(x, mx), (y, my), (z, mz)].into_iter(), span)?;
    let scalar = work.unary_scalar(Unary::Negate, scalar, scalar.quantity, span)?;
    let mut along = |m: Scalar, across: [Scalar; 2], parameters: [Scalar; 2]| {
        let product = work.determinant2(across, parameters, span)?;
        let plain = work.multiply(e0, m, span)?;
        join(work, Binary::Add, plain, product, span)
    };
    let all =
        [scalar, along(mx, [my, mz], [y, z])?, along(my, [mz, mx], [z, x])?, along(mz, [mx, my], [x, y])?];
    let [first, second, third, fourth] = all.map(|item| twice(work, item, span));
    Ok([first?, second?, third?, fourth?])
}

/// The four parameters of an orientation.
pub fn parameters(work: &mut Elaborator<'_>, e: &Value, user: &str) -> Result<Parameters, Fault> {
    let ([4], &[e0, x, y, z]) = (e.shape.as_slice(), e.items.as_slice()) else {
        return Err(work.wrong_shape(user, "an orientation of 4 Euler parameters", e, e.span));
    };
    for item in [e0, x, y, z] {
        work.number(item, "an Euler parameter", e.span)?;
    }
    Ok([e0, x, y, z])
}

pub(super) fn join(
    work: &mut Elaborator<'_>,
    function: Binary,
    a: Scalar,
    b: Scalar,
    span: Span,
) -> Result<Scalar, Fault> {
    let quantity = work.agree(a, b)?;
    work.binary_scalar(function, a, b, quantity, span)
}

fn twice(work: &mut Elaborator<'_>, a: Scalar, span: Span) -> Result<Scalar, Fault> {
    let two = work.number_literal(2.0, span);
    let twice = work.multiply(two, a, span)?;
    // A number of the formula is none of the text.
    Ok(Scalar { bare: a.bare, ..twice })
}
