//! Lengths of links: parameters that a row multiplies by the sine or cosine of a coordinate.

use super::expression::{Id, Node};
use super::units::Dimension;
use super::{Model, VariableKind};
use crate::symbolic::{Binary, Unary};

/// Ratio of a length to the longest one below which the rows lose it in rounding.
const LOST: f64 = 1e-12;

/// Before: a model, and values of its parameters by name; the others have their defaults. After: links that cannot be so long, each
/// in a phrase with the reason. A parameter whose default is negative or 0 is an offset, which may have any sign.
pub fn impossible(model: &Model, given: impl Fn(&str) -> Option<f64>) -> Vec<String> {
    let links: Vec<(&str, f64)> = links(model)
        .into_iter()
        .filter_map(|index| {
            let variable = model.variables.get(index)?;
            Some((variable.name.as_str(), given(&variable.name).unwrap_or(variable.default)))
        })
        .collect();
    let longest = links.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    let phrase = |(name, value): &(&str, f64)| {
        if *value < 0.0 {
            Some(format!(
                "`{name}` is {value} m: a link has no negative length; its direction is that of its angle"
            ))
        } else if *value != 0.0 && *value < LOST * longest {
            Some(format!("`{name}` is {value:e} m: beside {longest} m it is lost in rounding"))
        } else {
            None
        }
    };
    links.iter().filter_map(phrase).collect()
}

/// Indices of the parameters, ascending.
fn links(model: &Model) -> Vec<usize> {
    let expressions = &model.expressions;
    let reached = expressions.reachable(model.rows.iter().map(|row| row.residual));
    let moves = expressions.made_of(|node| matches!(node, Node::Coordinate(_)));
    let length = |id: Id| match expressions.node(id) {
        Node::Variable(index) => model.variables.get(index).and_then(|variable| {
            let is_length = variable.kind == VariableKind::Parameter
                && variable.dimension == Dimension::METRE
                && variable.default > 0.0;
            is_length.then_some(index)
        }),
        _ => None,
    };
    let is_direction = |id: Id| matches!(expressions.node(id), Node::Unary(Unary::Sin | Unary::Cos, angle) if moves.get(angle.index()) == Some(&true));
    let mut found: Vec<usize> = expressions
        .iter()
        .filter(|(id, _)| reached.get(id.index()) == Some(&true))
        .filter_map(|(_, node)| match node {
            Node::Binary(Binary::Multiply, a, b) if is_direction(b) => length(a),
            Node::Binary(Binary::Multiply, a, b) if is_direction(a) => length(b),
            _ => None,
        })
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}
