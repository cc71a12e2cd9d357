//! Texts with first-order states: rest, small motions, inverse dynamics.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Projection, Simulation, Tolerance, equilibrium, equilibrium_with_states,
    inverse, inverse_with_states, linearize, linearize_with_states, states_at_rest,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, Mechanism, mechanism};

mechanism! {
    /// A point on a spring, pushed by an actuator that lags behind its command and feels the point.
    pub mechanism Lagging;
    param gain: N/m = 0;
    coord x: m = 0.1;
    state z: N = 1;
    body point { mass: 2, com: [x, 0] }
    potential spring = 0.5*100N/1m*x^2;
    force actuator: z on x;
    der(z) == (2N - gain*x - z)/0.3s;
    start x = 0.1 rate 0;
}

mechanism! {
    /// A spring of a stiffness that grows by the hour, and the point that is driven on it.
    pub mechanism Stiffening;
    coord x: m = 0.1;
    state k: N/m = 50;
    body point { mass: 2, com: [x, 0] }
    force spring: -k*x on x;
    der(k) == 50N/1m/1s;
    start x = 0.1 rate 0;
}

mechanism! {
    /// A point on a curve with a damper that has a memory: two states, one nonlinear, of different units.
    pub mechanism Remembering;
    coord x: m = 0.1;
    coord y: m = 0.05;
    state a: N = 0.3;
    state b: m = 0.2;
    body point { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint curve { y == 0.5/1m*x^2 - 0.1*x; }
    force memory: a on x;
    der(a) == (40N/1m*(b - 0.2m) - a - 3N*(a/1N)^3)/0.1s + 5N/1m*der(x);
    der(b) == (x - b)/0.2s;
    start x = 0.1 rate 0;
}

mechanism! {
    /// A state that follows nothing of itself.
    pub mechanism Integrating;
    coord x: m = 0.1;
    state z: N = 0;
    body point { mass: 2, com: [x, 0] }
    force control: z - 10N/1m*x on x;
    der(z) == -3N/1m/1s*(x - 0.2m);
    start x = 0.1 rate 0;
}

mechanism! {
    /// The same where a row holds the point.
    pub mechanism Held;
    coord x: m = 0.1;
    state z: N = 0;
    body point { mass: 2, com: [x, 0] }
    constraint clamp { x == 0.1m; }
    force control: z on x;
    der(z) == -3N/1m/1s*(x - 0.2m);
}

mechanism! {
    /// An arm on a crank under two integral controls, of which one acts through a lagging motor, against its weight.
    pub mechanism Controlled;
    param gain: N*m/s = 4;
    param stiffness: N*m = 0;
    coord phi: rad = 0.2;
    coord psi: rad = 0.1;
    state total: N*m = 0;
    state motor: N*m = 0.5;
    state other: N*m = 1;
    let elbow = 0.5m*unit(phi);
    body upper { mass: 2, inertia: 0.04, com: elbow/2, angle: phi }
    body lower { mass: 1, inertia: 0.02, com: elbow + 0.3m*unit(psi), angle: psi }
    gravity weight { acceleration: [0, -9.81] }
    torque shoulder: motor on phi;
    torque elbow_motor: other on psi;
    torque spring: -stiffness*(phi - 0.4) on phi;
    der(total) == gain*(0.3 - phi);
    der(motor) == (total - motor)/0.05s;
    der(other) == gain*(sin(0.5) - sin(psi));
}

mechanism! {
    /// A bristle that moves with the speed alone: where it rests, it stays.
    pub mechanism Bristle;
    coord x: m = 0.1;
    state z: m = 0.02;
    body point { mass: 2, com: [x, 0] }
    force friction: -100N/1m*z on x;
    force spring: -50N/1m*x on x;
    der(z) == der(x) - abs(der(x))*z/0.01m;
    start x = 0.1 rate 0;
}

#[test]
fn states_rest_where_a_mechanism_rests() {
    let lagging = Lagging::<f64>::default();
    let rest = equilibrium(&lagging, 0.0, &[0.1]).unwrap();
    assert!((rest.q[0] - 0.02).abs() < 1e-14, "{:?}", rest.q);
    assert!((states_at_rest(&lagging, 0.0, &rest.q, &rest.lambda).unwrap()[0] - 2.0).abs() < 1e-14);
    // z = 2 − 300 x and 100 x = z.
    let rest = equilibrium(&Lagging { gain: 300.0_f64 }, 0.0, &[0.1]).unwrap();
    assert!((rest.q[0] - 0.005).abs() < 1e-14, "{:?}", rest.q);
    // Newton's method knows that the state follows: a linear system takes a step, and one that says so.
    assert!(rest.iterations <= 3, "{}", rest.iterations);
}

#[test]
fn a_nonlinear_state_rests_on_a_curve() {
    let text = Remembering::<f64>::default();
    let rest = equilibrium(&text, 0.0, &[0.1, 0.05]).unwrap();
    let [a, b] = states_at_rest(&text, 0.0, &rest.q, &rest.lambda).unwrap();
    let x = rest.q[0];
    assert!((b - x).abs() < 1e-12 && (40.0 * (b - 0.2) - a - 3.0 * a.powi(3)).abs() < 1e-10);
    assert!((a - 2.0 * 9.81 * (x - 0.1)).abs() < 1e-10, "{x} {a}");
    assert!(rest.iterations <= 12, "{}", rest.iterations);
}

#[test]
fn states_without_rest_are_refused_and_indifferent_ones_stay() {
    let failure = equilibrium(&Stiffening::<f64>::default(), 0.0, &[0.1]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::NoStateEquilibrium { state, .. }, .. } if state.name == "k"),
        "{failure}"
    );
    let failure = states_at_rest(&Integrating::<f64>::default(), 0.0, &[0.1], &[]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::NoStateEquilibrium { state, .. }, .. } if state.name == "z"),
        "{failure}"
    );
    // The rows hold what it integrates away from 0.
    let failure = equilibrium(&Held::<f64>::default(), 0.0, &[0.1]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::NoStateEquilibrium { state, .. }, .. } if state.name == "z"),
        "{failure}"
    );
    let rest = equilibrium(&Bristle::<f64>::default(), 0.0, &[0.1]).unwrap();
    assert!((rest.q[0] + 0.04).abs() < 1e-14, "{:?}", rest.q);
}

