//! Inverse dynamics, equilibrium, small motions.

use mbs_runtime::dynamics::{equilibrium, inverse, linearize};

use crate::linkage::{End, Linkage, Rod};
use crate::methods::hanging;

#[test]
fn a_point_that_two_rods_carry_along_needs_the_forces_of_its_motion() {
    // Two rods at right angles from a shaken ground: the point moves as the ground, and every force is known.
    let rods = [
        Rod { from: End::Ground([0.0, 0.0]), to: End::Point(0), length: 1.0, mass: 0.0 },
        Rod { from: End::Ground([1.0, 1.0]), to: End::Point(0), length: 1.0, mass: 0.0 },
    ];
    let linkage = Linkage { shake: [0.1, 3.0], ..Linkage::new(rods, [2.0; 2], [0.0, -9.81]) };
    for t in [0.0, 0.3, 1.7] {
        let driven = inverse(&linkage, t, &[1.0, 0.0]).unwrap();
        let (sine, cosine) = (3.0 * t).sin_cos();
        let expected = [1.0 + 0.1 * sine, 0.0, 0.3 * cosine, 0.0, -0.9 * sine, 0.0];
        let found = driven.q.into_iter().chain(driven.qd).chain(driven.qdd);
        for (found, expected) in found.zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        // −Φ_qᵀ λ carries the weight and the acceleration: along x by the first rod, along y by the second.
        let [first, second] = driven.lambda;
        assert!((-2.0 * first - 2.0 * driven.qdd[0]).abs() < 1e-12);
        assert!((2.0 * second - 2.0 * 9.81).abs() < 1e-12, "{second}");
    }
}

#[test]
fn a_pendulum_under_a_side_force_rests_in_line_with_its_load() {
    let pushed = Linkage { push: 10.0, ..hanging() };
    let weight = 3.0 * 9.81_f64;
    let load = weight.hypot(10.0);
    for start in [[0.5, -1.9], [2.0, 0.3], [1.0, -1.0]] {
        let found = equilibrium(&pushed, 0.0, &start).unwrap();
        let side = found.q[0].signum();
        assert!((found.q[0] - side * 20.0 / load).abs() < 1e-12, "{found:?}");
        assert!((found.q[1] + side * 2.0 * weight / load).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn small_swings_have_the_frequency_of_the_pendulum_and_its_damping() {
    let damped = Linkage { damping: 0.6, ..hanging() };
    let rest = equilibrium(&damped, 0.0, &[0.1, -1.9]).unwrap();
    let none = [0.0; 2];
    let small = linearize(&damped, 0.0, (&rest.q, &none, &none), &rest.lambda).unwrap();
    assert!(small.freedom == 1 && !small.frozen);
    let (mass, damping, stiffness) = (small.mass[0][0], small.damping[0][0], small.stiffness[0][0]);
    assert!((stiffness / mass - 9.81 / 2.0).abs() < 1e-12, "{}", stiffness / mass);
    assert!((damping / mass - 0.6 / 3.0).abs() < 1e-12, "{}", damping / mass);
}

#[test]
fn an_upright_pendulum_is_an_equilibrium_that_small_motions_leave() {
    let rest = equilibrium(&hanging(), 0.0, &[0.05, 1.95]).unwrap();
    assert!((rest.q[1] - 2.0).abs() < 1e-12);
    let none = [0.0; 2];
    let small = linearize(&hanging(), 0.0, (&rest.q, &none, &none), &rest.lambda).unwrap();
    assert!((small.stiffness[0][0] / small.mass[0][0] + 9.81 / 2.0).abs() < 1e-12);
}
