//! Masses and forces for the second back end: energies, and the displacement along which each force does work.

use std::fmt::Write;

use crate::emit::casadi::{assignments, variable};
use crate::emit::casadi::{or_zero, pins};
use crate::equations::Attribution;
use crate::model::Model;
use crate::model::dynamics::{Action, Dynamics, Rotation};
use crate::model::expression::Id;
use crate::model::springs::{SpringDamper, Turn};

/// Before: a text with masses or forces. After: the definition is followed by `K`, the number of first-order states,
/// and `dynamics(ca, q, v, t, der, z, l)`.
///
/// The function returns terms of the kinetic and of the potential energy, forces and rates of the states. It also
/// returns the outputs that depend on multipliers or states. A force is a dictionary: `work`, pairs of a value and the
/// displacement that it acts along, without what is stored as potential energy; `rayleigh`, a function R or None.
pub fn definition(model: &Model, dynamics: &Dynamics, attribution: Option<&Attribution>, text: &mut String) {
    let _ = writeln!(text, "\n\nK = {}\n\n\ndef dynamics(ca, q, v, t, der, z, l):", dynamics.states.len());
    assignments(model, roots(dynamics), text);
    let _ = writeln!(text, "    kinetic, potential, forces = [], [], []");
    for body in &dynamics.bodies {
        let mass = variable(body.mass);
        for place in &body.com {
            let _ = writeln!(text, "    kinetic.append({mass} * der({0}) * der({0}) / 2)", variable(*place));
        }
        match &body.rotation {
            None => {}
            Some(Rotation::Plane { inertia, angle }) => {
                let (inertia, angle) = (variable(*inertia), variable(*angle));
                let _ = writeln!(text, "    kinetic.append({inertia} * der({angle}) * der({angle}) / 2)");
            }
            Some(Rotation::Space { inertia, orientation }) => turning(inertia, *orientation, text),
        }
        for field in &dynamics.gravity {
            for (place, acceleration) in body.com.iter().zip(field) {
                let (place, acceleration) = (variable(*place), variable(*acceleration));
                let _ = writeln!(text, "    potential.append(-{mass} * {acceleration} * {place})");
            }
        }
    }
    for kinetic in &dynamics.kinetics {
        let _ = writeln!(text, "    kinetic.append({})", variable(kinetic.value));
    }
    for potential in &dynamics.potentials {
        let _ = writeln!(text, "    potential.append({})", variable(*potential));
    }
    for force in &dynamics.forces {
        match &force.action {
            Action::Work(pairs) => {
                let pair = |(value, on): &(Id, Id)| format!("({}, {})", variable(*value), variable(*on));
                let pairs = pairs.iter().map(pair).collect::<Vec<_>>().join(", ");
                let _ = writeln!(text, "    work = [{pairs}]");
                let _ = writeln!(text, "    forces.append(dict(work=work, rayleigh=None))");
            }
            Action::Dissipation(value) => {
                let value = variable(*value);
                let _ = writeln!(text, "    forces.append(dict(work=[], rayleigh={value}))");
            }
            Action::Line(line) => tension(line, text),
            Action::Turn(turn) => torque(turn, text),
        }
    }
    let rates = dynamics.states.iter().filter_map(|state| state.rate).map(variable);
    let _ = writeln!(text, "    rates = [{}]", rates.collect::<Vec<_>>().join(", "));
    if let Some(attribution) = attribution {
        pins::sums(model, dynamics, attribution, text);
    }
    assignments(model, dynamics.loads.iter().map(|load| load.value), text);
    let loads = dynamics.loads.iter().map(|load| variable(load.value));
    let _ = writeln!(text, "    loads = [{}]", loads.collect::<Vec<_>>().join(", "));
    let names = "kinetic=kinetic, potential=potential, forces=forces, rates=rates, loads=loads";
    let _ = writeln!(text, "    return dict({names})");
}