#[test]
fn integrated_errors_of_a_control_vanish_at_rest_and_the_control_holds_the_load() {
    let (rest, [z]) = equilibrium_with_states(&Integrating::<f64>::default(), 0.0, &[0.1]).unwrap();
    assert!((rest.q[0] - 0.2).abs() < 1e-13 && (z - 2.0).abs() < 1e-12, "{:?} {z}", rest.q);
    assert!(rest.indifferent == [false] && rest.iterations <= 6, "{rest:?}");
    for (gain, stiffness) in [(4.0, 0.0), (4.0, 20.0), (-0.3, 20.0), (4e3, 1e-3)] {
        let arm: Controlled = Controlled { gain, stiffness };
        let (rest, [total, motor, other]) = equilibrium_with_states(&arm, 0.0, &[0.2, 0.1]).unwrap();
        let [phi, psi] = rest.q;
        assert!((phi - 0.3).abs() < 1e-12 && (psi - 0.5).abs() < 1e-12, "{:?}", rest.q);
        // Moments about both joints.
        let upper = (2.0 * 0.25 + 0.5) * 9.81 * 0.3_f64.cos() - stiffness * 0.1;
        let lower = 0.3 * 9.81 * 0.5_f64.cos();
        assert!(
            (motor - upper).abs() < 1e-9 && (total - motor).abs() < 1e-12 && (other - lower).abs() < 1e-9
        );
        assert!(rest.iterations <= 12, "{}", rest.iterations);
    }
    let single: Integrating<f32> = Integrating::default();
    let (rest, [z]) = equilibrium_with_states(&single, 0.0, &[0.1]).unwrap();
    assert!((rest.q[0] - 0.2).abs() < 1e-6 && (z - 2.0).abs() < 1e-4, "{:?} {z}", rest.q);
}

