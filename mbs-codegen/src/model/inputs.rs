//! Inputs without known rates: they are allowed where no rate is needed.

use super::dynamics::{Action, Body, Dynamics, Rotation};
use super::expression::{Id, Node};
use super::{Field, Model, Role};
use crate::diagnostics::Diagnostics;

/// Before: a resolved model. After: inputs without rates are reported where their rates would silently be 0. Such places are
/// a row, the place of a body or of a spring, and an expression whose rate a force or an output uses.
pub fn check(model: &Model, diagnostics: &mut Diagnostics) {
    let inputs: Vec<&Field> = model.fields.iter().filter(|field| field.role == Role::Input).collect();
    if inputs.is_empty() {
        return;
    }
    let places = places(model);
    for field in inputs {
        let variables = field.first..field.first + field.shape.iter().product::<usize>();
        let used = model
            .expressions
            .made_of(|node| matches!(node, Node::Variable(index) if variables.contains(&index)));
        let Some((_, place)) = places.iter().find(|(id, _)| used.get(id.index()) == Some(&true)) else {
            continue;
        };
        let name = &field.name.text;
        let lengths = field.shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        let turns = model.variables.get(field.first).is_some_and(|variable| variable.turns);
        let unit = if turns { "turn" } else { &field.unit };
        let kind = match field.shape.as_slice() {
            [] => unit.to_owned(),
            _ => format!("[{unit}; {lengths}]"),
        };
        diagnostics.report(
            field.name.span,
            format!("input `{name}` stands in {place}, but its rates are not known"),
            format!("declare `input {name}: {kind}, rates;`"),
        );
    }
}

/// Expressions whose rates the equations need, with a phrase for their place.
fn places(model: &Model) -> Vec<(Id, String)> {
    let rows = model.rows.iter().map(|row| (row.residual, "a constraint or drive".to_string()));
    let mut places: Vec<(Id, String)> = rows.collect();
    if let Some(dynamics) = &model.dynamics {
        places.extend(of_dynamics(model, dynamics));
    }
    for output in &model.outputs {
        let phrase = format!("what output `{}` takes the rate of", output.name);
        places.extend(rates(model, [output.value]).map(|argument| (argument, phrase.clone())));
    }
    places
}

/// Those of bodies and forces.
fn of_dynamics(model: &Model, dynamics: &Dynamics) -> Vec<(Id, String)> {
    let mut places = Vec::new();
    for body in &dynamics.bodies {
        let parts = of_body(body).into_iter();
        places.extend(parts.flat_map(|(field, ids)| named(field, &body.name, ids)));
    }
    for force in &dynamics.forces {
        match &force.action {
            Action::Line(line) => {
                places.extend(named("from", &force.name, line.from.clone()));
                places.extend(named("to", &force.name, line.to.clone()));
            }
            Action::Turn(turn) => places.extend(named("angle", &force.name, vec![turn.angle])),
            Action::Work(_) | Action::Dissipation(_) => {}
        }
    }
    places.extend(rated(model, dynamics));
    places
}

fn of_body(body: &Body) -> [(&'static str, Vec<Id>); 2] {
    let rotation = match &body.rotation {
        None => ("angle", Vec::new()),
        Some(Rotation::Plane { angle, .. }) => ("angle", vec![*angle]),
        Some(Rotation::Space { orientation, .. }) => ("orientation", orientation.to_vec()),
    };
    [("com", body.com.clone()), rotation]
}

fn named(field: &'static str, of: &str, ids: Vec<Id>) -> impl Iterator<Item = (Id, String)> {
    let phrase = format!("`{field}` of `{of}`");
    ids.into_iter().map(move |id| (id, phrase.clone()))
}

/// Arguments of rates in a force or in the rate of a state: `der(x)`, the displacement of friction, a contact's gap.
fn rated(model: &Model, dynamics: &Dynamics) -> Vec<(Id, String)> {
    let values = dynamics.forces.iter().flat_map(|force| match &force.action {
        Action::Work(pairs) => pairs.iter().map(|(value, _)| *value).collect(),
        Action::Dissipation(value) => vec![*value],
        Action::Line(line) => {
            [line.stiffness, line.length, line.damping, line.actuator].into_iter().flatten().collect()
        }
        Action::Turn(turn) => {
            [turn.stiffness, turn.rest, turn.damping, turn.torque].into_iter().flatten().collect()
        }
    });
    let states = dynamics.states.iter().filter_map(|state| state.rate);
    let arguments = rates(model, values.chain(states));
    arguments.map(|argument| (argument, "what a force takes the rate of".to_string())).collect()
}

/// Arguments of rates in these expressions.
fn rates(model: &Model, values: impl IntoIterator<Item = Id>) -> impl Iterator<Item = Id> {
    let reached = model.expressions.reachable(values);
    let nodes = model.expressions.iter().filter(move |(id, _)| reached.get(id.index()) == Some(&true));
    nodes.filter_map(|(_, node)| match node {
        Node::Rate(argument, _) => Some(argument),
        _ => None,
    })
}
