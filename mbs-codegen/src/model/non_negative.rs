//! Values that cannot be negative: masses, moments of inertia, stiffness, damping, friction; values that must be above 0.

use proc_macro2::Span;

use super::expression::{Expressions, Id, Node};
use super::{Model, VariableKind, inertia};
use crate::diagnostics::{Diagnostic, Diagnostics};

/// The least value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Least {
    /// It is at least 0.
    Zero,
    /// It is divided by: above 0.
    AboveZero,
}

impl Least {
    /// Least value of a field, if it has one.
    pub fn of(field: &str) -> Option<Self> {
        match field {
            "mass" | "inertia" | "stiffness" | "damping" | "coefficient" | "viscous" | "sticks" => {
                Some(Least::Zero)
            }
            "speed" | "depth" | "exponent" | "bound" | "restitution" | "approach" | "bristles" => {
                Some(Least::AboveZero)
            }
            _ => None,
        }
    }

    fn admits(self, value: f64) -> bool {
        match self {
            Least::Zero => value >= 0.0,
            Least::AboveZero => value > 0.0,
        }
    }
}

/// A value that has a least one.
#[derive(Clone, Debug)]
pub struct NonNegative {
    /// The field.
    pub field: &'static str,
    /// Its least value.
    pub least: Least,
    /// The body or force.
    pub of: String,
    /// Its value.
    pub value: Id,
    /// Place in the text.
    pub span: Span,
}

/// Before: a model. After: values that are impossible with the parameters' defaults are reported.
pub fn check(model: &Model, diagnostics: &mut Diagnostics) {
    for Diagnostic { message, help, span } in impossible(model, |_| None) {
        diagnostics.report(span, message, help);
    }
}

/// The impossible values. `given` knows variables by name; the other parameters have their defaults. Values that depend on
/// inputs, states or the position of the mechanism are left to the caller.
pub fn impossible(model: &Model, given: impl Fn(&str) -> Option<f64>) -> Vec<Diagnostic> {
    let Some(dynamics) = &model.dynamics else { return Vec::new() };
    if dynamics.signed.is_empty() && dynamics.inertias.is_empty() {
        return Vec::new();
    }
    let variable = |index: usize| {
        let variable = model.variables.get(index)?;
        let standard = (variable.kind == VariableKind::Parameter).then_some(variable.default);
        given(&variable.name).or(standard)
    };
    let values = values(&model.expressions, |leaf| match leaf {
        Node::Variable(index) => variable(index),
        _ => None,
    });
    let value = |id: Id| values.get(id.index()).copied().flatten();
    let signed = dynamics.signed.iter().filter_map(|signed| wrong(signed, value(signed.value)?));
    let inertias = dynamics.inertias.iter().filter_map(|inertia| inertia::wrong(inertia, value));
    signed.chain(inertias).collect()
}

/// Reason why a value is below its least one; `None` where it is not, or is not finite.
fn wrong(signed: &NonNegative, value: f64) -> Option<Diagnostic> {
    let NonNegative { field, least, of, span, .. } = signed;
    if value.is_nan() || least.admits(value) {
        return None;
    }
    let message = match least {
        Least::Zero => format!("`{field}` of `{of}` is negative: {value}"),
        Least::AboveZero => format!("`{field}` of `{of}` is not above 0: {value}"),
    };
    let help = match *field {
        "stiffness" => "a force that pushes away from its rest is an energy of its own: `potential V = …;`",
        "damping" | "coefficient" | "viscous" | "sticks" => {
            "it would feed energy in; what drives is a force of its own: `force f: … on P;`"
        }
        "speed" => "friction is smooth below this speed: write a small one, `speed: 1mm/1s`",
        "depth" => "the stiffness is force over depth there: write a depth that is reached, `depth: 1mm`",
        "exponent" => "the force rises with the depth to this power: `exponent: 1.5` for spheres",
        "restitution" => "a contact without any rebound has a small one: `restitution: 0.01`",
        "1 - restitution" => "a rebound faster than the approach feeds energy in: it is at most 1",
        "approach" => {
            "write the speed at touch for which the restitution holds, `approach: 0.5`: a slower touch returns with a larger share"
        }
        "bristles" => "it is their deflection at the force of sliding: `bristles: 10um`",
        "bound" => {
            "it is the largest |second time derivative| of the open gap: under its weight alone `bound: 9.81`"
        }
        _ => "masses and moments of inertia are at least 0",
    };
    Some(Diagnostic { message, help: help.into(), span: *span })
}

/// Values of the expressions that depend on numbers and on leaves known to `leaf` alone.
fn values(expressions: &Expressions, leaf: impl Fn(Node) -> Option<f64>) -> Vec<Option<f64>> {
    let mut values: Vec<Option<f64>> = Vec::with_capacity(expressions.len());
    for (_, node) in expressions.iter() {
        let of = |id: Id| values.get(id.index()).copied().flatten();
        let value = match node {
            Node::Number(number) => Some(number),
            Node::Unary(function, a) => of(a).map(|a| (function.entry().value)(a)),
            Node::Binary(function, a, b) => of(a).zip(of(b)).map(|(a, b)| (function.entry().value)(a, b)),
            other => leaf(other),
        };
        values.push(value);
    }
    values
}
