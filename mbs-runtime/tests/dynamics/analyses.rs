//! Inverse dynamics, equilibrium, small motions.

use mbs_runtime::dynamics::{equilibrium, inverse, linearize};
use mbs_runtime::{Failure, FailureKind, Mechanism, mechanism};

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

#[test]
fn a_level_pendulum_falls_to_its_rest() {
    // level, the rod gives no stiffness against the weight.
    for side in [-2.0, 2.0] {
        let rest = equilibrium(&hanging(), 0.0, &[side, 0.0]).unwrap();
        assert!(rest.q[0].abs() < 1e-9 && (rest.q[1] + 2.0).abs() < 1e-12, "{rest:?}");
        assert_eq!(rest.indifferent, [false; 2]);
    }
}

mechanism! {
    /// A pole on a cart that a torque holds up.
    pub mechanism Held;
    param tau: N*m = 0;
    param k: N/m = 0;
    coord x: m = 0.3;
    coord phi: rad = 0;
    coord P: [m; 2] = [1.3, 0];
    body cart { mass: 1, com: [x, 0] }
    body bob { mass: 1, com: P }
    gravity weight { acceleration: [0, -9.81] }
    torque motor: tau on phi;
    potential spring = k*x^2/2;
    constraint pole { P == [x, 0] + 1m*unit(phi); }
}

#[test]
fn indifferent_coordinates_are_reported() {
    let free: Held = Held::default();
    let rest = equilibrium(&free, 0.0, &free.guess(&free.parameters())).unwrap();
    assert_eq!(rest.indifferent, [true, false, true, false], "the cart with its bob, sideways");
    // The shortest way: cart and bob meet in the middle.
    assert!((rest.q[0] - 0.8).abs() < 1e-9 && (rest.q[1].sin() + 1.0).abs() < 1e-12, "{rest:?}");
    assert!((rest.q[2] - rest.q[0]).abs() < 1e-9 && (rest.q[3] + 1.0).abs() < 1e-12, "{rest:?}");
    let sprung = Held { k: 50.0, ..free };
    let rest = equilibrium(&sprung, 0.0, &sprung.guess(&sprung.parameters())).unwrap();
    assert!(rest.indifferent == [false; 4] && rest.q[0].abs() < 1e-12, "{rest:?}");
    // Forces that hold at an angle: sin of it by the torque.
    let turned = Held { tau: 4.905, ..free };
    let rest = equilibrium(&turned, 0.0, &turned.guess(&turned.parameters())).unwrap();
    assert!((rest.q[1].cos() - 0.5).abs() < 1e-12, "{rest:?}");
}

mechanism! {
    /// An arm that a torque turns against its weight.
    pub mechanism Arm;
    param tau: N*m = 12;
    coord phi: rad = 1;
    body bob { mass: 1, com: 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    torque motor: tau on phi;
}

#[test]
fn a_mechanism_without_rest_names_the_least_force() {
    // The weight holds 9.81 N m at most; of 12 N m the rest pushes on.
    for start in [1.0, -2.0, 0.01] {
        let failure = equilibrium(&Arm::default(), 0.0, &[start]).unwrap_err();
        let Failure { kind: FailureKind::NoEquilibrium { coordinate, force, .. }, .. } = failure else {
            panic!("{failure}")
        };
        assert!(coordinate.name == "phi" && (force - 2.19).abs() < 1e-3, "{start}: {failure}");
        assert!(failure.to_string().contains("no position of rest") && failure.to_string().contains("J/rad"));
    }
    let held: Arm = Arm { tau: 9.0 };
    assert!(
        (equilibrium(&held, 0.0_f64, &[1.0]).unwrap().q[0].abs() - (9.0_f64 / 9.81).acos()).abs() < 1e-12
    );
}
