//! Declarations without any effect: forces without a value or a place that moves, gravity without bodies.

use super::Model;
use super::dynamics::{Action, Dynamics, Force};
use super::expression::{Id, Node};
use super::springs::{SpringDamper, Turn};
use crate::diagnostics::Diagnostics;

/// Before: a resolved model. After: forces without effect are reported.
pub fn check(model: &Model, diagnostics: &mut Diagnostics) {
    let Some(dynamics) = &model.dynamics else { return };
    // The bodies may stand where a fault is.
    if diagnostics.number() == 0 {
        gravity(dynamics, diagnostics);
    }
    let moving = model.expressions.made_of(|node| matches!(node, Node::Coordinate(_)));
    let moves = |place: Id| moving.get(place.index()) == Some(&true);
    for force in &dynamics.forces {
        let name = &force.name;
        if let Some((message, help)) = without_value(force) {
            diagnostics.report(force.span, message, help);
        } else if joins_a_point_to_itself(model, &force.action) {
            let message = format!("`{name}` begins and ends at one point");
            diagnostics.report(force.span, message, "let it join two points");
        } else if !places(&force.action).into_iter().any(moves) {
            let message = format!("`{name}` acts where nothing moves: no coordinate stands in its place");
            let help = "let it act on a point or an angle that coordinates move, or remove it";
            diagnostics.report(force.span, message, help);
        }
    }
}

/// `true` if both ends of a tension are written alike.
fn joins_a_point_to_itself(model: &Model, action: &Action) -> bool {
    let Action::Line(SpringDamper { from, to, .. }) = action else { return false };
    let alike = |(a, b): (&Id, &Id)| a == b || model.expressions.node(*a) == model.expressions.node(*b);
    from.iter().zip(to).all(alike)
}

/// Gravity pulls bodies alone: the mass of a `kinetic` energy has no weight.
fn gravity(dynamics: &Dynamics, diagnostics: &mut Diagnostics) {
    if dynamics.bodies.is_empty() {
        for (name, span) in &dynamics.gravity_names {
            let message = format!("gravity `{name}` has no body to pull");
            let help = "declare what has weight: `body rod { mass: …, com: … }`; or remove the gravity";
            diagnostics.report(*span, message, help);
        }
    }
}

/// Reason why a spring and damper exerts no force, or has a field without effect.
fn without_value(Force { name, action, .. }: &Force) -> Option<(String, &'static str)> {
    let (stiffness, others, rest, help) = match action {
        Action::Line(SpringDamper { stiffness, length, damping, actuator, .. }) => (
            stiffness,
            [damping, actuator],
            length.map(|_| "length"),
            "give it `stiffness: …`, `damping: …` or `actuator: …`",
        ),
        Action::Turn(Turn { stiffness, rest, damping, torque, .. }) => (
            stiffness,
            [damping, torque],
            rest.map(|_| "rest"),
            "give it `stiffness: …`, `damping: …` or `torque: …`",
        ),
        Action::Work(_) | Action::Dissipation(_) => return None,
    };
    if stiffness.is_none() && others.iter().all(|value| value.is_none()) {
        return Some((format!("`{name}` exerts no force"), help));
    }
    let rest = rest.filter(|_| stiffness.is_none())?;
    let help = "write `stiffness: …` too, or leave it out";
    Some((format!("`{name}` has a `{rest}` and no `stiffness`"), help))
}

/// Displacements of a force; of a dissipation its function, which has no rates without coordinates.
fn places(action: &Action) -> Vec<Id> {
    match action {
        Action::Work(pairs) => pairs.iter().map(|(_, on)| *on).collect(),
        Action::Dissipation(value) => vec![*value],
        Action::Line(SpringDamper { from, to, .. }) => from.iter().chain(to).copied().collect(),
        Action::Turn(Turn { angle, .. }) => vec![*angle],
    }
}
