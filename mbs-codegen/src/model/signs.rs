//! What cannot be negative: masses, moments of inertia, stiffness.

use proc_macro2::Span;

use super::expression::{Expressions, Id, Node};
use super::{Model, VariableKind, evaluate};
use crate::diagnostics::Diagnostics;

/// Fields whose values are at least 0.
pub const FIELDS: [&str; 3] = ["mass", "inertia", "stiffness"];

/// A value that is at least 0.
#[derive(Clone, Debug)]
pub struct Signed {
    /// The field.
    pub field: &'static str,
    /// The body or force.
    pub of: String,
    /// Its value.
    pub value: Id,
    /// Where the text says so.
    pub span: Span,
}

/// Before: a model. After: values that are negative with the parameters' defaults are reported.
pub fn check(model: &Model, diagnostics: &mut Diagnostics) {
    for (signed, value) in negative(model, |_| None) {
        let message = format!("`{}` of `{}` is negative: {value}", signed.field, signed.of);
        let help = match signed.field {
            "stiffness" => {
                "a force that pushes away from its rest is an energy of its own: `potential V = …;`"
            }
            _ => "masses and moments of inertia are at least 0",
        };
        diagnostics.report(signed.span, message, help);
    }
}

/// The values that are negative with the variables that `given` knows by name, the other parameters at their defaults.
/// What depends on inputs, states or the place of the mechanism is left to its caller.
pub fn negative(model: &Model, given: impl Fn(&str) -> Option<f64>) -> Vec<(&Signed, f64)> {
    let Some(dynamics) = model.dynamics.as_ref().filter(|dynamics| !dynamics.signed.is_empty()) else {
        return Vec::new();
    };
    let variable = |index: usize| {
        let variable = model.variables.get(index)?;
        let standard = (variable.kind == VariableKind::Parameter).then_some(variable.default);
        given(&variable.name).or(standard)
    };
    let values = values(&model.expressions, variable);
    let value = |id: Id| values.get(id.index()).copied().flatten();
    let found = dynamics.signed.iter().filter_map(|signed| Some((signed, value(signed.value)?)));
    found.filter(|(_, value)| *value < 0.0).collect()
}

/// The value of each expression that is made of numbers and known variables alone.
fn values(expressions: &Expressions, variable: impl Fn(usize) -> Option<f64>) -> Vec<Option<f64>> {
    let mut values: Vec<Option<f64>> = Vec::with_capacity(expressions.len());
    for (_, node) in expressions.iter() {
        let of = |id: Id| values.get(id.index()).copied().flatten();
        let value = match node {
            Node::Number(number) => Some(number),
            Node::Variable(index) => variable(index),
            Node::Unary(function, a) => of(a).map(|a| evaluate::unary(function, a)),
            Node::Binary(function, a, b) => of(a).zip(of(b)).map(|(a, b)| evaluate::binary(function, a, b)),
            _ => None,
        };
        values.push(value);
    }
    values
}
