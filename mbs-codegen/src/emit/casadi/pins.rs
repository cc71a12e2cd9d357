//! Forces of pins for the second back end: the forces on each body, which the reader of the definition sums up.

use std::fmt::Write;

use crate::emit::casadi::{or_zero, variable};
use crate::equations::{Attribution, On, RowMotion};
use crate::model::Model;
use crate::model::dynamics::{Action, Dynamics};
use crate::model::expression::Id;
use crate::model::springs::SpringDamper;

/// Before: a text with masses, of which an output asks for forces of pins. After: `pins` holds them, two components a pin.
///
/// `bodies`: mass, centre, inertia and angle or None; `joints`: place and the two bodies, None for the ground; `acting`:
/// a body with a force and its place, or with a moment and None; `held`: bodies and components that an unknown force or
/// moment holds.
pub fn sums(model: &Model, dynamics: &Dynamics, attribution: &Attribution, text: &mut String) {
    let _ = writeln!(
        text,
        "    bodies, gravity, joints, acting, length = [], [], [], [], ca.SX({:?})",
        model.longest.as_ref().map_or(0.0, |longest| longest.length)
    );
    for index in &model.lengths {
        let _ = writeln!(text, "    length = ca.fmax(length, ca.fabs(v[{index}]))");
    }
    for body in &dynamics.bodies {
        let (inertia, angle) = match body.in_plane() {
            Some((inertia, angle)) => (variable(inertia), variable(angle)),
            None => ("None".into(), "None".into()),
        };
        let mass = variable(body.mass);
        let _ = writeln!(text, "    bodies.append(({mass}, {}, {inertia}, {angle}))", list(&body.com));
    }
    for field in &dynamics.gravity {
        let _ = writeln!(text, "    gravity.append({})", list(field));
    }
    for pin in &dynamics.pins {
        let body = |body: Option<usize>| body.map_or_else(|| "None".into(), |body| body.to_string());
        let [first, second] = pin.bodies.map(body);
        let _ = writeln!(text, "    joints.append(({}, {first}, {second}))", list(&pin.at));
    }
    acting(dynamics, attribution, text);
    for (row, motion) in &attribution.rows {
        along(*motion, &format!("-l[{row}]"), text);
    }
    let held: Vec<String> =
        attribution.held.iter().map(|(body, component)| format!("({body}, {component})")).collect();
    let held = held.join(", ");
    let _ = writeln!(text, "    pins = ca.pins(bodies, gravity, joints, acting, [{held}], length, der)");
}

/// The named forces, part by part.
fn acting(dynamics: &Dynamics, attribution: &Attribution, text: &mut String) {
    for (index, force) in dynamics.forces.iter().enumerate() {
        let mut parts = attribution.acting.iter().filter(|(force, _)| *force == index).map(|(_, on)| *on);
        match &force.action {
            Action::Work(pairs) => {
                let (values, places): (Vec<Id>, Vec<Id>) = pairs.iter().copied().unzip();
                if let Some(on) = parts.next() {
                    let value = values.first().map(|value| variable(*value)).unwrap_or_default();
                    part(on, &list(&values), &value, &list(&places), text);
                }
            }
            Action::Line(line) => {
                if let (Some(begin), Some(end)) = (parts.next(), parts.next()) {
                    pulled(line, text);
                    part(begin, "pull", "0", &list(&line.from), text);
                    part(end, "[-x for x in pull]", "0", &list(&line.to), text);
                }
            }
            Action::Turn(turn) => {
                if let Some(on) = parts.next() {
                    let angle = variable(turn.angle);
                    let value = format!(
                        "-({} * ({angle} - {}) + {} * der({angle}) + {})",
                        or_zero(turn.stiffness),
                        or_zero(turn.rest),
                        or_zero(turn.damping),
                        or_zero(turn.torque)
                    );
                    part(on, "[]", &value, "[]", text);
                }
            }
            Action::Dissipation(_) => {}
        }
    }
}

/// The force of a tension on its begin.
fn pulled(line: &SpringDamper, text: &mut String) {
    let arm = |(a, b): (&Id, &Id)| format!("{} - {}", variable(*b), variable(*a));
    let arms: Vec<String> = line.from.iter().zip(&line.to).map(arm).collect();
    let _ = writeln!(text, "    arm = [{}]", arms.join(", "));
    let _ = writeln!(text, "    place = ca.sqrt(sum((x * x for x in arm), ca.SX(0)))");
    let elastic = format!("{} * (place - {})", or_zero(line.stiffness), or_zero(line.length));
    let active = format!("{} * der(place) + {}", or_zero(line.damping), or_zero(line.actuator));
    let _ = writeln!(text, "    pull = [({elastic} + {active}) * x / place for x in arm]");
}

/// A force on a point, or a force or torque along a motion.
fn part(on: On, force: &str, value: &str, place: &str, text: &mut String) {
    match on {
        On::Ground => {}
        On::Point(body) => {
            let _ = writeln!(text, "    acting.append(({body}, {force}, {place}))");
        }
        On::Moves(motion) => along(motion, value, text),
    }
}

/// A force or torque along a motion of bodies.
fn along(motion: RowMotion, value: &str, text: &mut String) {
    match motion {
        RowMotion::Angle { body, against, sign } => {
            let _ = writeln!(text, "    acting.append(({body}, {sign:?} * ({value}), None))");
            if let Some(against) = against {
                let _ = writeln!(text, "    acting.append(({against}, {:?} * ({value}), None))", -sign);
            }
        }
        RowMotion::Component { body, component, sign } => {
            let value = format!("{sign:?} * ({value})");
            let force = if component == 0 { format!("[{value}, 0]") } else { format!("[0, {value}]") };
            let _ = writeln!(text, "    acting.append(({body}, {force}, bodies[{body}][1]))");
        }
    }
}

fn list(values: &[Id]) -> String {
    format!("[{}]", values.iter().map(|value| variable(*value)).collect::<Vec<_>>().join(", "))
}