/// ½ ω'ᵀ J ω' with ω' = 2 (e₀ ε̇ − ė₀ ε − ε × ε̇).
fn turning(inertia: &[(usize, usize, Id)], orientation: [Id; 4], text: &mut String) {
    let [e0, x, y, z] = orientation.map(variable);
    let axes = [(&x, &y, &z), (&y, &z, &x), (&z, &x, &y)].map(|(i, j, k)| {
        format!("2 * ({e0} * der({i}) - der({e0}) * {i} - {j} * der({k}) + {k} * der({j}))")
    });
    let _ = writeln!(text, "    spin = [{}]", axes.join(", "));
    for (row, column, entry) in inertia {
        let half = if row == column { " / 2" } else { "" };
        let _ =
            writeln!(text, "    kinetic.append({} * spin[{row}] * spin[{column}]{half})", variable(*entry));
    }
}

/// Everything that the function uses.
fn roots(dynamics: &Dynamics) -> Vec<Id> {
    let mut roots = Vec::new();
    for body in &dynamics.bodies {
        roots.push(body.mass);
        roots.extend(&body.com);
        match &body.rotation {
            None => {}
            Some(Rotation::Plane { inertia, angle }) => roots.extend([*inertia, *angle]),
            Some(Rotation::Space { inertia, orientation }) => {
                roots.extend(inertia.iter().map(|(.., entry)| *entry).chain(*orientation));
            }
        }
    }
    roots.extend(dynamics.gravity.iter().flatten());
    roots.extend(dynamics.kinetics.iter().map(|kinetic| kinetic.value));
    roots.extend(&dynamics.potentials);
    for force in &dynamics.forces {
        match &force.action {
            Action::Work(pairs) => roots.extend(pairs.iter().flat_map(|(value, on)| [*value, *on])),
            Action::Dissipation(value) => roots.push(*value),
            Action::Line(SpringDamper { from, to, stiffness, length, damping, actuator, .. }) => {
                roots.extend(from.iter().chain(to));
                roots.extend([stiffness, length, damping, actuator].into_iter().flatten());
            }
            Action::Turn(Turn { angle, stiffness, rest, damping, torque, .. }) => {
                roots.push(*angle);
                roots.extend([stiffness, rest, damping, torque].into_iter().flatten());
            }
        }
    }
    roots.extend(dynamics.states.iter().filter_map(|state| state.rate));
    roots.extend(dynamics.pins.iter().flat_map(|pin| &pin.at));
    roots
}

fn tension(line: &SpringDamper, text: &mut String) {
    let square = |(a, b): (&Id, &Id)| format!("({} - {}) ** 2", variable(*b), variable(*a));
    let squares: Vec<String> = line.from.iter().zip(&line.to).map(square).collect();
    let _ = writeln!(text, "    place = ca.sqrt({})", squares.join(" + "));
    spring(line.stiffness, line.length, line.damping, line.actuator, line.stores, text);
}

fn torque(turn: &Turn, text: &mut String) {
    let _ = writeln!(text, "    place = {}", variable(turn.angle));
    spring(turn.stiffness, turn.rest, turn.damping, turn.torque, turn.stores, text);
}

/// Spring, damper and actuator along `place`.
fn spring(
    stiffness: Option<Id>,
    rest: Option<Id>,
    damping: Option<Id>,
    actuator: Option<Id>,
    stores: bool,
    text: &mut String,
) {
    let (stiffness, rest) = (or_zero(stiffness), or_zero(rest));
    let _ = writeln!(text, "    elastic = {stiffness} * (place - {rest})");
    let _ = writeln!(text, "    active = {} * der(place) + {}", or_zero(damping), or_zero(actuator));
    // A spring that stores energy pulls by the slope of that energy.
    let value = if stores { "-active" } else { "-active - elastic" };
    let _ = writeln!(text, "    work = [({value}, place)]");
    let stored = if stores { format!(", stored=elastic * (place - {rest}) / 2") } else { String::new() };
    let _ = writeln!(text, "    forces.append(dict(work=work, rayleigh=None{stored}))");
    if stores {
        let _ = writeln!(text, "    potential.append(elastic * (place - {rest}) / 2)");
    }
}
