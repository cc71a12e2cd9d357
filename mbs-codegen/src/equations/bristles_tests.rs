//! Friction with bristles against the same law typed by hand: forces, rates of the deflections and all of their slopes.

use super::Dynamics;
use super::seen_tests::{derived, value_at};
use crate::symbolic::sample_points::scattered;
use crate::symbolic::{Graph, Leaf, NodeId};

/// Two blocks: one on a moving belt, the other on a contact.
const COMMON: &str = "mechanism Rough;
    param mu: 1 = 0.2; param mus: 1 = 0.3; param vs: m/s = 0.4; param delta: m = 0.6; param d: s/m = 0.7; param c: N*s/m = 2;
    coord x: [m; 2] = 0; coord y: m = 0; state other: m = 0; der(other) == der(x[0]) - other/1s;
    for i in 0..2 { body block { mass: 2kg, com: [x[i], y] } }
    contact floor { gap: y - 0.2m, stiffness: 900, damping: 0.2 }
    force idle: 1 [N/m]*other on x[1];";

const LAW: &str = "
    for i in 0..2 {
        friction rub {
            along: x[i] - i*1 [m/s]*t, normal: normal(floor) + i*10N, coefficient: mu, sticks: mus, speed: vs,
            bristles: delta, damping: d, viscous: c
        }
    }
    friction plain { along: x[0] + x[1], normal: 5N, coefficient: mu, bristles: delta }
    out bent: [m; 3] = [deflection(rub[0]), deflection(rub[1]), deflection(plain)];
    out loss: W = power(rub[1]);";

const TYPED: &str = "
    state z: [m; 3] = 0;
    for i in 0..2 {
        let v = der(x[i]) - i*1 [m/s];
        let growth = v - abs(v)*z[i]/delta*mu/(mu + (mus - mu)*exp(-(v/vs)^2));
        der(z[i]) == growth;
        force rub: -(mu*abs(normal(floor) + i*10N)*(z[i]/delta + d*growth) + c*v) on x[i] - i*1 [m/s]*t;
    }
    let w = der(x[0]) + der(x[1]);
    der(z[2]) == w - abs(w)*z[2]/delta;
    force plain: -mu*5N*z[2]/delta on x[0] + x[1];
    out bent: [m; 3] = z;
    out loss: W = force(rub[1])*(der(x[1]) - 1 [m/s]);";

/// Parameters as they stand in the text.
const PARAMETERS: [f64; 6] = [0.2, 0.3, 0.4, 0.6, 0.7, 2.0];

fn value(graph: &Graph, node: Option<NodeId>, trial: usize) -> f64 {
    let leaf = |leaf: Leaf| match leaf {
        Leaf::Parameter(index) => PARAMETERS[index as usize],
        other => 2.0 * scattered(other, trial) - 0.7,
    };
    node.map_or(0.0, |node| value_at(graph, node, leaf))
}

/// Values of everything that the integrators see.
fn values(graph: &Graph, dynamics: &Dynamics, trial: usize) -> Vec<f64> {
    let dense = |matrix: &[Vec<(usize, NodeId)>]| -> Vec<Option<NodeId>> {
        let entry = |row: &Vec<(usize, NodeId)>, column| {
            row.iter().find(|(known, _)| *known == column).map(|(_, node)| *node)
        };
        matrix.iter().flat_map(|row| (0..3).map(move |column| entry(row, column))).collect()
    };
    let slopes = dynamics.slopes.iter().flat_map(|slope| {
        [&slope.force, &slope.q, &slope.qd, &slope.states].into_iter().flatten().copied().collect::<Vec<_>>()
    });
    let mut roots = [dynamics.force.clone(), dynamics.state_rates.clone(), dynamics.powers.clone()].concat();
    roots.extend(dense(&dynamics.force_q).into_iter().chain(dense(&dynamics.force_qd)).chain(slopes));
    roots.into_iter().map(|root| value(graph, root, trial)).collect()
}

#[test]
fn bristles_are_the_states_and_forces_that_a_text_would_type() {
    let (model, keyword) = derived(&format!("{COMMON}{LAW}"));
    let (_, typed) = derived(&format!("{COMMON}{TYPED}"));
    let states: Vec<String> =
        model.dynamics.expect("forces").states.into_iter().map(|state| state.name).collect();
    assert_eq!(states, ["other", "rub.0.deflection", "rub.1.deflection", "plain.deflection"]);
    let dynamics = [&keyword, &typed].map(|equations| equations.dynamics.as_ref().expect("forces"));
    let mut pressed = 0;
    for trial in 0..8 {
        let found = values(&keyword.graph, dynamics[0], trial);
        let wanted = values(&typed.graph, dynamics[1], trial);
        assert_eq!(found.len(), wanted.len());
        for (place, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            assert!((found - wanted).abs() <= 1e-12 * (1.0 + wanted.abs()), "{place}: {found} and {wanted}");
        }
        pressed += usize::from(found[2] != 0.0);
        for (found, wanted) in dynamics[0].loads.iter().zip(&dynamics[1].loads) {
            let [found, wanted] =
                [value(&keyword.graph, Some(*found), trial), value(&typed.graph, Some(*wanted), trial)];
            assert!((found - wanted).abs() <= 1e-12 * (1.0 + wanted.abs()), "{found} and {wanted}");
        }
    }
    assert!(pressed > 0, "the contact is always open");
}

#[test]
fn without_friction_the_deflection_is_a_number_and_the_force_is_zero() {
    let (_, equations) = derived(
        "mechanism Smooth; coord x: m = 0; body block { mass: 1, com: [x, 0] }
         friction rub { along: x, normal: 5N, coefficient: 0, sticks: 0, speed: 0.1, bristles: 1mm }",
    );
    let dynamics = equations.dynamics.expect("forces");
    for trial in 0..8 {
        assert_eq!(value(&equations.graph, dynamics.force[0], trial), 0.0);
        assert!(value(&equations.graph, dynamics.state_rates[0], trial).is_finite());
    }
}