#[test]
fn states_are_asked_for_where_a_motion_depends_on_them() {
    let text = Stiffening::<f64>::default();
    for failure in [
        inverse(&text, 3.0, &[0.1]).unwrap_err(),
        linearize(&text, 3.0, (&[0.1], &[0.0], &[0.0]), &[]).unwrap_err(),
    ] {
        assert!(
            matches!(failure, Failure { kind: FailureKind::StatesUnknown { state, .. }, .. } if state.name == "k"),
            "{failure}"
        );
    }
    // k = 200 at 3 s: q̈ = −200·0.1/2.
    let driven = inverse_with_states(&text, 3.0, &[0.1], &[200.0]).unwrap();
    assert!((driven.qdd[0] + 10.0).abs() < 1e-12, "{:?}", driven.qdd);
    let run = Simulation::start_from_text(text, Explicit::new(DormandPrince8, Projection::default()), 0.0);
    let mut run = run.unwrap().with_tolerance(Tolerance::new(1e-12));
    run.advance_to(3.0).unwrap();
    let (linear, slopes) = linearize_with_states(run.mechanism(), run.instant(), &[]).unwrap();
    assert!((linear.stiffness[0][0] - 200.0).abs() < 1e-9 && linear.frozen);
    let [slope] = slopes.unwrap();
    assert!((slope.force[0] + run.q()[0]).abs() < 1e-12 && slope.q == [0.0] && slope.states == [0.0]);
}

#[test]
fn small_motions_carry_their_states_along() {
    let text = Lagging { gain: 300.0_f64 };
    let run = Simulation::start_from_text(text, Explicit::new(DormandPrince8, Projection::default()), 0.0);
    let run = run.unwrap();
    let (linear, slopes) = linearize_with_states(run.mechanism(), run.instant(), &[]).unwrap();
    let [slope] = slopes.unwrap();
    assert!((linear.mass[0][0] - 2.0).abs() < 1e-14 && (linear.stiffness[0][0] - 100.0).abs() < 1e-12);
    assert!((slope.force[0] - 1.0).abs() < 1e-14 && slope.qd == [0.0]);
    assert!((slope.q[0] + 1000.0).abs() < 1e-10 && (slope.states[0] + 1.0 / 0.3).abs() < 1e-14);
    assert!(linear.frozen, "the state moves");
}

#[test]
fn slopes_of_states_are_the_differences_of_forces_and_rates() {
    let text = Remembering::<f64>::default();
    let (p, z, lambda, qd) = (text.parameters(), [0.3, -0.2], [0.0], [0.4, -0.7]);
    let here = text.position(&p, &[0.3, 0.1], 0.0);
    let slopes = text.state_slopes(&p, &here, &qd, &z, &lambda).unwrap();
    let h = 1e-6;
    for (index, slope) in slopes.iter().enumerate() {
        let by_state = |sign: f64| {
            let mut moved = z;
            moved[index] += sign * h;
            (text.force(&p, &here, &qd, &moved, &lambda), text.state_rates(&p, &here, &qd, &moved, &lambda))
        };
        let ((force, rate), (below, slower)) = (by_state(1.0), by_state(-1.0));
        for ((force, below), slope) in force.iter().zip(below).zip(slope.force) {
            let found = (force - below) / (2.0 * h);
            assert!((found - slope).abs() < 1e-7, "{found}");
        }
        for (state, slope) in slopes.iter().enumerate() {
            let found = (rate[state] - slower[state]) / (2.0 * h);
            assert!((found - slope.states[index]).abs() < 1e-5 * (1.0 + found.abs()), "{found}");
        }
    }
    assert_eq!((slopes[0].qd, slopes[1].q, slopes[1].qd), ([5.0, 0.0], [5.0, 0.0], [0.0, 0.0]));
}
