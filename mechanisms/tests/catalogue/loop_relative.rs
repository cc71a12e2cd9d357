//! Tests of `mechanisms::loop_relative`.

use core::f64::consts::TAU;

use crate::reference::{angle_difference, one_turn};
use mechanisms::loop_relative::*;

const L: [f64; 3] = [0.1, 0.25, 0.2];
const OD: f64 = 0.3;

/// Absolute angles of links 2 and 3 by the cosine rule in the triangle `A B D`; `side` as in the text.
fn angles(theta1: f64, side: f64) -> [f64; 3] {
    let d = [OD - L[0] * theta1.cos(), -L[0] * theta1.sin()];
    let reach = d[0].hypot(d[1]);
    let at_a = ((L[1] * L[1] + reach * reach - L[2] * L[2]) / (2.0 * L[1] * reach)).acos();
    let theta2 = d[1].atan2(d[0]) + side * at_a;
    let b = [L[0] * theta1.cos() + L[1] * theta2.cos(), L[0] * theta1.sin() + L[1] * theta2.sin()];
    [theta1, theta2, (-b[1]).atan2(OD - b[0])]
}

/// Rates of the absolute angles from `Σ Lᵢ ωᵢ u′(θᵢ) = 0`, multiplied by the unit vectors of links 3 and 2.
fn rates([a1, a2, a3]: [f64; 3], w1: f64) -> [f64; 3] {
    let w2 = -L[0] * w1 * (a3 - a1).sin() / (L[1] * (a3 - a2).sin());
    let w3 = -L[0] * w1 * (a2 - a1).sin() / (L[2] * (a2 - a3).sin());
    [w1, w2, w3]
}

/// Second derivatives in the same way, from `Σ Lᵢ (αᵢ u′(θᵢ) − ωᵢ² u(θᵢ)) = 0` with `α1 = 0`.
fn accelerations([a1, a2, a3]: [f64; 3], [w1, w2, w3]: [f64; 3]) -> [f64; 3] {
    let e = [L[0] * w1 * w1, L[1] * w2 * w2, L[2] * w3 * w3];
    let along3 = e[0] * (a1 - a3).cos() + e[1] * (a2 - a3).cos() + e[2];
    let along2 = e[0] * (a1 - a2).cos() + e[1] + e[2] * (a3 - a2).cos();
    [0.0, along3 / (L[1] * (a3 - a2).sin()), along2 / (L[2] * (a2 - a3).sin())]
}

fn relative([a, b, c]: [f64; 3]) -> [f64; 3] {
    [a, b - a, c - b]
}

#[test]
fn the_motion_equals_the_closed_form() {
    for (run, side) in [1.0, -1.0].into_iter().enumerate() {
        let motion = one_turn(&CARD, run, 72);
        for (step, t) in motion.time.iter().enumerate() {
            let angle = angles(TAU * t, side);
            let rate = rates(angle, TAU);
            let acceleration = accelerations(angle, rate);
            for (k, coordinate) in motion.coordinates.iter().enumerate() {
                assert!(
                    angle_difference(coordinate.q[step], relative(angle)[k]) < 1e-12,
                    "ψ{} at {t}",
                    k + 1
                );
                assert!((coordinate.qd[step] - relative(rate)[k]).abs() < 1e-11, "ψ̇{} at {t}", k + 1);
                let difference = coordinate.qdd[step] - relative(acceleration)[k];
                assert!(difference.abs() < 1e-9, "ψ̈{} at {t}: {difference:e}", k + 1);
            }
        }
    }
}

#[test]
fn the_time_constraint_stands_first() {
    let names: Vec<_> = CARD.equations().rows().iter().map(|row| row.name).collect();
    assert_eq!(names, ["crank", "closure.0", "closure.1"]);
}
